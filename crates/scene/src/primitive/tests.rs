//! Convex solids against twice the precision, and values worked out by hand.

use super::double::Double;
use super::*;
use crate::transform::Placement;

/// A fixed sequence of numbers.
pub(super) struct Numbers(u64);

impl Numbers {
    pub(super) fn new() -> Self {
        Self(0x2545_f491_4f6c_dd1d)
    }

    /// From −1 to 1.
    pub(super) fn unit(&mut self) -> f64 {
        let state = &mut self.0;
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        let unit = (*state >> 11) as f64 / (1_u64 << 53) as f64;
        2.0 * unit - 1.0
    }
}

/// Points and directions over many decades, the awkward ones included; fixed sequence.
pub(super) fn samples() -> impl Iterator<Item = (DVec3, DVec3)> {
    let mut numbers = Numbers::new();
    let mut next = move || numbers.unit();
    (0..4000).map(move |i| {
        let far = libm::exp10(f64::from(i % 9));
        let target = DVec3::new(next(), next(), next()) * 1.2 + DVec3::new(0.3, 0.0, 0.0);
        let mut direction = DVec3::new(next(), next(), next());
        match i % 7 {
            0 => direction.x = 0.0,
            1 => direction = DVec3::X * direction.x,
            2 => direction.y = -0.0,
            3 => direction = DVec3::new(1.0, 1.0, 0.0),
            _ => {}
        }
        (target - direction * far, direction)
    })
}

#[test]
fn keywords_are_distinct_lower_case_and_files() {
    let mut seen = std::collections::BTreeSet::new();
    for solid in Primitive::ALL {
        for keyword in solid.keywords() {
            assert_eq!(*keyword, keyword.to_ascii_lowercase(), "case");
            assert!(seen.insert(*keyword), "{keyword} twice");
            assert_eq!(Primitive::named(&keyword.to_uppercase()), Some(*solid), "found by name");
        }
        let file =
            format!("{}/src/primitive/{}.rs", env!("CARGO_MANIFEST_DIR"), solid.keywords()[0]);
        assert!(std::path::Path::new(&file).exists(), "{file}");
    }
}

#[test]
fn the_middle_of_a_span_is_inside_and_just_beyond_is_not() {
    for &solid in Primitive::ALL {
        let mut hits = 0;
        for (origin, direction) in samples() {
            let span = solid.span(&Ray::new(origin, direction));
            let at = |t: f64| origin + t * direction;
            // Rounding of the origin blurs the solid by this much, as a length.
            let blur = 1e-14 * (1.0 + origin.abs().max_element());
            let inside = |p: DVec3| solid.distance(p, DVec3::length) < -blur;
            let outside = |p: DVec3| solid.distance(p, DVec3::length) > blur;
            if span.from < span.to {
                hits += 1;
                let width = span.to - span.from;
                assert!(
                    !outside(at(span.from + 0.5 * width)),
                    "{solid:?}: the middle of {span:?} from {origin} along {direction}"
                );
                let before = at(span.from - 1e-3 * width);
                let after = at(span.to + 1e-3 * width);
                assert!(!inside(before), "{solid:?}: before {span:?} from {origin}");
                assert!(!inside(after), "{solid:?}: after {span:?} from {origin}");
            } else {
                for i in 0..64 {
                    let t = (f64::from(i) / 32.0 - 1.0) * 3.0;
                    let nearest = -origin.dot(direction) / direction.length_squared();
                    assert!(!inside(at(nearest + t)), "{solid:?}: missed from {origin}");
                }
            }
        }
        assert!(hits > 400, "{solid:?}: {hits} hits say something");
    }
}

#[test]
fn ends_lie_on_the_face_they_name_and_normals_oppose_the_entering_ray() {
    for &solid in Primitive::ALL {
        for (origin, direction) in samples() {
            let span = solid.span(&Ray::new(origin, direction));
            if span.from >= span.to || span.to - span.from < 1e-3 {
                continue;
            }
            let blur = 1e-13 * (1.0 + origin.abs().max_element()) + 1e-9;
            for (t, face, sign) in [(span.from, span.entered(), -1.0), (span.to, span.left(), 1.0)]
            {
                let p = origin + t * direction;
                assert!(
                    solid.distance(p, DVec3::length).abs() < blur * 100.0,
                    "{solid:?}: {p} is on the surface: {} from {origin} along {direction}, {span:?}",
                    solid.distance(p, DVec3::length)
                );
                let slope = DVec3::from_array(solid.gradient(p.to_array(), face.number()))
                    .dot(direction)
                    * sign;
                assert!(slope > -blur * 1e3, "{solid:?}: face {face:?} at {p}: {slope}");
                let uv = solid.texture_coordinates(p, face);
                assert!(
                    uv.cmpge(DVec2::splat(-blur)).all() && uv.cmple(DVec2::splat(1.0 + blur)).all(),
                    "{solid:?}: {uv} at {p}"
                );
            }
        }
    }
}

