//! The paper's form of small scenes, worked out by hand.

use scene::class::AttributesTable;
use scene::texture::Texture;
use scene::{AttributesId, ClassId, Placement, Transparency};

use super::*;

fn printed(scene: &Scene, limit: u64) -> String {
    let mut text = Vec::new();
    print(scene, limit, &mut text).unwrap();
    String::from_utf8(text).unwrap()
}

fn at(x: f64, y: f64, z: f64) -> Frame {
    let placement = Placement { place: DVec3::new(x, y, z), ..Placement::default() };
    Frame { parent: None, placement, attributes: AttributesId::NONE }
}

fn instance(class: u32, frame: u32) -> Node {
    Node::Instance { class: ClassId(class), frame: FrameId(frame) }
}

/// Spheres 10 apart along x, then `operators`, as a scene of one object.
fn row(n: u32, operators: &[(usize, Node)]) -> Scene {
    let frames = (0..n).map(|i| at(10.0 * f64::from(i), 0.0, 0.0)).collect();
    let leaf = |i| Node::Primitive { kind: Primitive::Sphere, frame: FrameId(i) };
    let mut nodes: Vec<Node> = (0..n).map(leaf).collect();
    for (place, operator) in operators {
        nodes.insert(*place, *operator);
    }
    let mut scene = Scene::default();
    scene.add_object(None, Solid { frames, nodes, ..Solid::default() });
    scene
}

/// The one object with brackets about its operators and spheres by number, and its depth.
fn tree(scene: &Scene) -> (String, u32) {
    let mut stack: Vec<(String, u32)> = Vec::new();
    let text = printed(scene, LIMIT);
    for line in text.lines() {
        let operator = match line.trim_start() {
            "union" => "+",
            "intersection" => "*",
            "subtraction" => "-",
            _ => {
                if let Some(row) = line.strip_prefix("    inverse 1.0 0.0 0.0 ") {
                    let x: f64 = row.split(' ').next().unwrap().parse().unwrap();
                    stack.push((format!("{}", x / 10.0), 0));
                }
                continue;
            }
        };
        let (second, b) = stack.pop().unwrap();
        let (first, a) = stack.pop().unwrap();
        stack.push((format!("({first}{operator}{second})"), 1 + a.max(b)));
    }
    assert_eq!(stack.len(), 1, "one tree: {text}");
    stack.remove(0)
}

#[test]
fn the_example_of_the_documentation_holds() {
    let page = include_str!("../../../../docs/compiled-scene.md");
    let block = |first: &str| {
        let begin = page.find(&format!("```text\n{first}")).unwrap() + "```text\n".len();
        &page[begin..begin + page[begin..].find("```").unwrap()]
    };
    let scene = format::read(block("portray scene 2\n").as_bytes()).unwrap();
    assert_eq!(printed(&scene, LIMIT), block("portray expanded 1\n"), "expanded");
}

#[test]
fn seven_terms_are_three_deep() {
    let (text, depth) = tree(&row(7, &[(7, Node::Union(7))]));
    assert_eq!((text.as_str(), depth), ("(((0+1)+(2+3))+((4+5)+6))", 3), "union");
    let (text, depth) = tree(&row(7, &[(7, Node::Intersection(7))]));
    assert_eq!((text.as_str(), depth), ("(((0*1)*(2*3))*((4*5)*6))", 3), "intersection");
    for n in 2_u32..70 {
        let (_, depth) = tree(&row(n, &[(n as usize, Node::Union(n))]));
        assert_eq!(depth, n.next_power_of_two().ilog2(), "{n} terms");
    }
}

