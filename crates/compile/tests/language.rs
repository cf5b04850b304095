//! Numbers, classes with parameters, and what is repeated: against values worked out by hand, and an evaluator of its own.

#![expect(clippy::unwrap_used, reason = "functions that tests share")]

use compile::{Compiled, Options, compile_text, compile_text_with};
use glam::DVec3;
use proptest::prelude::*;
use scene::{ClassId, Node, Scene};

fn scene(text: &str) -> Scene {
    let compiled = compile_text(text);
    assert_eq!(compiled.error_report(), "", "{text}");
    compiled.scene.unwrap()
}

/// The place of the first frame of the first object.
fn place(text: &str) -> DVec3 {
    scene(text).objects[0].solid.frames[0].placement.place
}

fn value(expression: &str) -> f64 {
    place(&format!("let n = 5 let a = {expression} object is sphere at (a, 0, 0)")).x
}

/// Scenes that have to be the same but for the names of classes.
fn same(a: &str, b: &str) {
    let plain = |text: &str| {
        let mut scene = scene(text);
        for class in &mut scene.classes {
            class.name.clear();
        }
        scene
    };
    assert_eq!(plain(a), plain(b), "{a}\n{b}");
}

#[test]
fn expressions_by_hand() {
    for (text, expected) in [
        ("2 + 3 * 4", 14.0),
        ("(2 + 3) * 4", 20.0),
        ("10 - 4 - 3", 3.0),
        ("16 / 4 / 2", 2.0),
        ("-2 ^ 2", -4.0),
        ("(-2) ^ 2", 4.0),
        ("2 ^ 3 ^ 2", 512.0),
        ("2 ^ -1", 0.5),
        ("2 * -3", -6.0),
        ("- - 3", 3.0),
        ("+3", 3.0),
        ("2 - -3", 5.0),
        ("-3 * -2 ^ 2 - 1", 11.0),
        ("sin (30) * 2", 1.0),
        ("cos (90)", 0.0),
        ("tan (45)", 1.0),
        ("sqrt (2 ^ 2 + 3 * 7)", 5.0),
        ("abs (-3) + abs (3)", 6.0),
        ("min (3, 1, 2) - max (3, 1, 2)", -2.0),
        ("floor (-1.5)", -2.0),
        ("mod (7, 3)", 1.0),
        ("mod (-7, 3)", 2.0),
        ("mod (7, -3)", -2.0),
        ("mod (6, 3)", 0.0),
        ("pi", std::f64::consts::PI),
        ("N * frame + n", 5.0),
        ("1e3/*a*/*2// b\n", 2000.0),
    ] {
        let found = value(text);
        assert!((found - expected).abs() < 1e-15 * (1.0 + expected.abs()), "{text}: {found}");
    }
}

#[test]
fn operators_outside_parentheses_belong_to_solids() {
    same("object is sphere scale 2 * block", "object is sphere scale (2) * block");
    let scaled =
        scene("let r = 2 object is sphere scale (r * 3) - block scale -r - cone scale sin (90)");
    let scales: Vec<f64> =
        scaled.objects[0].solid.frames.iter().map(|frame| frame.placement.scale.x).collect();
    assert_eq!(scales, [6.0, -2.0, 1.0]);
    assert_eq!(scaled.objects[0].solid.nodes.len(), 6, "two subtractions");
    same(
        "let s = .5 let d = 4 object is shininess s smoothness (s / 2) priority -d trans (d * 2, 1 + s) rgb (s, 0, 1 - s) cone
         light spot (d, d * 5) at (0, d, 0) toward (0, 0, 0) intensity s fog d focal length (d * 10)",
        "object is shininess .5 smoothness .25 priority -4 trans (8, 1.5) rgb (.5, 0, .5) cone
         light spot (4, 20) at (0, 4, 0) toward (0, 0, 0) intensity .5 fog 4 focal length 40",
    );
}

