//! Looks: attributes, colours, paint, mirrors and panes.

use scene::color::linear;

use super::{HALF, assert_drawn, assert_near, drawn, from_afar, middle};

/// `text` in ambient light: `r`, `g`, `b` and `w` for full colours, `k` for black, `.` where nothing is.
fn colors(text: &str) -> String {
    let picture = drawn(&format!("ambient {text}"));
    picture.letters(|i| match (picture.pixels[i], picture.coverage[i] > 0.5) {
        (_, false) => '.',
        ([255, 0, 0], _) => 'r',
        ([0, 255, 0], _) => 'g',
        ([0, 0, 255], _) => 'b',
        ([255, 255, 255], _) => 'w',
        ([0, 0, 0], _) => 'k',
        _ => '?',
    })
}

/// The row of `text` through the middle.
fn middle_row(text: &str) -> String {
    colors(text).lines().nth(8).expect("16 rows").to_owned()
}

const LEFT: &str = "block scale 0.4 at (-1, 0, 0)";
const MIDDLE: &str = "block scale 0.4";
const RIGHT: &str = "block scale 0.4 at (1, 0, 0)";

#[test]
fn the_attribute_closest_to_the_primitive_shows() {
    for (text, expected) in [
        (format!("object is {LEFT} + red {MIDDLE} + blue {RIGHT}"), ".wwww.rrrr.bbbb."),
        (format!("object is red ({LEFT} + {MIDDLE} + blue {RIGHT})"), ".rrrr.rrrr.bbbb."),
        (format!("object is red ({LEFT} + green ({MIDDLE} + blue {RIGHT}))"), ".rrrr.gggg.bbbb."),
        (
            format!("class two is {LEFT} + blue {MIDDLE} object is red two + green {RIGHT}"),
            ".rrrr.bbbb.gggg.",
        ),
        (
            format!(
                "class two is red {LEFT} + {MIDDLE} class all is two + {RIGHT} object is blue all"
            ),
            ".rrrr.bbbb.bbbb.",
        ),
        // What a subtraction leaves looks like what was taken away; the rest like what was cut.
        (
            "object is red block scale (1.4, 1, 1) - blue block at (0, 0, 1)".into(),
            ".rrbbbbbbbbbbrr.",
        ),
        // Of two faces in one place the earlier shows.
        (format!("object is red {MIDDLE} + blue {MIDDLE}"), "......rrrr......"),
    ] {
        assert_eq!(middle_row(&text), expected, "{text}");
    }
}

#[test]
fn colours_by_name_and_number() {
    for (color, expected) in [
        ("red", [255, 0, 0]),
        ("yellow", [255, 255, 0]),
        ("green", [0, 255, 0]),
        ("purple", [255, 0, 255]),
        ("white", [255, 255, 255]),
        ("black", [0, 0, 0]),
        ("light gray", [170, 170, 170]),
        ("dark gray", [85, 85, 85]),
        ("hsv (210, 0.5, 0.8)", [102, 153, 204]),
        ("rgb (0.2, 0.4, 0.6)", [51, 102, 153]),
        ("red-orange", [255, 64, 0]),
    ] {
        let body = drawn(&format!("ambient object is {color} block"));
        assert_eq!(body.at(8, 8), expected, "{color} block");
        let behind = drawn(&format!("background {color} object is block at (9, 0, 0)"));
        assert_eq!(behind.at(8, 8), expected, "{color} background");
    }
}

#[test]
fn fields_and_stripes_on_a_block() {
    let checker = "
        ................
        ................
        ................
        ...rrrrrwwwww...
        ...rrrrrwwwww...
        ...rrrrrwwwww...
        ...rrrrrwwwww...
        ...rrrrrwwwww...
        ...wwwwwrrrrr...
        ...wwwwwrrrrr...
        ...wwwwwrrrrr...
        ...wwwwwrrrrr...
        ...wwwwwrrrrr...
        ................
        ................
        ................";
    assert_drawn(&colors("object is paint checker (2, 2) red block"), checker, "checker");
    let stripes = "
        ................
        ................
        ................
        ...bbbbbbbbbb...
        ...??????????...
        ...rrrrrrrrrr...
        ...rrrrrrrrrr...
        ...bbbbbbbbbb...
        ...bbbbbbbbbb...
        ...rrrrrrrrrr...
        ...rrrrrrrrrr...
        ...??????????...
        ...bbbbbbbbbb...
        ................
        ................
        ................";
    // Five stripes, the first at the bottom bare; a pixel on an edge has a part of both.
    assert_drawn(&colors("object is paint stripes (count = 5) red blue block"), stripes, "stripes");
}

