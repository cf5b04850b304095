//! Whatever the input, there is a scene or a diagnostic with its place, soon.

#![expect(clippy::unwrap_used, reason = "functions that tests share")]

use std::fmt::Write;

use compile::{Compiled, Severity, compile_text};
use proptest::prelude::*;

const LISTING: &str = include_str!("../../../scenes/wine-glass/wine-glass.sdl");

/// Compiles, and checks what holds of any input.
fn compile(text: impl AsRef<[u8]>) -> Compiled {
    let compiled = compile_text(text);
    let errors = compiled.diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
    assert_eq!(compiled.scene.is_none(), errors > 0, "a scene or an error");
    let report = compiled.report();
    let limit = 1000 * compiled.diagnostics.len().min(100) + 100;
    assert!(report.len() < 10 * limit, "a report is short: {}", report.len());
    for diagnostic in compiled.diagnostics.iter().filter(|d| d.span.is_some()) {
        let location = compiled.sources.locate(diagnostic.span.unwrap()).unwrap();
        assert!(location.line >= 1 && location.column >= 1, "from 1");
    }
    if let Some(scene) = &compiled.scene {
        let mut text = Vec::new();
        scene::format::write(scene, &mut text).unwrap();
        let read = scene::format::read(&text);
        assert!(
            read.is_ok(),
            "well formed: {}",
            read.err().map_or_else(String::new, |error| error.to_string())
        );
    }
    compiled
}

#[test]
fn every_prefix_of_the_listing_is_understood() {
    let mut scenes = 0;
    for end in 0..=LISTING.len() {
        scenes += usize::from(compile(&LISTING[..end]).scene.is_some());
    }
    assert!(scenes > 20, "some prefixes are scenes: {scenes}");
}

#[test]
fn the_listing_is_what_the_paper_says() {
    let compiled = compile(LISTING);
    let messages: Vec<&str> = compiled.diagnostics.iter().map(|d| d.message.as_str()).collect();
    assert_eq!(messages, ["this parenthesis is not closed"]);
    let scene = compiled.scene.unwrap();
    assert_eq!(scene.objects.len(), 4, "glass, wine, floor and backdrop");
    assert_eq!(scene.objects[0].solid.frames.len(), 5, "no frames for groups");
    assert_eq!(scene.lights.len(), 1, "a spot");
    assert!((scene.background.x - 0.401_978).abs() < 1e-6, "light gray is 2/3 on the display");
    assert!((scene.ambient.x - 0.3).abs() < 1e-15, "intensity is linear");
}

#[test]
fn nesting_has_a_named_limit() {
    let nested =
        |n: usize, close: usize| format!("object is\n{}sphere{}", "(".repeat(n), ")".repeat(close));
    assert!(compile(nested(50_000, 50_000)).scene.is_some(), "the limit itself");
    assert!(compile(nested(50_000, 0)).scene.is_some(), "all closed at the end");
    for n in [50_001, 1_000_000] {
        let compiled = compile(nested(n, n));
        let expected = "<text>:2:50001: error: parentheses nest deeper than 50000\n";
        assert!(compiled.report().starts_with(expected), "{}", compiled.report());
        assert_eq!(compiled.diagnostics.len(), 1, "nothing follows from it");
    }
    let moved =
        format!("object is {}sphere{}", "red (".repeat(50_000), ") at (1, 0, 0)".repeat(50_000));
    let scene = compile(moved).scene.unwrap();
    assert_eq!(scene.objects[0].solid.frames.len(), 50_001, "a frame for each");
}

#[test]
fn long_chains_are_flat() {
    for (operator, nodes) in [("+", 1_000_001), ("-", 2_000_000), ("*", 1_000_001)] {
        let text = format!("object is cone{}", format!("{operator}cone").repeat(999_999));
        let scene = compile_text(text).scene.unwrap();
        assert_eq!(scene.objects[0].solid.nodes.len(), nodes, "{operator}");
    }
    let text = format!("object is cone{}", "+cone-cone".repeat(300_000));
    let scene = compile_text(text).scene.unwrap();
    assert_eq!(scene.objects[0].solid.nodes.len(), 600_001 + 900_000, "+ and - in turn");
}

#[test]
fn long_tokens_are_cut_in_messages() {
    let long = 100_000_000;
    for (text, message) in [
        ("fog ".to_owned() + &"9".repeat(long), "number too large: `9999"),
        ("object is ".to_owned() + &"x".repeat(long), "unknown class `xxxx"),
        ("fog \"".to_owned() + &"ä".repeat(long / 2), "the text has no closing `\"`"),
        ("object is paint ".to_owned() + &"bump(".repeat(long / 5), "a relief cannot be made of"),
        ("fog ".to_owned() + &"(".repeat(long), "signs and parentheses nest deeper than 50000"),
    ] {
        let compiled = compile(text);
        assert!(compiled.diagnostics[0].message.starts_with(message), "{message}");
        assert!(compiled.report().len() < 1000, "{message}");
    }
}