#[test]
fn words_of_this_language_are_still_names() {
    same(
        "class let is sphere class repeat is cone class union is block class of is cylinder
         class sin is sphere class frame is let class pi is repeat class step is of
         object from is let + repeat + union + of + sin + frame + pi + step object to is let
         object let is union * intersection class intersection is sphere"
            .replace("union * intersection class intersection is sphere", "union * let")
            .as_str(),
        "class a is sphere class b is cone class c is block class d is cylinder
         class e is sphere class f is a class g is b class h is d
         object from is a + b + c + d + e + f + g + h object to is a object let is c * a",
    );
}

#[test]
fn repeats_are_what_they_stand_for() {
    same(
        "repeat i from 1 to 3 { object is sphere at (i, i ^ 2, 0) light beam at (i, 0, 0) }",
        "object is sphere at (1, 1, 0) light beam at (1, 0, 0) object is sphere at (2, 4, 0)
         light beam at (2, 0, 0) object is sphere at (3, 9, 0) light beam at (3, 0, 0)",
    );
    same(
        "let i = 7 repeat i from 2 to 1 step -.5 { let k = 2 * i repeat j from 0 to i { object is cone at (i, j, k) } }
         object is block at (i, 0, 0)",
        "object is cone at (2, 0, 4) object is cone at (2, 1, 4) object is cone at (2, 2, 4)
         object is cone at (1.5, 0, 3) object is cone at (1.5, 1, 3)
         object is cone at (1, 0, 2) object is cone at (1, 1, 2) object is block at (7, 0, 0)",
    );
    assert!(scene("repeat i from 1 to 0 { object is sphere }").objects.is_empty(), "no turn");
    let named = scene("repeat i from 1 to 2 { object ball is sphere at (i, 0, 0) }");
    assert!(named.objects.iter().all(|object| object.name.as_deref() == Some("ball")), "names");
}

#[test]
fn solids_are_joined_over_a_variable() {
    same(
        "object is union of i from 1 to 3 (sphere at (i, 0, 0))",
        "object is (sphere at (1, 0, 0) + sphere at (2, 0, 0) + sphere at (3, 0, 0))",
    );
    same(
        "object is block - red intersection of i from 1 to 2 (sphere scale i - cone at (i, 0, 0)) scale 2 at (0, 1, 0)",
        "object is block - red ((sphere scale 1 - cone at (1, 0, 0)) * (sphere scale 2 - cone at (2, 0, 0)))
         scale 2 at (0, 1, 0)",
    );
    same("object is union of i from 4 to 4 (cone at (i, 0, 0))", "object is cone at (4, 0, 0)");
    same(
        "object is union of i from 1 to 2 (union of j from 1 to i (block at (i, j, 0)))",
        "object is block at (1, 1, 0) + (block at (2, 1, 0) + block at (2, 2, 0))",
    );
}

#[test]
fn classes_with_parameters_are_made_where_they_are_used() {
    same(
        "class wheel (r, w = r / 4) is red cylinder scale (w, r, r)
         object is wheel (4) + wheel (2, 3) at (9, 0, 0) + wheel (w = 1, r = 8) rotate (0, 90, 0)",
        "class a is red cylinder scale (1, 4, 4) class b is red cylinder scale (3, 2, 2)
         class c is red cylinder scale (1, 8, 8) object is a + b at (9, 0, 0) + c rotate (0, 90, 0)",
    );
    same(
        "class ball (r = 2) is sphere scale r object is ball",
        "class ball is sphere scale 2 object is ball",
    );
    // What a class sees is where it stands, not where it is used.
    same(
        "let k = 3 class rod (l) is cylinder scale (l, k, k)
         repeat k from 1 to 2 { object is rod (k) at (0, k, 0) }",
        "class a is cylinder scale (1, 3, 3) object is a at (0, 1, 0)
         class b is cylinder scale (2, 3, 3) object is b at (0, 2, 0)",
    );
    // A class of a class, in the order that they are needed in.
    same(
        "class leg (h) is cylinder scale (h, 1, 1)
         class table (h, n) is block at (0, h, 0) + union of i from 1 to n (leg (h) at (i, 0, 0))
         object is table (3, 2)",
        "class leg is cylinder scale (3, 1, 1)
         class table is block at (0, 3, 0) + (leg at (1, 0, 0) + leg at (2, 0, 0)) object is table",
    );
}