#[test]
fn subtractions_go_from_left_to_right() {
    let complement = Node::Complement;
    let cases = [
        (3, vec![(2, complement), (4, complement), (5, Node::Intersection(3))], "((0-1)-2)"),
        (
            3,
            vec![
                (2, complement),
                (3, Node::Intersection(2)),
                (5, complement),
                (6, Node::Intersection(2)),
            ],
            "((0-1)-2)",
        ),
        (3, vec![(3, Node::Union(2)), (4, complement), (5, Node::Intersection(2))], "(0-(1+2))"),
        (
            6,
            vec![(3, complement), (7, complement), (8, Node::Intersection(6))],
            "(((((0*1)-2)*3)*4)-5)",
        ),
    ];
    for (n, operators, expected) in cases {
        assert_eq!(tree(&row(n, &operators)).0, expected, "{operators:?}");
    }
}

#[test]
fn a_class_used_twice_is_printed_twice() {
    let mut scene = Scene::default();
    let mut table = AttributesTable::default();
    let trans = Transparency { half_distance: 3.0, index: Index::Refractive(1.5) };
    let glass = Attributes { transparency: Some(trans), ..Attributes::default() };
    let coat = Paint { texture: Texture::named("checker3d").unwrap(), color: Some(DVec3::X) };
    let red = Attributes {
        color: Some(DVec3::new(0.5, 0.0, 0.0)),
        smoothness: Some(0.125),
        paint: vec![coat],
        ..Attributes::default()
    };
    let (glass, red) = (table.intern(&mut scene, glass), table.intern(&mut scene, red));
    let stretched = Placement {
        scale: DVec3::new(2.0, 1.0, 4.0),
        place: DVec3::new(1.0, 0.0, 0.0),
        ..Placement::default()
    };
    let cut = Solid {
        frames: vec![
            Frame { parent: None, placement: stretched, attributes: glass },
            at(0.0, 0.5, 0.0),
        ],
        nodes: vec![
            Node::Primitive { kind: Primitive::Block, frame: FrameId(0) },
            Node::Primitive { kind: Primitive::Cone, frame: FrameId(1) },
            Node::Complement,
            Node::Intersection(2),
        ],
        ..Solid::default()
    };
    scene.add_class("cut".to_owned(), cut);
    let twice = Solid {
        frames: vec![at(0.0, 8.0, 0.0), Frame { attributes: red, ..at(0.0, -8.0, 0.0) }],
        nodes: vec![instance(0, 0), instance(0, 1), Node::Union(2)],
        ..Solid::default()
    };
    scene.add_object(Some("twice".to_owned()), twice);
    let text = printed(&scene, 4);
    let boxes: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("    box ")).collect();
    let text: String = text.split_inclusive('\n').filter(|l| !l.contains("box")).collect();
    assert_eq!(text, TWICE, "without the boxes");
    // Each block reaches from −1 to 3 along x, by 1 along y and by 4 along z.
    let expected = [
        [-1.0, 7.0, -4.0, 3.0, 9.0, 4.0],
        [-1.0, -9.0, -4.0, 3.0, -7.0, 4.0],
        [-1.0, -9.0, -4.0, 3.0, 9.0, 4.0],
    ];
    assert_eq!(boxes.len(), 3, "{boxes:?}");
    for (found, expected) in boxes.iter().zip(expected) {
        for (found, expected) in found.split(' ').zip(expected) {
            let found: f64 = found.parse().unwrap();
            assert!((found - expected).abs() < 1e-13, "{boxes:?}");
        }
    }
}

