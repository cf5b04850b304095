//! Values worked out by hand.

use glam::{DVec2, DVec3};

use super::{Arguments, FORMS, Form, FormError, Row};
use crate::primitive::{Face, Primitive};
use crate::ray::{FacedSpan, Ray};
use crate::transform::Map;

fn form(word: &str, arguments: &[f64]) -> Form {
    Form::new(Row::named(word).unwrap(), arguments).unwrap()
}

fn spans(form: &Form, origin: [f64; 3], direction: [f64; 3]) -> Vec<FacedSpan> {
    let (ray, mut t) = (Ray { origin, direction }, f64::NEG_INFINITY);
    let next = || {
        let span = form.span_at(&ray, t);
        t = span.to;
        (span.from < span.to).then_some(span)
    };
    std::iter::from_fn(next).collect()
}

fn near(spans: &[FacedSpan], expected: &[[f64; 2]]) {
    assert_eq!(spans.len(), expected.len(), "{spans:?} {expected:?}");
    for (span, [from, to]) in spans.iter().zip(expected) {
        assert!((span.from - from).abs() < 1e-14, "{span:?} {from}");
        assert!((span.to - to).abs() < 1e-14, "{span:?} {to}");
    }
}

#[test]
fn rows_are_words_of_their_own_and_files() {
    for row in FORMS {
        assert!(Primitive::named(row.keyword).is_none(), "{}", row.keyword);
        let file = format!("{}/src/form/{}.rs", env!("CARGO_MANIFEST_DIR"), row.keyword);
        assert!(std::path::Path::new(&file).exists(), "{file}");
        if let Some(defaults) = row.defaults() {
            assert!(Form::new(row, &defaults).is_ok(), "{} by default", row.keyword);
        }
        if let Arguments::Numbers(parameters) = row.arguments {
            let error = Form::new(row, &[]).unwrap_err();
            assert_eq!(error.found, "0", "{}: {error}", row.keyword);
            assert!(parameters.len() < 4, "{}: a few", row.keyword);
        }
    }
}

#[test]
fn a_torus_along_its_axes() {
    let ring = form("torus", &[0.25]);
    near(&spans(&ring, [0.0, -3.0, 0.0], [0.0, 1.0, 0.0]), &[[1.75, 2.25], [3.75, 4.25]]);
    near(&spans(&ring, [0.0, 3.0, 0.0], [0.0, -2.0, 0.0]), &[[0.875, 1.125], [1.875, 2.125]]);
    near(&spans(&ring, [-1.0, 1.0, 0.0], [1.0, 0.0, 0.0]), &[[0.75, 1.25]]);
    near(&spans(&ring, [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]), &[]);
    // 3-4-5: at x = 0.15 the tube is 0.2 wide to either side.
    near(&spans(&ring, [0.15, 0.0, -2.0], [0.0, 0.0, 1.0]), &[[0.8, 1.2], [2.8, 3.2]]);
    // Along a tangent of the inner equator: f = (√(0.75² + u²) − 1)² − 1/16 vanishes at u = 0 and where ρ = 1.25.
    near(&spans(&ring, [0.0, 0.75, -2.0], [0.0, 0.0, 1.0]), &[[1.0, 3.0]]);
    // Just inside of it there are two spans.
    assert_eq!(spans(&ring, [0.0, 0.74, -2.0], [0.0, 0.0, 1.0]).len(), 2, "a bay");
    // A tangent of the outer equator.
    assert!(spans(&ring, [0.0, 1.25, -2.0], [0.0, 0.0, 1.0]).is_empty(), "it only touches");
    // With a tube of 1 the hole is a point.
    let full = form("torus", &[1.0]);
    near(&spans(&full, [0.0, -3.0, 0.0], [0.0, 1.0, 0.0]), &[[1.0, 5.0]]);
}

