//! What statements mean, against values worked out by hand.

#![expect(clippy::unwrap_used, reason = "functions that tests share")]

use std::collections::HashSet;

use compile::compile_text;
use glam::DVec3;
use scene::{Attributes, Index, LightKind, Node, Rgb, Scene, Transparency};

fn scene(text: &str) -> Scene {
    let compiled = compile_text(text);
    assert_eq!(compiled.report(), "", "{text}");
    compiled.scene.unwrap()
}

/// What is written at the first factor of the first object.
fn attributes(text: &str) -> Attributes {
    let scene = scene(text);
    scene.attributes[scene.objects[0].solid.frames[0].attributes.0 as usize].clone()
}

fn color(name: &str) -> Rgb {
    attributes(&format!("object is {name} sphere")).color.unwrap()
}

fn close(a: Rgb, b: [f64; 3]) -> bool {
    a.abs_diff_eq(Rgb::from_array(b), 1e-6)
}

#[test]
fn lights_have_clauses_in_any_order() {
    let text = "light point at (0,0,0) light red light beam toward (1,0,0)
        light spot (2, 30) toward (0, 0, 1) no shadows intensity 0.5 at (0, 5, 0) green";
    let lights = scene(text).lights;
    assert_eq!(lights[0].kind, LightKind::Point { at: DVec3::ZERO });
    // Light red is (1, 1/3, 1/3) on the display; 1/3 is 0.09084 in linear light.
    assert!(close(lights[0].color, [1.0, 0.090_841_7, 0.090_841_7]), "{}", lights[0].color);
    assert!(lights[0].shadows, "by default");
    assert_eq!(lights[1].kind, LightKind::Beam { at: DVec3::ZERO, toward: DVec3::X });
    assert_eq!(lights[1].color, Rgb::ONE, "white by default");
    let spot = LightKind::Spot {
        at: DVec3::new(0.0, 5.0, 0.0),
        toward: DVec3::Z,
        concentration: 2.0,
        half_angle_degrees: 30.0,
    };
    assert_eq!(lights[2].kind, spot);
    assert!(close(lights[2].color, [0.0, 0.5, 0.0]), "intensity is linear: {}", lights[2].color);
    assert!(!lights[2].shadows, "as written");
}

#[test]
fn surroundings() {
    let scene = scene("ambient intensity 3 hsv (120, 1, 1) background light gray fog 7.5");
    assert!(close(scene.ambient, [0.0, 3.0, 0.0]), "{}", scene.ambient);
    // 2/3 on the display.
    assert!(close(scene.background, [0.401_977_8; 3]), "{}", scene.background);
    assert_eq!(scene.fog_half_distance, Some(7.5));
    assert_eq!(scene.camera, None, "no camera is no error");
}

#[test]
fn cameras_have_defaults() {
    let camera = scene("object is cone Camera at (0,1500,4000)").camera.unwrap();
    assert_eq!((camera.target, camera.focal_length_mm), (DVec3::ZERO, 50.0));
    let camera =
        scene("object is cone focal length 35 target at (1,2,3) camera at (4,5,6)").camera.unwrap();
    assert_eq!(camera.position, DVec3::new(4.0, 5.0, 6.0));
    assert_eq!((camera.target, camera.focal_length_mm), (DVec3::new(1.0, 2.0, 3.0), 35.0));
}

#[test]
fn attributes_are_kept_as_written() {
    let all = attributes(
        "object is priority -2 trans (1000, 1.65) rgb (0, 1, 0.5) smoothness 0.3 pure shinier sphere",
    );
    let expected = Attributes {
        color: Some(Rgb::new(0.0, 1.0, 0.214_041_140_482_232_3)),
        shininess: Some(0.8),
        smoothness: Some(0.3),
        pure: Some(true),
        transparency: Some(Transparency { half_distance: 1000.0, index: Index::Refractive(1.65) }),
        priority: Some(-2),
        paint: Vec::new(),
    };
    assert!(all.color.unwrap().abs_diff_eq(expected.color.unwrap(), 1e-15), "{:?}", all.color);
    assert_eq!(Attributes { color: expected.color, ..all }, expected);
    let fake = attributes("object is trans (5, fake) block").transparency.unwrap();
    assert_eq!(fake.index, Index::Fake);
    assert_eq!(attributes("object is composite sphere").pure, Some(false));
}

#[test]
fn equal_attributes_are_shared_and_others_are_not() {
    let shared =
        scene("object is red sphere + red block + blue cone + paint wood red cone + red (cube)");
    assert_eq!(shared.attributes.len(), 4, "none, red, blue, painted");
    let told_apart = scene(
        "object is shininess 0.25 cone + smoothness 0.25 cone + priority 0 cone + composite cone
        + trans (1, fake) cone + trans (1, 1) cone + trans (2, 1) cone + black cone + cone",
    );
    assert_eq!(told_apart.attributes.len(), 9, "{:?}", told_apart.attributes);
}