#[test]
fn paint_works_where_it_is_written() {
    for (text, expected) in [
        // Cubes of 1 / 0.9 in the coordinates of the primitive, so that its front lies within one.
        ("object is paint checker3d (0.9) red block scale 1.4", ".wwwwwwwrrrrrrr."),
        ("object is (paint checker3d (0.9) red block) scale 1.4", ".wwwwwwwrrrrrrr."),
        // Cubes of 1 in those of the group, before it is moved; a pixel on an edge has a part of both.
        ("object is paint checker3d red (block scale 1.4)", ".wwrrrrrwwwww?r."),
        ("object is paint checker3d red (block scale 1.2) at (0.4, 0, 0)", "....wrrrrrwwwww?"),
        // The closest level that has any paint replaces those outside.
        (
            "object is paint checker3d red (paint checker3d (scale = 9) white block scale 1.4)",
            ".wwwwwwwwwwwwww.",
        ),
        // Within a level, one coat over the other.
        (
            "object is paint checker3d (0.9) red paint checker3d (0.9) blue block scale 1.4",
            ".wwwwwwwbbbbbbb.",
        ),
    ] {
        assert_eq!(middle_row(text), expected, "{text}");
    }
}

#[test]
fn ambient_light_is_the_albedo() {
    let pixel = middle(&from_afar("ambient intensity 0.25 object is rgb (0.5, 1, 0) block", HALF));
    let half = linear([0.5; 3]).x;
    assert_near(pixel.color, [0.25 * half, 0.25, 0.0], "a quarter of the albedo");
    let light = middle(&from_afar("ambient intensity 0.5 red object is block", HALF));
    assert_near(light.color, [0.5, 0.0, 0.0], "coloured");
    let later = "ambient intensity 0.5 ambient intensity 0.125 object is block";
    assert_near(middle(&from_afar(later, HALF)).color, [0.125; 3], "the later one");
}

/// A perfect mirror that turns the view along z toward +x.
const MIRROR: &str = "object is smoothest shiniest block scale (4, 4, 0.5) rotate (0, 45, 0)";

#[test]
fn a_mirror_shows_what_is_beside_it() {
    let red = "object is rgb (1, 0.5, 0.5) block at (20, 0, 0)";
    let half = linear([0.5; 3]).x;
    let seen = middle(&from_afar(&format!("ambient {MIRROR} {red}"), HALF));
    assert_near(seen.color, [1.0, half, half], "the block, and no ambient light of its own");
    assert!((seen.coverage - 1.0).abs() < 1e-6, "a mirror covers: {}", seen.coverage);
    let open = middle(&from_afar(&format!("ambient background red {MIRROR}"), HALF));
    assert_near(open.color, [1.0, 0.0, 0.0], "the background");
    let pure = MIRROR.replace("shiniest", "pure green shiniest");
    let tinted = middle(&from_afar(&format!("ambient {pure} {red}"), HALF));
    // F90 is 1, and the fifth power of 1 − cos 45° is 0.0021555.
    let grazing = 0.002_155_5;
    assert!((f64::from(tinted.color[0]) - grazing).abs() < 1e-6, "metal: {:?}", tinted.color);
    let matte = MIRROR.replace("shiniest", "dullest");
    let own = middle(&from_afar(&format!("ambient intensity 0.5 {matte} {red}"), HALF));
    assert_near(own.color, [0.5; 3], "a dull one shows itself");
}

#[test]
fn a_pane_lets_its_share_through() {
    // Two units thick, halved in two: a half passes. Red halves the others (1 + 8) times as often.
    let pane = |color: &str| format!("object is trans (2, fake) {color} block");
    let white = middle(&from_afar(&format!("background white {}", pane("white")), HALF));
    assert!((white.coverage - 0.5).abs() < 1e-6, "coverage {}", white.coverage);
    assert_near(white.color, [0.0; 3], "what is seen through it is left out");
    let faint = 1.0 / 512.0;
    for (background, linear) in
        [("black", [0.0; 3]), ("white", [1.0; 3]), ("blue", [0.0, 0.0, 1.0])]
    {
        let red = middle(&from_afar(&format!("background {background} {}", pane("red")), HALF));
        let open = (0.5 + 2.0 * faint) / 3.0;
        let covered = f64::from(red.coverage);
        assert!((covered - (1.0 - open)).abs() < 1e-6, "1 − mean share: {covered}");
        let share = [0.5, faint, faint];
        let expected = std::array::from_fn(|k| share[k] * linear[k] - open * linear[k]);
        assert_near(
            red.color,
            expected,
            &format!("over its background, {background}, it is whole"),
        );
    }
    // A body behind it is filtered, and covers.
    let behind = format!("ambient {} object is block at (0, 0, -5)", pane("red"));
    let seen = middle(&from_afar(&behind, HALF));
    assert_near(seen.color, [0.5, faint, faint], "a white block through it");
    assert!((seen.coverage - 1.0).abs() < 1e-6, "covered");
}
