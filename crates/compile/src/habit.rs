//! Words of other languages, and how this one says it.

/// What is meant by a word that is none here, in lower case: a hint. A new one is a new row.
const HABITS: &[(&[&str], &str)] = &[
    (&["cyan", "aqua"], "cyan is `blue-green`, or rgb (0, 1, 1)"),
    (&["magenta", "fuchsia"], "magenta is `purple`, or rgb (1, 0, 1)"),
    (&["pink", "rose"], "pink is `very light purplish red`"),
    (&["violet", "indigo"], "violet is `bluish purple`"),
    (&["turquoise", "teal"], "turquoise is `strong blue-green`"),
    (
        &["gold", "golden"],
        "gold is `strong orangish yellow`; `pure` makes its highlights those of a metal",
    ),
    (&["silver"], "silver is `light gray`; `pure` makes its highlights those of a metal"),
    (&["navy"], "navy is `very dark blue`"),
    (&["maroon", "crimson"], "crimson is `dark strong purplish red`"),
    (&["olive"], "olive is `dark strong yellow`"),
    (&["lime"], "lime is `yellow-green`"),
    (&["beige", "ivory"], "beige is `very light grayish yellow`"),
    (
        &["bright", "pale"],
        "a colour is made lighter by `light` and `very light`, paler by `grayish`",
    ),
    (
        &["color", "colour", "rgbf", "rgbt"],
        "a colour stands by itself, as in red sphere, or rgb (1, 0, 0)",
    ),
    (
        &["translate", "translation", "move", "position", "location", "shift"],
        "a solid is moved by `at (x, y, z)`, which stands behind it",
    ),
    (&["rotation", "turn"], "a solid is turned by `rotate (x, y, z)`, which stands behind it"),
    (
        &["size", "radius", "resize"],
        "`scale x` or `scale (x, y, z)` behind a solid says how large it is",
    ),
    (
        &["box", "cuboid"],
        "`block` goes from -1 to 1 along each axis; `scale (x, y, z)` makes a box of it",
    ),
    (&["ball"], "a ball is a `sphere`"),
    (&["tube", "pipe", "rod"], "a `cylinder` goes along x from 0 to 1 with radius 1; `-` bores it"),
    (
        &["plane", "floor_plane", "ground"],
        "a wide flat block is a plane: block scale (1000, 1, 1000) at (0, -1, 0)",
    ),
    (
        &["difference", "subtract", "subtraction", "minus"],
        "what is cut away stands behind `-`, as in sphere - block",
    ),
    (&["merge", "join", "and"], "solids are joined by `+`, as in sphere + block"),
    (
        &["union"],
        "solids are joined by `+`, as in sphere + block; `union of i from 1 to 12 ( … )` joins turns",
    ),
    (
        &["intersection", "intersect"],
        "what solids share is written with `*`, as in sphere * block; `intersection of i from 1 to 12 ( … )` joins turns",
    ),
    (
        &["texture", "pigment", "material", "finish", "surface", "interior"],
        "what a solid looks like stands in front of it, as in shiny red paint wood brown sphere",
    ),
    (
        &[
            "reflection",
            "reflective",
            "specular",
            "phong",
            "diffuse",
            "metallic",
            "mirror",
            "glossy",
        ],
        "`dull`, `shiny`, `shiniest` say how much is reflected, `rough`, `smooth`, `smoothest` how sharply",
    ),
    (
        &[
            "transparent",
            "transparency",
            "transmit",
            "glass",
            "water",
            "ior",
            "refraction",
            "opacity",
            "alpha",
        ],
        "light passes through `trans (half distance, index of refraction)`, as in trans (10, 1.5) sphere",
    ),
    (&["light_source", "lamp"], "a light is written light at (x, y, z)"),
    (
        &["sun", "direction", "directional", "parallel_light"],
        "parallel rays are `light beam toward (x, y, z)`",
    ),
    (
        &["spotlight"],
        "a spot is written light spot (concentration, half-angle) at (x, y, z) toward (x, y, z)",
    ),
    (
        &["area", "area_light", "shadowless"],
        "the kinds of light are `point`, `beam` and `spot`; `no shadows` is a clause",
    ),
    (&["look_at", "lookat"], "the camera looks at `target at (x, y, z)`"),
    (&["eye", "viewpoint"], "the eye stands at `camera at (x, y, z)`"),
    (
        &["fov", "zoom", "lens"],
        "`focal length 50` says how much the camera sees; more brings things nearer",
    ),
    (&["orthographic"], "rays run side by side from `camera parallel at (x, y, z)`"),
    (
        &["for", "while", "loop", "foreach"],
        "what comes several times is written repeat i from 1 to 12 { … }",
    ),
    (
        &["if", "else", "switch"],
        "nothing is chosen here; a repeat whose range is over before it begins has no turn",
    ),
    (
        &["def", "define", "declare", "var", "const", "set", "local"],
        "`let n = 3` names a number, `class a is …` a solid",
    ),
    (
        &["function", "module", "macro", "fn", "proc"],
        "a class has parameters, as in class wheel (radius) is cylinder scale (0.2, radius, radius)",
    ),
    (&["let"], "it is written let n = 3"),
    (&["repeat"], "it is written repeat i from 1 to 12 { … }"),
    (&["import", "use", "require"], "another file is read by include \"FILE\""),
    (&["sky", "sky_sphere"], "what is seen where nothing is: background light blue"),
];

/// How this language says what `word`, in lower case, says elsewhere.
pub(crate) fn hint(word: &str) -> Option<&'static str> {
    HABITS.iter().find(|(words, _)| words.contains(&word)).map(|(_, hint)| *hint)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::token::{Symbols, Token};

    #[test]
    fn habits_are_no_words_of_this_language_and_stand_once() {
        let mut symbols = Symbols::new();
        let mut seen = Vec::new();
        for &word in HABITS.iter().flat_map(|(words, _)| *words) {
            assert!(matches!(symbols.token(word), Token::Name(_)), "{word} is reserved");
            assert!(!seen.contains(&word), "{word} twice");
            seen.push(word);
        }
    }

    #[test]
    fn colours_and_solids_in_hints_compile() {
        for (words, hint) in HABITS {
            // What a hint calls a colour is one.
            let quoted: Vec<&str> = hint.split('`').skip(1).step_by(2).collect();
            if hint.starts_with(words[0]) && hint.contains(" is `") {
                let text = format!("object is {} sphere", quoted[0]);
                let solid = format!("object is {}", quoted[0]);
                let fits =
                    [text, solid].iter().any(|text| crate::compile_text(text).scene.is_some());
                assert!(fits, "{words:?}: {hint}");
            }
            if let Some((_, example)) = hint.split_once("as in ") {
                let example = example.split([';', ',']).next().unwrap_or(example);
                let whole = hint.split_once("as in ").map_or(example, |(_, rest)| rest);
                let whole = whole.split(';').next().unwrap_or(whole);
                let fits = ["object is ", ""].iter().any(|begin| {
                    crate::compile_text(format!("{begin}{whole}"))
                        .report()
                        .lines()
                        .all(|line| !line.contains("error"))
                }) || whole.contains("or ");
                assert!(fits, "{words:?}: {whole}");
            }
        }
    }
}
