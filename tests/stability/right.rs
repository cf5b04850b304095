//! Scenes whose pixels are the oracle's: contact, slender and thin things, detail on large bodies, awkward rays, media.

use glam::DVec3;
use render::{Accel, Options};
use scene::{Attributes, Scene};

use super::case::{Case, Found, Peer, Promise, Written};
use crate::oracle::author::{Author, Site, block, clear, opaque, sphere};
use crate::oracle::compare::{Tally, compare, compare_with};
use crate::random_csg::{floor, stage};

const CONTACT: &str = "Faces that touch, coincide or nearly do";
const SHAPE: &str = "Slender, thin and small things";
const AIM: &str = "Rays along what they seldom meet";
const MEDIA: &str = "Media and light";
const FRAME: &str = "Cameras and pictures";

/// Gaps and walls of this size are seen by everyone, and as small as nothing in a picture.
const SAFE: f64 = 1e-3;

/// Another program's pictures against its own at a safe size.
fn own(file: &'static str, written: Written, name: &'static str) -> Peer {
    Peer::Own(written, Written::new(file, &[(name, SAFE)]))
}

/// Random solids of a lattice.
const LATTICE: u64 = 60;

/// What a comparison found.
fn found(tally: &Tally) -> Found {
    Found::Pixels { wrong: tally.wrong.len() as u64, of: tally.pixels, edges: tally.edges }
}

/// A scene of a file against the oracle.
fn right(
    section: &'static str,
    name: impl Into<String>,
    written: Written,
    size: (u32, u32),
) -> Case {
    Case::new(section, name, Promise::Right, move || {
        found(&compare(&unpainted(written.scene()), size, Accel::Bvh))
    })
}

/// Without paint, of which the tracer shows the mean over a pixel.
pub(crate) fn unpainted(mut scene: Scene) -> Scene {
    scene.attributes.iter_mut().for_each(|set| set.paint.clear());
    scene
}

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = contact();
    cases.extend(shape());
    cases.extend(aims());
    cases.extend(media());
    cases.extend(frames());
    cases
}

fn contact() -> Vec<Case> {
    let mut cases = Vec::new();
    let gaps = (0..=15).rev().map(|decade| libm::exp10(f64::from(-decade)));
    for gap in std::iter::once(0.0).chain(gaps) {
        let opaque = Written::new("contact.sdl", &[("gap", gap)]);
        let clear = Written::new("layers.sdl", &[("gap", gap)]);
        let case = right(CONTACT, format!("opaque, gap {gap:e}"), opaque.clone(), (48, 36));
        cases.push(case.beside(Peer::Ours(opaque)));
        let case = right(CONTACT, format!("refracting, gap {gap:e}"), clear.clone(), (32, 24));
        // Without a gap there is no air between, and the picture another one.
        let open = gap > 0.0 && gap < SAFE;
        cases.push(if open { case.beside(own("layers.sdl", clear, "gap")) } else { case });
    }
    let films = "films of half to two and a half rounding bounds on mirrors";
    cases.push(Case::new(CONTACT, films, Promise::Right, film));
    let lattice =
        Case::new(CONTACT, "random solids of a half-unit lattice", Promise::Right, || {
            let all = (0..LATTICE)
                .map(|seed| compare(&super::algebra::joined(seed), (24, 24), Accel::Bvh));
            found(&all.fold(Tally::default(), |mut sum, tally| {
                sum.add(tally);
                sum
            }))
        });
    cases.push(lattice);
    cases
}

/// Balls of glass that mirrors in films that do not: a ray that springs from a film starts as far below it as the glass.
fn film() -> Found {
    let middle = DVec3::new(3.1, -2.7, 5.3);
    // A rounding bound of what stands eight units off.
    let bound = 64.0 * 0.5 * f64::EPSILON * 8.0;
    let tally = (0..256).fold(Tally::default(), |mut sum, k| {
        let gap = bound * (0.5 + f64::from(k) / 128.0);
        let ball = |radius, look: &Attributes| sphere(middle.to_array(), radius, look);
        let mut author = Author::new(Site::UNIT, middle + DVec3::new(1.1, 0.7, 2.5), middle);
        author.object(&ball(1.0 - gap, &clear([0.5; 3], 1e-6, Some(100.0))));
        author.object(&ball(1.0, &clear([0.9; 3], 1e6, Some(1.0))));
        sum.add(compare(&author.finish(), (6, 6), Accel::Bvh));
        sum
    });
    // The film is seen or not, which makes no difference: no pixel may be on an edge.
    let wrong = tally.wrong.len() as u64 + tally.edges;
    Found::Pixels { wrong, of: tally.pixels, edges: 0 }
}

