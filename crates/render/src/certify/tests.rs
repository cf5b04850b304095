//! What is proved, beside dense grids of rays.

use glam::DVec3;
use scene::form::FORMS;
use scene::{
    AttributesId, Camera, Form, Frame as SolidFrame, FrameId, Node, Placement, Primitive, Scene,
    Solid,
};

use super::band::{Band, Rays};
use super::outline::Outline;
use super::quadtree::{Plan, Proof, Prover};
use super::sheet::{Cell, Sheet};
use super::verdict::Surface;
use crate::options::{Accel, Options};
use crate::render;
use crate::sampling::place::sight;
use crate::tile::Frame;
use crate::trace::event::{Events, Finder, Quest};
use crate::world::World;

/// A fixed sequence of numbers.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, n: u32) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        u32::try_from(self.0 >> 40).unwrap() % n
    }

    /// Between −1 and 1.
    fn signed(&mut self) -> f64 {
        f64::from(self.below(20_001)) / 10_000.0 - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }
}

/// A random expression of solids.
fn solid(numbers: &mut Numbers, leaves: u32, with_forms: bool) -> Solid {
    let mut solid = Solid::default();
    let mut open = 0;
    for _ in 0..leaves {
        let lattice = numbers.below(3) == 0;
        let turn =
            if lattice { 90.0 * f64::from(numbers.below(4)) } else { 180.0 * numbers.signed() };
        let size = libm::exp2(numbers.signed() - 0.5);
        let place = 1.5 * numbers.vector();
        let placement = Placement {
            scale: if lattice { DVec3::splat(0.5) } else { size * (0.6 + 0.5 * numbers.vector()) },
            rotation_degrees: DVec3::new(turn, 2.0 * turn, 0.5 * turn),
            place: if lattice { (2.0 * place).round() * 0.5 } else { place },
        };
        solid.frames.push(SolidFrame { parent: None, placement, attributes: AttributesId::NONE });
        let frame = FrameId(u32::try_from(solid.frames.len() - 1).unwrap());
        let kinds = u32::try_from(Primitive::ALL.len() + usize::from(with_forms)).unwrap();
        let node = match numbers.below(kinds) as usize {
            kind if kind == Primitive::ALL.len() => {
                let row = &FORMS[numbers.below(u32::try_from(FORMS.len()).unwrap()) as usize];
                let bay = || vec![-1.0, -1.0, 1.0, -1.0, 1.0, 1.0, 0.5, 1.0, 0.0, -0.5, -1.0, 1.0];
                let arguments = row.defaults().unwrap_or_else(bay);
                let form = Form::new(row, &arguments).unwrap();
                Node::Form { form: solid.add_form(form), frame }
            }
            kind => Node::Primitive { kind: Primitive::ALL[kind], frame },
        };
        solid.nodes.push(node);
        open += 1;
        while open > 1 && numbers.below(3) > 0 {
            match numbers.below(6) {
                0..=2 => solid.nodes.push(Node::Union(2)),
                3 => solid.nodes.push(Node::Intersection(2)),
                _ => solid.nodes.extend([Node::Complement, Node::Intersection(2)]),
            }
            open -= 1;
        }
    }
    if open > 1 {
        solid.nodes.push(Node::Union(open));
    }
    solid
}

/// One solid anywhere, seen from anywhere.
fn alone(numbers: &mut Numbers, kind: Primitive, parallel: bool) -> World {
    let mut scene = Scene::default();
    let placement = Placement {
        scale: libm::exp2(3.0 * numbers.signed()) * (DVec3::ONE + 0.8 * numbers.vector()),
        rotation_degrees: 180.0 * numbers.vector(),
        place: 1.5 * numbers.vector(),
    };
    scene.add_object(None, Solid::primitive(kind, placement));
    let distance = libm::exp2(3.0 * numbers.signed() + 2.0);
    scene.camera = Some(Camera {
        parallel,
        position: distance * numbers.vector().normalize_or(DVec3::X),
        target: 0.5 * numbers.vector(),
        focal_length_mm: 35.0,
    });
    World::load(&scene).unwrap()
}

