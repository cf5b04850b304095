//! What is refused or warned of, rather than silently wrong.

use super::case::{Case, Found, Promise};

const LIMITS: &str = "Limits that are said";

pub(crate) fn cases() -> Vec<Case> {
    let said = |name: &'static str, words: &'static str, text: &'static str| {
        Case::new(LIMITS, name, Promise::Said(words), move || {
            let compiled = compile::compile_text(text);
            let loaded = compiled.scene.as_ref().map(render::World::load);
            let load = loaded.and_then(Result::err).map_or_else(String::new, |e| e.to_string());
            Found::Said(compiled.report() + &load)
        })
    };
    vec![
        said("a size of 0", "scale", "object is sphere scale (1, 0, 1)\ncamera at (0, 0, 9)"),
        said(
            "the eye at its target",
            "target",
            "object is sphere\ncamera at (0, 0, 9) target at (0, 0, 9)",
        ),
        said(
            "a number beyond double precision",
            "number",
            "object is sphere scale 1e999\ncamera at (0, 0, 9)",
        ),
        said("an index of 0", "index", "object is trans (1, 0) sphere\ncamera at (0, 0, 9)"),
        said(
            "a half-distance of 0",
            "half",
            "object is trans (0, 1.5) sphere\ncamera at (0, 0, 9)",
        ),
        said("a lens of 0 mm", "focal", "object is sphere\ncamera at (0, 0, 9)\nfocal length 0"),
        said(
            "places beyond double precision",
            "less than 1e100",
            "object is (sphere at (1e300, 0, 0)) scale 1e300\ncamera at (0, 0, 9)",
        ),
        said(
            "a ball of 1e-8 at 1e6",
            "will look rough",
            "object is sphere scale 1e-8 at (1e6, 0, 0)\ncamera at (1e6, 0, 1e-7) target at (1e6, 0, 0)",
        ),
        said(
            "a ball of 1e-9 at 1e6",
            "too small for its place",
            "object is sphere scale 1e-9 at (1e6, 0, 0)\ncamera at (1e6, 0, 1e-7) target at (1e6, 0, 0)",
        ),
    ]
}