const TWICE: &str = "\
portray expanded 1
object twice
  block
    matrix 0.5 0.0 0.0 -0.5 0.0 1.0 0.0 -8.0 0.0 0.0 0.25 0.0
    inverse 2.0 0.0 0.0 1.0 0.0 1.0 0.0 8.0 0.0 0.0 4.0 0.0
    optics color 1.0 1.0 1.0 shininess 1.0 smoothness 0.25 composite trans 3.0 1.5 priority 0
  cone
    matrix 1.0 0.0 0.0 0.0 0.0 1.0 0.0 -8.5 0.0 0.0 1.0 0.0
    inverse 1.0 0.0 0.0 0.0 0.0 1.0 0.0 8.5 0.0 0.0 1.0 0.0
    optics color 1.0 1.0 1.0 shininess 0.0 smoothness 0.25 composite priority 0
  subtraction
  block
    matrix 0.5 0.0 0.0 -0.5 0.0 1.0 0.0 8.0 0.0 0.0 0.25 0.0
    inverse 2.0 0.0 0.0 1.0 0.0 1.0 0.0 -8.0 0.0 0.0 4.0 0.0
    optics color 0.5 0.0 0.0 shininess 1.0 smoothness 0.125 composite trans 3.0 1.5 priority 0
    paint checker3d scale 1.0 color 1.0 0.0 0.0
    grain 1.0 0.0 0.0 0.0 0.0 1.0 0.0 8.0 0.0 0.0 1.0 0.0
  cone
    matrix 1.0 0.0 0.0 0.0 0.0 1.0 0.0 7.5 0.0 0.0 1.0 0.0
    inverse 1.0 0.0 0.0 0.0 0.0 1.0 0.0 -7.5 0.0 0.0 1.0 0.0
    optics color 0.5 0.0 0.0 shininess 0.0 smoothness 0.125 composite priority 0
    paint checker3d scale 1.0 color 1.0 0.0 0.0
    grain 1.0 0.0 0.0 0.0 0.0 1.0 0.0 8.0 0.0 0.0 1.0 0.0
  subtraction
  union
end
";

#[test]
fn what_is_said_further_in_wins() {
    let mut scene = Scene::default();
    let mut table = AttributesTable::default();
    let coat = |color| Paint { texture: Texture::named("checker3d").unwrap(), color: Some(color) };
    let mut shiny = |shininess, smoothness, paint: &[Paint]| {
        let attributes = Attributes {
            shininess: Some(shininess),
            smoothness,
            paint: paint.to_vec(),
            ..Attributes::default()
        };
        table.intern(&mut scene, attributes)
    };
    let outer = shiny(0.125, Some(0.0), &[coat(DVec3::X)]);
    let group = shiny(0.25, None, &[coat(DVec3::Y), coat(DVec3::Z)]);
    let inner = shiny(0.5, None, &[]);
    let own = shiny(0.75, None, &[coat(DVec3::ONE)]);
    let within = |attributes, x| Frame { parent: Some(FrameId(0)), attributes, ..at(x, 0.0, 0.0) };
    let frames = vec![
        Frame { attributes: group, ..at(0.0, 4.0, 0.0) },
        within(inner, 1.0),
        within(own, 2.0),
    ];
    let leaf = |frame| Node::Primitive { kind: Primitive::Sphere, frame: FrameId(frame) };
    let pair = Solid { frames, nodes: vec![leaf(1), leaf(2), Node::Union(2)], ..Solid::default() };
    scene.add_class("pair".to_owned(), pair);
    let frames = vec![Frame { attributes: outer, ..at(0.0, 0.0, 8.0) }];
    scene.add_object(None, Solid { frames, nodes: vec![instance(0, 0)], ..Solid::default() });
    let text = printed(&scene, LIMIT);
    let said: Vec<&str> = text
        .lines()
        .filter_map(|line| {
            line.strip_prefix("    ").filter(|line| {
                ["optics", "paint", "grain"].iter().any(|word| line.starts_with(word))
            })
        })
        .collect();
    let expected = [
        "optics color 1.0 1.0 1.0 shininess 0.5 smoothness 0.0 composite priority 0",
        "paint checker3d scale 1.0 color 0.0 1.0 0.0",
        "paint checker3d scale 1.0 color 0.0 0.0 1.0",
        "grain 1.0 0.0 0.0 0.0 0.0 1.0 0.0 -4.0 0.0 0.0 1.0 -8.0",
        "optics color 1.0 1.0 1.0 shininess 0.75 smoothness 0.0 composite priority 0",
        "paint checker3d scale 1.0 color 1.0 1.0 1.0",
    ];
    assert_eq!(said, expected, "{text}");
}