fn shape() -> Vec<Case> {
    let mut cases = Vec::new();
    for decade in [1, 3, 6, 9] {
        let thick = libm::exp10(f64::from(-decade));
        let written = Written::new("slender.sdl", &[("thick", thick), ("needles", 40.0)]);
        let case = right(SHAPE, format!("1 : 1e{decade}"), written.clone(), (48, 36));
        cases.push(case.beside(Peer::Ours(written)));
    }
    for decade in (1..=9).rev() {
        let wall = libm::exp10(f64::from(-decade));
        let written = Written::new("shells.sdl", &[("wall", wall)]);
        let case = right(SHAPE, format!("walls of 1e-{decade}"), written.clone(), (48, 36));
        let thin = wall < SAFE;
        cases.push(if thin { case.beside(own("shells.sdl", written, "wall")) } else { case });
    }
    for (body, part) in [(1e2, 1e-6), (1e4, 1e-6), (1e6, 1e-6), (1e6, 1e-4), (1e9, 1e-2)] {
        let written = Written::new("detail.sdl", &[("body", body), ("part", part)]);
        let case = right(
            SHAPE,
            format!("parts of {part:e} on a body of {body:e}"),
            written.clone(),
            (48, 36),
        );
        cases.push(case.beside(Peer::Ours(written)));
    }
    let underfoot = Written::new("underfoot.sdl", &[]);
    cases.push(right(SHAPE, "a planet underfoot", underfoot, (48, 36)));
    cases
}

/// `aims.sdl` seen from another place.
fn from(eye: [f64; 3], target: [f64; 3]) -> Scene {
    let mut scene = Written::new("aims.sdl", &[]).scene();
    if let Some(camera) = &mut scene.camera {
        camera.position = DVec3::from_array(eye);
        camera.target = DVec3::from_array(target);
    }
    scene
}

