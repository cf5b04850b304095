//! Scenes of any size, written as text.

use std::fmt::Write;

/// A scene that can be made with any number of solids.
#[derive(Debug)]
pub struct Case {
    /// The word on the command line.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    write: fn(&mut Text, u32),
}

/// All cases. A new one is a new row.
pub const CASES: &[Case] = &[
    Case {
        name: "scattered",
        about: "N small solids, (sphere - cylinder) * block",
        write: scattered,
    },
    Case { name: "drilled", about: "a block minus N spheres", write: drilled },
    Case { name: "heap", about: "a union of N spheres", write: heap },
    Case { name: "chain", about: "N operators, + and - in turn, from the left", write: chain },
    Case { name: "mirrors", about: "such a chain that mirrors itself", write: mirrors },
    Case {
        name: "chess",
        about: "N turned pieces and a board that mirror each other",
        write: chess,
    },
];

/// The name of [`WINE_GLASS`] among the cases.
pub const WINE_GLASS_NAME: &str = "wine-glass";

/// The listing of the paper, which does not grow.
pub const WINE_GLASS: &str = include_str!("../../../../scenes/wine-glass/wine-glass.sdl");

/// The scene of the paper's Figure 1, in a folder that holds the repository's scenes.
pub const STATION: &str = "scenes/station/station.sdl";

/// The largest N.
pub const MOST: u32 = 10_000_000;

/// A description under way, with numbers of a fixed sequence.
struct Text {
    text: String,
    state: u64,
}

impl Case {
    /// The row of a name.
    #[must_use]
    pub fn by_name(name: &str) -> Option<&'static Self> {
        CASES.iter().find(|case| case.name == name)
    }

    /// The description with `count` solids; the same for the same number.
    #[must_use]
    pub fn description(&self, count: u32) -> String {
        let mut text = Text { text: String::new(), state: 4711 };
        text.add("background rgb (0.85, 0.85, 1) ambient intensity 0.3\n");
        text.add("light at (20, 40, 30) intensity 0.8\n");
        (self.write)(&mut text, count);
        text.add("\n");
        text.text
    }
}

impl Text {
    fn add(&mut self, words: &str) {
        self.text += words;
    }

    /// 0…1 (Park and Miller, "Random number generators: good ones are hard to find", 1988).
    fn chance(&mut self) -> f64 {
        self.state = self.state * 16_807 % 2_147_483_647;
        #[expect(clippy::cast_precision_loss, reason = "31 bits")]
        let state = self.state as f64;
        state / 2_147_483_647.0
    }

    fn view(&mut self, x: f64, y: f64, z: f64) {
        writeln!(self.text, "camera at ({x}, {y}, {z}) target at (0, 0, 0)").expect("a string");
    }

    fn ball(&mut self, [x, y, z]: [f64; 3], r: f64) {
        write!(self.text, "sphere scale {r} at ({x}, {y}, {z})").expect("a string");
    }
}

fn scattered(text: &mut Text, count: u32) {
    text.view(0.0, 12.0, 40.0);
    let r = 0.4 * 14.0 / libm::cbrt(f64::from(count));
    for _ in 0..count {
        let [x, y, z] = [(); 3].map(|()| 14.0 * (text.chance() - 0.5));
        // In five digits behind the point: a million solids would be more text than the compiler takes.
        write!(text.text, "object is (sphere scale {r:.5} at ({x:.5}, {y:.5}, {z:.5})")
            .expect("a string");
        // Along y, from 2 r below the middle.
        let (high, wide, foot) = (4.0 * r, 0.5 * r, y - 2.0 * r);
        let (a, b) = (r, 0.8 * r);
        writeln!(
            text.text,
            " - cylinder scale ({high:.5}, {wide:.5}, {wide:.5}) rotate (0, 0, 90) at ({x:.5}, {foot:.5}, {z:.5})) \
             * block scale ({a:.5}, {b:.5}, {b:.5}) at ({x:.5}, {y:.5}, {z:.5})"
        )
        .expect("a string");
    }
}

fn drilled(text: &mut Text, count: u32) {
    text.view(0.0, 12.0, 14.0);
    text.add("object is block scale (3, 1, 3) at (0, 0, 0)");
    let r = 2.4 / f64::from(count).sqrt();
    for _ in 0..count {
        let at = [
            6.0 * (text.chance() - 0.5),
            1.0 + r * (text.chance() - 0.5),
            6.0 * (text.chance() - 0.5),
        ];
        text.add("\n- ");
        text.ball(at, r);
    }
}

fn heap(text: &mut Text, count: u32) {
    text.view(0.0, 12.0, 14.0);
    let r = 2.4 / libm::cbrt(f64::from(count));
    for number in 0..count {
        let at =
            [6.0 * (text.chance() - 0.5), 4.0 * (text.chance() - 0.5), 6.0 * (text.chance() - 0.5)];
        text.add(if number == 0 { "object is " } else { "\n+ " });
        text.ball(at, r);
    }
}

fn chain(text: &mut Text, count: u32) {
    text.view(0.0, 12.0, 14.0);
    text.add("object is block scale (3, 0.5, 3) at (0, -0.5, 0)");
    links(text, count);
}