#[test]
fn outlines_and_bands_hold_for_every_solid() {
    const SIDE: u32 = 9;
    let mut numbers = Numbers(0x1234_5678_9abc_def1);
    for kind in Primitive::ALL {
        // Cells that all rays miss, that all go through, and how many of either are proved.
        let mut counts = [[0_u32; 2]; 2];
        for number in 0..150 {
            let world = alone(&mut numbers, *kind, number % 3 == 2);
            let view = world.view_from.view(64, 64);
            let sheet = Sheet::new(world.eye, &view, (64, 64));
            let leaf = &world.leaves[0];
            let outline = Outline::of_leaf(&sheet, leaf, &world.nodes[0].bounds());
            for _ in 0..40 {
                let middle = [0, 1].map(|_| 32.0 + 32.0 * numbers.signed());
                let cell = Cell { middle, half: libm::exp2(2.0 * numbers.signed()) };
                let missed = outline.is_missed(&cell);
                let rays = Rays::new(&sheet, &cell);
                let band = Band::new(&sheet, &cell, &rays, leaf, &outline);
                let mut met = 0;
                for k in 0..SIDE * SIDE {
                    let step =
                        |k: u32| (2.0 * f64::from(k) / f64::from(SIDE - 1) - 1.0) * cell.half;
                    let place = [middle[0] + step(k % SIDE), middle[1] + step(k / SIDE)];
                    let span = leaf.span(&sheet.ray(place), 0.0);
                    let hits = span.from < span.to && span.to > 0.0;
                    met += u32::from(hits);
                    assert!(!(hits && missed), "{kind:?} {number}: {cell:?} is met at {place:?}");
                    if !band.crossed {
                        continue;
                    }
                    let name = format!("{kind:?} {number}: {band:?} at {place:?}: {span:?}");
                    assert!(hits, "{name}");
                    let within = |t: f64, range: [f64; 2]| t >= range[0] && t <= range[1];
                    let enters = if span.from > 0.0 { span.from } else { f64::NEG_INFINITY };
                    assert!(within(enters, band.enters) && within(span.to, band.leaves), "{name}");
                    assert!(band.front.is_none_or(|face| face == span.entered()), "{name}");
                    assert!(band.back.is_none_or(|face| face == span.left()), "{name}");
                }
                for (count, proved) in [(0, missed), (SIDE * SIDE, band.crossed)] {
                    let which = usize::from(count > 0);
                    counts[which][0] += u32::from(met == count);
                    counts[which][1] += u32::from(met == count && proved);
                }
            }
        }
        for [all, proved] in counts {
            assert!(all > 400 && 10 * proved > 9 * all, "{kind:?}: {counts:?} are proved");
        }
    }
}

/// A random scene of several objects, seen from some distance or from within.
fn scene(numbers: &mut Numbers, number: u32) -> Scene {
    let mut scene = Scene::default();
    for _ in 0..=numbers.below(5) {
        let leaves = 1 + numbers.below(6);
        scene.add_object(None, solid(numbers, leaves, number % 4 == 3));
    }
    let distance = if number % 5 == 4 { 1.0 } else { 4.0 + 3.0 * numbers.signed() };
    scene.camera = Some(Camera {
        parallel: number % 3 == 2,
        position: distance * numbers.vector().normalize_or(DVec3::X),
        target: 0.5 * numbers.vector(),
        focal_length_mm: 35.0,
    });
    scene
}

/// What the ray through a place sees first: a leaf and a face.
struct Truth<'w> {
    finder: Finder<'w>,
    frame: Frame<'w>,
    size: (u32, u32),
}

impl<'w> Truth<'w> {
    fn new(world: &'w World, options: &'w Options) -> Self {
        let size = (options.columns, options.rows);
        let view = world.view_from.view(size.0, size.1);
        Self {
            finder: Finder::new(world, Accel::Bvh),
            frame: Frame::new(world, view, options),
            size,
        }
    }

