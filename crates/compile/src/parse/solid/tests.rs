//! Solids as they are read: trees of operators, attributes and places.

use scene::AttributesId;

use super::*;
use crate::Options;
use crate::diagnostic::Diagnostics;
use crate::shared::Shared;
use crate::source::Text;

fn solid(text: &str) -> Solid {
    let mut shared = Shared::new(&Options::default());
    let file = Text { text: text.into(), bad: None };
    let mut cursor = Cursor::new(file, 0, &mut Diagnostics::default());
    let solid = Parser::new(&mut cursor, &mut shared).solid().unwrap();
    assert!(!shared.diagnostics.has_errors(), "{text}");
    solid
}

/// The nodes in a line: primitives by their first letter, operators with their count.
fn shape(text: &str) -> String {
    let words = solid(text).nodes.into_iter().map(|node| match node {
        Node::Primitive { kind, .. } => kind.keywords()[0][..2].to_owned(),
        Node::Form { .. } => "form".to_owned(),
        Node::Named { .. } | Node::Made { .. } => "name".to_owned(),
        Node::Union(n) => format!("+{n}"),
        Node::Intersection(n) => format!("*{n}"),
        Node::Complement => "!".to_owned(),
    });
    words.collect::<Vec<_>>().join(" ")
}

#[test]
fn operators_keep_their_order() {
    for (text, expected) in [
        ("sphere", "sp"),
        ("sphere + block + cone", "sp bl co +3"),
        ("sphere * block * cone", "sp bl co *3"),
        ("sphere - block", "sp bl ! *2"),
        ("sphere - block - cone", "sp bl ! co ! *3"),
        ("sphere + block - cone + cylinder", "sp bl +2 co ! *2 cy +2"),
        ("sphere - block + cone + cylinder", "sp bl ! *2 co cy +3"),
        ("sphere + block * cone", "sp bl co *2 +2"),
        ("sphere - block * cone", "sp bl co *2 ! *2"),
        ("sphere - (block + cone)", "sp bl co +2 ! *2"),
        ("(sphere + block) * cone", "sp bl +2 co *2"),
        ("((sphere)) + (((block)))", "sp bl +2"),
        ("cube", "bl"),
    ] {
        assert_eq!(shape(text), expected, "{text}");
    }
}

#[test]
fn only_groups_that_say_something_have_frames() {
    let plain = solid("((sphere + block))");
    assert_eq!(plain.frames.len(), 2, "one for each primitive");
    assert!(plain.frames.iter().all(|frame| frame.parent.is_none()), "{plain:?}");

    let moved = solid("((sphere + block) at (1, 2, 3) + red (cone))");
    let parents: Vec<_> = moved.frames.iter().map(|frame| frame.parent).collect();
    assert_eq!(parents, [None, Some(0), Some(0), None, Some(3)]);
    assert_eq!(moved.frames[0].placement.place, DVec3::new(1.0, 2.0, 3.0));
    assert_ne!(moved.frames[3].attributes, AttributesId::NONE, "red");
}

#[test]
fn transforms_stand_in_any_order() {
    let frame = solid("cone rotate (0, 0, 90) scale -2 at (1, 2, 3)").frames[0];
    assert_eq!(frame.placement.scale, DVec3::splat(-2.0));
    assert_eq!(frame.placement.rotation_degrees, DVec3::new(0.0, 0.0, 90.0));
    assert_eq!(frame.placement.place, DVec3::new(1.0, 2.0, 3.0));
    let frame = solid("cone scale (1, 2, 3)").frames[0];
    assert_eq!(frame.placement.scale, DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(shape("sphere scale 2 - block scale 2 * cone"), "sp bl co *2 ! *2");
}
