//! Piles of glass.

use crate::{Options, World, render};

/// Balls of glass in front of a wall, and how many parts they are.
fn seen(balls: &str) -> (Vec<[f32; 3]>, usize) {
    let text = format!(
        "{balls}\nobject is strong red block scale (9, 9, 1) at (0, 0, -6)\nlight point at (3, 5, 9)\n\
         ambient intensity 0.3\ncamera at (0.3, 1, 6) target at (0, 0, 0)\n"
    );
    let compiled = compile::compile_text(&text);
    let scene = compiled.scene.as_ref().unwrap_or_else(|| panic!("{}", compiled.report()));
    let world = World::load(scene).expect("it loads");
    let options = Options { columns: 20, rows: 20, ..Options::default() };
    let picture = render(&world, &options, &|_| ()).expect("a picture");
    let pixels = picture.film.pixels().map(|pixel| pixel.color).collect();
    (pixels, world.whole.parts.len())
}

fn ball(index: f64, radius: f64) -> String {
    format!("smoothest trans (9, {index}) white sphere scale {radius}")
}

fn pile(count: u32, step: f64, join: &str) -> String {
    let balls = (0..count).map(|k| ball(1.5, 1.0 + step * f64::from(k)));
    balls.collect::<Vec<_>>().join(join)
}

#[test]
fn a_pile_is_one_part_and_looks_like_the_last_of_it() {
    let (largest, parts) = seen(&format!("object is {}", ball(1.5, 1.0 + 199.0 * 1e-15)));
    assert_eq!(parts, 2);
    for join in [" + ", "\nobject is "] {
        let (pixels, parts) = seen(&format!("object is {}", pile(200, 1e-15, join)));
        assert_eq!(parts, 2, "{join:?}");
        for (pixel, expected) in pixels.iter().zip(&largest) {
            let apart = (0..3).map(|k| (pixel[k] - expected[k]).abs());
            assert!(apart.fold(0.0, f32::max) < 1e-6, "{pixel:?} {expected:?}");
        }
    }
}

#[test]
fn what_other_media_stand_between_or_lies_apart_stays_apart() {
    let turns = (0..20).map(|k| ball([1.5, 1.33][k % 2], 1.0 + 1e-15 * k as f64));
    let turns = turns.collect::<Vec<_>>().join("\nobject is ");
    assert_eq!(seen(&format!("object is {turns}")).1, 21, "water between glass");
    assert_eq!(seen(&format!("object is {}", pile(20, 0.1, "\nobject is "))).1, 21, "shells");
    assert_eq!(seen(&format!("object is {}", pile(5, 1e-15, "\nobject is "))).1, 6, "few");
    // Larger than single precision has room for.
    let boundless = ball(1.5, 1e39);
    assert_eq!(seen(&format!("object is {boundless}\nobject is {boundless}")).1, 3, "boundless");
}
