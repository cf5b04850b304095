//! The compiled scene file: round trips, damaged files, and messages.

#![expect(clippy::unwrap_used, reason = "tests, and what they share")]

use std::io;

use glam::DVec3;
use scene::class::AttributesTable;
use scene::texture::Texture;
use scene::{
    Attributes, AttributesId, Camera, ClassId, Frame, FrameId, Index, Light, LightKind, Node,
    Paint, Placement, Primitive, Scene, Solid, Transparency, format,
};

#[path = "format/limits.rs"]
mod limits;
mod support;
use support::Random;

fn written(scene: &Scene) -> Vec<u8> {
    let mut text = Vec::new();
    format::write(scene, &mut text).unwrap_or_else(|error| panic!("{error}\n{scene:?}"));
    text
}

/// Reads a text; if it is accepted, what is written of it has to be read as the same, to the byte.
fn read(text: &[u8]) -> Result<Scene, String> {
    let scene = format::read(text).map_err(|error| error.to_string())?;
    let again = written(&scene);
    assert_eq!(format::read(&again).as_ref(), Ok(&scene), "{}", String::from_utf8_lossy(text));
    assert_eq!(written(&format::read(&again).unwrap()), again, "the same bytes");
    Ok(scene)
}

fn frame(placement: Placement) -> Frame {
    Frame { parent: None, placement, attributes: AttributesId::NONE }
}

fn at(x: f64, y: f64, z: f64) -> Placement {
    Placement { place: DVec3::new(x, y, z), ..Placement::default() }
}

fn leaf(kind: Primitive, frame: u32) -> Node {
    Node::Primitive { kind, frame: FrameId(frame) }
}

fn instance(class: u32, frame: u32) -> Node {
    Node::Instance { class: ClassId(class), frame: FrameId(frame) }
}

/// The scene of `docs/compiled-scene.md`: a cup of glass, twice, on a table.
fn cups() -> Scene {
    let mut scene = Scene {
        camera: Some(Camera {
            parallel: false,
            position: DVec3::new(0.0, 2.0, 8.0),
            target: DVec3::ZERO,
            focal_length_mm: 50.0,
        }),
        lights: vec![
            Light {
                kind: LightKind::Point { at: DVec3::new(4.0, 9.0, 6.0) },
                color: DVec3::ONE,
                shadows: true,
                radius: 0.0,
            },
            Light {
                kind: LightKind::Spot {
                    at: DVec3::new(-5.0, 8.0, 2.0),
                    toward: DVec3::ZERO,
                    concentration: 12.0,
                    half_angle_degrees: 30.0,
                },
                color: DVec3::new(0.5, 0.45, 0.25),
                shadows: false,
                radius: 0.0,
            },
        ],
        ambient: DVec3::splat(0.1),
        background: DVec3::new(0.0, 0.0, 0.25),
        fog_half_distance: Some(100.0),
        ..Scene::default()
    };
    let mut table = AttributesTable::default();
    let trans = Transparency { half_distance: 4.0, index: Index::Refractive(1.5) };
    let glass = Attributes { transparency: Some(trans), ..Attributes::default() };
    let glass = table.intern(&mut scene, glass);
    let grain = Paint {
        texture: Texture::named("wood").unwrap(),
        color: Some(DVec3::new(0.25, 0.125, 0.0)),
    };
    let wood = Attributes {
        color: Some(DVec3::new(0.5, 0.25, 0.125)),
        smoothness: Some(0.125),
        paint: vec![grain],
        ..Attributes::default()
    };
    let wood = table.intern(&mut scene, wood);
    let upright = Placement {
        scale: DVec3::new(2.0, 1.0, 1.0),
        rotation_degrees: DVec3::new(0.0, 0.0, 90.0),
        ..Placement::default()
    };
    let inner = Placement { place: DVec3::new(0.0, 0.25, 0.0), ..upright };
    let cup = Solid {
        frames: vec![frame(upright), frame(inner)],
        nodes: vec![
            leaf(Primitive::Cone, 0),
            leaf(Primitive::Cone, 1),
            Node::Complement,
            Node::Intersection(2),
        ],
        ..Solid::default()
    };
    let cup = scene.add_class("cup".to_owned(), cup);
    let pair = Solid {
        frames: vec![
            Frame { attributes: glass, ..frame(at(0.0, 0.5, 0.0)) },
            Frame { parent: Some(FrameId(0)), ..frame(at(-1.5, 0.0, 0.0)) },
            Frame { parent: Some(FrameId(0)), ..frame(at(1.5, 0.0, 0.0)) },
        ],
        nodes: vec![instance(cup.0, 1), instance(cup.0, 2), Node::Union(2)],
        ..Solid::default()
    };
    scene.add_object(Some("pair".to_owned()), pair);
    let mut board = Solid::primitive(
        Primitive::Block,
        Placement { scale: DVec3::new(4.0, 0.5, 2.0), ..Placement::default() },
    );
    board.frames[0].attributes = wood;
    scene.add_object(None, board);
    scene
}