/// How far a line may be off a face, as a length, relative to the largest coordinate of its origin: the rounding of the
/// origin alone is 2⁻⁵³ of it for each axis.
pub(super) const KERNEL: f64 = 4.0 * f64::EPSILON;

#[test]
fn spans_are_those_of_twice_the_precision_over_nine_decades() {
    for &solid in Primitive::ALL {
        let mut worst = 0.0_f64;
        for (origin, direction) in samples() {
            let direction = direction.normalize_or(DVec3::X);
            let span = solid.span(&Ray::new(origin, direction));
            let lines = |v: DVec3| v.to_array().map(Double::new);
            let exact = solid.span(&Ray { origin: lines(origin), direction: lines(direction) });
            let size = 1.0 + origin.abs().max_element();
            let width = exact.to.value() - exact.from.value();
            if exact.from.value().is_infinite() || width < 1e4 * KERNEL * size {
                // A miss, or a graze that rounding may turn into one.
                assert!(
                    span.to - span.from < 1e-2 + 1e5 * KERNEL * size,
                    "{solid:?} from {origin}"
                );
                continue;
            }
            for (found, exact, face) in [
                (span.from, exact.from.value(), span.entered()),
                (span.to, exact.to.value(), span.left()),
            ] {
                let gradient = DVec3::from_array(
                    solid.gradient((origin + exact * direction).to_array(), face.number()),
                )
                .normalize_or_zero();
                // What counts is the distance from the face, not along a grazing line.
                let off = (found - exact).abs() * gradient.dot(direction).abs();
                worst = worst.max(off / size);
            }
        }
        assert!(worst < KERNEL, "{solid:?}: {worst:e} of the largest coordinate");
        assert!(worst > 0.0, "{solid:?}: the two differ somewhere");
    }
}

#[test]
fn far_spheres_keep_fourteen_digits() {
    // Seen from 10^k radii along a line that passes half a radius from the centre: the ends are at ∓√(3/4).
    for k in 1..=7 {
        let distance = libm::exp10(f64::from(k));
        let ray = Ray::new(DVec3::new(-distance, 0.5, 0.0), DVec3::X);
        let span = Primitive::Sphere.span(&ray);
        let error = (span.to - span.from - 2.0 * 0.75_f64.sqrt()).abs();
        assert!(error < 4.0 * f64::EPSILON * distance, "1e{k}: {error}");
    }
}

#[test]
fn a_cone_along_a_generator_and_through_its_apex() {
    let generator = Ray::new(DVec3::new(-1.0, -1.0, 0.5), DVec3::new(1.0, 1.0, 0.0));
    let span = Primitive::Cone.span(&generator);
    // On the line x = y, z = 1/2 the quadric is 1/4 throughout.
    assert!(span.from >= span.to, "parallel to a generator, outside: {span:?}");
    let inside = Ray::new(DVec3::new(0.5, 0.0, 0.0), DVec3::new(1.0, 1.0, 0.0));
    let span = Primitive::Cone.span(&inside);
    assert!((span.from + 0.25).abs() < 1e-15 && (span.to - 0.5).abs() < 1e-15, "{span:?}");
    let apex = Ray::new(DVec3::new(-1.0, 0.0, 0.0), DVec3::X);
    let span = Primitive::Cone.span(&apex);
    assert!((span.from - 1.0).abs() < 1e-15 && (span.to - 2.0).abs() < 1e-15, "{span:?}");
    let across = Ray::new(DVec3::new(0.0, -1.0, 0.0), DVec3::Y);
    let span = Primitive::Cone.span(&across);
    assert!(span.from >= span.to, "touches the apex only: {span:?}");
}

#[test]
fn boxes_are_the_published_ones_and_hold_the_surface() {
    // Reference page on bounds: scale (2, 1, .5), rotate (30, 40, 50), at (1, 2, 3).
    let map = Placement {
        scale: DVec3::new(2.0, 1.0, 0.5),
        rotation_degrees: DVec3::new(30.0, 40.0, 50.0),
        place: DVec3::new(1.0, 2.0, 3.0),
    }
    .map();
    for (solid, low, high) in [
        (
            Primitive::Sphere,
            [-0.147_060_77, 0.577_040_97, 1.618_175_42],
            [2.147_060_77, 3.422_959_03, 4.381_824_59],
        ),
        (
            Primitive::Cylinder,
            [0.411_865_58, 1.195_411_68, 1.207_734_01],
            [2.572_942_17, 3.978_236_5, 3.506_690_77],
        ),
        (Primitive::Cone, [1.0, 2.0, 1.207_734_01], [2.572_942_17, 3.978_236_5, 3.0]),
        (
            Primitive::Block,
            [-0.812_055_27, -0.029_040_75, 0.999_695_58],
            [2.812_055_27, 4.029_040_75, 5.000_304_41],
        ),
    ] {
        let bounds = solid.bounds(&map.linear, map.place);
        assert!(bounds.low.abs_diff_eq(DVec3::from_array(low), 6e-8), "{solid:?} {bounds:?}");
        assert!(bounds.high.abs_diff_eq(DVec3::from_array(high), 6e-8), "{solid:?} {bounds:?}");
    }
}
