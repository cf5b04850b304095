//! The oracle against values worked out by hand.

use glam::DVec3;
use scene::{Attributes, LightKind, Placement, Primitive, Rgb, Scene};

use super::author::{Author, Shape, Site, block, clear, opaque, sphere, stands, upright};
use super::body::{Body, Kind};
use super::dd::{Dd, Vec3, dot, sin_cos_degrees, vector};
use super::finish::Finish;
use super::line::{Ray, crossing};
use super::place::Affine;
use super::trace::{Limits, Oracle};

const LIMITS: Limits = Limits { depth: 15, min_weight: 1.0 / 256.0 };
const RED: [f64; 3] = [0.9, 0.1, 0.1];
const BLUE: [f64; 3] = [0.1, 0.1, 0.9];

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

fn same(a: [f64; 3], b: [f64; 3]) -> bool {
    a.into_iter().zip(b).all(|(a, b)| near(a, b))
}

#[test]
fn double_doubles_hold_thirty_digits() {
    let third = Dd::ONE / Dd::from(3.0);
    assert!((third * Dd::from(3.0) - Dd::ONE).value().abs() < 1e-31, "quotient");
    let root = Dd::from(2.0).sqrt();
    assert!((root * root - Dd::from(2.0)).value().abs() < 1e-31, "root");
    // 1 + 2⁻¹⁰⁰ needs both halves.
    let tiny = f64::from_bits((1023 - 100) << 52);
    let sum = Dd::ONE + Dd::from(tiny);
    assert!((sum - Dd::ONE).value() >= tiny, "sum");
    assert!((sum * sum - Dd::ONE).value() > 1.9 * tiny, "product");
}

#[test]
fn angles_are_exact_at_quarters_and_good_elsewhere() {
    for (angle, s, c) in [(0.0, 0.0, 1.0), (90.0, 1.0, 0.0), (-90.0, -1.0, 0.0), (540.0, 0.0, -1.0)]
    {
        assert_eq!(sin_cos_degrees(angle), (Dd::from(s), Dd::from(c)), "{angle}");
    }
    let (s, c) = sin_cos_degrees(-210.0);
    assert!((s - Dd::from(0.5)).value().abs() < 1e-30, "sine of -210°");
    assert!((c * c - Dd::from(0.75)).value().abs() < 1e-30, "cosine of -210°");
}

fn body(kind: Primitive, placement: &Placement) -> Body {
    Body {
        kind: Kind::Convex(kind),
        map: Affine::new(placement),
        magnitude: 0.0,
        color: [1.0; 3],
        shininess: 0.0,
        finish: Finish::PLAIN,
        clear: None,
        priority: 0,
    }
}

/// Ends of the span and the normals there, as numbers.
fn ends(body: &Body, origin: [f64; 3], direction: [f64; 3]) -> Option<[(f64, [f64; 3]); 2]> {
    let vector = |v: [f64; 3]| -> Vec3 { v.map(Dd::from) };
    let span = *body.spans(&vector(origin), &vector(direction)).first()?;
    Some(span.map(|end| (end.t.value(), end.outward.map(Dd::value))))
}