#[test]
fn random_scenes_come_back_the_same() {
    let (mut bytes, mut nodes) = (0, [0; 6]);
    for seed in 0..500 {
        let scene = Random(seed).scene();
        let text = written(&scene);
        let found = format::read(&text).unwrap_or_else(|error| panic!("{seed}: {error}"));
        assert_eq!(found, scene, "seed {seed}");
        assert_eq!(written(&found), text, "seed {seed}");
        bytes += text.len();
        for node in scene.objects.iter().flat_map(|object| &object.solid.nodes) {
            nodes[match node {
                Node::Primitive { .. } => 0,
                Node::Instance { .. } => 1,
                Node::Union(_) => 2,
                Node::Intersection(_) => 3,
                Node::Complement => 4,
                Node::Form { .. } => 5,
            }] += 1;
        }
    }
    assert!(bytes > 500_000 && nodes.iter().all(|n| *n > 100), "{bytes} bytes, nodes {nodes:?}");
}

/// The first block of text in `docs/compiled-scene.md` that begins with `first`.
fn documented(first: &str) -> &'static str {
    let page = include_str!("../../../docs/compiled-scene.md");
    let begin = page.find(&format!("```text\n{first}")).expect("an example") + "```text\n".len();
    let end = page[begin..].find("```").expect("the end of the example");
    &page[begin..begin + end]
}

#[test]
fn the_example_of_the_documentation_holds() {
    let text = documented("portray scene 2\n");
    assert_eq!(String::from_utf8(written(&cups())).unwrap(), text, "what is written");
    assert_eq!(format::read(text.as_bytes()), Ok(cups()), "what is read");
}

#[test]
fn every_bit_of_a_number_survives() {
    let numbers = [
        0.0,
        -0.0,
        5e-324,
        -2.225_073_858_507_201e-308,
        f64::MIN_POSITIVE,
        1e-5,
        0.1,
        1.0 / 3.0,
        1.0 + f64::EPSILON,
        9_007_199_254_740_994.0,
        1e16,
        1e22,
        1e23,
        1e300,
        f64::MAX,
    ];
    for number in numbers {
        let mut scene = Scene { ambient: DVec3::new(number, -number, 1.0), ..Scene::default() };
        if number.abs() < 1e299 {
            scene.add_object(None, Solid::primitive(Primitive::Sphere, at(number, 0.0, 0.0)));
        }
        let found = format::read(&written(&scene)).unwrap();
        assert_eq!(found.ambient.x.to_bits(), number.to_bits(), "{number:?}");
        let place = found.objects.first().map(|o| o.solid.frames[0].placement.place.x.to_bits());
        assert!(place.is_none_or(|bits| bits == number.to_bits()), "{number:?} as place");
    }
}

