//! Errors of the formulas, against double-double arithmetic.

use glam::DVec3;
use idf::Transfer;
use ilut::oklab;
use render::{Options, World, radiance};
use scene::form::Row;
use scene::{Form, Placement, Primitive, Ray, Rgb};

use super::case::{Case, Found, Promise};
use super::extreme::direction;
use crate::oracle::author::{Author, Chance, Site, block, clear, opaque, sphere};
use crate::oracle::body::{Body, Kind};
use crate::oracle::dd::{Dd, Vec3, dot, minus, unit, vector};
use crate::oracle::finish::Finish;
use crate::oracle::place::Affine;
use crate::oracle::trace::{Limits, Oracle};

const HITS: &str =
    "Error of hits, in 2⁻⁵³ of the largest number in play; child rays start 64 of these off";
const NORMALS: &str =
    "Error of normals, in 2⁻⁵³ of the largest number in play over the size of the solid";
const STATES: &str = "Error of what is inside, in 2⁻⁵³ of the largest number in play; points are asked 64 of these off";
const CHAINS: &str = "Error of light through chains of refraction, in 2⁻⁵³ of the largest number in play over the size of the scene";
const LIGHT: &str = "Error of optics, relative";
const TONES: &str = "Error of tones and colours, in units in the last place";

/// 2⁻⁵³.
const UNIT: f64 = 0.5 * f64::EPSILON;
/// Rays of a decade.
const RAYS: u32 = 1500;
/// Decades of a row.
const DECADES: std::ops::RangeInclusive<i32> = 0..=12;

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (section, which) in [(HITS, 0), (NORMALS, 1)] {
        for kind in kinds() {
            let name = format!("{} at 1e0, 1e1 … 1e12 radii", word(&kind));
            // Near its apex a cone is as small as one likes, and the tube of a torus is half as wide as it.
            let most = match (section == HITS, word(&kind)) {
                (true, _) => 8.0,
                (false, "cone") => 256.0,
                (false, "torus") => 96.0,
                (false, _) => 48.0,
            };
            cases.push(Case::new(section, name, Promise::Within(most), move || {
                Found::Decades(DECADES.map(|decade| hits(&kind, decade)[which]).collect())
            }));
        }
    }
    for kind in kinds() {
        let name = format!("{} 1e0, 1e1 … 1e12 radii from the origin", word(&kind));
        cases.push(Case::new(STATES, name, Promise::Within(4.0), move || {
            Found::Decades(DECADES.map(|decade| states(&kind, decade)).collect())
        }));
    }
    for (name, make, most) in CHAIN {
        let name = format!("{name}, moved by 1e0, 1e1 … 1e9");
        cases.push(Case::new(CHAINS, name, Promise::Within(most), move || {
            Found::Decades((0..=9).map(|decade| chain(make, decade)).collect())
        }));
    }
    cases.extend(light());
    cases.extend(tones());
    cases
}

fn kinds() -> Vec<Kind> {
    let form = |word, arguments: &[f64]| {
        let row = Row::named(word).expect("a row of the table");
        Kind::Form(Form::new(row, arguments).expect("arguments that fit"))
    };
    let arrow = [0.0, 1.0, -0.9, -0.8, 0.1, -0.3, 0.8, -1.0];
    let forms = [form("torus", &[0.5]), form("prism", &arrow), form("terrain", &[3.0, 0.6, 2.0])];
    Primitive::ALL.iter().map(|&kind| Kind::Convex(kind)).chain(forms).collect()
}

fn word(kind: &Kind) -> &'static str {
    match kind {
        Kind::Convex(primitive) => primitive.keywords()[0],
        Kind::Form(form) => form.row().keyword,
    }
}

