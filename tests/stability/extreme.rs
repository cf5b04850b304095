//! Random scenes at the limits of numbers: any size and place, needles and plates, shells, faces that nearly coincide,
//! detail on large bodies, eyes on surfaces and inside of bodies, every index and half-distance.

use glam::DVec3;
use scene::{Attributes, LightKind, Placement, Primitive, Rgb, Scene};

use crate::oracle::author::{Author, Chance, Shape, Site, Writing, clear, opaque};

/// What is extreme about a random scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Sides down to a millionth of the largest.
    Slender,
    /// Copies a gap of 10⁻¹⁵ … 1 apart, or none.
    Contact,
    /// Bodies of sizes from a millionth to a million.
    Sizes,
    /// Shells 10⁻⁹ … 10⁻¹ of a radius thick.
    Shells,
    /// Faces on a lattice, eyes in its planes and on its lines.
    Lattice,
}

impl Kind {
    pub(crate) const ALL: [Self; 5] =
        [Self::Slender, Self::Contact, Self::Sizes, Self::Shells, Self::Lattice];

    /// What the page says.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Slender => "needles and plates, 1 : 1 … 1 : 1e6",
            Self::Contact => "copies of bodies, 0 … 1 apart",
            Self::Sizes => "bodies of 1e-6 … 1e6 on each other",
            Self::Shells => "shells 1e-9 … 1e-1 thick",
            Self::Lattice => "coincident faces, eyes in their planes",
        }
    }
}

/// What is extreme about the scene of a number.
pub(crate) fn kind(seed: u64) -> Kind {
    Kind::ALL[generator(seed).below(5) as usize]
}

fn generator(seed: u64) -> Chance {
    Chance::new(seed ^ 0x0057_ab1e)
}

/// How far off a body of size 1 is still placed to a thousandth of its size, all rounding bounds included.
const HELD: f64 = 1e9;

/// 10 to a random power.
pub(super) fn decade(chance: &mut Chance, low: f64, high: f64) -> f64 {
    libm::exp10(chance.between(low, high))
}

pub(super) fn vector(chance: &mut Chance, low: f64, high: f64) -> DVec3 {
    DVec3::from_array([(); 3].map(|()| chance.between(low, high)))
}

