//! Layouts by hand, and what holds of the layout of every text.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use proptest::prelude::*;

use super::*;
use crate::source::Text;
use crate::{compile_path, compile_text};

fn sources(text: &[u8]) -> SourceMap {
    SourceMap::from_reader(Path::new("a.sdl"), text).unwrap()
}

/// Laid out, after a look at what has to hold of every text.
fn laid(text: &str) -> String {
    let once = laid_out(&sources(text.as_bytes())).unwrap();
    assert_eq!(laid_out(&sources(once.as_bytes())).unwrap(), once, "twice is once: {text}");
    assert_eq!(words(text), words(&once), "tokens and comments in their order: {text}");
    assert!(!once.lines().any(|line| line.ends_with(' ')) || text.contains("/*"), "blanks: {once}");
    assert!(!once.contains("\n\n\n") || text.contains("/*"), "empty lines: {once}");
    assert!(once.is_empty() || once.ends_with('\n'), "the last line is ended: {once}");
    once
}

/// Tokens and comments by another way than that of the formatter: all that is not white space.
fn words(text: &str) -> String {
    text.trim_start_matches('\u{feff}').chars().filter(|c| !c.is_whitespace()).collect()
}

/// The bytes of the compiled scene.
fn compiled(compiled: crate::Compiled) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    scene::format::write(&compiled.scene?, &mut bytes).unwrap();
    Some(bytes)
}

/// Every scene description below a folder of the repository.
fn scenes(folder: &str) -> Vec<PathBuf> {
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(folder)];
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "sdl") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

#[test]
fn scenes_of_the_repository_mean_the_same() {
    let all = [scenes("scenes"), scenes("crates/compile/tests/data"), scenes("docs")].concat();
    assert!(all.len() > 20, "scenes: {}", all.len());
    let mut same = 0;
    for path in all {
        let text = std::fs::read_to_string(&path).unwrap();
        // What is not made of tokens is refused.
        if laid_out(&sources(text.as_bytes())).is_err() {
            assert!(compiled(compile_path(&path)).is_none(), "{}", path.display());
            continue;
        }
        let laid = laid(&text);
        let folder = path.parent().unwrap();
        let beside = tempfile::Builder::new().suffix(".sdl").tempfile_in(folder).unwrap();
        std::fs::write(beside.path(), &laid).unwrap();
        let (before, after) =
            (compiled(compile_path(&path)), compiled(compile_path(beside.path())));
        same += usize::from(before.is_some());
        assert!(before == after, "{}", path.display());
    }
    assert!(same > 10, "scenes that compile: {same}");
}

#[test]
fn constructs_have_one_layout() {
    for (text, expected) in [
        ("Object  IS sphere", "Object IS sphere\n"),
        ("object is a*b-c+d", "object is a * b - c + d\n"),
        ("object is red  - orange a-red b", "object is red-orange a - red b\n"),
        ("object is((a)) at(0,-1 ,+2)", "object is ((a)) at (0, -1, +2)\n"),
        ("object is trans(10,fake)cone scale-2", "object is trans (10, fake) cone scale -2\n"),
        (
            "object is paint wood( scale=2 )light gray paint marble black red a",
            "object is paint wood (scale = 2) light gray paint marble black red a\n",
        ),
        ("light at(0,0,0)light red light beam", "light at (0, 0, 0) light red\nlight beam\n"),
        ("fog 2 light red at (0,0,0)", "fog 2\nlight red at (0, 0, 0)\n"),
        ("camera at (0,0,1) target at (0,0,0)", "camera at (0, 0, 1) target at (0, 0, 0)\n"),
        ("camera at (0,0,1)\ntarget at (0,0,0)", "camera at (0, 0, 1)\ntarget at (0, 0, 0)\n"),
        ("fog 1\n\n\n\nfog 2\nfog 3", "fog 1\n\nfog 2\nfog 3\n"),
        ("\n\n fog 1 \r\n\r\n", "fog 1\n"),
        ("\u{feff}fog 1", "fog 1\n"),
        ("object is ) + + glas glas (", "object is ) + + glas glas (\n"),
        ("include\"a b.sdl\"", "include \"a b.sdl\"\n"),
        ("", ""),
    ] {
        assert_eq!(laid(text), expected, "{text}");
    }
}

#[test]
fn new_constructs_have_one_layout() {
    for (text, expected) in [
        ("let x=-2^-y*( 3-x )/sin (30)", "let x = -2^-y * (3 - x) / sin(30)\n"),
        ("object is sphere scale(2*r)*block", "object is sphere scale (2 * r) * block\n"),
        ("object is sphere at(-x,x-1,min(a,-b))", "object is sphere at (-x, x - 1, min(a, -b))\n"),
        ("object is shininess s (a+b)", "object is shininess s (a + b)\n"),
        (
            "class wheel(r,width=.2)is cone scale(r ,width,r)",
            "class wheel (r, width = .2) is cone scale (r, width, r)\n",
        ),
        ("object is wheel(3,width=1)at(0,0,0)", "object is wheel (3, width = 1) at (0, 0, 0)\n"),
        (
            "repeat i from 0 to n-1 step 2{object is a let y=i}object is b",
            "repeat i from 0 to n - 1 step 2 {\n  object is a\n  let y = i\n}\nobject is b\n",
        ),
        ("object is union of i from 1 to n(a)", "object is union of i from 1 to n (a)\n"),
    ] {
        assert_eq!(laid(text), expected, "{text}");
    }
}

