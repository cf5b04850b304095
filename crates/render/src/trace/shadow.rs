//! Light that reaches a surface, and the rays that find out how much of it.

use std::ops::Range;

use glam::DVec2;
use scene::Rgb;

use super::event::{Event, Events, Finder, Quest};
use crate::sampling::sequence::Draw;
use crate::shade::fresnel::reflectance;
use crate::shade::light::{Arriving, arriving};
use crate::shade::transmission::transmittance;
use crate::world::region::{Beam, Region};
use crate::world::{MediumId, World, is_fake};

/// Fewer rays to a light do not pay for finding out what they can meet.
const LEAST_SHAFT: usize = 64;

/// Some rays to a light do not pay for finding out that they can meet more.
const MOST_PARTS: usize = 64;

/// The lamps that light one surface in one way: a piece of [`Lamps`].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Lit {
    first: u32,
    end: u32,
}

/// What one light gives to one surface where nothing stands in between, and the share that gets through.
#[derive(Clone, Copy, Debug)]
struct Lamp {
    light: Rgb,
    open: Rgb,
}

/// A ray on its way to a light.
#[derive(Clone, Copy, Debug)]
struct Feeler {
    quest: Quest,
    lamp: u32,
    /// Which of the scene's lights.
    light: usize,
}

/// The lamps of a batch of surfaces, and the rays to them that are still to be followed.
#[derive(Debug)]
pub(super) struct Lamps {
    lamps: Vec<Lamp>,
    feelers: Vec<Feeler>,
    /// What the ray chooses whose surface is lit: points of lights that have an extent.
    pub(super) draw: Draw,
}

impl Default for Lamps {
    fn default() -> Self {
        Self { lamps: Vec::new(), feelers: Vec::new(), draw: Draw::MIDDLE }
    }
}

impl Lamps {
    pub(super) fn clear(&mut self) {
        self.lamps.clear();
        self.feelers.clear();
    }

    /// The light that came through, in the order of the scene's lights.
    pub(super) fn sum(&self, lit: Lit) -> Rgb {
        let range: Range<usize> = lit.first as usize..lit.end as usize;
        self.lamps[range].iter().fold(Rgb::ZERO, |sum, lamp| sum + lamp.light * lamp.open)
    }

    /// Takes in the lights that shine on a surface, by what it makes of a unit of each.
    pub(super) fn add(
        &mut self,
        world: &World,
        event: &Event,
        response: impl Fn(&Arriving) -> Rgb,
    ) -> Lit {
        let first = self.next();
        let origin = event.before();
        for (number, light) in world.lights.iter().enumerate() {
            // Most lights are points.
            let moved;
            let light = if light.radius > 0.0 {
                let pair = u32::try_from(number).expect("a scene has few lights");
                moved = light.seen_at(origin, self.draw.pair(pair));
                &moved
            } else {
                light
            };
            let Some(arriving) = arriving(light, origin, event.normal) else { continue };
            let lit = arriving.color * response(&arriving);
            if lit.max_element() <= 0.0 {
                continue;
            }
            if light.shadows {
                let (direction, limit) = (arriving.toward, arriving.distance);
                let (start, medium) = (event.start(), event.near);
                let quest = Quest { origin, direction, start, limit, medium };
                self.feelers.push(Feeler { quest, lamp: self.next(), light: number });
            }
            self.lamps.push(Lamp { light: lit, open: Rgb::ONE });
        }
        Lit { first, end: self.next() }
    }

    fn next(&self) -> u32 {
        u32::try_from(self.lamps.len()).expect("a batch has few surfaces")
    }

    /// Follows all rays to lights and returns how many there were.
    pub(super) fn follow(&mut self, finder: &mut Finder<'_>) -> u64 {
        let count = self.feelers.len() as u64;
        let world = finder.world();
        if world.lights.len() > 1 {
            // Rays to one light lie close.
            self.feelers.sort_by_key(|feeler| feeler.light);
        }
        let (mut done, mut left) = (0, 0);
        while done < self.feelers.len() {
            let light = self.feelers[done].light;
            let rays = self.feelers[done..].iter().take_while(|feeler| feeler.light == light);
            let end = done + rays.count();
            finder.at_light(light);
            // Rays to a light that has an extent end in many places.
            let beam = if world.lights[light].radius > 0.0 {
                None
            } else {
                shaft(&self.feelers[done..end])
            };
            let region = beam.and_then(|beam| world.reached(&beam, MOST_PARTS));
            self.pass(finder, region.as_ref().unwrap_or(&world.whole), done..end, &mut left);
            done = end;
        }
        self.feelers.truncate(left);
        // Behind a surface a ray starts a rounding bound aside, each time: no longer sure to be in the shaft.
        while !self.feelers.is_empty() {
            let mut left = 0;
            self.pass(finder, &world.whole, 0..self.feelers.len(), &mut left);
            self.feelers.truncate(left);
        }
        count
    }