#[test]
fn equal_numbers_share_a_class() {
    let shared = scene(
        "class wheel (r, w = 1) is cylinder scale (w, r, r)
         repeat i from 1 to 1000 { object is wheel (2 + mod (i, 2)) at (i, 0, 0) }
         object is wheel (2, 1) + wheel (r = 2) + wheel (4 / 2)",
    );
    let names: Vec<&str> = shared.classes.iter().map(|class| class.name.as_str()).collect();
    assert_eq!(names, ["wheel(3,1)", "wheel(2,1)"], "in the order of their first use");
    let Node::Instance { class, .. } = shared.objects[1000].solid.nodes[2] else { panic!("three") };
    assert_eq!(class, ClassId(1));
    let mut text = Vec::new();
    scene::format::write(&shared, &mut text).unwrap();
    assert!(scene::format::read(&text).unwrap() == shared, "such a name is written and read");
}

#[test]
fn painted_and_stretched_instances_keep_their_parameters() {
    let solid = |text: &str| {
        let scene = scene(text);
        let frame = scene.classes[0].solid.frames[0];
        (frame.placement, scene.attributes[frame.attributes.0 as usize].clone(), scene.objects)
    };
    let made = solid(
        "class board (l) is paint wood (scale = l * 2) brown block scale (l, l / 4, 1)
         object is shiny board (8) scale (1, 2, 3) rotate (10, 20, 30)",
    );
    let written = solid(
        "class board is paint wood (scale = 16) brown block scale (8, 2, 1)
         object is shiny board scale (1, 2, 3) rotate (10, 20, 30)",
    );
    assert_eq!((made.0, made.1), (written.0, written.1), "the class");
    let frames = |objects: &[scene::Object]| objects[0].solid.frames[0].placement;
    assert_eq!(frames(&made.2), frames(&written.2), "the instance");
}

fn report(compiled: &Compiled) -> String {
    compiled.report()
}