    fn first(&mut self, place: [f64; 2]) -> Option<(u32, u32)> {
        let world = self.frame.world;
        let medium = self.finder.medium_at(world.eye);
        let sight = sight(self.frame.view(), place.into(), self.size);
        let quest: Quest = self.finder.quest(sight, medium);
        let mut events = Events::new();
        self.finder.events(&world.whole, 1, |_| &quest, &mut events);
        events.get(0).map(|event| (event.owner.leaf, event.face.0))
    }
}

/// Compares all that is proved of a picture with `side` × `side` rays in each cell, its edges included. Returns the area
/// that is proved and how many rays were looked at.
fn check(name: &str, world: &World, options: &Options, side: u32) -> (f64, u32) {
    let mut truth = Truth::new(world, options);
    let sheet = Sheet::new(world.eye, truth.frame.view(), truth.size);
    let mut prover = Prover::new(world, &sheet);
    let (mut area, mut rays) = (0.0, 0);
    for number in 0..truth.frame.tile_count() {
        let piece = truth.frame.piece(number);
        let beam = truth.frame.beam(&piece);
        let region = world.reached(&beam, usize::MAX).unwrap();
        let plan: &Plan = prover.tile(&piece, &beam, &region, world.slack());
        let mut proved: Vec<([f64; 2], f64, Option<Surface>)> = Vec::new();
        for (pixel, proof) in plan.proofs.iter().enumerate() {
            match *proof {
                Proof::Whole(shown) => {
                    proved.push((piece.pixel(pixel).map(|at| f64::from(at) + 0.5), 0.5, shown));
                }
                Proof::Open { .. } => {}
                Proof::Parts { first, count } => {
                    let parts = &plan.parts[first as usize..][..count as usize];
                    let all: f64 =
                        parts.iter().map(|part| 4.0 * part.cell.half * part.cell.half).sum();
                    assert!((all - 1.0).abs() < 1e-12, "{name}: parts fill a pixel: {all}");
                    proved.extend(
                        parts.iter().filter_map(|part| {
                            Some((part.cell.middle, part.cell.half, part.proved?))
                        }),
                    );
                }
            }
        }
        for (middle, half, shown) in proved {
            area += 4.0 * half * half;
            let side = if half < 0.5 { 3 } else { side };
            for k in 0..side * side {
                // A hair within the edges.
                let step =
                    |k: u32| (2.0 * f64::from(k) / f64::from(side - 1) - 1.0) * half * (1.0 - 1e-6);
                let place = [middle[0] + step(k % side), middle[1] + step(k / side)];
                let expected = shown.map(|surface| (surface.leaf, surface.face.0));
                let found = truth.first(place);
                rays += 1;
                assert_eq!(found, expected, "{name}: at {place:?} of {middle:?} ± {half}");
            }
        }
    }
    (area / f64::from(options.columns * options.rows), rays)
}

/// `PORTRAY_PROOFS=n` tries n times as many random scenes, and n times as many rays of each pixel of others.
fn more() -> u32 {
    std::env::var("PORTRAY_PROOFS").ok().and_then(|n| n.parse().ok()).unwrap_or(1)
}

#[test]
fn proofs_of_random_scenes_hold() {
    let mut numbers = Numbers(0x9e37_79b9_7f4a_7c15);
    let (mut area, mut rays, count) = (0.0, 0, 250 * more());
    for number in 0..count {
        let scene = scene(&mut numbers, number);
        let world = World::load(&scene).unwrap();
        let options = Options { columns: 24, rows: 20, ..Options::default() };
        let (own, looked) = check(&format!("scene {number}"), &world, &options, 5);
        area += own;
        rays += looked;
    }
    let share = area / f64::from(count);
    assert!(share > 0.7 && rays > 1_000_000, "{share} of the pictures are proved, by {rays} rays");
}

