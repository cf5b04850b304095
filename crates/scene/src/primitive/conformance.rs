//! What every solid holds to, over the whole table and with several sets of arguments.

use glam::{DVec2, DVec3};

use super::tests::{KERNEL, Numbers, samples};
use super::{Face, Primitive};
use crate::form::{FORMS, Form, Row};
use crate::lanes::{Eight, Four};
use crate::ray::{Bounds, FacedSpan, Ray};
use crate::transform::{Map, Placement};

/// Solids with arguments, each row with several sets of them.
fn forms() -> Vec<Form> {
    let star: Vec<f64> = (0..10)
        .flat_map(|k| {
            let radius = if k % 2 == 0 { 1.0 } else { 0.4 };
            let angle = f64::from(k) * std::f64::consts::PI / 5.0;
            [radius * libm::cos(angle), radius * libm::sin(angle)]
        })
        .collect();
    let sets: Vec<(&str, Vec<f64>)> = vec![
        ("torus", vec![0.25]),
        ("torus", vec![0.9]),
        ("torus", vec![1.0]),
        ("prism", vec![-0.9, -0.8, 1.0, -0.5, 0.2, 0.9]),
        // Clockwise, a horseshoe.
        (
            "prism",
            vec![
                -1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0, -1.0, 0.5, -1.0, 0.5, 0.5, -0.5, 0.5, -0.5,
                -1.0,
            ],
        ),
        ("prism", star),
        ("terrain", vec![1.0, 0.5, 3.0]),
        ("terrain", vec![7.0, 1.0, 2.0]),
        ("terrain", vec![0.0, 0.3, 6.0]),
    ];
    for row in FORMS {
        assert!(sets.iter().any(|(word, _)| *word == row.keyword), "{} is tried", row.keyword);
    }
    sets.iter().map(|(word, set)| Form::new(Row::named(word).unwrap(), set).unwrap()).collect()
}

/// A solid of the table as the tests ask about it.
#[derive(Clone, Debug)]
enum Subject {
    Convex(Primitive),
    Form(Form),
}

impl Subject {
    fn all() -> Vec<Self> {
        let convex = Primitive::ALL.iter().copied().map(Self::Convex);
        convex.chain(forms().into_iter().map(Self::Form)).collect()
    }

    fn spans(&self, ray: &Ray) -> Vec<FacedSpan> {
        match self {
            Self::Convex(kind) => {
                let span = kind.span(ray);
                if span.from < span.to { vec![span] } else { Vec::new() }
            }
            Self::Form(form) => {
                let (mut spans, mut t) = (Vec::new(), f64::NEG_INFINITY);
                loop {
                    let span = form.span_at(ray, t);
                    if span.from >= span.to {
                        return spans;
                    }
                    spans.push(span);
                    t = span.to;
                }
            }
        }
    }

    fn contains(&self, p: DVec3) -> bool {
        match self {
            Self::Convex(kind) => kind.contains(p.to_array()),
            Self::Form(form) => form.contains(p),
        }
    }

    fn gradient(&self, p: DVec3, face: Face) -> DVec3 {
        match self {
            Self::Convex(kind) => DVec3::from_array(kind.gradient(p.to_array(), face.number())),
            Self::Form(form) => form.gradient(p, face),
        }
    }

    fn texture_coordinates(&self, p: DVec3, face: Face) -> DVec2 {
        match self {
            Self::Convex(kind) => kind.texture_coordinates(p, face),
            Self::Form(form) => form.texture_coordinates(p, face),
        }
    }

    fn bounds(&self, map: &Map) -> Bounds {
        match self {
            Self::Convex(kind) => kind.bounds(&map.linear, map.place),
            Self::Form(form) => form.bounds(&map.linear, map.place),
        }
    }

    fn support(&self, direction: DVec3) -> DVec3 {
        match self {
            Self::Convex(kind) => kind.support(direction),
            Self::Form(form) => form.support(direction),
        }
    }

    fn distance(&self, p: DVec3) -> f64 {
        match self {
            Self::Convex(kind) => kind.distance(p, DVec3::length),
            Self::Form(form) => form.distance(p, DVec3::length),
        }
    }

    /// The ends of all spans with their faces: where the ray enters and leaves.
    fn ends(&self, ray: &Ray) -> Vec<(f64, Face)> {
        let ends = |span: &FacedSpan| [(span.from, span.entered()), (span.to, span.left())];
        self.spans(ray).iter().flat_map(ends).collect()
    }
}

/// How much rounding of an origin blurs a solid, as a length.
fn blur(origin: DVec3) -> f64 {
    1e-14 * (1.0 + origin.abs().max_element())
}