fn mirrors(text: &mut Text, count: u32) {
    text.view(0.0, 12.0, 14.0);
    text.add("object is smoothest shininess 0.7 block scale (3, 0.5, 3) at (0, -0.5, 0)");
    links(text, count);
}

fn links(text: &mut Text, count: u32) {
    let r = 2.4 / f64::from(count).sqrt();
    for number in 0..count {
        let at = [6.0 * (text.chance() - 0.5), 0.0, 6.0 * (text.chance() - 0.5)];
        text.add(if number % 2 == 0 { "\n+ " } else { "\n- " });
        text.ball(at, r);
    }
}

/// Pawn, rook, bishop, queen and king from the neck up, over the place (X, Z).
const HEADS: [&str; 5] = [
    "sphere scale 0.2 at (X, 0.95, Z)",
    "(cylinder scale (0.34, 0.24, 0.24) rotate (0, 0, 90) at (X, 0.74, Z)
  - cylinder scale (0.2, 0.16, 0.16) rotate (0, 0, 90) at (X, 0.95, Z)
  - block scale (0.3, 0.06, 0.06) at (X, 1.05, Z) - block scale (0.06, 0.06, 0.3) at (X, 1.05, Z))",
    "(sphere scale (0.19, 0.3, 0.19) at (X, 1, Z) - block scale (0.3, 0.03, 0.12) rotate (35, 0, 0) at (X, 1.12, Z + 0.15))
  + sphere scale 0.05 at (X, 1.31, Z)",
    "(cone scale (0.5, 0.26, 0.26) rotate (0, 0, 90) at (X, 0.72, Z) - sphere scale 0.22 at (X, 1.26, Z))
  + torus (0.12) scale 0.25 rotate (0, 0, 90) at (X, 1.21, Z) + sphere scale 0.09 at (X, 1.16, Z)",
    "(cone scale (0.5, 0.26, 0.26) rotate (0, 0, 90) at (X, 0.72, Z)) + torus (0.12) scale 0.25 rotate (0, 0, 90) at (X, 1.2, Z)
  + block scale (0.04, 0.17, 0.04) at (X, 1.38, Z) + block scale (0.12, 0.04, 0.04) at (X, 1.42, Z)",
];

/// Pieces on the white squares of a board of twice as many squares.
fn chess(text: &mut Text, count: u32) {
    let side = f64::from(2 * count).sqrt().ceil();
    writeln!(
        text.text,
        "light at ({}, {}, {side}) intensity 0.5\ncamera at (0, {}, {}) target at (0, 0, 0)",
        -side,
        2.0 * side,
        0.7 * side + 2.0,
        1.1 * side + 3.0
    )
    .expect("a string");
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number")]
    let squares = side as u32;
    let mut pieces = 0;
    for (row, column) in (0..squares).flat_map(|row| (0..squares).map(move |c| (row, c))) {
        let [x, z] = [column, row].map(|k| f64::from(k) + 0.5 - 0.5 * side);
        let is_white = (row + column) % 2 == 0;
        let color = if is_white { "" } else { "rgb (0.25, 0.15, 0.15) " };
        writeln!(
            text.text,
            "object is smoothest shininess 0.2 {color}block scale (0.5, 0.1, 0.5) at ({x}, -0.1, {z})"
        )
        .expect("a string");
        if !is_white || pieces == count {
            continue;
        }
        let head = HEADS[pieces as usize % HEADS.len()];
        let place = |words: &str| {
            words
                .replace('X', &x.to_string())
                .replace("Z + 0.15", &(z + 0.15).to_string())
                .replace('Z', &z.to_string())
        };
        let stem = "cylinder scale (0.1, 0.36, 0.36) rotate (0, 0, 90) at (X, 0, Z)
  + torus (0.2) scale 0.31 rotate (0, 0, 90) at (X, 0.1, Z) + cone scale (1, 0.28, 0.28) rotate (0, 0, -90) at (X, 1.1, Z)
  + torus (0.3) scale 0.15 rotate (0, 0, 90) at (X, 0.72, Z)";
        let color = if row < squares / 2 { "" } else { "rgb (0.5, 0.3, 0.15) " };
        writeln!(
            text.text,
            "object is smoothest shininess 0.15 {color}({}\n  + {})",
            place(stem),
            place(head)
        )
        .expect("a string");
        pieces += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn descriptions_compile_to_as_many_primitives() {
        // 15 by 15 squares, 20 pieces of each kind: 4 solids, and 1, 4, 3, 4 and 4 on them.
        for (name, expected) in [
            ("scattered", 300),
            ("drilled", 101),
            ("heap", 100),
            ("chain", 101),
            ("mirrors", 101),
            ("chess", 945),
        ] {
            let text = Case::by_name(name).unwrap().description(100);
            let compiled = compile::compile_text(&text);
            assert!(compiled.diagnostics.is_empty(), "{name}: {}", compiled.report());
            let world = render::World::load(&compiled.scene.unwrap()).unwrap();
            assert_eq!(world.stands_for(), expected, "{name}");
        }
        assert!(compile::compile_text(WINE_GLASS).scene.is_some());
    }
}