/// Spheres, each in a square of its own, with radii of so many powers of ten of a pixel, and where their middles are from
/// the eye.
fn small_spheres(across: u32, size: u32, [least, most]: [f64; 2]) -> (Scene, Vec<DVec3>) {
    let mut numbers = Numbers(0x2545_f491_4f6c_dd1d);
    let mut scene = Scene { ambient: scene::Rgb::ONE, ..Scene::default() };
    let position = DVec3::new(0.0, 0.0, 1000.0);
    let pixel = 480.0 / f64::from(size);
    let mut middles = Vec::new();
    for number in 0..across * across {
        let apart = f64::from(size) / f64::from(across);
        let mut along = |at: u32| {
            let off = 0.5 + 0.25 * numbers.signed();
            (apart * (f64::from(at) + off) - 0.5 * f64::from(size)) * pixel
        };
        let place = DVec3::new(along(number % across), along(number / across), 0.0);
        let radius = libm::exp10(least + 0.5 * (most - least) * (numbers.signed() + 1.0)) * pixel;
        let placement = Placement { place, scale: DVec3::splat(radius), ..Placement::default() };
        scene.add_object(None, Solid::primitive(Primitive::Sphere, placement));
        middles.push(place - position);
    }
    scene.camera =
        Some(Camera { position, target: DVec3::ZERO, focal_length_mm: 50.0, parallel: false });
    (scene, middles)
}

/// Where those of the small spheres are whose pixel shows nothing.
fn absent(across: u32, size: u32, radii: [f64; 2], options: &Options) -> Vec<[f64; 2]> {
    let (scene, middles) = small_spheres(across, size, radii);
    let world = World::load(&scene).unwrap();
    let options = Options { columns: size, rows: size, ..*options };
    let picture = render(&world, &options, &|_| ()).unwrap();
    let pixels: Vec<_> = picture.film.pixels().collect();
    let sheet = Sheet::new(DVec3::ZERO, &world.view_from.view(size, size), (size, size));
    // On an edge it may be taken for a place in either pixel.
    let is_absent = |place: &[f64; 2]| {
        [-1e-9, 1e-9].iter().all(|off| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a pixel")]
            let [column, row] = place.map(|at| (at + off) as usize);
            pixels[row * size as usize + column].coverage <= 0.0
        })
    };
    let places = middles.iter().map(|&middle| {
        let seen = sheet.seen(middle);
        [seen.x / seen.z, seen.y / seen.z]
    });
    places.filter(is_absent).collect()
}

#[test]
fn nothing_small_is_absent() {
    let certified = Options { certify: true, ..Options::default() };
    let radii = [-2.0, 0.0];
    let none: [[f64; 2]; 0] = [];
    assert_eq!(absent(40, 200, radii, &certified), none, "spheres apart");
    // So many in a pixel that nothing is proved of it.
    assert_eq!(absent(40, 8, [-2.3, -2.0], &certified), none, "spheres close together");
    let drawn = crate::Sampling::Stochastic(crate::Rate::Samples(2));
    assert_eq!(absent(40, 200, radii, &Options { sampling: drawn, ..certified }), none, "by lot");
    let sixteen = Options { sampling: crate::Sampling::Grid(4), ..Options::default() };
    let lost = absent(40, 200, radii, &sixteen).len();
    assert!(lost > 400, "16 samples lose {lost} of 1600");
}

#[cfg(feature = "command")]
#[test]
fn proofs_of_scenes_of_the_gallery_hold() {
    for (name, least) in [
        ("wine-glass/wine-glass", 0.5),
        ("solids/solids", 0.05),
        ("cylinders/cylinders", 0.05),
        ("spindles/spindles", 0.05),
        ("gallery/cheese", 0.05),
        ("gallery/gears", 0.05),
        ("gallery/lenses", 0.05),
        ("gallery/pendulums", 0.05),
        ("gallery/planet", 0.05),
        ("gallery/rings", 0.05),
        ("gallery/section", 0.05),
    ] {
        let path = format!("{}/../../scenes/{name}.sdl", env!("CARGO_MANIFEST_DIR"));
        let compiled = compile::compile_path(path.as_ref());
        let world = World::load(compiled.scene.as_ref().unwrap()).unwrap();
        let options = Options { columns: 48, rows: 40, ..Options::default() };
        let (share, _) = check(name, &world, &options, 3 + 2 * more());
        assert!(share > least, "{name}: {share} is proved");
    }
}