#[test]
fn mistakes_name_the_use_and_the_turn() {
    let compiled = compile_text(
        "class wheel (r) is cylinder scale (1 / r)\nclass car (w) is block + wheel (w - 1)
repeat i from 3 to 0 step -1 {\n  object is car (i) at (i, 0, 0)\n}",
    );
    let expected = "\
<text>:1:40: error: division by 0
1 | class wheel (r) is cylinder scale (1 / r)
  |                                        ^
<text>:2:26: note: in this use of `wheel`
2 | class car (w) is block + wheel (w - 1)
  |                          ^^^^^^^^^^^^^
<text>:4:13: note: in this use of `car`
4 |   object is car (i) at (i, 0, 0)
  |             ^^^^^^^
<text>:3:8: note: in the turn with i = 1
3 | repeat i from 3 to 0 step -1 {
  |        ^
hint: the number below the line has to differ from 0
";
    assert_eq!(report(&compiled), expected);
}

#[test]
fn a_mistake_in_a_class_names_every_use_that_has_it() {
    let compiled = compile_text(
        "class wheel (r) is cylinder scale (1 / r)
class car (w) is wheel (w) + wheel (w - 1)
object is wheel (0)
object is wheel (2)
object is wheel (0) at (1, 0, 0)
object is car (1)
object is car (1) at (1, 0, 0)",
    );
    assert_eq!(compiled.diagnostics.len(), 1, "one mistake");
    let found: Vec<(u32, &str)> = compiled.diagnostics[0]
        .notes
        .iter()
        .map(|note| (compiled.sources.locate(note.span).unwrap().line, note.message.as_str()))
        .collect();
    let expected = [
        (3, "in this use of `wheel`"),
        (5, "in this use of `wheel`"),
        (2, "in this use of `wheel`"),
        (6, "in this use of `car`"),
        (7, "in this use of `car`"),
    ];
    assert_eq!(found, expected, "each place, innermost first");
    // Of many uses some are named, the others counted.
    let many = format!("class w (r) is cone scale (1 / r) {}", "object is w (0) ".repeat(10_000));
    let report = compile_text(many).report();
    assert!(report.len() < 5_000 && report.contains("more places"), "{report}");
}

#[test]
fn numbers_from_outside_replace_those_of_let() {
    let text = "let n = 2 let m = n + 1 object is sphere at (n, m, frame)";
    let given = |definitions: &[(&str, f64)]| {
        let definitions = definitions.iter().map(|&(name, n)| (name.to_owned(), n)).collect();
        let compiled = compile_text_with(text, &Options { definitions, ..Options::default() });
        compiled.scene.map(|scene| scene.objects[0].solid.frames[0].placement.place)
    };
    assert_eq!(given(&[]), Some(DVec3::new(2.0, 3.0, 0.0)));
    assert_eq!(given(&[("N", 5.0)]), Some(DVec3::new(5.0, 6.0, 0.0)), "later ones follow");
    assert_eq!(given(&[("m", 5.0), ("Frame", 9.0)]), Some(DVec3::new(2.0, 5.0, 9.0)));
    assert_eq!(given(&[("k", 1.0)]), None, "nothing is called so");
}

#[test]
fn depth_costs_no_stack() {
    // Each class is made of the one before it, so the last is made of all.
    let mut chain = String::from("class c0 (n) is sphere scale n\n");
    for i in 1..20_000 {
        chain += &format!("class c{i} (n) is c{} (n)\n", i - 1);
    }
    let made = scene(&(chain + "object is c19999 (2)"));
    assert_eq!(made.classes.len(), 20_000, "one for each");
    let nested = 40_000;
    let text = "repeat i from 1 to 1 { ".repeat(nested) + "object is sphere" + &"}".repeat(nested);
    assert_eq!(scene(&text).objects.len(), 1, "repeats");
    let text = "object is ".to_owned()
        + &"union of i from 1 to 1 (".repeat(nested)
        + "sphere"
        + &")".repeat(nested);
    assert_eq!(scene(&text).objects[0].solid.nodes.len(), 1, "unions");
    let text = "let a = ".to_owned() + &"(-".repeat(20_000) + "1" + &")".repeat(20_000);
    assert_eq!(place(&(text + " object is sphere at (a, 0, 0)")).x.to_bits(), 1_f64.to_bits());
    for text in [
        "repeat i from 1 to 1 {",
        "object is union of i from 1 to 1 (",
        "let a = -(",
        "class a (b) is (",
    ] {
        assert!(compile_text(text.repeat(200_000)).scene.is_none(), "{text}: an error");
    }
}

#[test]
fn what_is_made_is_limited() {
    // Each class twice the one before: the last would be made of 2⁴⁰.
    let mut doubled = String::from("class c0 (n) is sphere scale (n + 1)\n");
    for i in 1..=40 {
        doubled += &format!("class c{i} (n) is c{0} (2 * n) + c{0} (2 * n + 1)\n", i - 1);
    }
    let limit = |text: &str, max_primitives| {
        let options = Options { max_primitives, ..Options::default() };
        compile_text_with(text, &options).error_report()
    };
    let said = limit(&(doubled + "object is c40 (0)"), 10_000);
    assert!(said.contains("expected at most 10000 solids from repeats and classes"), "{said}");
    let nested = "repeat i from 1 to 900 { repeat j from 1 to 900 { let a = i } }";
    let expected = "\
<text>:1:33: error: expected turns that make something, found 371 that make nothing beside 0 that do
1 | repeat i from 1 to 900 { repeat j from 1 to 900 { let a = i } }
  |                                 ^
<text>:1:33: note: in the turn with j = 371
1 | repeat i from 1 to 900 { repeat j from 1 to 900 { let a = i } }
  |                                 ^
<text>:1:8: note: in the turn with i = 1
1 | repeat i from 1 to 900 { repeat j from 1 to 900 { let a = i } }
  |        ^
hint: --max-primitives raises the limit
";
    assert_eq!(limit(nested, 1000), expected, "work is limited, too");
    assert_eq!(limit(nested, 100_000_000), "");
    // One of many turns that makes something, as a question is written.
    let asked = "repeat i from 1 to 8000 { repeat k from 1 to 1 - mod (i, 8) { object is cone at (i, 0, 0) } }";
    assert_eq!(limit(asked, 10_000), "");
    let vast = "repeat i from 1 to 1e7 { repeat j from 1 to 1e7 { let a = i } }";
    let said = limit(vast, 10_000_000);
    assert!(said.contains("that make nothing"), "{said}");
}

/// NaN for what is no finite number: an expression with such a part has no value.
fn known(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::NAN }
}