/// The largest errors of places across the surface and of normals, with the origin so many radii away.
fn hits(kind: &Kind, decade: i32) -> [f64; 2] {
    let mut chance = Chance::new(u64::from(decade.unsigned_abs()) + 77);
    let far = libm::exp10(f64::from(decade));
    let mut most = [0.0_f64; 2];
    for _ in 0..RAYS {
        let mut three = |low, high| {
            DVec3::new(
                chance.between(low, high),
                chance.between(low, high),
                chance.between(low, high),
            )
        };
        let placement = Placement {
            scale: three(0.5, 1.5),
            rotation_degrees: three(-360.0, 360.0),
            place: three(-1.0, 1.0),
        };
        let aim = placement.place + three(-0.8, 0.8);
        let way = direction(&mut chance);
        let origin = aim + way * (2.0 + far);
        let ray = Ray::new(origin, (aim - origin).normalize());
        let body = body(kind, &placement);
        let toward = DVec3::from_array(ray.direction);
        let expected = body.spans(&vector(origin), &vector(toward));
        let map = placement.map();
        let local = map.ray_inward(&ray);
        let span = match kind {
            Kind::Convex(primitive) => primitive.span(&local),
            Kind::Form(form) => form.span_at(&local, f64::NEG_INFINITY),
        };
        // Where only one of them meets the solid, it grazes.
        let Some(first) = expected.first().filter(|_| span.from < span.to) else { continue };
        let scale = UNIT * origin.abs().max_element().max(3.0);
        for (end, (t, face)) in
            first.iter().zip([(span.from, span.entered()), (span.to, span.left())])
        {
            let cosine = dot(&end.outward, &vector(toward)).value().abs();
            let off = (Dd::from(t) - end.t).value().abs() * cosine;
            most[0] = most[0].max(off / scale);
            let point = map.inward(ray.at(t)).to_array();
            let gradient = match kind {
                Kind::Convex(primitive) => primitive.gradient(point, face.number()),
                Kind::Form(form) => form.gradient_lanes(point, face.number()),
            };
            let normal = map.gradient_outward(DVec3::from_array(gradient)).normalize();
            let apart: Vec3 = minus(&vector(normal), &unit(&end.outward));
            // Two faces meet at an edge, and a cone has no normal at its apex.
            let turned = dot(&apart, &apart).sqrt().value();
            if turned < 0.01 && cosine > 0.1 {
                most[1] = most[1].max(turned / scale);
            }
        }
    }
    most
}

fn body(kind: &Kind, placement: &Placement) -> Body {
    Body {
        kind: kind.clone(),
        map: Affine::new(placement),
        magnitude: 0.0,
        color: [1.0; 3],
        shininess: 0.0,
        finish: Finish::PLAIN,
        clear: None,
        priority: 0,
    }
}

/// How far off the surface a point is at most that is taken for one on the other side, with the solid so many radii from
/// the origin.
fn states(kind: &Kind, decade: i32) -> f64 {
    let mut chance = Chance::new(u64::from(decade.unsigned_abs()) + 177);
    let far = libm::exp10(f64::from(decade));
    let mut most = 0.0_f64;
    for _ in 0..RAYS / 10 {
        let mut three = |low, high| {
            DVec3::new(
                chance.between(low, high),
                chance.between(low, high),
                chance.between(low, high),
            )
        };
        let (scale, rotation_degrees) = (three(0.5, 1.5), three(-360.0, 360.0));
        let aside = three(-0.8, 0.8);
        let place = far * direction(&mut chance);
        let placement = Placement { scale, rotation_degrees, place };
        let body = body(kind, &placement);
        let way = direction(&mut chance);
        let spans = body.spans(&vector(place + aside - 3.0 * way), &vector(way));
        let Some([end, _]) = spans.first() else { continue };
        let normal = DVec3::from_array(end.outward.map(|x| x.value()));
        if normal.dot(way).abs() < 0.1 {
            continue;
        }
        let surface = place + aside + (end.t.value() - 3.0) * way;
        let unit = UNIT * surface.abs().max_element().max(3.0);
        for k in 0..12_u32 {
            let off = 0.5 * unit * libm::exp2(f64::from(k / 2)) * [1.0, -1.0][k as usize % 2];
            let point = surface + off * normal;
            let ends = body.spans(&vector(point), &vector(normal)).concat();
            let inside = ends.chunks(2).any(|span| span[0].t <= Dd::ZERO && span[1].t > Dd::ZERO);
            let local = placement.map().inward(point);
            let found = match kind {
                Kind::Convex(primitive) => primitive.contains(local.to_array()),
                Kind::Form(form) => form.contains(local),
            };
            if found != inside {
                let way = ends.iter().map(|end| end.t.value().abs()).fold(f64::INFINITY, f64::min);
                most = most.max(way / unit);
            }
        }
    }
    most
}

/// What stands between the eye and a ball that is lit.
type Between = fn(&mut Author);