#[test]
fn damaged_files_are_refused_or_stable() {
    let text = written(&cups());
    let (mut refused, mut accepted) = (0, 0);
    let mut count = |text: &[u8]| match read(text) {
        Ok(_) => accepted += 1,
        Err(_) => refused += 1,
    };
    for end in 0..text.len() {
        count(&text[..end]);
    }
    for i in 0..text.len() {
        let mut damaged = text.clone();
        for byte in (0..=255).filter(|byte| *byte != text[i]) {
            damaged[i] = byte;
            count(&damaged);
        }
        damaged.remove(i);
        count(&damaged);
    }
    let lines: Vec<&[u8]> = text.split_inclusive(|byte| *byte == b'\n').collect();
    for i in 0..lines.len() {
        count(&[&lines[..i], &lines[i + 1..]].concat().concat());
        count(&[&lines[..=i], &lines[i..]].concat().concat());
        for j in 0..i {
            let mut swapped = lines.clone();
            swapped.swap(i, j);
            count(&swapped.concat());
        }
    }
    assert!(refused > 300_000 && accepted > 1_000, "{refused} refused, {accepted} accepted");
}

#[test]
fn a_cut_file_is_never_a_smaller_scene() {
    let text = written(&cups());
    // The last byte ends the line of `end`.
    for end in 0..text.len() - 1 {
        assert!(format::read(&text[..end]).is_err(), "{end} bytes of {}", text.len());
    }
}

/// The message for the documented scene with `from` replaced by `to` once.
fn refusal(from: &str, to: &str) -> String {
    let text = String::from_utf8(written(&cups())).unwrap();
    assert!(text.contains(from), "`{from}` in the example");
    read(text.replacen(from, to, 1).as_bytes()).expect_err(to)
}

/// What to replace in the documented scene, by what, and what is said of it.
const MESSAGES: &[(&str, &str, &str)] = &[
    (
        "portray scene 2",
        "portray scene 1",
        "line 1, column 15: expected version 2, found `1`: compile the scene again with the \
             programs of this version",
    ),
    (
        "portray",
        "class",
        "line 1, column 1: expected `portray`, found `class`: this is not a compiled scene",
    ),
    (
        "target 0.0 0.0 0.0",
        "target 0 2 8",
        "line 2, column 30: expected two points a finite distance apart, found `0`",
    ),
    ("focal 50.0", "focal -50.0", "line 2, column 48: expected a number above 0, found `-50.0`"),
    ("ambient 0.1", "ambient inf", "line 3, column 9: expected a finite number, found `inf`"),
    ("fog 100.0", "fog", "line 5, column 4: expected a number above 0, found the end of the line"),
    (
        "angle 30.0",
        "angle 181.0",
        "line 7, column 72: expected an angle above 0, at most 180, found `181.0`",
    ),
    (
        "light point",
        "light laser",
        "line 6, column 7: expected `point`, `beam` or `spot`, found `laser`",
    ),
    (
        "smoothness 0.125",
        "smoothness 1.5",
        "line 9, column 46: expected a number from 0 to 1, found `1.5`",
    ),
    ("trans 4.0 1.5", "trans 4.0 0.0", "line 8, column 24: expected a number above 0, found `0.0`"),
    (
        "attributes 2",
        "attributes 3",
        "line 9, column 12: expected number 2, the next in order, found `3`",
    ),
    ("paint wood", "paint wool", "line 10, column 9: expected a texture function, found `wool`"),
    (
        "wood scale 4.0",
        "wood scale 0.0",
        "line 10, column 20: expected an argument in its range, found `0.0`",
    ),
    (
        "class 0 cup",
        "class 0 Cup",
        "line 11, column 9: expected a name in lower case without blanks, found `Cup`",
    ),
    (
        "scale 2.0 1.0",
        "scale 2.0 0.0",
        "line 12, column 18: expected a number other than 0, found `0.0`",
    ),
    (
        "  instance 0 in 0 at 1.5",
        "  instance 0 frame 2 at 1.5",
        "line 20, column 20: expected a frame from 0 to 1, found `2`",
    ),
    (
        "  instance 0 in 0 at 1.5",
        "  instance 0 frame 1 at 1.5",
        "line 20, column 22: expected the end of the line, found `at`",
    ),
    (
        "  cone scale",
        "  instance 0 scale",
        "line 12, column 12: expected a class, of which there is none so far, found `0`",
    ),
    (
        "intersection 2",
        "union 2",
        "line 15, column 9: expected complements only as operands, not the first, of \
             intersections, found `2`",
    ),
    (
        "intersection 2",
        "intersection 3",
        "line 15, column 16: expected a number of operands from 2 to 2, as many as precede, \
             found `3`",
    ),
    (
        "  intersection 2\n",
        "",
        "line 15, column 3: expected an operator that joins the 2 operands, found `box`",
    ),
    (
        "  cone scale",
        "  complement\n  cone scale",
        "line 12, column 3: expected an operand before its complement, found `complement`",
    ),
    (
        "  complement\n",
        "  comp\n",
        "line 14, column 3: expected a solid, `instance`, `union`, \
             `intersection`, `complement`, `frame` or `box`, found `comp`",
    ),
    (
        "  frame 0 at",
        "  frame 0 in 0 at",
        "line 18, column 14: expected a frame, of which there is none so far, found `0`",
    ),
    (
        "  frame 0 at",
        "  frame 1 at",
        "line 18, column 9: expected number 0, the next in order, found `1`",
    ),
    (
        "attributes 1\n  instance",
        "attributes 3\n  instance",
        "line 18, column 37: expected a set of attributes from 0 to 2, found `3`",
    ),
    (
        "block scale 4.0 0.5",
        "block scale 4.0 1e-320",
        "line 26, column 3: expected placements that make finite matrices and boxes, found `box`",
    ),
    (
        "object pair",
        "object a pair",
        "line 17, column 10: expected the end of the line, found `pair`",
    ),
    (
        "\nend\n",
        "\ncamera\n",
        "line 28, column 1: expected one of these lines, in this order: `camera`, `lens`, `ambient`, \
             `background`, `fog`, `light`, `image`, `attributes`, `class`, `object`, `end`, found `camera`",
    ),
    ("\nend\n", "\nend\n\nend\n", "line 30, column 1: expected nothing after `end`, found `end`"),
];