#[test]
fn spans_by_hand() {
    let along_x = [1.0, 0.0, 0.0];
    for (kind, origin, direction, expected) in [
        (Primitive::Block, [-3.0, 0.5, 0.0], along_x, Some((2.0, 4.0))),
        (Primitive::Block, [-3.0, 1.5, 0.0], along_x, None),
        (Primitive::Block, [0.0, 0.0, 9.0], [0.0, 0.0, -2.0], Some((4.0, 5.0))),
        // 3-4-5.
        (Primitive::Sphere, [-3.0, 0.6, 0.0], along_x, Some((2.2, 3.8))),
        (Primitive::Sphere, [-3.0, 1.0, 0.0], along_x, None),
        (Primitive::Cylinder, [-3.0, 0.6, 0.0], along_x, Some((3.0, 4.0))),
        (Primitive::Cylinder, [0.5, -3.0, 0.6], [0.0, 1.0, 0.0], Some((2.2, 3.8))),
        // Lengthwise: in through the side at x = 0.6, out through the base.
        (Primitive::Cone, [-3.0, 0.6, 0.0], along_x, Some((3.6, 4.0))),
        (Primitive::Cone, [3.0, 0.6, 0.0], [-1.0, 0.0, 0.0], Some((2.0, 2.4))),
        // Across, at half the height.
        (Primitive::Cone, [0.5, -3.0, 0.0], [0.0, 1.0, 0.0], Some((2.5, 3.5))),
        // Parallel to a generator.
        (Primitive::Cone, [0.5, 0.0, 0.0], [1.0, 1.0, 0.0], Some((-0.25, 0.5))),
        // In through the side at x = 0.36, out through the base; and across.
        (Primitive::Paraboloid, [-3.0, 0.6, 0.0], along_x, Some((3.36, 4.0))),
        (Primitive::Paraboloid, [0.36, -3.0, 0.0], [0.0, 1.0, 0.0], Some((2.4, 3.6))),
        // The other nappe does not exist.
        (Primitive::Cone, [-0.5, -3.0, 0.0], [0.0, 1.0, 0.0], None),
    ] {
        let found = ends(&body(kind, &Placement::default()), origin, direction);
        let found = found.map(|[from, to]| (from.0, to.0));
        let alike = match (found, expected) {
            (Some(a), Some(b)) => near(a.0, b.0) && near(a.1, b.1),
            (None, None) => true,
            _ => false,
        };
        assert!(alike, "{kind:?} from {origin:?} along {direction:?}: {found:?}");
    }
}

#[test]
fn normals_by_hand() {
    // An ellipsoid with half axes 2, 1, 1 turned by 90° about z: 2 along y. At (0.6, 1.6, 0) the gradient is
    // (x, y / 4, 0) = (0.6, 0.4, 0).
    let turned = Placement {
        scale: DVec3::new(2.0, 1.0, 1.0),
        rotation_degrees: DVec3::new(0.0, 0.0, 90.0),
        place: DVec3::ZERO,
    };
    let [_, (t, n)] = ends(&body(Primitive::Sphere, &turned), [0.0, 1.6, 0.0], [1.0, 0.0, 0.0])
        .expect("through the ellipsoid");
    let length = 0.52_f64.sqrt();
    assert!(near(t, 0.6) && near(n[0], 0.6 / length) && near(n[1], 0.4 / length), "{t} {n:?}");
    // The side of the cone is at 45°, and mirrors turn no normal inside out.
    let mirrored = Placement { scale: DVec3::new(-1.0, 1.0, 1.0), ..Placement::default() };
    let [(_, side), (_, base)] =
        ends(&body(Primitive::Cone, &mirrored), [3.0, 0.6, 0.0], [-1.0, 0.0, 0.0])
            .expect("along the mirrored cone");
    let half = 0.5_f64.sqrt();
    assert!(near(side[0], half) && near(side[1], half), "side {side:?}");
    assert!(near(base[0], -1.0) && near(base[1], 0.0), "base {base:?}");
}

/// A scene seen along −z from (0, 0, 10), with white light from everywhere and nothing else.
fn seen_along_z(shapes: &[Shape]) -> Scene {
    let mut author = Author::new(Site::UNIT, DVec3::new(0.0, 0.0, 10.0), DVec3::ZERO);
    shapes.iter().for_each(|shape| author.object(shape));
    let mut scene = author.finish();
    scene.ambient = Rgb::ONE;
    scene.background = Rgb::ZERO;
    scene
}

/// Where the ray along −z from (x, y, 10) first changes media, and the colour of the surface's owner.
fn first(scene: &Scene, x: f64, y: f64) -> Option<(f64, [f64; 3])> {
    let oracle = Oracle::new(scene, (1, 1), LIMITS);
    let origin = vector(DVec3::new(x, y, 0.0));
    let ray = Ray { origin, direction: vector(DVec3::NEG_Z), on: Vec::new() };
    let at = crossing(&oracle.solids, &ray, None)?;
    Some((at.t.value(), oracle.solids.bodies[at.owner].color))
}