#[test]
fn what_is_too_large_is_counted_and_refused() {
    let mut scene = row(1, &[]);
    for level in 0..40 {
        let frames = vec![at(1.0, 0.0, 0.0); 10];
        let kind = Primitive::Sphere;
        let mut nodes: Vec<Node> = match level {
            0 => (0..10).map(|i| Node::Primitive { kind, frame: FrameId(i) }).collect(),
            _ => (0..10).map(|i| instance(level - 1, i)).collect(),
        };
        nodes.push(Node::Union(10));
        scene.add_class(format!("level_{level}"), Solid { frames, nodes, ..Solid::default() });
    }
    let sum =
        Solid { frames: vec![at(0.0, 0.0, 0.0)], nodes: vec![instance(2, 0)], ..Solid::default() };
    scene.add_object(None, sum.clone());
    let mut text = Vec::new();
    match print(&scene, 1000, &mut text) {
        Err(PaperError::TooMany { primitives: 1001, limit: 1000 }) => {}
        other => panic!("{other:?}"),
    }
    assert!(text.is_empty(), "nothing is printed");
    assert_eq!(printed(&scene, 1001).matches("optics").count(), 1001, "one more is allowed");
    scene.objects[1].solid.nodes = vec![instance(39, 0)];
    let message = print(&scene, LIMIT, &mut text).unwrap_err().to_string();
    assert!(message.contains("at least 18446744073709551615 primitives"), "{message}");
}

#[test]
fn classes_nested_deeply_cost_no_stack_and_overflow_is_named() {
    let mut scene = row(1, &[]);
    let half = Placement { scale: DVec3::splat(0.5), ..Placement::default() };
    let frame = Frame { placement: half, ..at(0.0, 0.0, 0.0) };
    let once = |node| Solid { frames: vec![frame], nodes: vec![node], ..Solid::default() };
    let kind = Primitive::Cylinder;
    scene.add_class("c".to_owned(), once(Node::Primitive { kind, frame: FrameId(0) }));
    for class in 0..20_000 {
        scene.add_class("c".to_owned(), once(instance(class, 0)));
    }
    scene.objects[0].solid = once(instance(999, 0));
    assert!(printed(&scene, 1).contains("  cylinder\n"), "2⁻¹⁰⁰¹ is a number");
    scene.add_object(None, once(instance(20_000, 0)));
    match print(&scene, LIMIT, &mut io::sink()) {
        Err(PaperError::NotFinite { object: 1 }) => {}
        other => panic!("{other:?}"),
    }
}

#[test]
fn solids_that_the_paper_has_not_are_refused() {
    let mut scene = Scene::default();
    scene.add_object(None, Solid::primitive(Primitive::Sphere, Placement::default()));
    scene.add_class(
        "dish".to_owned(),
        Solid::primitive(Primitive::Paraboloid, Placement::default()),
    );
    let mut out = Vec::new();
    let error = print(&scene, LIMIT, &mut out).unwrap_err().to_string();
    let expected = "`paraboloid` has no expanded form: it knows sphere, cylinder, cone, block only";
    assert_eq!((error.as_str(), out.len()), (expected, 0), "nothing is printed");
    scene.classes.clear();
    let mut ring = Solid { frames: vec![at(0.0, 0.0, 0.0)], ..Solid::default() };
    let row = scene::form::Row::named("torus").unwrap();
    let form = ring.add_form(scene::Form::new(row, &[0.5]).unwrap());
    ring.nodes.push(Node::Form { form, frame: FrameId(0) });
    scene.add_object(None, ring);
    let error = print(&scene, LIMIT, &mut out).unwrap_err();
    assert!(matches!(error, PaperError::NotOfThePaper { solid: "torus" }), "{error}");
}