/// Chains of refraction, and the error promised.
const CHAIN: [(&str, Between, f64); 4] = [
    ("4 panes", |author| panes(author, 4), 200.0),
    ("16 panes", |author| panes(author, 16), 500.0),
    ("2 balls", |author| balls(author, 2), 1e3),
    ("4 balls", |author| balls(author, 4), 2e3),
];

fn glass() -> scene::Attributes {
    clear([1.0; 3], 1e6, Some(1.5))
}

fn panes(author: &mut Author, count: u32) {
    for k in 0..count {
        let z = -0.5 * f64::from(k);
        author.object(&block([-3.0, -3.0, z - 0.3], [3.0, 3.0, z], &glass()));
    }
}

fn balls(author: &mut Author, count: u32) {
    for k in 0..count {
        author.object(&sphere([0.0, 0.0, -2.5 * f64::from(k)], 1.0, &glass()));
    }
}

/// The largest error of the light of a lit ball behind what is between, moved by a power of ten.
fn chain(between: Between, decade: i32) -> f64 {
    let mut author = Author::new(Site::UNIT, DVec3::new(0.3, 0.2, 4.0), DVec3::new(0.1, 0.05, 0.0));
    between(&mut author);
    author.object(&sphere([0.4, -0.3, -19.0], 8.0, &opaque([0.9, 0.6, 0.3])));
    let mut scene = author.finish();
    if let Some(camera) = &mut scene.camera {
        camera.focal_length_mm = 400.0;
    }
    author = Author::new(Site::UNIT, DVec3::X, DVec3::ZERO);
    author.light(scene::LightKind::Point { at: DVec3::new(9.0, 7.0, 5.0) }, Rgb::ONE);
    scene.lights = author.finish().lights;
    scene.lights.iter_mut().for_each(|light| light.shadows = false);
    let far = libm::exp10(f64::from(decade));
    let scene = super::place::moved(scene, far * DVec3::new(1.0, -0.7, 0.9));
    let options =
        Options { columns: 4, rows: 4, min_weight: 1e-3, depth: 40, ..Options::default() };
    let limits = Limits { depth: options.depth, min_weight: options.min_weight };
    let world = World::load(&scene).expect("it loads");
    let oracle = Oracle::new(&scene, (4, 4), limits);
    let unit = UNIT * far.max(20.0) / 20.0;
    (0..16_u32).fold(0.0, |most, k| {
        let (column, row) = (k % 4, k / 4);
        let at = (f64::from(column) + 0.5, f64::from(row) + 0.5);
        let seen = radiance(&world, &options, &[at]).expect("a thread")[0];
        let found = seen.color + (1.0 - seen.coverage) * scene.background;
        let expected = oracle.pixel(column, row);
        let error = (found.x / expected[0] - 1.0).abs();
        f64::max(most, error / unit)
    })
}

/// What a camera that looks at the upper face of a block sees at an angle of this cosine.
fn seen(index: f64, half: f64, cosine: f64, wall: bool) -> (f64, Dd) {
    let sine = (1.0 - cosine * cosine).sqrt();
    let eye = DVec3::new(sine, 1.0 + cosine, 0.0);
    let mut author = Author::new(Site::UNIT, eye, DVec3::new(0.0, 1.0, 0.0));
    author.object(&block(
        [-900.0, 0.0, -900.0],
        [900.0, 1.0, 900.0],
        &clear([1.0; 3], half, Some(index)),
    ));
    if wall {
        author.object(&block([-900.0, -1.0, -900.0], [900.0, 0.0, 900.0], &opaque([1.0; 3])));
    }
    let mut scene = author.finish();
    (scene.ambient, scene.background) = (Rgb::ONE, if wall { Rgb::ZERO } else { Rgb::ONE });
    let world = World::load(&scene).expect("it loads");
    let options = Options { columns: 1, rows: 1, min_weight: 0.0, ..Options::default() };
    let seen = radiance(&world, &options, &[(0.5, 0.5)]).expect("a thread")[0];
    let value = (seen.color + (1.0 - seen.coverage) * scene.background).x;
    let way = minus(&vector(eye), &vector(DVec3::new(0.0, 1.0, 0.0)));
    (value, unit(&way)[1])
}

