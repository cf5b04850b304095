//! Lights: kinds, shadows, sums and edges.

use super::{HALF, assert_drawn, assert_near, drawn, from_afar, middle};

/// A white floor at z = 0, and a red plate over it that is 0.7 wide.
const FLOOR: &str = "object is block scale (99, 99, 1) at (0, 0, -1)";
const PLATE: &str = "object is red block scale (0.35, 0.35, 0.1) at (0, 0, 2)";

/// `#` where the floor is lit, `.` where it is dark, `o` on the plate.
fn lit(light: &str) -> String {
    let picture = drawn(&format!("{FLOOR} {PLATE} {light}"));
    picture.letters(|i| match picture.pixels[i] {
        [0, 0, 0] => '.',
        [_, 0, 0] => 'o',
        _ => '#',
    })
}

const UNDER: &str = "
    ################
    ################
    ################
    ################
    ################
    #####......#####
    #####.oooo.#####
    #####.oooo.#####
    #####.oooo.#####
    #####.oooo.#####
    #####......#####
    ################
    ################
    ################
    ################
    ################";

#[test]
fn shadows_of_each_kind_of_light() {
    // The upper face of the plate, 2.1 up, throws the wider shadow: 4.3 / 2.2 of its size.
    for light in
        ["light point at (0, 0, 4.3)", "light spot (1, 40) at (0, 0, 4.3) toward (0, 0, 0)"]
    {
        assert_drawn(&lit(light), UNDER, light);
    }
    // Slanted by 0.3 in 1 along x: the shadow of the faces 1.9 and 2.1 up reaches from 0.22 to 0.98.
    let slanted = "
        ################
        ################
        ################
        ################
        ################
        ################
        ######oooo...###
        ######oooo...###
        ######oooo...###
        ######oooo...###
        ################
        ################
        ################
        ################
        ################
        ################";
    assert_drawn(&lit("light beam at (-3, 0, 10)"), slanted, "beam");
}

#[test]
fn lights_without_shadows_light_everything() {
    for light in [
        "light point at (0, 0, 4.3)",
        "light spot (1, 40) at (0, 0, 4.3) toward (0, 0, 0)",
        "light beam at (-3, 0, 10)",
    ] {
        let found = lit(&format!("{light} no shadows"));
        assert!(!found.contains('.') && found.contains('o'), "{light}:\n{found}");
    }
}

#[test]
fn a_spot_has_an_edge() {
    // 45° from a height of 1: a radius of 1 about the foot of the axis.
    let expected = "
        ................
        ................
        ................
        ......####......
        ....########....
        ....########....
        ...##########...
        ...##########...
        ...##########...
        ...##########...
        ....########....
        ....########....
        ......####......
        ................
        ................
        ................";
    let picture = drawn(&format!("{FLOOR} light spot (0, 45) at (0, 0, 1) toward (0, 0, 0)"));
    let found = picture.letters(|i| if picture.pixels[i] == [0, 0, 0] { '.' } else { '#' });
    assert_drawn(&found, expected, "45°");
}

/// Linear light on the floor where the camera's axis meets it.
fn at_middle(lights: &str) -> [f32; 3] {
    middle(&from_afar(&format!("{FLOOR} {lights}"), HALF)).color
}

#[test]
fn light_falls_by_the_cosine_and_adds_up() {
    for (lights, expected) in [
        ("light beam at (0, 0, 1) intensity 0.5", 0.5),
        ("light beam at (0, 0, 1) toward (0, 0, -7) intensity 0.5", 0.5),
        ("light point at (0, 0, 1)", 1.0),
        ("light at (0, 0, 5000)", 1.0),
        // 3-4-5: a cosine of 0.8.
        ("light at (3, 0, 4)", 0.8),
        ("light at (300, 0, 400) intensity 0.25", 0.2),
        ("light beam at (0, 3, 4)", 0.8),
        // From below the floor.
        ("light beam at (0, 0, -1)", 0.0),
        ("light beam at (0, 0, 1) intensity 0.25 light at (3, 0, 4) intensity 0.5", 0.65),
        ("light beam at (0, 0, 1) intensity 0.25 ambient intensity 0.125", 0.375),
        // On the axis, and 36.87° off it with and without concentration.
        ("light spot (9, 60) at (0, 0, 7) toward (0, 0, 0)", 1.0),
        ("light spot (0, 60) at (0, 0, 4) toward (3, 0, 0)", 1.0),
        ("light spot (1, 60) at (0, 0, 4) toward (3, 0, 0)", 0.8),
        ("light spot (2, 60) at (0, 0, 4) toward (3, 0, 0)", 0.64),
        ("light spot (0, 36.8) at (0, 0, 4) toward (3, 0, 0)", 0.0),
        ("light spot (0, 36.9) at (0, 0, 4) toward (3, 0, 0)", 1.0),
    ] {
        assert_near(at_middle(lights), [expected; 3], lights);
    }
    let colored = at_middle("light beam red at (0, 0, 1) light blue at (0, 0, 9) intensity 0.5");
    assert_near(colored, [1.0, 0.0, 0.5], "red and blue");
}

#[test]
fn clear_bodies_cast_coloured_shadows() {
    // 0.2 thick, halved in 0.2; `fake` has no reflection.
    let pane = "object is trans (0.2, fake) red block scale (9, 9, 0.1) at (5, 0, 2)";
    let seen = at_middle(&format!("{pane} light beam at (20, 0, 20)"));
    let slant = std::f64::consts::SQRT_2;
    let share = |rate: f64| libm::exp2(-slant * rate) * slant / 2.0;
    // The eye looks through the pane, too, straight.
    let expected = [0.5 * share(1.0), share(9.0) / 512.0, share(9.0) / 512.0];
    assert_near(seen, expected, "through the pane both ways");
}

#[test]
fn fog_halves_by_its_distance() {
    // The front of the block is 9 999 units from the camera.
    let block = "ambient object is block";
    let clear = middle(&from_afar(block, HALF));
    assert_near(clear.color, [1.0; 3], "without fog");
    assert!((clear.coverage - 1.0).abs() < 1e-6, "covered");
    for (fog, share) in [(9999.0, 0.5), (9999.0 / 2.0, 0.25), (9999.0 / 10.0, 1.0 / 1024.0)] {
        for background in ["black", "red"] {
            let text = format!("{block} fog {fog} background {background}");
            let seen = middle(&from_afar(&text, HALF));
            assert_near(seen.color, [share; 3], &text);
            assert!((f64::from(seen.coverage) - share).abs() < 1e-6, "{text}: {}", seen.coverage);
        }
    }
    // Light rays are not dimmed.
    let far = "light beam at (0, 0, 1) object is block fog 9999";
    assert_near(middle(&from_afar(far, HALF)).color, [0.5; 3], "lit through the fog");
}