fn vector(numbers: &mut Numbers) -> DVec3 {
    DVec3::new(numbers.unit(), numbers.unit(), numbers.unit())
}

#[test]
fn spans_hold_what_the_solid_contains() {
    for subject in Subject::all() {
        let (mut inside, mut outside) = (0, 0);
        for (origin, direction) in samples() {
            let ray = Ray::new(origin, direction);
            let spans = subject.spans(&ray);
            for pair in spans.windows(2) {
                assert!(pair[0].to < pair[1].from, "{subject:?}: apart and in order: {spans:?}");
            }
            let nearest = -origin.dot(direction) / direction.length_squared();
            let step = 0.09 / direction.length();
            for i in -20..=20 {
                let t = nearest + step * f64::from(i);
                let point = ray.at(t);
                if subject.distance(point).abs() < 100.0 * blur(origin) {
                    continue;
                }
                let spanned = spans.iter().any(|span| span.from <= t && t < span.to);
                assert_eq!(spanned, subject.contains(point), "{subject:?} at {point}: {spans:?}");
                *if spanned { &mut inside } else { &mut outside } += 1;
            }
        }
        assert!(inside > 2000 && outside > 2000, "{subject:?}: {inside} {outside}");
    }
}

#[test]
fn distance_is_negative_inside_and_a_length_near_the_surface() {
    let mut numbers = Numbers::new();
    for subject in Subject::all() {
        let mut near = 0;
        for _ in 0..4000 {
            let ray = Ray::new(1.3 * vector(&mut numbers), vector(&mut numbers).normalize());
            for (t, face) in subject.ends(&ray) {
                let outward = subject.gradient(ray.at(t), face).normalize();
                for off in [-1e-7, 1e-7] {
                    let point = ray.at(t) + off * outward;
                    let distance = subject.distance(point);
                    // Beside an edge or an apex the nearest face is another one.
                    if (distance - off).abs() < 1e-9 {
                        near += 1;
                    } else {
                        assert!(distance.abs() < 3e-7, "{subject:?} {point}: {distance} {off}");
                    }
                    assert_eq!(distance < 0.0, subject.contains(point), "{subject:?} {point}");
                }
            }
        }
        assert!(near > 500, "{subject:?}: {near}");
    }
}

#[test]
fn normals_are_those_of_three_points_of_the_surface() {
    let mut numbers = Numbers::new();
    for subject in Subject::all() {
        let mut compared = 0;
        for _ in 0..4000 {
            let origin = 3.0 * vector(&mut numbers);
            let direction = (0.9 * vector(&mut numbers) - origin).normalize();
            let (right, up) = direction.any_orthonormal_pair();
            let beside = |offset: DVec3| {
                let ray = Ray::new(origin + 1e-6 * offset, direction);
                let ends = subject.ends(&ray);
                ends.into_iter().map(move |(t, face)| (ray.at(t), face)).collect::<Vec<_>>()
            };
            let sides = [beside(right), beside(-right), beside(up), beside(-up)];
            let middle = Ray::new(origin, direction);
            for (k, &(t, face)) in subject.ends(&middle).iter().enumerate() {
                let normal = subject.gradient(middle.at(t), face).normalize();
                let ends: Vec<_> = sides
                    .iter()
                    .filter_map(|ends| ends.get(k))
                    .filter(|end| end.1 == face)
                    .collect();
                let [a, b, c, d] = ends[..] else { continue };
                if normal.dot(direction).abs() < 0.1 {
                    continue;
                }
                let found = (a.0 - b.0).cross(c.0 - d.0).normalize();
                let found = if found.dot(normal) < 0.0 { -found } else { found };
                assert!(found.distance(normal) < 1e-4, "{subject:?} {face:?}: {found} {normal}");
                let outward = if k % 2 == 0 { -1.0 } else { 1.0 };
                assert!(outward * normal.dot(direction) > 0.0, "{subject:?} {face:?}: outward");
                compared += 1;
            }
        }
        assert!(compared > 1000, "{subject:?}: {compared}");
    }
}