#[test]
fn long_solids_have_a_line_for_each_term() {
    let (long, leaf) = ("object is ", "cylinder scale (100, 200, 300) at (100, 200, 300)");
    let text = format!("{long}{leaf} * {leaf}+red({leaf}-{leaf})\n\n - {leaf}");
    let expected = format!(
        "\
object is
    {leaf}
      * {leaf}
  + red (
        {leaf}
      - {leaf}
    )

  - {leaf}
"
    );
    assert_eq!(laid(&text), expected);
    let one = format!("object is smoothest shiniest trans (1000, 1.5) light moderate blue {leaf}");
    let expected = one.replace(" cylinder", "\n  cylinder") + "\n";
    assert_eq!(laid(&one), expected, "attributes, and the solid below them");
}

#[test]
fn lines_are_at_most_a_hundred_columns() {
    let numbers: Vec<String> = (0..200).map(|i| i.to_string()).collect();
    for text in [
        format!("object is sphere at ({})", numbers.join(" + ")),
        format!("let x = {}", numbers.join(" * ")),
        format!("object is ({})", vec!["sphere"; 200].join(" * ")),
        format!("object is {} sphere", vec!["paint wood red"; 100].join(" ")),
        format!("object is w ({})", numbers.join(", ")),
        format!("light {}", vec!["at (1, 2, 3)"; 40].join(" ")),
    ] {
        let laid = laid(&text);
        let longest = laid.lines().map(|line| line.chars().count()).max().unwrap();
        assert!(longest <= 100 && laid.lines().count() > 4, "{longest}: {laid}");
    }
}

#[test]
fn comments_stay_where_they_are() {
    let text = "\
// head

// of the class
class /* name */ w is // solid
    // first
    cone at (1, /* y */ 2, 3) // behind
    // before
  + sphere
  // end

/* two
     lines */
object is (
    w // in parentheses
    // last
) // after
// end of the file
";
    let expected = text.replace("\n  // end\n", "\n// end\n");
    assert_eq!(laid(text), expected);
    assert_eq!(laid("fog /* a *//* b */ 2 // c"), "fog /* a */ /* b */ 2 // c\n");
    assert_eq!(
        laid("object is sphere at (1, // x\n2, // y\n3)"),
        "object is sphere\n  at (1, // x\n    2, // y\n    3)\n"
    );
    assert_eq!(laid("/*a*/"), "/*a*/\n");
    assert_eq!(laid("// a\n\n\n\n// b"), "// a\n\n// b\n");
    assert_eq!(laid("repeat i from 1 to 2 {\n\n// a\n\n}"), "repeat i from 1 to 2 {\n  // a\n}\n");
}

#[test]
fn what_is_no_token_is_refused_with_its_place() {
    for (text, at) in [("fog 1 $", 6), ("fog 1 /* open", 6), ("include \"a", 8), ("fog 1e999", 4)] {
        let errors = laid_out(&sources(text.as_bytes())).unwrap_err();
        assert_eq!(errors[0].span.map(|span| span.start), Some(at), "{text}");
    }
    assert!(laid_out(&sources(b"fog 1 \xff")).is_err(), "not UTF-8");
}

#[test]
fn what_nests_deeply_is_laid_out() {
    let deep = format!("object is {}sphere{}", "(".repeat(50_000), ")".repeat(50_000));
    let laid_deep = laid(&deep);
    assert!(laid_deep.len() < 12_000_000, "indentation has an end: {}", laid_deep.len());
    let open = "object is red(a-".repeat(20_000);
    laid(&open);
    let numbers = format!("let x = {}1{}", "(".repeat(100_000), ")".repeat(100_000));
    laid(&numbers);
    let braces = "repeat i from 1 to 2 {".repeat(20_000);
    laid(&braces);
}

#[test]
fn items_hold_the_whole_text() {
    let text = "/* a */ fog 2 // b\n\n\n/* c */ /* d */ // e\n";
    let text = Text { text: text.into(), bad: None };
    let items = trivia::items(&text).unwrap();
    let mut found = String::new();
    for item in &items {
        for comment in &item.comments {
            write!(found, "{}[{}]", comment.lines, comment.text).unwrap();
        }
        write!(found, "{}<{}>", item.lines, item.text).unwrap();
    }
    assert_eq!(found, "1[/* a */]0<fog>0<2>0[// b]2[/* c */ /* d */ // e]1<>");
}

const LISTING: &str = include_str!("../../tests/data/accepted/listing.sdl");

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_tokens_in_any_order_are_laid_out(
        picks in prop::collection::vec(
            prop::sample::select(vec![
                "object", "is", "class", "light", "red", "blue", "-", "+", "*", "/", "^", "(", ")", "(", ")", ",",
                "=", "{", "}", "sphere", "name", "2", ".5", "at", "scale", "trans", "paint", "wood", "hsv",
                "shininess", "camera", "target", "let", "repeat", "union", "of", "from", "to", "step", "\"t\"",
                "fog", "very", "gray", "// c\n", "/* d */", "/* e\n  e */", "\n", "\n\n\n", "sin", "gray", "dull",
            ]),
            0..60,
        ),
    ) {
        laid(&picks.join(" "));
    }

    #[test]
    fn white_space_does_not_decide(at in 0..LISTING.len(), blanks in " {0,3}\n? ?") {
        let mut text = LISTING.to_owned();
        // A comment to the end of its line is ended by it, and a token is not cut.
        if text.as_bytes()[at] == b' ' && !text[..at].lines().last().unwrap_or("").contains("//") {
            text.insert_str(at, &blanks);
        }
        prop_assert_eq!(compiled(compile_text(laid(&text))), compiled(compile_text(LISTING)));
    }
}