#[test]
fn thin_rings_are_met_and_missed_where_they_are() {
    for decade in 1..=6 {
        let tube = libm::exp10(f64::from(-decade));
        let ring = form("torus", &[tube]);
        for turn in 0..97 {
            let angle = f64::from(turn) * 0.37;
            let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
            let middle = DVec3::new(0.0, cosine, sine);
            let (outward, along) = (middle, DVec3::new(0.0, -sine, cosine));
            // Across the tube at a slant, beside its middle by a share of its radius.
            for share in [0.0, 0.3, 0.999, 0.999_999, 1.000_001, 1.001] {
                for distance in [1e-3, 1.0, 100.0] {
                    let beside = middle + share * tube * outward;
                    let direction = (DVec3::X + 0.2 * f64::from(turn % 5) * along).normalize();
                    let origin = beside - distance * direction;
                    let ray = Ray::new(origin, direction);
                    let span = ring.span_about(&ray, distance);
                    // Far along the slant the ring bends away by less than the square of the way.
                    let hit = span.from < span.to && (span.from - distance).abs() < 20.0 * tube;
                    let blur = 4.0 * f64::EPSILON * (1.0 + distance);
                    let slack = blur + 4.0 * tube * tube;
                    if share < 1.0 && (1.0 - share) * tube > slack {
                        assert!(hit, "{tube} {share} {distance} {turn}: {span:?}");
                    }
                    if share > 1.0 && turn % 5 == 0 && (share - 1.0) * tube > slack {
                        assert!(!hit, "{tube} {share} {distance} {turn}: {span:?}");
                    }
                    for t in [span.from, span.to].into_iter().filter(|_| hit) {
                        let off = ring.distance(ray.at(t), DVec3::length);
                        assert!(off.abs() < 2.0 * blur, "{tube} {share} {distance}: {off:e}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_prism_with_a_bay() {
    // Seen from the left: a wall, a bay, a wall.
    let bay = [0.0, 0.0, 3.0, 0.0, 3.0, 2.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0, 1.0, 2.0, 0.0, 2.0];
    let mut backward = bay;
    backward.reverse();
    backward.chunks_exact_mut(2).for_each(|pair| pair.swap(0, 1));
    for outline in [bay, backward] {
        let prism = form("prism", &outline);
        near(&spans(&prism, [-1.0, 1.5, 0.5], [1.0, 0.0, 0.0]), &[[1.0, 2.0], [3.0, 4.0]]);
        near(&spans(&prism, [-1.0, 0.5, 0.5], [1.0, 0.0, 0.0]), &[[1.0, 4.0]]);
        near(&spans(&prism, [0.5, 1.5, -1.0], [0.0, 0.0, 2.0]), &[[0.5, 1.0]]);
        near(&spans(&prism, [1.5, 1.5, -1.0], [0.0, 0.0, 2.0]), &[]);
        near(&spans(&prism, [-1.0, 1.5, 1.5], [1.0, 0.0, 0.0]), &[]);
        // Through two corners of the bay: a line in a face is on one side of it.
        let along = spans(&prism, [-1.0, 1.0, 0.5], [1.0, 0.0, 0.0]);
        assert!(along.len() < 3, "{along:?}");
        assert!(prism.contains(DVec3::new(0.5, 1.9, 0.9)), "in the left wall");
        assert!(!prism.contains(DVec3::new(1.5, 1.9, 0.9)), "in the bay");
        let [span, _] = spans(&prism, [-1.0, 1.5, 0.5], [1.0, 0.0, 0.0])[..] else { panic!("two") };
        let (left, right) = (span.entered(), span.left());
        let normal = |face: Face| prism.gradient(DVec3::ZERO, face).normalize();
        assert_eq!(normal(left), DVec3::NEG_X, "outward");
        assert_eq!(normal(right), DVec3::X, "outward, into the bay");
        // The outline is 3 + 2 + 1 + 1 + 1 + 1 + 1 + 2 = 12 long; either way around its last edge is 2.
        let uv = prism.texture_coordinates(DVec3::new(0.0, 1.0, 0.25), left);
        assert!(uv.abs_diff_eq(DVec2::new(11.0 / 12.0, 0.25), 1e-15), "{uv}");
        let bounds = prism.bounds(&Map::IDENTITY.linear, DVec3::ZERO);
        assert_eq!((bounds.low, bounds.high), (DVec3::ZERO, DVec3::new(3.0, 2.0, 1.0)));
    }
}

#[test]
fn outlines_that_meet_themselves_are_refused() {
    let refused = |outline: &[f64]| -> FormError {
        Form::new(Row::named("prism").unwrap(), outline).expect_err("no polygon")
    };
    for (outline, point) in [
        (&[0.0, 0.0, 1.0, 0.0][..], 2),
        (&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 5.0][..], 3),
        // A bow.
        (&[0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0][..], 2),
        // All on a line.
        (&[0.0, 0.0, 1.0, 1.0, 2.0, 2.0][..], 2),
        // A corner on an edge.
        (&[0.0, 0.0, 2.0, 0.0, 2.0, 2.0, 1.0, 0.0, 0.0, 2.0][..], 2),
        // A point twice.
        (&[0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0][..], 2),
    ] {
        let error = refused(outline);
        assert_eq!(error.argument / 2, point, "{outline:?}: {error}");
    }
    let circle: Vec<f64> = (0..4002)
        .map(|k| {
            let angle = f64::from(k / 2) * std::f64::consts::TAU / 2001.0;
            if k % 2 == 0 { libm::cos(angle) } else { libm::sin(angle) }
        })
        .collect();
    assert_eq!(refused(&circle).found, "2001", "points");
    assert!(Form::new(Row::named("prism").unwrap(), &circle[..4000]).is_ok(), "2000 are not");
}

#[test]
fn terrain_reaches_from_zero_to_one_and_is_closed() {
    for (seed, roughness, detail) in [(1.0, 0.5, 1_u32), (2.0, 1.0, 4), (3.0, 0.1, 7)] {
        let ground = form("terrain", &[seed, roughness, f64::from(detail)]);
        let top = ground.support(DVec3::Y);
        assert!((top.y - 1.0).abs() < 1e-15, "{top}");
        let cells = 1 << detail;
        let mut least = f64::INFINITY;
        // Straight down through every corner, and beside it: one span from the floor up.
        for k in 0..=2 * cells {
            for l in 0..=2 * cells {
                let at = |k: u32| f64::from(k) / f64::from(cells) - 1.0;
                let found = spans(&ground, [at(k), 3.0, at(l)], [0.0, -1.0, 0.0]);
                let [span] = found[..] else { panic!("{found:?} at {k} {l}") };
                assert!((span.to - 4.0).abs() < 1e-15, "to the floor");
                let height = 3.0 - span.from;
                assert!((0.0..=1.0).contains(&height), "{height}");
                least = least.min(height);
                let point = |y: f64| DVec3::new(at(k), y, at(l));
                assert!(ground.contains(point(height - 1e-9)), "below the ground");
                assert!(!ground.contains(point(height + 1e-9)), "above it");
            }
        }
        assert!(least < 1e-7, "the lowest point: {least}");
        // From below it is all floor.
        let below = spans(&ground, [0.3, -9.0, 0.2], [0.01, 1.0, 0.02]);
        assert_eq!(below[0].entered(), Face(2), "the floor");
    }
    let heights = |seed: f64| {
        let ground = form("terrain", &[seed, 0.5, 5.0]);
        spans(&ground, [0.3, 3.0, 0.2], [0.0, -1.0, 0.0])[0].from.to_bits()
    };
    assert_eq!(heights(4.0), heights(4.0), "the same seed");
    assert_ne!(heights(4.0), heights(5.0), "another seed");
}