/// Reflected share, and cosine beyond (Fresnel).
fn fresnel(index: f64, cosine: Dd) -> (Dd, Dd) {
    let n = Dd::from(index);
    let below = Dd::ONE - (Dd::ONE - cosine * cosine) / (n * n);
    if below <= Dd::ZERO {
        return (Dd::ONE, Dd::ZERO);
    }
    let c = below.sqrt();
    let across = (cosine - n * c) / (cosine + n * c);
    let along = (n * cosine - c) / (n * cosine + c);
    ((across * across + along * along) * Dd::from(0.5), c)
}

fn relative(found: f64, expected: Dd) -> f64 {
    ((Dd::from(found) - expected) / expected).value().abs()
}

fn light() -> Vec<Case> {
    let cosines = || (0..=24).map(|k| libm::exp10(-0.25 * f64::from(k)) * 0.999);
    let mut cases = Vec::new();
    for (index, most) in [
        (1.5, 1e-15),
        (0.01, 1e-15),
        (100.0, 1e-15),
        (1.0 + 1e-3, 1e-13),
        (1.0 + 1e-6, 2e-13),
        (1.0 + 1e-12, 2e-13),
        (1.0 - 1e-12, 2e-13),
    ] {
        let name = format!("reflected share, index {}, 3° to 0.00006° of grazing", name_of(index));
        cases.push(Case::new(LIGHT, name, Promise::Within(most), move || {
            Found::Error(cosines().fold(0.0, |most, cosine| {
                let (found, cosine) = seen(index, 1e-12, cosine, false);
                let expected = fresnel(index, cosine).0;
                // Below what a display shows a share is as good as none.
                let error = if expected.value() < 1e-6 { 0.0 } else { relative(found, expected) };
                f64::max(most, error)
            }))
        }));
    }
    for (index, most) in [(1.0 + 1e-12, 2e-10), (1.33, 2e-11), (1.5, 2e-11), (100.0, 2e-11)] {
        let name = format!("way through a slab, index {}", name_of(index));
        cases.push(Case::new(LIGHT, name, Promise::Within(most), move || {
            Found::Error((1..=20).fold(0.0, |most, k| {
                let (found, cosine) = seen(index, 1.0, 0.05 * f64::from(k) - 1e-3, true);
                let (reflected, beyond) = fresnel(index, cosine);
                let way = (Dd::ONE / beyond).value();
                let through = (Dd::ONE - reflected) * Dd::from(libm::exp2(-way));
                f64::max(most, relative(found, through))
            }))
        }));
    }
    // The narrower the lobe, the more a rounding of the angle is of it.
    for (slope, most) in
        [(1e-3, 5e-10), (1e-2, 5e-11), (0.1, 5e-11), (0.25, 5e-11), (0.6, 1e-10), (1.0, 1e-10)]
    {
        let name = format!("highlight of slope {slope}");
        cases.push(Case::new(LIGHT, name, Promise::Within(most), move || {
            Found::Error(highlight(slope))
        }));
    }
    cases
}

fn name_of(index: f64) -> String {
    if (index - 1.0).abs() < 0.1 && index.to_bits() != 1.0_f64.to_bits() {
        format!("1 {} {:.0e}", if index > 1.0 { '+' } else { '−' }, (index - 1.0).abs())
    } else {
        format!("{index}")
    }
}

/// A rough block lit by a lamp, in the mirror direction and beside it.
fn highlight(slope: f64) -> f64 {
    let options = Options { columns: 1, rows: 1, ..Options::default() };
    let limits = Limits { depth: options.depth, min_weight: options.min_weight };
    (0..40).fold(0.0, |most, k| {
        let angle = 2.0 * f64::from(k);
        let ((s, c), (sl, cl)) = (
            scene::transform::sin_cos_degrees(angle),
            scene::transform::sin_cos_degrees(angle + 25.0 * slope),
        );
        let mut author = Author::new(Site::UNIT, 5.0 * DVec3::new(s, c, 0.3 * slope), DVec3::ZERO);
        let look =
            scene::Attributes { shininess: Some(1.0), smoothness: Some(slope), ..opaque([0.0; 3]) };
        author.object(&block([-900.0, -1.0, -900.0], [900.0, 0.0, 900.0], &look));
        let at = 7.0 * DVec3::new(-sl, cl, 0.0);
        author.light(scene::LightKind::Point { at }, Rgb::ONE);
        let mut scene = author.finish();
        (scene.ambient, scene.background) = (Rgb::ZERO, Rgb::ZERO);
        let world = World::load(&scene).expect("it loads");
        let found = radiance(&world, &options, &[(0.5, 0.5)]).expect("a thread")[0].color.x;
        let expected = Oracle::new(&scene, (1, 1), limits).pixel(0, 0)[0];
        let error = if expected < 1e-6 { 0.0 } else { (found / expected - 1.0).abs() };
        f64::max(most, error)
    })
}

