//! Shapes: solids, operators, transforms, groups and classes.

use super::{HALF, SIDE, assert_drawn, silhouette};
use crate::support::{scene, shown, square};

#[test]
fn a_block_drilled_along_z() {
    let found = silhouette(
        "object is block - cylinder scale (4, 0.6, 0.6) rotate (0, -90, 0) at (0, 0, -2)",
    );
    let expected = "
        ................
        ................
        ................
        ...##########...
        ...##########...
        ...###....###...
        ...##......##...
        ...##......##...
        ...##......##...
        ...##......##...
        ...###....###...
        ...##########...
        ...##########...
        ................
        ................
        ................";
    assert_drawn(&found, expected, "drilled");
}

#[test]
fn a_cone_opens_along_x() {
    let expected = "
        ................
        ................
        .............#..
        ............##..
        ...........###..
        ..........####..
        .........#####..
        ........######..
        ........######..
        .........#####..
        ..........####..
        ...........###..
        ............##..
        .............#..
        ................
        ................";
    assert_drawn(&silhouette("object is cone scale 1.25 at (-.05, 0, 0)"), expected, "cone");
}

/// Whether x and y are inside the silhouette of a primitive that was moved by 0.05 along x.
type Outline = fn(f64, f64) -> bool;

const PRIMITIVES: [(&str, Outline); 8] = [
    ("sphere", |x, y| (x - 0.05) * (x - 0.05) + y * y < 1.0),
    ("cylinder", |x, y| x > 0.05 && x < 1.05 && y.abs() < 1.0),
    ("cone", |x, y| x < 1.05 && y.abs() < x - 0.05),
    ("block", |x, y| (x - 0.05).abs() < 1.0 && y.abs() < 1.0),
    ("cube", |x, y| (x - 0.05).abs() < 1.0 && y.abs() < 1.0),
    ("paraboloid scale 1.03", |x, y| x - 0.05 < 1.03 && y * y < 1.03 * (x - 0.05)),
    ("torus (0.5) scale 0.7 rotate (0, 90, 0)", |x, y| {
        let radius = (x - 0.05).hypot(y) / 0.7;
        (radius - 1.0).abs() < 0.5
    }),
    (
        "(prism ((-1.32, -1.35), (1.1, -1.35), (1.1, 0.4), (0, -0.7), (-1.32, 0.4)) at (0, 0, -0.5))",
        |x, y| {
            let x = x - 0.05;
            let notch = if x > 0.0 { -0.7 + x } else { -0.7 - x * 1.1 / 1.32 };
            x > -1.32 && x < 1.1 && y > -1.35 && y < notch
        },
    ),
];

/// A bar along z: seen along z it cuts silhouettes as it cuts solids.
const BAR: &str = "block at (0.25, 0.35, 0) scale (0.4, 0.5, 100)";

fn in_bar(x: f64, y: f64) -> bool {
    (x - 0.25).abs() < 0.4 && (y - 0.35).abs() < 0.5
}

fn outline(inside: impl Fn(f64, f64) -> bool) -> String {
    let place = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE) * 2.0 * HALF - HALF;
    let row = |row| -> String {
        let letter = |column| if inside(place(column), -place(row)) { '#' } else { '.' };
        (0..SIDE).map(letter).collect()
    };
    (0..SIDE).map(row).collect::<Vec<_>>().join("\n")
}

#[test]
fn operators_on_each_primitive() {
    for (name, inside) in PRIMITIVES {
        let solid = format!("{name} at (0.05, 0, 0)");
        for (operator, expected) in [
            ("+", outline(|x, y| inside(x, y) || in_bar(x, y))),
            ("*", outline(|x, y| inside(x, y) && in_bar(x, y))),
            ("-", outline(|x, y| inside(x, y) && !in_bar(x, y))),
        ] {
            let found = silhouette(&format!("object is {solid} {operator} {BAR}"));
            assert_drawn(&found, &expected, &format!("{name} {operator} bar"));
        }
        // A thin plate shows the section through the middle, which is the outline.
        let plate = BAR.replace("100", "0.001");
        let expected = outline(|x, y| in_bar(x, y) && !inside(x, y));
        let found = silhouette(&format!("object is {plate} - {solid}"));
        assert_drawn(&found, &expected, &format!("plate - {name}"));
    }
}

#[test]
fn parallel_rays_see_the_far_as_large_as_the_near() {
    // 24 · 5 / 37.5 = 3.2 wide, and what is behind the eye is not there.
    let text = "object is block scale (0.5, 0.5, 0.1) at (-0.85, 0.85, 0)
        object is block scale (0.5, 0.5, 0.1) at (0.85, -0.85, -500)
        object is sphere at (0, 0, 9)
        camera parallel at (0, 0, 5) focal length 37.5";
    let square_at = |x: f64, y: f64| x.abs() < 0.5 && y.abs() < 0.5;
    let expected = outline(|x, y| square_at(x + 0.85, y - 0.85) || square_at(x - 0.85, y + 0.85));
    let scene = scene(text);
    assert_drawn(&shown(&scene, &square(SIDE, 1)).silhouette(), &expected, "squares");
    // More than a tile, each seen through its own beam.
    let large = shown(&scene, &square(8 * SIDE, 1));
    let covered = large.coverage.iter().filter(|&&coverage| coverage > 0.5).count();
    assert_eq!(covered, 2 * 40 * 40, "two squares of 40 pixels");
}

