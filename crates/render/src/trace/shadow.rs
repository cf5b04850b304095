//! Light that reaches a surface, and the rays that find out how much of it.

use std::ops::Range;

use glam::DVec3;
use scene::Rgb;

use super::event::{Event, Events, Finder, Quest};
use crate::shade::fresnel::reflectance;
use crate::shade::light::arriving;
use crate::shade::transmission::transmittance;
use crate::world::{MediumId, World, is_fake};

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
}

/// The lamps of a batch of surfaces, and the rays to them that are still to be followed.
#[derive(Debug, Default)]
pub(super) struct Lamps {
    lamps: Vec<Lamp>,
    feelers: Vec<Feeler>,
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

    /// Takes in the lights that shine on a surface, by what it makes of each direction.
    pub(super) fn add(
        &mut self,
        world: &World,
        event: &Event,
        response: impl Fn(DVec3) -> Rgb,
    ) -> Lit {
        let first = self.next();
        let origin = event.before();
        for light in &world.lights {
            let Some(arriving) = arriving(light, origin, event.normal) else { continue };
            let lit = arriving.color * response(arriving.toward);
            if lit.max_element() <= 0.0 {
                continue;
            }
            if light.shadows {
                let (direction, limit) = (arriving.toward, arriving.distance);
                let quest = Quest { origin, direction, limit, medium: event.near };
                self.feelers.push(Feeler { quest, lamp: self.next() });
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
        let width = finder.width();
        let mut events = Events::new();
        while !self.feelers.is_empty() {
            // Those that go on through a clear body stay, in their order.
            let mut left = 0;
            let mut from = 0;
            while from < self.feelers.len() {
                let to = self.feelers.len().min(from + width);
                let quests = &self.feelers[from..to];
                let quest = |number: usize| &quests[number].quest;
                finder.events(&world.whole, to - from, quest, &mut events);
                for at in from..to {
                    let event = events.get(at - from);
                    let mut feeler = self.feelers[at];
                    let open = &mut self.lamps[feeler.lamp as usize].open;
                    if feeler.quest.pass(world, event, open) {
                        self.feelers[left] = feeler;
                        left += 1;
                    }
                }
                from = to;
            }
            self.feelers.truncate(left);
        }
        count
    }
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
            *open *= transmittance(body, event.t);
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
        self.limit -= event.t;
        self.medium = event.far;
        true
    }
}
