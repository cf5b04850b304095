//! The graded words with their numbers, and what stands where nothing is said.

use scene::{Attributes, Optics, Scene};

use crate::support::scene;

/// What the one set of attributes of `text` comes to.
fn optics(attributes: &str) -> Optics {
    let scene: Scene = scene(&format!("object is {attributes} sphere camera at (0, 0, 9)"));
    scene.attributes.last().map(Attributes::resolved).expect("a set")
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-15
}

#[test]
fn graded_words_are_numbers() {
    for (word, shininess) in [
        ("dullest", 0.0),
        ("duller", 0.05),
        ("dull", 0.2),
        ("shiny", 0.5),
        ("shinier", 0.8),
        ("shiniest", 1.0),
    ] {
        let found = optics(word);
        assert!(same(found.shininess, shininess), "{word}: {found:?}");
        assert!(same(found.smoothness, 0.25) && !found.pure, "{word} says no more: {found:?}");
        assert_eq!(found, optics(&format!("shininess {shininess}")), "{word}");
    }
    for (word, smoothness) in [
        ("roughest", 0.6),
        ("rougher", 0.4),
        ("rough", 0.25),
        ("smooth", 0.12),
        ("smoother", 0.05),
        ("smoothest", 0.0),
    ] {
        let found = optics(word);
        assert!(same(found.smoothness, smoothness), "{word}: {found:?}");
        assert!(same(found.shininess, 0.0) && !found.pure, "{word} says no more: {found:?}");
        assert_eq!(found, optics(&format!("smoothness {smoothness}")), "{word}");
    }
}

#[test]
fn what_is_not_said_has_a_default() {
    let plain = optics("white");
    assert_eq!(plain, Optics::DEFAULT, "matte, rough, composite, opaque");
    assert!(optics("pure").pure && !optics("composite").pure, "pure and composite");
    let glass = optics("trans (5, 1.5)");
    assert!(same(glass.shininess, 1.0) && same(glass.smoothness, 0.25), "{glass:?}");
    let dull = optics("dull trans (5, 1.5)");
    assert!(same(dull.shininess, 0.2), "{dull:?}");
}