#[test]
fn operators_and_owners_by_hand() {
    let (red, blue) = (opaque(RED), opaque(BLUE));
    let cube = |look: &Attributes| block([-1.0; 3], [1.0; 3], look);
    let right = |look: &Attributes| block([0.0, -1.0, -1.0], [1.0; 3], look);
    for (name, shape, x, expected) in [
        ("equal solids: the first shows", cube(&blue).plus(cube(&red)), 0.5, Some((9.0, BLUE))),
        ("a solid less itself is nothing", cube(&red).minus(cube(&blue)), 0.5, None),
        (
            "the cut is coloured as the cutter",
            cube(&red).minus(block([-2.0, -2.0, 0.5], [2.0; 3], &blue)),
            0.5,
            Some((9.5, BLUE)),
        ),
        ("a cutter flush with a face", cube(&red).minus(right(&blue)), 0.5, None),
        ("beside that cutter", cube(&red).minus(right(&blue)), -0.5, Some((9.0, RED))),
        (
            "abutting solids share nothing",
            Shape::Intersection(vec![cube(&red), block([-1.0, -1.0, 1.0], [1.0, 1.0, 2.0], &blue)]),
            0.5,
            None,
        ),
        (
            "of factors with one face, the first",
            Shape::Intersection(vec![right(&blue), cube(&red)]),
            0.5,
            Some((9.0, BLUE)),
        ),
        (
            "what was taken away and put back",
            cube(&red).minus(cube(&blue)).plus(cube(&blue)),
            0.5,
            Some((9.0, BLUE)),
        ),
    ] {
        let found = first(&seen_along_z(&[shape]), x, 0.25);
        let alike = match (found, expected) {
            (Some(a), Some(b)) => near(a.0, b.0) && same(a.1, b.1),
            (None, None) => true,
            _ => false,
        };
        assert!(alike, "{name}: {found:?}");
    }
}

#[test]
fn opaque_beats_clear_and_priority_the_source() {
    let glass = |color| clear(color, 1.0, Some(1.5));
    let urgent = Attributes { priority: Some(1), ..glass(BLUE) };
    for (name, first_look, second_look, expected) in [
        ("opaque last", glass(RED), opaque(BLUE), BLUE),
        ("clear both", glass(RED), glass(BLUE), RED),
        ("priority", glass(RED), urgent, BLUE),
        ("fake first", clear(RED, 1.0, None), glass(BLUE), BLUE),
    ] {
        let objects =
            [block([-1.0; 3], [1.0; 3], &first_look), block([-1.0; 3], [1.0; 3], &second_look)];
        let found = first(&seen_along_z(&objects), 0.5, 0.25);
        assert!(found.is_some_and(|at| same(at.1, expected)), "{name}: {found:?}");
    }
}

/// The colour at the centre of the picture.
fn center(scene: &Scene) -> [f64; 3] {
    Oracle::new(scene, (1, 1), LIMITS).pixel(0, 0)
}

#[test]
fn light_on_a_matte_face_by_hand() {
    let mut scene = seen_along_z(&[block([-1.0; 3], [1.0; 3], &opaque([0.5; 3]))]);
    scene.ambient = Rgb::splat(0.25);
    let spot = |degrees: f64| {
        let at = DVec3::new(3.0, 0.0, 4.0);
        // The axis is turned by 30°: cos² is ¾.
        let turned = DVec3::new(-(0.75_f64.sqrt() - 0.5), 0.0, -(0.75_f64.sqrt() + 0.5));
        LightKind::Spot { at, toward: at + turned, concentration: 2.0, half_angle_degrees: degrees }
    };
    let slanted = 0.5_f64.sqrt();
    let beam = LightKind::Beam { at: DVec3::new(1.0, 0.0, 1.0), toward: DVec3::ZERO };
    let point = LightKind::Point { at: DVec3::new(3.0, 0.0, 4.0) };
    for (name, kind, expected) in [
        ("point", point, slanted),
        ("beam", beam, slanted),
        ("spot", spot(31.0), 0.75 * slanted),
        ("outside the spot", spot(29.0), 0.0),
        ("from behind", LightKind::Point { at: DVec3::new(0.0, 0.0, -5.0) }, 0.0),
    ] {
        let light = scene::Light { kind, color: Rgb::ONE, shadows: true, radius: 0.0 };
        scene.lights = vec![light];
        let found = center(&scene)[0];
        assert!((found - 0.5 * (0.25 + expected)).abs() < 1e-9, "{name}: {found}");
    }
}