pub(crate) fn direction(chance: &mut Chance) -> DVec3 {
    loop {
        let v = vector(chance, -1.0, 1.0);
        if (0.01..1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}

pub(super) fn primitive(chance: &mut Chance) -> Primitive {
    let all = Primitive::ALL;
    all[chance.below(u32::try_from(all.len()).expect("a few")) as usize]
}

pub(super) fn turn(chance: &mut Chance) -> DVec3 {
    if chance.below(2) == 0 {
        DVec3::from_array([(); 3].map(|()| 90.0 * f64::from(chance.below(4))))
    } else {
        vector(chance, -360.0, 360.0)
    }
}

/// Opaque for the most part; glass, nearly nothing, or what nature does not have.
pub(super) fn look(chance: &mut Chance, clear_share: u32) -> Attributes {
    let color = [(); 3].map(|()| chance.between(0.2, 1.0));
    if chance.below(100) >= clear_share {
        return opaque(color);
    }
    let half_distance = match chance.below(6) {
        0 => 1e-12,
        1 => 1e12,
        _ => decade(chance, -1.0, 2.0),
    };
    let index = match chance.below(10) {
        0 => None,
        1 => Some(1.0 + 1e-12),
        2 => Some(1.0 - 1e-12),
        3 => Some(0.01),
        4 => Some(100.0),
        5 => Some(1.0),
        6 => Some(1.33),
        _ => Some(1.5),
    };
    let rank = chance.below(8);
    let priority = (rank == 0).then(|| i32::try_from(chance.below(3)).expect("a rank") - 1);
    Attributes { priority, ..clear(color, half_distance, index) }
}

/// Where the next body of a scene stands.
pub(crate) fn place(
    kind: Kind,
    chance: &mut Chance,
    bodies: &[(Primitive, Placement)],
) -> (Primitive, Placement) {
    let free = |chance: &mut Chance| Placement {
        scale: vector(chance, 0.4, 1.6),
        rotation_degrees: turn(chance),
        place: vector(chance, -1.2, 1.2),
    };
    let solid = primitive(chance);
    let placement = match kind {
        Kind::Slender => {
            let mut own = free(chance);
            for k in 0..3 {
                if chance.below(2) == 0 {
                    own.scale[k] *= decade(chance, -6.0, 0.0);
                }
            }
            own
        }
        Kind::Contact => {
            let known = bodies.len();
            if known == 0 || chance.below(4) == 0 {
                free(chance)
            } else {
                let (solid, mut other) =
                    bodies[chance.below(u32::try_from(known).expect("a few")) as usize];
                let gap = decade(chance, -15.0, 0.0);
                let axis = chance.below(3) as usize;
                match chance.below(5) {
                    0 => {}
                    1 => other.place[axis] += gap,
                    2 => other.scale *= 1.0 + gap,
                    3 => other.scale[axis] *= 1.0 + gap,
                    _ => {
                        // Face to face.
                        let reach = if solid == Primitive::Block { 2.0 } else { 1.0 };
                        let along = DVec3::AXES[axis] * (other.scale[axis] * (reach + gap));
                        other.place +=
                            other.map().outward(along) - other.map().outward(DVec3::ZERO);
                    }
                }
                return (solid, other);
            }
        }
        Kind::Sizes => {
            let size = decade(chance, -6.0, 6.0);
            let mut own = free(chance);
            own.scale *= size;
            own.place *= size;
            if let Some((_, other)) = bodies.first() {
                // On the surface of the first.
                let at = direction(chance);
                own.place = other.map().outward(at) + own.scale * vector(chance, -1.0, 1.0);
            }
            own
        }
        Kind::Shells => free(chance),
        Kind::Lattice => {
            let mut half = || 0.5 * f64::from(chance.below(4) + 1);
            let scale = match solid {
                Primitive::Block | Primitive::Sphere => DVec3::new(half(), half(), half()),
                _ => {
                    let r = half();
                    DVec3::new(2.0 * half(), r, r)
                }
            };
            let place = DVec3::new(half(), half(), half()) - 1.5;
            let rotation_degrees =
                DVec3::from_array([(); 3].map(|()| 90.0 * f64::from(chance.below(4))));
            Placement { scale, rotation_degrees, place }
        }
    };
    (solid, placement)
}

/// The bodies under operators.
pub(super) fn tree(
    kind: Kind,
    chance: &mut Chance,
    bodies: &[(Primitive, Placement)],
    clear_share: u32,
) -> Vec<Shape> {
    let mut objects = Vec::new();
    let mut current: Option<Shape> = None;
    for &(solid, placement) in bodies {
        let own = Shape::Primitive(solid, placement, look(chance, clear_share));
        let own = if kind == Kind::Shells {
            let thickness = decade(chance, -9.0, -1.0);
            let inner = Placement { scale: placement.scale * (1.0 - thickness), ..placement };
            own.minus(Shape::Primitive(solid, inner, look(chance, clear_share)))
        } else {
            own
        };
        current = Some(match current {
            None => own,
            Some(before) => match chance.below(10) {
                0..4 => before.plus(own),
                4..6 => before.minus(own),
                6 => Shape::Intersection(vec![before, own]),
                _ => {
                    objects.push(before);
                    own
                }
            },
        });
    }
    objects.extend(current);
    objects
}

/// A special point of a body: apex, corner, edge, pole, centre of a face.
pub(super) fn special(chance: &mut Chance, solid: Primitive, placement: &Placement) -> DVec3 {
    let mut sign = || f64::from(chance.below(3)) - 1.0;
    let local = match solid {
        Primitive::Block => DVec3::new(sign(), sign(), sign()),
        Primitive::Sphere => DVec3::AXES[0] * sign(),
        _ => DVec3::new(0.5 * (sign() + 1.0), sign(), 0.0),
    };
    placement.map().outward(local)
}

/// Where the eye of a scene stands, and what it looks at.
pub(super) fn view(
    kind: Kind,
    chance: &mut Chance,
    bodies: &[(Primitive, Placement)],
) -> (DVec3, DVec3, f64) {
    let (solid, seen) = bodies[chance.below(u32::try_from(bodies.len()).expect("a few")) as usize];
    let size = seen.scale.abs().max_element();
    let target = special(chance, solid, &seen);
    let (far, focal) = match chance.below(6) {
        0 => (0.0, 50.0),
        1 => {
            let far = decade(chance, 1.0, 5.0);
            (far * size, 24.0 * far)
        }
        2 => (decade(chance, -3.0, 0.0) * size, 24.0),
        _ => (chance.between(2.0, 5.0) * size, chance.between(24.0, 80.0)),
    };
    let away = match chance.below(4) {
        // In a plane, or along a line, of the body.
        0 => (seen.map().outward(DVec3::AXES[chance.below(3) as usize])
            - seen.map().outward(DVec3::ZERO))
        .normalize(),
        1 => {
            let toward = DVec3::new(1.0, f64::from(chance.below(2)), 0.0);
            (seen.map().outward(toward) - seen.map().outward(DVec3::ZERO)).normalize()
        }
        _ => direction(chance),
    };
    if far <= 0.0 {
        // On the surface, or in the midst.
        let other = if chance.below(2) == 0 { target } else { seen.place };
        return (other, other + size * away, focal);
    }
    let target = if kind == Kind::Lattice || chance.below(2) == 0 {
        target
    } else {
        target + 0.3 * size * direction(chance)
    };
    (target + far * away, target, focal)
}

/// The scene of a number.
pub(crate) fn scene(seed: u64) -> (Kind, Scene) {
    let mut chance = generator(seed);
    let kind = Kind::ALL[chance.below(5) as usize];
    let clear_share = [0, 0, 40, 80][chance.below(4) as usize];
    let scale = if chance.below(2) == 0 { 1.0 } else { decade(&mut chance, -12.0, 12.0) };
    let far = if chance.below(3) > 0 { 0.0 } else { decade(&mut chance, 0.0, 9.0) };
    let form = if chance.below(5) == 0 { Writing::Instances } else { Writing::Plain };
    let mut bodies = Vec::new();
    for _ in 0..=chance.below(6) {
        let next = place(kind, &mut chance, &bodies);
        bodies.push(next);
    }
    let (eye, target, focal) = view(kind, &mut chance, &bodies);
    // No farther than numbers can hold the size of the smallest body.
    let least = bodies.iter().map(|body| body.1.scale.abs().max_element()).fold(1.0, f64::min);
    let offset = scale * far.min(least * HELD);
    let site = Site { scale, offset, form };
    let mut author = Author::new(site, eye, target);
    for shape in tree(kind, &mut chance, &bodies, clear_share) {
        author.object(&shape);
    }
    let near = (eye - target).length() + bodies[0].1.scale.max_element();
    for _ in 0..=chance.below(2) {
        let at = eye + near * direction(&mut chance);
        let light = match chance.below(3) {
            0 => LightKind::Beam { at, toward: target },
            _ => LightKind::Point { at },
        };
        author.light(light, Rgb::splat(0.5));
    }
    let mut scene = author.finish();
    if let Some(camera) = &mut scene.camera {
        camera.focal_length_mm = focal;
    }
    (kind, scene)
}