#[test]
fn many_errors_are_counted() {
    let compiled = compile("object is sphree\n".repeat(5000));
    assert_eq!(compiled.diagnostics.len(), 1001, "some and a count");
    assert_eq!(compiled.diagnostics[1000].message, "4000 more errors are not listed");
    assert_eq!(compiled.report().matches("did you mean `sphere`?").count(), 100, "printed");
    assert!(compiled.report().ends_with("and 901 more\n"), "{}", compiled.report());
    let warned = compile("fog 1 ".repeat(3000) + "object is sphree");
    assert!(warned.error_report().contains("unknown class"), "warnings hide no error");
}

#[test]
fn text_that_is_not_utf8_is_placed() {
    let compiled = compile(b"fog 1\nobject \xc3\xa4\xff is sphere");
    let report = compiled.report();
    assert!(
        report.starts_with("<text>:2:9: error: the file is not UTF-8: found the byte 0xff"),
        "{report}"
    );
    assert_eq!(compiled.diagnostics.len(), 1, "{report}");
}

#[test]
fn numbers_at_the_ends_of_their_range_are_safe() {
    for number in ["1e308", "-1e308", "1e-320", "5e-324", "1e150", "-1e-150", "1e99", "1e-99"] {
        for text in [
            "object is sphere scale N",
            "object is sphere at (N, N, N) rotate (N, N, N)",
            "object is (sphere scale N) scale N at (N, 0, 0)",
            "class a is block scale N object is a scale N",
            "camera at (N, 0, 0) target at (0, N, 0)",
            "light spot (0, 90) at (N, 0, 0) toward (0, 0, N) intensity 1e308",
            "fog 1e-320 ambient intensity 1e308 vivid red",
            "object is trans (1e-320, 1e308) paint wood (1e308, 1e308) red cone",
        ] {
            compile(text.replace('N', number));
        }
    }
}

/// Words, numbers and signs in any order.
fn noise() -> impl Strategy<Value = String> {
    let words = "object is class include camera at target focal length light point beam spot toward \
        intensity no shadows ambient background fog scale rotate shininess smoothness trans fake \
        priority paint wood sphere cone cube shiny smoothest pure red red-orange very dark light gray \
        reddish brown hsv rgb glass let repeat union intersection of from to step i n = { } { } / ^ sin min pi \
        frame ( ) ( ) , , + - * = 1 0 .5 (1,2,3) 90 \"x\" // /* */ \n";
    let words: Vec<&str> = words.split(' ').filter(|word| !word.is_empty()).collect();
    prop::collection::vec(prop::sample::select(words), 0..60).prop_map(|words| words.join(" "))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn noise_is_understood(text in noise()) {
        compile(text);
    }

    #[test]
    fn mutated_bytes_are_understood(
        changes in prop::collection::vec((0..LISTING.len(), any::<u8>()), 1..8),
        cut in prop::option::of((0..LISTING.len(), 0_usize..200)),
    ) {
        let mut bytes = LISTING.as_bytes().to_vec();
        for (at, byte) in changes {
            bytes[at] = byte;
        }
        if let Some((at, length)) = cut {
            let end = (at + length).min(bytes.len());
            bytes.drain(at..end);
        }
        compile(bytes);
    }

    #[test]
    fn signs_swapped_for_signs_are_understood(
        changes in prop::collection::vec((0..LISTING.len(), prop::sample::select(b"()+-*,=/\" \n0.e".to_vec())), 1..20),
    ) {
        let mut bytes = LISTING.as_bytes().to_vec();
        for (at, byte) in changes {
            bytes[at] = byte;
        }
        compile(bytes);
    }
}

#[test]
fn a_large_scene_stays_as_it_is_written() {
    let text = |objects: usize| {
        let mut text = String::from("class leg is cylinder scale (1, .1, .1)\n");
        for i in 0..objects {
            writeln!(
                text,
                "object is shiny red sphere at ({i}, 0, 1) scale 2 - blue block rotate (0, {i}, 0) + leg at (0, 0, {i})"
            )
            .unwrap();
        }
        text
    };
    let scene = compile_text(text(100_000)).scene.unwrap();
    assert_eq!(scene.objects.len(), 100_000, "all of them");
    let leaves = scene.objects.iter().map(|object| object.solid.nodes.len()).sum::<usize>();
    // Three leaves, a complement, an intersection and a union each.
    assert_eq!(leaves, 600_000, "nothing expanded");
}