#[test]
fn shadows_by_hand() {
    // Light from straight above the eye's point on the floor, through a pane 0.5 thick.
    let shadowed = |pane: Attributes| {
        let mut author = Author::new(Site::UNIT, DVec3::new(0.0, 3.0, 10.0), DVec3::ZERO);
        author.object(&block([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0], &opaque([1.0; 3])));
        author.object(&block([-1.0, 4.0, -1.0], [1.0, 4.5, 1.0], &pane));
        author.light(LightKind::Point { at: DVec3::new(0.0, 9.0, 0.0) }, Rgb::ONE);
        let mut scene = author.finish();
        scene.ambient = Rgb::ZERO;
        center(&scene)
    };
    assert!(same(shadowed(opaque([1.0; 3])), [0.0; 3]), "opaque");
    // Twice 4 % lost at n = 1.5; half of the half-distance for white, 9 halves for black.
    let glass = shadowed(clear([1.0, 1.0, 0.0], 1.0, Some(1.5)));
    let surfaces = 0.96 * 0.96;
    assert!((glass[0] - surfaces * 0.5_f64.sqrt()).abs() < 1e-9, "white channel {glass:?}");
    assert!((glass[2] - surfaces * 0.5_f64.sqrt() / 16.0).abs() < 1e-9, "black channel {glass:?}");
    let fake = shadowed(clear([1.0; 3], 0.5, None));
    assert!((fake[0] - 0.5).abs() < 1e-9, "fake has no surface losses: {fake:?}");
}

#[test]
fn a_pane_before_a_wall_by_hand() {
    // Head on: R = 4 % at either face, and what goes to and fro between them: T² / (1 − R²) of the wall with
    // absorption a in the pane, T² a / (1 − R² a²); the rest sees the black background.
    let pane = |index, half_distance: f64| {
        let look = clear([1.0; 3], half_distance, index);
        let wall = block([-9.0, -9.0, -4.0], [9.0, 9.0, -3.0], &opaque([0.5; 3]));
        let mut scene = seen_along_z(&[block([-9.0, -9.0, -1.0], [9.0, 9.0, 1.0], &look), wall]);
        scene.ambient = Rgb::ONE;
        center(&scene)[0]
    };
    let limits = 1.0 / 256.0;
    let (r, a) = (0.04, 0.5);
    let through = 0.96 * 0.96 * a / (1.0 - r * r * a * a);
    assert!(
        (pane(Some(1.5), 2.0) - 0.5 * through).abs() < 2.0 * limits,
        "{}",
        pane(Some(1.5), 2.0)
    );
    assert!(near(pane(Some(1.0), 2.0), 0.25), "no index, no reflection");
    assert!(near(pane(None, 1.0), 0.125), "fake absorbs");
}

#[test]
fn refraction_and_total_reflection_by_hand() {
    // From inside a block of n = 1.5 toward its face at 30° and at 60°: sin 48.590° = 0.75, and none gets out.
    let mut author = Author::new(Site::UNIT, DVec3::ZERO, DVec3::new(0.5, 0.0, -0.75_f64.sqrt()));
    author.object(&block([-100.0, -100.0, -1.0], [100.0; 3], &clear([1.0; 3], 1e9, Some(1.5))));
    author.object(&block([-50.0, -50.0, -9.0], [50.0, 50.0, -2.0], &opaque([1.0; 3])));
    // The spot on the wall that the bent ray meets: tan 30° + tan 48.590°.
    let x = (1.0_f64 / 3.0).sqrt() + 0.75 / (1.0 - 0.5625_f64).sqrt();
    author.object(&sphere([x, 0.0, -2.0], 1e-3, &opaque([1.0, 0.0, 0.0])));
    let mut scene = author.finish();
    scene.ambient = Rgb::ONE;
    scene.background = Rgb::ZERO;
    let bent = center(&scene);
    // Fresnel at 48.590° from outside: 0.0575, red only; the reflected rest goes into the block and out of the scene.
    let (c1, c2) = (0.75_f64.sqrt(), 0.4375_f64.sqrt());
    let s = (1.5 * c1 - c2) / (1.5 * c1 + c2);
    let p = (1.5 * c2 - c1) / (1.5 * c2 + c1);
    let out = 1.0 - 0.5 * (s * s + p * p);
    assert!((bent[0] - out).abs() < 1e-6 && bent[1] < 1e-6, "{bent:?}, {out}");
    scene.camera = scene
        .camera
        .map(|camera| scene::Camera { target: DVec3::new(0.75_f64.sqrt(), 0.0, -0.5), ..camera });
    assert!(center(&scene)[0] < 1e-6, "total reflection: {:?}", center(&scene));
}