#[test]
fn messages_name_place_expectation_and_finding() {
    let mut wrong = Vec::new();
    let again = "does not match; compile the scene again";
    for (from, to, message) in MESSAGES {
        let found = refusal(from, to);
        if found != *message {
            wrong.push(format!("{from} → {to}:\n  {found}\n  {message}"));
        }
    }
    assert!(wrong.is_empty(), "found and expected:\n{}", wrong.join("\n"));
    // Whatever follows from the rest has to follow from it.
    for (from, to) in [
        ("at 0.0 0.5 0.0", "at 0.0 0.25 0.0"),
        ("scale 2.0 1.0", "scale 2.5 1.0"),
        ("block", "cylinder"),
        ("  box -4", "  box -5"),
        ("  box -4.000000000000014", "  box -4.000000000000015"),
        ("  rectangle -", "  rectangle "),
        ("camera at 0.0 2.0 8.0", "camera at 0.0 2.0 9.0"),
        ("  rectangle", "  box"),
    ] {
        let message = refusal(from, to);
        assert!(message.ends_with(again), "{from} → {to}: {message}");
    }
    assert!(refusal("end\n", "\u{1}end\n").contains("found byte 1"), "control characters");
    let long = refusal("object pair", &format!("object {}", "PAIR".repeat(1000)));
    assert!(long.len() < 200, "{long}");
}