/// The root of `x ↦ x^degree − power` near `start`.
fn root(power: Dd, degree: i32, start: f64) -> Dd {
    let raised = |x: Dd, n: i32| (0..n).fold(Dd::ONE, |product, _| product * x);
    (0..3).fold(Dd::from(start), |x, _| {
        x - (raised(x, degree) - power) / (Dd::from(f64::from(degree)) * raised(x, degree - 1))
    })
}

fn tones() -> Vec<Case> {
    let mut cases = Vec::new();
    for decade in 0..=8 {
        let light = move |k: u32| libm::exp10(f64::from(-decade) - f64::from(k) / 500.0);
        let name = |what: &str| format!("{what} of light 1e-{decade} … 1e-{}", decade + 1);
        cases.push(Case::new(TONES, name("sRGB"), Promise::Within(4.0), move || {
            Found::Error((0..500).fold(0.0, |most, k| {
                let x = light(k);
                let (stored, back) = (Transfer::Srgb.encode(x), Transfer::Srgb.decode(x));
                let fifth = |x: Dd| x * x * x * x * x;
                let curve = root(fifth(Dd::from(x)), 12, libm::pow(x, 1.0 / 2.4));
                let expected = if x <= 0.003_130_8 {
                    Dd::from(12.92) * Dd::from(x)
                } else {
                    Dd::from(1.055) * curve - Dd::from(0.055)
                };
                let base = (Dd::from(x) + Dd::from(0.055)) / Dd::from(1.055);
                let square = base * base;
                let sixth = square * square * square;
                let decoded = if x <= 0.040_45 {
                    Dd::from(x) / Dd::from(12.92)
                } else {
                    root(sixth * sixth, 5, libm::pow(base.value(), 2.4))
                };
                let error = relative(stored, expected).max(relative(back, decoded));
                f64::max(most, error / f64::EPSILON)
            }))
        }));
        cases.push(Case::new(TONES, name("Oklab"), Promise::Within(8.0), move || {
            Found::Error((0..500).fold(0.0, |most, k| {
                #[expect(clippy::cast_possible_truncation, reason = "light in single precision")]
                let x = light(k) as f32;
                let color = [x, 0.7 * x, 0.2 * x];
                let (found, expected) = (oklab::from_linear(color), lab(color));
                let size = expected[0].value().abs() * f64::from(f32::EPSILON);
                (0..3).fold(most, |most, k| {
                    let off = (Dd::from(f64::from(found[k])) - expected[k]).value().abs();
                    f64::max(most, off / size)
                })
            }))
        }));
    }
    cases
}

/// Oklab times 255, with the published matrices.
fn lab(color: [f32; 3]) -> [Dd; 3] {
    let rows = |rows: [[f64; 3]; 3], v: [Dd; 3]| {
        rows.map(|row| {
            let [a, b, c] = row.map(Dd::from);
            a * v[0] + b * v[1] + c * v[2]
        })
    };
    let cones = rows(
        [
            [0.412_221_470_8, 0.536_332_536_3, 0.051_445_992_9],
            [0.211_903_498_2, 0.680_699_545_1, 0.107_396_956_6],
            [0.088_302_461_9, 0.281_718_837_6, 0.629_978_700_5],
        ],
        color.map(|channel| Dd::from(f64::from(channel))),
    );
    let roots = cones.map(|light| root(light, 3, libm::cbrt(light.value())));
    rows(
        [
            [0.210_454_255_3, 0.793_617_785_0, -0.004_072_046_8],
            [1.977_998_495_1, -2.428_592_205_0, 0.450_593_709_9],
            [0.025_904_037_1, 0.782_771_766_2, -0.808_675_766_0],
        ],
        roots,
    )
    .map(|x| x * Dd::from(255.0))
}