#[test]
fn depth_and_weight_end_the_tree() {
    let look = clear([1.0; 3], 1e9, Some(1.5));
    let mut scene = seen_along_z(&[block([-1.0; 3], [1.0; 3], &look)]);
    scene.background = Rgb::ONE;
    // Past the depth limit both branches see the background.
    let shallow = Oracle::new(&scene, (1, 1), Limits { depth: 0, min_weight: 0.0 });
    assert!((shallow.pixel(0, 0)[0] - 1.0).abs() < 1e-12, "background");
    // The reflected 4 % are too faint, and so is what is reflected inside: 0.96² is left.
    let faint = Oracle::new(&scene, (1, 1), Limits { depth: 9, min_weight: 0.05 });
    assert!((faint.pixel(0, 0)[0] - 0.96 * 0.96).abs() < 1e-6, "{:?}", faint.pixel(0, 0));
}

#[test]
fn a_highlight_by_hand() {
    // A light behind the eye mirrored in the flat face of glass: R / sin² 0.25°.
    let mut scene = seen_along_z(&[block([-1.0; 3], [1.0; 3], &clear([1.0; 3], 1e-3, Some(1.5)))]);
    let at = |x| scene::Light {
        kind: LightKind::Beam { at: DVec3::new(x, 0.0, 1.0), toward: DVec3::ZERO },
        color: Rgb::ONE,
        shadows: true,
        radius: 0.0,
    };
    scene.lights = vec![at(0.0043)];
    let disc = 0.04 / (0.25_f64.to_radians() * 0.25_f64.to_radians());
    let bright = center(&scene)[0];
    assert!((bright / disc - 1.0).abs() < 1e-4, "within the disc: {bright}, {disc}");
    scene.lights = vec![at(0.0045)];
    assert!(center(&scene)[0] < 1e-6, "beside it");
}

#[test]
fn groups_instances_and_attributes_by_hand() {
    // A class at twice its size, a quarter turn and a step; inside it a group moved by 1. The apex of the cone, at
    // the class's (1, 0, 0), comes to (3, 2, 0); its axis points along +y.
    let mut author = Author::new(Site::UNIT, DVec3::new(0.0, 0.0, 10.0), DVec3::ZERO);
    let said = opaque(BLUE);
    let cone = upright(Primitive::Cone, [0.0; 3], (1.0, 1.0), 0.0, &Attributes::default());
    let group = Shape::Group(Box::new(cone), stands([1.0, 0.0, 0.0], [1.0; 3]), said);
    let class = author.class(&group);
    let placement = Placement {
        scale: DVec3::splat(2.0),
        rotation_degrees: DVec3::new(0.0, 0.0, 90.0),
        place: DVec3::new(3.0, 0.0, 0.0),
    };
    author.object(&Shape::Instance(class, placement, opaque(RED)));
    let scene = author.finish();
    // Half-way up, at y = 3, the radius is 1.
    let found = first(&scene, 3.0, 3.0);
    assert!(found.is_some_and(|at| near(at.0, 9.0) && same(at.1, BLUE)), "half-way: {found:?}");
    assert!(first(&scene, 3.0, 1.9).is_none(), "below the apex");
    assert!(first(&scene, 3.0, 4.1).is_none(), "above the base");
    let oracle = Oracle::new(&scene, (1, 1), LIMITS);
    let away = dot(&oracle.solids.bodies[0].map.place, &vector(DVec3::Z)).value();
    assert!(near(away, -10.0), "the eye is the origin: {away}");
}