#[test]
fn boxes_hold_the_surface_and_are_tight() {
    let mut numbers = Numbers::new();
    for subject in Subject::all() {
        for _ in 0..20 {
            let map = Placement {
                scale: DVec3::ONE + 0.9 * vector(&mut numbers),
                rotation_degrees: 180.0 * vector(&mut numbers),
                place: 5.0 * vector(&mut numbers),
            }
            .map();
            let bounds = subject.bounds(&map);
            let mut seen = Bounds::EMPTY;
            for _ in 0..100 {
                let ray = Ray::new(2.0 * vector(&mut numbers), vector(&mut numbers));
                for (t, _) in subject.ends(&ray) {
                    let point = map.outward(ray.at(t));
                    assert!(bounds.nears(point, 1e-13), "{subject:?}: {point} in {bounds:?}");
                    seen = seen.hull(Bounds { low: point, high: point });
                }
            }
            assert!(!seen.is_empty(), "{subject:?} is met");
            for axis in DVec3::AXES {
                for outer in [axis, -axis] {
                    let local = map.linear.transpose() * outer;
                    let point = subject.support(local);
                    let reach = outer.dot(map.outward(point));
                    let side = if outer == axis { bounds.high } else { -bounds.low };
                    assert!(
                        (side.dot(axis) - reach).abs() < 1e-13,
                        "{subject:?}: {reach} on {side} along {outer}"
                    );
                    assert!(
                        subject.distance(point).abs() < 1e-15,
                        "{subject:?}: the farthest point {point} is of the solid"
                    );
                }
            }
        }
    }
}

#[test]
fn seventeen_decades_of_size_change_nothing() {
    for subject in Subject::all() {
        let mut compared = 0;
        for (origin, direction) in samples().take(700) {
            let direction = direction.normalize_or(DVec3::X);
            let plain = subject.spans(&Ray::new(origin, direction));
            for decade in -8..=8 {
                let unit = libm::exp10(f64::from(decade));
                let scale = DVec3::splat(unit);
                let map = Placement { scale, ..Placement::default() }.map();
                let found = subject.spans(&map.ray_inward(&Ray::new(unit * origin, direction)));
                let size = 1.0 + origin.abs().max_element();
                // The number of spans is the same but for grazing ones.
                let wide = |spans: &[FacedSpan], unit: f64| {
                    let least = 1e-5 * size.sqrt() * unit;
                    spans.iter().filter(|span| span.to - span.from > least).count()
                };
                if wide(&plain, 1.0) != plain.len() || plain.len() != found.len() {
                    assert!(wide(&plain, 2.0) <= found.len(), "{subject:?} 1e{decade}: {origin}");
                    continue;
                }
                for (a, b) in plain.iter().zip(&found) {
                    let ends = [(a.from, b.from, a.entered()), (a.to, b.to, a.left())];
                    for (expected, t, face) in ends {
                        let normal = subject.gradient(origin + expected * direction, face);
                        let off =
                            (t / unit - expected).abs() * normal.normalize().dot(direction).abs();
                        assert!(
                            off < 4.0 * KERNEL * size,
                            "{subject:?} 1e{decade}: {off:e} from {origin} along {direction}"
                        );
                        compared += 1;
                    }
                }
            }
        }
        assert!(compared > 2000, "{subject:?}: {compared}");
    }
}

#[test]
fn grazing_and_tangent_rays_do_no_harm() {
    let mut numbers = Numbers::new();
    for subject in Subject::all() {
        let mut tangents = 0;
        for _ in 0..300 {
            let aim = Ray::new(2.0 * vector(&mut numbers), vector(&mut numbers));
            for (t, face) in subject.ends(&aim) {
                let point = aim.at(t);
                let normal = subject.gradient(point, face).normalize();
                let tangent = normal.cross(vector(&mut numbers)).normalize();
                for k in 0..34 {
                    let tilt = libm::exp10(-0.5 * f64::from(k)) * f64::from(1 - 2 * (k & 1));
                    for back in [0.0, 3.0, 1e4] {
                        let direction = (tangent + tilt * normal).normalize();
                        let origin = point - back * direction;
                        let ray = Ray::new(origin, direction);
                        let slack = 100.0 * blur(origin);
                        for span in subject.spans(&ray) {
                            assert!(span.from < span.to, "{subject:?}: {span:?} at {point}");
                            let ends = span.from.is_finite() && span.to.is_finite();
                            assert!(ends, "{subject:?}: {span:?} at {point} along {direction}");
                            let middle = ray.at(0.5 * (span.from + span.to));
                            let distance = subject.distance(middle);
                            assert!(distance < slack, "{subject:?}: {distance} {span:?} {tilt}");
                            tangents += 1;
                        }
                    }
                }
            }
        }
        assert!(tangents > 5000, "{subject:?}: {tangents}");
    }
}