#[test]
fn paint_comes_in_coats() {
    let paint =
        attributes("object is paint wood red paint Marble (stir = 2) black white sphere").paint;
    assert_eq!(paint.len(), 2);
    assert_eq!(paint[0].texture.function().keyword, "wood");
    assert_eq!(paint[0].texture.arguments(), [4.0, 0.3], "defaults");
    assert_eq!((paint[0].color, paint[1].color), (Some(Rgb::X), Some(Rgb::ZERO)));
    assert_eq!(paint[1].texture.arguments(), [1.0, 2.0], "by name");
    let placed = attributes("object is paint checker (2, 3) red sphere");
    assert_eq!(placed.paint[0].texture.arguments(), [2.0, 3.0], "by place");
    assert_eq!(placed.color, None, "the colour is the paint's");
}

#[test]
fn a_joined_hue_is_no_subtraction() {
    let scene = scene("object is red-orange sphere - red block");
    let solid = &scene.objects[0].solid;
    assert_eq!(solid.nodes.len(), 4, "{:?}", solid.nodes);
    assert_eq!(solid.nodes[2..], [Node::Complement, Node::Intersection(2)]);
    // Hue 15: (1, 1/4, 0).
    assert!(close(color("red-orange"), [1.0, 0.050_876_1, 0.0]), "{}", color("red-orange"));
    for (a, b) in [("red - orange", "orange-red"), ("GREEN-\nblue", "blue /* */ - green")] {
        assert_eq!(color(a), color(b), "{a}, {b}");
    }
}

/// All names of the system with a hue.
fn names() -> Vec<String> {
    let ring = ["red", "orange", "yellow", "green", "blue", "purple"];
    let splash = |hue: &str| match hue {
        "red" => "reddish".to_owned(),
        "blue" => "bluish".to_owned(),
        "orange" | "purple" => format!("{}ish", hue.trim_end_matches('e')),
        _ => format!("{hue}ish"),
    };
    let mut hues: Vec<String> = ring.iter().map(|&hue| hue.to_owned()).collect();
    hues.push("brown".to_owned());
    let mut pairs: Vec<(&str, &str)> = (0..6).map(|i| (ring[i], ring[(i + 1) % 6])).collect();
    pairs.extend([("brown", "red"), ("brown", "yellow")]);
    for (a, b) in pairs {
        hues.push(format!("{} {a}", splash(b)));
        hues.push(format!("{a}-{b}"));
        hues.push(format!("{} {b}", splash(a)));
    }
    assert_eq!(hues.len(), 31, "hues");
    let mut names = Vec::new();
    for lightness in ["very dark", "dark", "medium", "light", "very light"] {
        for saturation in ["grayish", "moderate", "strong", "vivid"] {
            names.extend(hues.iter().map(|hue| format!("{lightness} {saturation} {hue}")));
        }
    }
    names
}

#[test]
fn all_627_names_are_read_and_distinct() {
    let mut names = names();
    let grays =
        ["black", "very dark gray", "dark gray", "gray", "light gray", "very light gray", "white"];
    names.extend(grays.map(str::to_owned));
    assert_eq!(names.len(), 627);
    let colors: HashSet<String> = names.iter().map(|name| format!("{:?}", color(name))).collect();
    assert_eq!(colors.len(), 627);
}

#[test]
fn what_a_name_leaves_out_has_a_default() {
    for (short, long) in [
        ("red", "medium vivid red"),
        ("dark bluish green", "dark vivid bluish green"),
        ("greyish brown", "medium grayish brown"),
        ("grey", "medium gray"),
        ("light strong yellow-green", "light strong green-yellow"),
    ] {
        assert_eq!(color(short), color(long), "{short}");
    }
    assert_eq!(color("hsv (360, 1, 1)"), color("hsv (0, 1, 1)"), "a turn");
}

#[test]
fn instances_carry_their_own_frame() {
    let scene = scene(
        "class leg is cylinder scale (1, .1, .1)
        class pair is leg + leg at (0, 1, 0)
        object table is red pair at (0, 0, 1) + leg",
    );
    let names: Vec<&str> = scene.classes.iter().map(|class| class.name.as_str()).collect();
    assert_eq!(names, ["leg", "pair"]);
    assert_eq!(scene.objects[0].name.as_deref(), Some("table"));
    let bounds = scene.bounds().objects[0];
    assert!(bounds.contains(DVec3::new(0.5, 1.0, 1.0)), "the second leg of the pair");
    assert!(!bounds.contains(DVec3::new(0.5, 1.2, 1.0)), "and not much more");
}
