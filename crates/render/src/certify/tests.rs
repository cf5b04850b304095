//! What is proved, beside dense grids of rays.

use glam::DVec3;
use scene::form::FORMS;
use scene::{
    AttributesId, Camera, Form, Frame as SolidFrame, FrameId, Node, Placement, Primitive, Scene,
    Solid,
};

use super::quadtree::{Plan, Proof, Prover};
use super::sheet::Sheet;
use super::verdict::Surface;
use crate::options::{Accel, Options};
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
        let turn = if lattice { 90.0 * f64::from(numbers.below(4)) } else { 180.0 * numbers.signed() };
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
                Proof::Open => {}
                Proof::Parts { first, count } => {
                    let parts = &plan.parts[first as usize..][..count as usize];
                    let all: f64 = parts.iter().map(|part| 4.0 * part.cell.half * part.cell.half).sum();
                    assert!((all - 1.0).abs() < 1e-12, "{name}: parts fill a pixel: {all}");
                    proved.extend(parts.iter().filter_map(|part| {
                        Some((part.cell.middle, part.cell.half, part.proved?))
                    }));
                }
            }
        }
        for (middle, half, shown) in proved {
            area += 4.0 * half * half;
            let side = if half < 0.5 { 3 } else { side };
            for k in 0..side * side {
                // A hair within the edges.
                let step = |k: u32| (2.0 * f64::from(k) / f64::from(side - 1) - 1.0) * half * (1.0 - 1e-6);
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

#[test]
fn proofs_of_random_scenes_hold() {
    let mut numbers = Numbers(0x9e37_79b9_7f4a_7c15);
    let (mut area, mut rays, count) = (0.0, 0, 300);
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