#[test]
fn a_ray_that_starts_inside_is_in_one_span() {
    let mut numbers = Numbers::new();
    for subject in Subject::all() {
        let (mut inside, mut outside) = (0, 0);
        for _ in 0..40_000 {
            let origin = 1.2 * vector(&mut numbers);
            if subject.distance(origin).abs() < 1e-12 {
                continue;
            }
            let spans = subject.spans(&Ray::new(origin, vector(&mut numbers)));
            let around = spans.iter().filter(|span| span.from < 0.0 && 0.0 < span.to).count();
            assert_eq!(around, usize::from(subject.contains(origin)), "{subject:?} {origin}");
            *if around == 1 { &mut inside } else { &mut outside } += 1;
        }
        assert!(inside > 400 && outside > 400, "{subject:?}: {inside} {outside}");
    }
}

#[test]
fn lanes_of_other_solids_do_no_harm() {
    let mut numbers = Numbers::new();
    for form in forms() {
        for face in [0.0, 1.0, 5.0, 77.0, 4e9, f64::NAN, f64::INFINITY, -1.0] {
            for point in [vector(&mut numbers), DVec3::INFINITY, DVec3::NAN, 1e300 * DVec3::ONE] {
                let lanes = point.to_array().map(|x| Four::new([0.1, x, 0.2, x]));
                let _ = form.gradient_lanes(lanes, Four::new([0.0, face, face, 0.0]));
                let _ = form.contains_lanes(lanes);
                let ray = Ray { origin: lanes, direction: [lanes[2], lanes[0], lanes[1]] };
                let span = form.span_at(&ray, Four::new([face; 4]));
                let alone = |lane: usize| {
                    let pick = |v: [Four; 3]| v.map(|x| x.to_array()[lane]);
                    let ray = Ray { origin: pick(ray.origin), direction: pick(ray.direction) };
                    form.span_at(&ray, face).from.to_bits()
                };
                let found = span.from.to_array().map(f64::to_bits);
                assert_eq!(found, [0, 1, 2, 3].map(alone), "{form:?} {face} {point}");
            }
        }
    }
}

#[test]
fn texture_coordinates_are_shares() {
    let mut numbers = Numbers::new();
    for subject in Subject::all() {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for _ in 0..20_000 {
            let ray = Ray::new(2.0 * vector(&mut numbers), vector(&mut numbers));
            for (t, face) in subject.ends(&ray) {
                let uv = subject.texture_coordinates(ray.at(t), face);
                (low, high) = (low.min(uv), high.max(uv));
            }
        }
        let slack = 1e-14;
        assert!(low.cmpge(DVec2::splat(-slack)).all(), "{subject:?}: {low}");
        assert!(high.cmple(DVec2::splat(1.0 + slack)).all(), "{subject:?}: {high}");
        // They are used from end to end.
        assert!(low.cmplt(DVec2::splat(0.05)).all(), "{subject:?}: {low}");
        assert!(high.cmpgt(DVec2::splat(0.95)).all(), "{subject:?}: {high}");
    }
}

/// A test that every primitive has the same bits in lanes as alone.
macro_rules! lanes_have_the_bits_of_one {
    ($name:ident $lanes:ident) => {
        #[test]
        fn $name() {
            for &kind in Primitive::ALL {
                let rays: Vec<Ray> = samples().map(|(origin, d)| Ray::new(origin, d)).collect();
                for several in rays.chunks_exact($lanes::LANES) {
                    let lanes = |pick: fn(&Ray) -> [f64; 3]| -> [$lanes; 3] {
                        let lane = |k: usize| std::array::from_fn(|lane| pick(&several[lane])[k]);
                        std::array::from_fn(|k| $lanes::new(lane(k)))
                    };
                    let (origin, direction) = (lanes(|ray| ray.origin), lanes(|ray| ray.direction));
                    let together = kind.span(&Ray { origin, direction });
                    let contains = kind.contains(origin).bits();
                    let gradient = kind.gradient(origin, together.from_face);
                    for (lane, ray) in several.iter().enumerate() {
                        let alone = kind.span(ray);
                        let found =
                            [together.from, together.to, together.from_face, together.to_face]
                                .map(|lanes| lanes.to_array()[lane].to_bits());
                        let expected = [alone.from, alone.to, alone.from_face, alone.to_face];
                        assert_eq!(found, expected.map(f64::to_bits), "{kind:?} {ray:?}");
                        assert_eq!(
                            contains >> lane & 1 == 1,
                            kind.contains(ray.origin),
                            "{kind:?}"
                        );
                        let slope = kind.gradient(ray.origin, alone.from_face).map(f64::to_bits);
                        let found = gradient.map(|along| along.to_array()[lane].to_bits());
                        assert_eq!(found, slope, "{kind:?} {ray:?}");
                    }
                }
            }
        }
    };
}

lanes_have_the_bits_of_one! { four_lanes_have_the_bits_of_one Four }
lanes_have_the_bits_of_one! { eight_lanes_have_the_bits_of_one Eight }