#[test]
fn parallel_rays_start_in_what_is_around_them() {
    // The left half of the picture starts in glass, the right half in air; a wall behind.
    let text = "ambient object is smoothest trans (1, 1) white block scale (1, 2, 3) at (-1, 0, 0)
        object is block scale (4, 4, 0.5) at (0, 0, -3)
        camera parallel at (0, 0, 2) focal length 37.5";
    let picture = shown(&scene(text), &square(SIDE, 1));
    // Four and a half units of glass halve the light as many times: the root of 2⁻⁹.
    let (left, right) = (picture.at(4, 8), picture.at(12, 8));
    assert_eq!(right, [255; 3], "air");
    let display = idf::Transfer::Srgb.encode((1.0 / 512.0_f64).sqrt());
    assert!((f64::from(left[0]) - 255.0 * display).abs() <= 1.0, "{left:?}, {display}");
}

#[test]
fn intersection_binds_tighter_and_the_rest_goes_left_to_right() {
    let piece = |x: f64| format!("block scale 0.2 at ({x}, 0, 0)");
    let (a, b) = (piece(-1.0), piece(1.0));
    let same = |found: &str, expected: &str| {
        let drawing = silhouette(&format!("object is {expected}"));
        assert_drawn(&silhouette(&format!("object is {found}")), &drawing, found);
    };
    same(&format!("{a} + {b} * {b}"), &format!("{a} + {b}"));
    same(&format!("{a} - {a} + {b}"), &b);
    same(&format!("{a} - ({a} + {b})"), &format!("{a} * {b}"));
    same(&format!("{a} + {b} - {b}"), &a);
}

#[test]
fn nothing_is_left_of_an_empty_intersection() {
    let empty = outline(|_, _| false);
    for solid in [
        "sphere * block at (5, 0, 0)",
        "block - block",
        "block - block scale 2",
        // They share a face, and a face has no volume.
        "block * block at (2, 0, 0)",
        "(sphere - sphere) * block",
    ] {
        assert_drawn(&silhouette(&format!("object is {solid}")), &empty, solid);
    }
}

#[test]
fn solids_are_scaled_then_rotated_then_moved() {
    let upright = "
        ................
        ................
        ................
        ..........####..
        ..........####..
        ..........####..
        ..........####..
        ..........####..
        ..........####..
        ..........####..
        ..........####..
        ..........####..
        ..........####..
        ................
        ................
        ................";
    let [scale, rotate, at] = ["scale (1, 0.4, 1)", "rotate (0, 0, 90)", "at (0.8, 0, 0)"];
    for clauses in [
        [scale, rotate, at],
        [scale, at, rotate],
        [rotate, scale, at],
        [rotate, at, scale],
        [at, scale, rotate],
        [at, rotate, scale],
    ] {
        let text = format!("object is block {}", clauses.join(" "));
        assert_drawn(&silhouette(&text), upright, &text);
    }
}

#[test]
fn rotation_is_about_x_then_y_then_z() {
    let along_z = outline(|x, y| x * x + y * y < 0.2);
    let up = outline(|x, y| x.abs() < 0.45 && y > 0.0 && y < 1.0);
    let down = outline(|x, y| x.abs() < 0.45 && y < 0.0 && y > -1.0);
    for (angles, expected) in [
        // The axis points along x; y turns it to −z, and there z leaves it.
        ("(0, 90, 90)", &along_z),
        // x leaves it, z turns it up. The other order would turn it to z.
        ("(90, 0, 90)", &up),
        ("(0, 180, 90)", &down),
        ("(90, -90, 0)", &along_z),
        ("(0, 0, -90)", &down),
    ] {
        let text = format!("object is cylinder scale (1, 0.45, 0.45) rotate {angles}");
        assert_drawn(&silhouette(&text), expected, &text);
    }
}

#[test]
fn a_negative_scale_mirrors() {
    let right = silhouette("object is cone at (-.05, 0, 0) - block scale 0.3 at (0.95, 1, 0)");
    let mirrored: Vec<String> = right.lines().map(|line| line.chars().rev().collect()).collect();
    let left = silhouette(
        "object is (cone at (-.05, 0, 0) - block scale 0.3 at (0.95, 1, 0)) scale (-1, 1, 1)",
    );
    assert_drawn(&left, &mirrored.join("\n"), "left and right");
    let flipped: Vec<&str> = right.lines().rev().collect();
    let below = silhouette(
        "object is (cone at (-.05, 0, 0) - block scale 0.3 at (0.95, 1, 0)) scale (1, -1, 1)",
    );
    assert_drawn(&below, &flipped.join("\n"), "top and bottom");
}

/// Two of a group, turned and moved.
const TURNED: &str = "scale (1, 0.5, 1) rotate (0, 0, 90) at (0.2, -0.3, 0)";

#[test]
fn groups_and_classes_are_transformed_as_one() {
    let expected = "
        ................
        ................
        ................
        ................
        ................
        ................
        ........##......
        ........##......
        ........##......
        ................
        ................
        ........##......
        ........##......
        ........##......
        ........##......
        ........##......";
    let pair = "(block scale 0.5 at (-0.8, 0, 0) + sphere scale 0.4 at (0.4, 0, 0))";
    let group = format!("object is {pair} {TURNED}");
    let class = format!("class pair is {pair} object is pair {TURNED}");
    let nested = format!("class inner is {pair} class outer is inner {TURNED} object is outer");
    for text in [group, class, nested] {
        assert_drawn(&silhouette(&text), expected, &text);
    }
}
