//! Parts of one clear medium that fill nearly the same space, one after the other in the source, are sought as one.
//!
//! A ray inside of a thousand balls of glass whose radii differ by a rounding leaves them one by one: each is a boundary at
//! which nothing changes, that takes as long to find out about as there are balls. As one part they are left where the
//! last of them ends. Parts that other media stand between stay apart, as [`super::parts`] says; opaque ones need no
//! such care, since the first of them ends a ray.

use scene::Bounds;

use super::build::{Builder, Operand};
use super::{MediumId, Part};

/// No fewer parts make a pile: a few are found out about as quickly one by one.
const FEWEST: usize = 8;
/// Boxes whose corners differ by at most this share of the larger one fill nearly the same space.
const ALIKE: f64 = 0.125;

/// Joins piles among the parts of a scene.
pub(super) fn join_piles(builder: &mut Builder, parts: &mut Vec<Part>) {
    let mut joined = Vec::with_capacity(parts.len());
    let mut rest = parts.as_slice();
    while let Some(first) = rest.first() {
        let bounds = builder.nodes[first.node as usize].bounds();
        let same = |part: &&Part| {
            part.medium == first.medium
                && are_alike(&bounds, &builder.nodes[part.node as usize].bounds())
        };
        let clear = first.medium != MediumId::OPAQUE && first.medium != MediumId::AIR;
        // Not even itself has a box like that of what is boundless, or holds nothing.
        let count = if clear { 1 + rest[1..].iter().take_while(same).count() } else { 1 };
        let (pile, later) = rest.split_at(count);
        rest = later;
        if count < FEWEST {
            joined.extend_from_slice(pile);
            continue;
        }
        let union = builder.union(pile.iter().map(|part| Operand::Node(part.node)));
        let node = builder.finish(union);
        joined.extend(node.map(|node| Part { node, medium: first.medium }));
    }
    *parts = joined;
}

fn are_alike(a: &Bounds, b: &Bounds) -> bool {
    let most = ALIKE * (a.high - a.low).max(b.high - b.low);
    (a.low - b.low).abs().cmple(most).all() && (a.high - b.high).abs().cmple(most).all()
}

#[cfg(all(test, feature = "command"))]
mod tests {
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
        assert_eq!(
            seen(&format!("object is {boundless}\nobject is {boundless}")).1,
            3,
            "boundless"
        );
    }
}