fn aims() -> Vec<Case> {
    // In pictures of odd sides the ray in the middle goes to the target.
    let views: [(&str, [f64; 3], [f64; 3]); 18] = [
        ("along an axis, at a face", [0.0, 0.0, 9.0], [0.0; 3]),
        ("in the plane of a face", [1.0, 0.0, 9.0], [1.0, 0.0, 0.0]),
        ("along an edge", [1.0, 1.0, 9.0], [1.0, 1.0, 0.0]),
        ("at a corner", [5.0, 5.0, 5.0], [1.0, 1.0, 1.0]),
        ("across two edges", [4.0, 4.0, 0.0], [0.0; 3]),
        ("down on a corner", [1.0, 9.0, 1.0], [1.0, 0.0, 1.0]),
        ("at an apex, along the axis", [-7.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ("at an apex, across the axis", [1.0, 0.0, 7.0], [1.0, 0.0, 0.0]),
        ("along a generator", [6.0, 5.0, 0.0], [1.0, 0.0, 0.0]),
        ("along a generator from inside", [1.5, 0.5, 0.0], [2.0, 1.0, 0.0]),
        ("along a cylinder's axis", [-1.5, 1.0, 7.0], [-1.5, 1.0, 0.0]),
        ("along a cylinder's side", [-1.0, 1.0, 7.0], [-1.0, 1.0, 0.0]),
        ("touching a sphere", [0.0, 2.0, 7.0], [0.0, 2.0, 0.0]),
        ("touching a sphere from above", [0.5, 7.0, 0.0], [0.5, 1.5, 0.0]),
        ("eye on a face", [0.3, 0.2, 1.0], [0.3, 0.9, 5.0]),
        ("eye on an edge", [1.0, 1.0, 0.2], [3.0, 3.0, 1.0]),
        ("eye on a corner", [1.0, 1.0, 1.0], [4.0, 0.2, 2.0]),
        ("eye at an apex", [1.0, 0.0, 0.0], [3.0, 0.0, 3.5]),
    ];
    views
        .into_iter()
        .map(|(name, eye, target)| {
            Case::new(AIM, name, Promise::Right, move || {
                found(&compare(&from(eye, target), (49, 49), Accel::Bvh))
            })
        })
        .collect()
}

fn media() -> Vec<Case> {
    vec![
        right(MEDIA, "index 0.01, 1 ± 1e-12, 100; half-distance 1e±12", indices(), (48, 36)),
        right(MEDIA, "grazing light", Written::new("grazing.sdl", &[]), (64, 48))
            .beside(Peer::Ours(Written::new("grazing.sdl", &[]))),
        right(MEDIA, "the eye inside five solids", Written::new("inside.sdl", &[]), (48, 36)),
        finish("opaque, shiny", None),
        finish("glass", Some(1.5)),
        mirrors(1),
        mirrors(30),
        mirrors(100),
        Case::new(MEDIA, "depth 1000 against depth 2000", Promise::Alike, || {
            let scene = Written::new("mirrors.sdl", &[]).scene();
            let shown = |depth| crate::support::shown(&scene, &between_mirrors(depth));
            super::place::differing(&shown(1000), &shown(2000), 1)
        }),
    ]
}

/// Bodies as smooth and as rough as can be, beside and behind each other.
fn finish(name: &str, index: Option<f64>) -> Case {
    Case::new(MEDIA, format!("{name}, smoothness 0, 1e-6 and 1"), Promise::Right, move || {
        let look = |slope: f64, color: [f64; 3]| Attributes {
            smoothness: Some(slope),
            shininess: Some(if index.is_some() { 1.0 } else { 0.3 }),
            ..index.map_or_else(|| opaque(color), |_| clear(color, 3.0, index))
        };
        let sizes = [([0.9, 0.4, 0.3], 0.0), ([0.4, 0.9, 0.3], 1e-6), ([0.3, 0.4, 0.9], 1.0)];
        let mut author = stage(Site::UNIT, [1.1, 2.3, 6.0]);
        for (k, (color, slope)) in (0_u32..).zip(sizes) {
            let x = 2.2 * f64::from(k) - 2.2;
            author.object(&sphere([x, 0.0, 0.0], 1.0, &look(slope, color)));
            author.object(&block([x, -1.0, -3.0], [x + 1.0, 1.0, -2.0], &look(slope, color)));
        }
        author.object(&floor());
        found(&compare(&author.finish(), (48, 36), Accel::Bvh))
    })
}

fn indices() -> Written {
    Written::new("indices.sdl", &[])
}

fn between_mirrors(depth: u32) -> Options {
    Options { columns: 24, rows: 18, depth, min_weight: 0.0, ..Options::default() }
}

fn mirrors(depth: u32) -> Case {
    Case::new(MEDIA, format!("mirrors to depth {depth}"), Promise::Right, move || {
        let scene = unpainted(Written::new("mirrors.sdl", &[]).scene());
        found(&compare_with(&scene, &between_mirrors(depth)))
    })
}

fn frames() -> Vec<Case> {
    let contact = || Written::new("contact.sdl", &[]).scene();
    let sized = [(1, 1), (1, 65_535), (65_535, 1)].map(|size: (u32, u32)| {
        let name = format!("{} × {} pixels", size.0, size.1);
        Case::new(FRAME, name, Promise::Right, move || {
            found(&compare(&contact(), size, Accel::Bvh))
        })
    });
    let lenses = [(0.01, 1.0), (1.0, 1.0), (1e6, 2e4)].map(|(millimetres, farther)| {
        Case::new(FRAME, format!("a lens of {millimetres:e} mm"), Promise::Right, move || {
            let mut scene = contact();
            if let Some(camera) = &mut scene.camera {
                camera.focal_length_mm = millimetres;
                camera.position = camera.target + farther * (camera.position - camera.target);
            }
            found(&compare(&scene, (48, 36), Accel::Bvh))
        })
    });
    sized.into_iter().chain(lenses).collect()
}
