//! What is legal but surely not meant: where it is said, and where not.

use compile::compile_text;

/// A scene, and how its first warning begins; nothing where none is deserved.
const WARNINGS: &[(&str, &str)] = &[
    ("object is sphere * block at (9, 0, 0)", "1:1: warning: this object is empty"),
    ("object is sphere - block scale 2", "1:1: warning: this object is empty"),
    ("object is sphere - block", ""),
    ("object is sphere - cone - block scale 1.001", "1:1: warning: this object is empty"),
    ("object is block scale 9\nobject is sphere", "2:1: warning: this object is hidden inside"),
    ("object is trans (1, 1) block scale 9\nobject is sphere", ""),
    ("object is block scale 9\nobject is sphere at (8.5, 0, 0)", ""),
    ("object is block scale 9 - cone\nobject is sphere", ""),
    ("camera at (0, 1, 0) object is block scale 9", "1:1: warning: the camera is inside a solid"),
    (
        "camera at (0, 1, 0) object is trans (9, 1.3) block scale 9",
        "1:1: warning: the camera is inside a clear solid",
    ),
    (
        "camera at (0, 1, 0) object is trans (9, 1.3) block scale 9 object is sphere at (0, -3, 0)",
        "",
    ),
    ("object is sphere - sphere", "1:1: warning: this object is empty"),
    ("object is (sphere - cone) - sphere", ""),
    ("object is sphere - sphere at (1e-9, 0, 0)", ""),
    (
        "object is red cone + sphere\nobject is blue cone + green sphere",
        "2:1: warning: this object stands where an equal one stands",
    ),
    (
        "repeat i from 1 to 2 { object is cone at (0, 1, 0) }",
        "1:24: warning: this object stands where an equal one stands",
    ),
    ("object is cone at (1, 0, 0)\nobject is cone rotate (0, 0, 1) at (1, 0, 0)", ""),
    ("object is sphere\nobject is torus (0.5) scale (2, 1, 1)", ""),
    ("camera at (0, 1, 0)", "1:1: warning: the scene has no objects"),
    ("", "1:1: warning: the scene has no objects"),
    ("let a = 3", ""),
    ("background red", ""),
    (
        "camera at (0, 0, 9) object is sphere object is sphere at (0, 0, 12)",
        "1:38: warning: this object is out of view",
    ),
    (
        "camera parallel at (0, 0, 9) object is sphere object is sphere at (30, 0, 0)",
        "1:47: warning: this object is out of view",
    ),
    ("camera parallel at (0, 0, 9) object is sphere object is sphere at (4, 0, 0)", ""),
    ("camera at (0, 0, 9) object is sphere object is sphere at (4, 0, 0)", ""),
    ("camera at (0, 0, 9) object is sphere at (0, 0, 12) + sphere", ""),
    // It may be seen in a mirror, or through a lens, or throw a shadow.
    ("camera at (0, 0, 9) object is shiny smoothest sphere object is sphere at (0, 0, 12)", ""),
    ("camera at (0, 0, 9) object is trans (1, 1.5) sphere object is sphere at (0, 0, 12)", ""),
    ("camera at (0, 0, 9) light at (0, 0, 19) object is sphere object is sphere at (0, 0, 12)", ""),
    (
        "camera at (0, 0, 9) light beam at (1, 2, 7) object is sphere object is sphere at (2, 5, 16)",
        "",
    ),
    (
        "camera at (0, 0, 9) light beam at (1, 2, 7) object is sphere object is sphere at (-5, 5, 16)",
        "1:62: warning: this object is out of view",
    ),
    (
        "camera at (0, 0, 9) light at (0, 0, 19) no shadows object is sphere object is sphere at (0, 0, 12)",
        "1:69: warning: this object is out of view",
    ),
    (
        "object is dullest (trans (1, 1.5) sphere + cone)",
        "1:1: warning: the dullest surface lets no light through the clear body in it",
    ),
    (
        "class a is trans (1, 1.5) sphere class b is cone + a\nobject is shininess 0 b",
        "2:1: warning: the dullest surface lets no light through the clear body in it",
    ),
    ("object is dullest (shiny trans (1, 1.5) sphere + cone)", ""),
    ("object is trans (1, 1.5) (dullest cone + sphere)", ""),
    ("class a is shiny trans (1, 1.5) sphere object is dullest a", ""),
    ("object is shiny (trans (1, 1.5) sphere) + dullest cone", ""),
    ("camera at (0, 1, 0) object is block scale 9 - sphere scale 2", ""),
    (
        "camera at (0, 1, 0) class a (r) is cone scale r object is a (9) rotate (0, 0, 90) at (0, -1, 0)",
        "1:1: warning: the camera is inside",
    ),
    (
        "object is sphere light beam at (0, 9, 0) intensity 0",
        "1:18: warning: this light lights nothing",
    ),
    ("object is sphere light beam at (0, 9, 0) black", "1:18: warning: this light lights nothing"),
    ("object is sphere light at (0, 9, 0) no shadows", ""),
    ("object is block light at (0, .5, 0)", "1:17: warning: this light lights nothing"),
    ("object is block light at (0, .5, 0) no shadows", ""),
    (
        "object is block light spot (1, 20) at (0, 9, 0) toward (9, 9, 0)",
        "1:17: warning: this light lights nothing",
    ),
    ("object is block light spot (1, 20) at (0, 9, 0) toward (4, 0, 0)", ""),
    ("light spot (1, 20) at (0, 9, 0) toward (4, 0, 0)", ""),
];

#[test]
fn warnings_are_given_where_they_are_proved() {
    for (text, expected) in WARNINGS {
        let report = compile_text(text).report();
        match *expected {
            "" => assert_eq!(report, "", "{text}"),
            _ => assert!(report.starts_with(&format!("<text>:{expected}")), "{text}: {report}"),
        }
    }
}