    /// Follows some rays to the next surface. Those that go on behind it move to `left` and on, in their order.
    fn pass(
        &mut self,
        finder: &mut Finder<'_>,
        region: &Region,
        range: Range<usize>,
        left: &mut usize,
    ) {
        let world = finder.world();
        let width = finder.width();
        let mut events = Events::new();
        for from in range.clone().step_by(width) {
            let to = range.end.min(from + width);
            let quests = &self.feelers[from..to];
            finder.events(region, to - from, |number| &quests[number].quest, &mut events);
            for at in from..to {
                let mut feeler = self.feelers[at];
                let open = &mut self.lamps[feeler.lamp as usize].open;
                if feeler.quest.pass(world, events.get(at - from), open) {
                    self.feelers[*left] = feeler;
                    *left += 1;
                }
            }
        }
    }
}

/// A beam from a light that holds all rays to it, if they come from one side.
fn shaft(feelers: &[Feeler]) -> Option<Beam> {
    let first = &feelers.first()?.quest;
    if feelers.len() < LEAST_SHAFT || !first.limit.is_finite() {
        return None;
    }
    let light = first.origin + first.limit * first.direction;
    let middle = first.direction;
    let (right, up) = middle.any_orthonormal_pair();
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for feeler in feelers {
        let toward = feeler.quest.direction;
        let along = toward.dot(middle);
        if along < 0.1 {
            return None;
        }
        let place = DVec2::new(toward.dot(right), toward.dot(up)) / along;
        (low, high) = (low.min(place), high.max(place));
    }
    // A little more on each side for rounding.
    let slack = 1e-9 + 1e-9 * (high - low);
    let (low, high) = (low - slack, high + slack);
    let corner = |x: f64, y: f64| -(middle + x * right + y * up);
    let corners = [
        corner(low.x, low.y),
        corner(high.x, low.y),
        corner(high.x, high.y),
        corner(low.x, high.y),
    ];
    Some(Beam::new(light, corners))
}

impl Quest {
    /// Takes what stands in the way off the `open` share; true if the ray goes on behind it.
    fn pass(&mut self, world: &World, event: Option<&Event>, open: &mut Rgb) -> bool {
        let Some(event) = event else {
            // A light inside a body: the last stretch absorbs, too.
            if let Some(body) = world.medium(self.medium)
                && self.limit.is_finite()
                && self.medium != MediumId::OPAQUE
            {
                *open *= transmittance(body, self.limit);
            }
            return false;
        };
        if event.far == MediumId::OPAQUE {
            *open = Rgb::ZERO;
            return false;
        }
        let leaf = &world.leaves[event.owner.leaf as usize];
        let optics = &world.surfaces[leaf.surface as usize];
        if let Some(body) = world.medium(event.near) {
            *open *= transmittance(body, event.way());
        }
        let reflects = if is_fake(optics) {
            0.0
        } else {
            let index = |medium| world.medium(medium).map_or(1.0, |medium| medium.index);
            reflectance(index(event.near), index(event.far), event.cosine).0
        };
        *open *= optics.shininess * (1.0 - reflects);
        if open.max_element() <= 0.0 {
            *open = Rgb::ZERO;
            return false;
        }
        self.origin = event.behind();
        self.start = event.start();
        self.limit -= event.t;
        self.medium = event.far;
        true
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// Rays from `points` to a light.
    fn feelers(points: &[DVec3], light: DVec3) -> Vec<Feeler> {
        let feeler = |&origin: &DVec3| {
            let limit = (light - origin).length();
            let direction = (light - origin) / limit;
            let quest = Quest { origin, direction, start: 0.0, limit, medium: MediumId::AIR };
            Feeler { quest, lamp: 0, light: 0 }
        };
        points.iter().map(feeler).collect()
    }

    #[test]
    fn a_shaft_holds_all_its_rays() {
        let plane: Vec<DVec3> =
            (0..100_u32).map(|k| DVec3::new(f64::from(k % 10), -3.0, f64::from(k / 10))).collect();
        let light = DVec3::new(2.0, 7.0, -1.0);
        let rays = feelers(&plane, light);
        let beam = shaft(&rays).expect("from one side");
        for ray in &rays {
            for share in [0.0, 0.3, 0.9] {
                let point = ray.quest.origin + share * ray.quest.limit * ray.quest.direction;
                let speck = scene::Bounds::about(point, DVec3::splat(1e-9));
                assert!(!beam.misses(&speck, 0.0), "{point}");
            }
        }
        let beside = scene::Bounds::about(DVec3::new(-4.0, 0.0, 0.0), DVec3::ONE);
        assert!(beam.misses(&beside, 0.0), "what is beside it is left out");
    }

    #[test]
    fn a_light_among_its_surfaces_has_no_shaft() {
        let around: Vec<DVec3> = (0..100_u32)
            .map(|k| DVec3::new(f64::from(k % 10) - 4.5, 0.0, f64::from(k / 10) - 4.5))
            .collect();
        assert!(shaft(&feelers(&around, DVec3::new(0.0, 0.1, 0.0))).is_none());
        assert!(shaft(&feelers(&around[..8], DVec3::new(0.0, 9.0, 0.0))).is_none(), "few rays");
    }
}