#[test]
fn any_other_number_in_place_of_one_derived_is_refused_in_its_line() {
    let text = written(&cups());
    let mut line = 1;
    let (mut refused, mut same) = (0, 0);
    for (i, &byte) in text.iter().enumerate() {
        line += usize::from(byte == b'\n');
        let begin = text[..i].iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        let first = text[begin..].trim_ascii_start();
        let derived = ["box", "rectangle"].iter().any(|word| first.starts_with(word.as_bytes()));
        if !derived || !byte.is_ascii_digit() {
            continue;
        }
        let start = text[..i].iter().rposition(|byte| *byte == b' ').unwrap() + 1;
        let length = text[i..].iter().position(|byte| *byte <= b' ').unwrap();
        let number = |text: &[u8]| -> f64 {
            std::str::from_utf8(&text[start..i + length]).unwrap().parse().unwrap()
        };
        for digit in (b'0'..=b'9').filter(|digit| *digit != byte) {
            let mut other = text.clone();
            other[i] = digit;
            match format::read(&other) {
                Ok(_) => {
                    assert_eq!(number(&other).to_bits(), number(&text).to_bits(), "line {line}");
                    same += 1;
                }
                Err(error) => {
                    assert_eq!(error.line, line, "{error}");
                    assert!(error.hint.is_some(), "{error}");
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > 3_500 && same < refused / 100, "{refused} refused, {same} the same");
}

#[test]
fn what_nobody_derives_may_be_edited() {
    let text = String::from_utf8(written(&cups())).unwrap();
    let edited = text
        .replace("trans 4.0 1.5", "  trans\t4 1.33")
        .replace("color 1.0 1.0 1.0", "color 1 .5 1e0")
        .replace('\n', "\r\n\r\n");
    let scene = read(edited.as_bytes()).unwrap();
    assert_eq!(scene.lights[0].color, DVec3::new(1.0, 0.5, 1.0), "light");
    assert_eq!(
        scene.attributes[1].transparency.map(|t| t.index),
        Some(Index::Refractive(1.33)),
        "glass"
    );
}

#[test]
fn shared_classes_stay_shared() {
    let mut scene = Scene::default();
    let mut nodes = vec![leaf(Primitive::Sphere, 0)];
    for level in 0..40 {
        if level > 0 {
            nodes = (0..10).map(|i| instance(level - 1, i)).collect();
            nodes.push(Node::Union(10));
        }
        let frames = (0..10).map(|i| frame(at(f64::from(i), f64::from(level), 0.0))).collect();
        scene.add_class(
            format!("level_{level}"),
            Solid { frames, nodes: nodes.clone(), ..Solid::default() },
        );
    }
    scene.add_object(
        None,
        Solid {
            frames: vec![frame(Placement::default())],
            nodes: vec![instance(39, 0)],
            ..Solid::default()
        },
    );
    let text = written(&scene);
    assert!(text.len() < 200_000, "{} bytes", text.len());
    assert_eq!(format::read(&text), Ok(scene), "round trip");
}

#[test]
fn a_scene_no_reader_takes_is_not_written() {
    type Change = fn(&mut Scene);
    let refused = |change: Change| {
        let mut scene = cups();
        change(&mut scene);
        let error = format::write(&scene, &mut io::sink()).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::InvalidInput, "{error}");
        error.to_string()
    };
    let changes: [(&str, Change); 12] = [
        ("line 3", |scene| scene.ambient.x = f64::NAN),
        ("apart", |scene| scene.camera.as_mut().unwrap().target = DVec3::new(0.0, 2.0, 8.0)),
        ("above 0", |scene| scene.fog_half_distance = Some(0.0)),
        ("empty", |scene| scene.attributes.clear()),
        ("lower case", |scene| scene.classes[0].name = "two words".to_owned()),
        ("lower case", |scene| scene.objects[0].name = Some(String::new())),
        ("earlier frame", |scene| scene.objects[0].solid.frames[1].parent = Some(FrameId(1))),
        ("other than 0", |scene| scene.objects[1].solid.frames[0].placement.scale.y = -0.0),
        ("earlier class", |scene| scene.classes[0].solid.nodes[0] = instance(0, 0)),
        ("from 2 to 2", |scene| scene.objects[0].solid.nodes[2] = Node::Union(3)),
        ("a primitive or an instance", |scene| scene.objects[0].solid.nodes.clear()),
        // 1 / 5e-324 is infinite.
        ("finite", |scene| scene.objects[1].solid.frames[0].placement.scale.y = 5e-324),
    ];
    for (expected, change) in changes {
        let message = refused(change);
        assert!(message.contains(expected), "{expected}: {message}");
    }
}