/// An expression, and its value by another way: a tree that is evaluated as it is made.
fn expression() -> impl Strategy<Value = (String, f64)> {
    let leaf = prop_oneof![
        (0_u32..100).prop_map(|n| (n.to_string(), f64::from(n))),
        (0_u32..1000).prop_map(|n| (format!("{}.{:02}", n / 100, n % 100), f64::from(n) / 100.0)),
        Just(("pi".to_owned(), std::f64::consts::PI)),
        Just(("n".to_owned(), 5.0)),
    ];
    leaf.prop_recursive(6, 60, 3, |inner| {
        let two = (inner.clone(), inner.clone());
        prop_oneof![
            (two.clone(), 0_usize..4).prop_map(|(((a, x), (b, y)), which)| {
                let quotient = if y.abs() > 0.0 { x / y } else { f64::NAN };
                let (sign, value) =
                    [('+', x + y), ('-', x - y), ('*', x * y), ('/', quotient)][which];
                (format!("({a}) {sign} ({b})"), known(value))
            }),
            (inner.clone(), 0_u8..4).prop_map(|((a, x), n)| {
                (
                    format!("({a}) ^ {n}"),
                    known((0..n).fold(x * 0.0 + 1.0, |product, _| product * x)),
                )
            }),
            inner.clone().prop_map(|(a, x)| (format!("-({a})"), -x)),
            inner.clone().prop_map(|(a, x)| (format!("abs ({a})"), x.abs())),
            inner.clone().prop_map(|(a, x)| (format!("floor ({a})"), x.floor())),
            two.clone().prop_map(|((a, x), (b, y))| {
                (format!("max ({a}, {b})"), if x > y { x } else { y + 0.0 * x })
            }),
            two.prop_map(|((a, x), (b, y))| {
                (format!("min ({a}, {b}, {a})"), if x < y { x } else { y + 0.0 * x })
            }),
        ]
    })
}

/// Numbers joined without parentheses, and their value with every operator in its turn.
fn flat() -> impl Strategy<Value = (String, f64)> {
    let number = (1_u32..9, any::<bool>());
    (number.clone(), prop::collection::vec((0_usize..4, number), 1..12)).prop_map(
        |(first, rest)| {
            let text = |(n, minus): (u32, bool)| format!("{}{n}", if minus { "-" } else { "" });
            let value = |(n, minus): (u32, bool)| if minus { -f64::from(n) } else { f64::from(n) };
            let (mut written, mut terms) = (text(first), vec![value(first)]);
            for (operator, number) in rest {
                written += &format!(" {} {}", ['+', '-', '*', '/'][operator], text(number));
                let last = terms.last_mut().unwrap();
                match operator {
                    0 => terms.push(value(number)),
                    1 => terms.push(-value(number)),
                    2 => *last *= value(number),
                    _ => *last /= value(number),
                }
            }
            (written, terms.iter().skip(1).fold(terms[0], |sum, term| sum + term))
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn expressions_have_the_value_of_another_evaluator((text, expected) in prop_oneof![expression(), flat()]) {
        let compiled = compile_text(format!("let n = 5 let a = {text} object is sphere at (a, 0, 0)"));
        match compiled.scene {
            Some(scene) => {
                let found = scene.objects[0].solid.frames[0].placement.place.x;
                // Powers are rounded otherwise; a rounding may be what separates two whole numbers.
                let close = (found - expected).abs() <= 1e-9 * (1.0 + expected.abs());
                prop_assert!(close || text.contains('^'), "{text} = {found}, expected {expected}");
                prop_assert!(expected.is_finite(), "{text} = {found}, expected none");
            }
            None => prop_assert!(
                expected.is_nan() || expected.abs() > 1e90,
                "{text}, expected {expected}: {}", compiled.report()
            ),
        }
    }
}
