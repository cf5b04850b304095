//! The tree of rays below a primary ray (Whitted, "An Improved Illumination Model for Shaded Display", 1980).

use glam::DVec3;
use scene::{Index, Optics, Rgb};

use super::event::{Event, Finder};
use crate::options::Accel;
use crate::shade::fog::clear_share;
use crate::shade::fresnel::{reflectance, reflected, refracted};
use crate::shade::light::arriving;
use crate::shade::microfacet::lobe;
use crate::shade::opaque::{Opaque, spark};
use crate::shade::paint::painted;
use crate::shade::transmission::transmittance;
use crate::stats::RayStats;
use crate::world::region::Region;
use crate::world::{MediumId, World};

/// What a ray sees. Where it sees the background straight, `color` lacks it and `coverage` says so:
/// `color + (1 − coverage) · background` is the whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Seen {
    pub(crate) color: Rgb,
    pub(crate) coverage: f64,
}

impl Seen {
    const BACKGROUND: Self = Self { color: Rgb::ZERO, coverage: 0.0 };
    const DARK: Self = Self { color: Rgb::ZERO, coverage: 1.0 };

    pub(crate) fn over(&self, background: Rgb) -> Rgb {
        self.color + (1.0 - self.coverage) * background
    }

    /// Seen through a filter. Coverage takes the mean; what tints the background beyond that goes into the colour.
    fn filtered(self, share: Rgb, background: Rgb) -> Self {
        let mean = (share.x + share.y + share.z) / 3.0;
        let open = 1.0 - self.coverage;
        Self {
            color: share * self.color + open * (share - mean) * background,
            coverage: 1.0 - mean * open,
        }
    }

    fn plus(self, light: Rgb) -> Self {
        Self { color: self.color + light, ..self }
    }
}

/// Where a ray of the tree starts and what it may still add.
#[derive(Clone, Copy)]
struct Branch {
    origin: DVec3,
    direction: DVec3,
    medium: MediumId,
    /// The largest share of a channel that can reach the eye.
    weight: f64,
    depth: u32,
}

/// Follows rays through one world; each thread has its own.
pub(crate) struct Tracer<'w> {
    finder: Finder<'w>,
    depth_limit: u32,
    min_weight: f64,
    eye_medium: MediumId,
    pub(crate) stats: RayStats,
}

impl<'w> Tracer<'w> {
    pub(crate) fn new(world: &'w World, accel: Accel, depth_limit: u32, min_weight: f64) -> Self {
        let mut finder = Finder::new(world, accel);
        let eye_medium = finder.medium_at(world.eye);
        Self { finder, depth_limit, min_weight, eye_medium, stats: RayStats::default() }
    }

    /// What is seen along a unit direction from the eye, where rays meet nothing outside of `region`.
    pub(crate) fn primary(&mut self, region: &Region, direction: DVec3) -> Seen {
        self.stats.primary += 1;
        let origin = self.finder.world().eye;
        let medium = self.eye_medium;
        self.trace(region, &Branch { origin, direction, medium, weight: 1.0, depth: 0 })
    }

    fn trace(&mut self, region: &Region, ray: &Branch) -> Seen {
        let world = self.finder.world();
        let Some(event) =
            self.finder.event(region, ray.origin, ray.direction, f64::INFINITY, ray.medium)
        else {
            return Seen::BACKGROUND;
        };
        if event.near == MediumId::AIR {
            let Some(half_distance) = world.fog_half_distance else {
                return self.surface(ray, &event, ray.weight);
            };
            let clear = clear_share(half_distance, event.t);
            let seen = self.surface(ray, &event, ray.weight * clear);
            return Seen { color: clear * seen.color, coverage: clear * seen.coverage };
        }
        let Some(medium) = world.medium(event.near) else {
            return self.surface(ray, &event, ray.weight);
        };
        let share = transmittance(medium, event.t);
        let seen = self.surface(ray, &event, ray.weight * share.max_element());
        seen.filtered(share, world.background)
    }

    /// What leaves the surface toward the ray's origin.
    fn surface(&mut self, ray: &Branch, event: &Event, weight: f64) -> Seen {
        let world = self.finder.world();
        let leaf = &world.leaves[event.owner.leaf as usize];
        let optics = &world.surfaces[leaf.surface as usize];
        let color = painted(world, &self.finder.seeker.scopes, event, optics.color);
        if event.far == MediumId::OPAQUE {
            self.opaque(ray, event, optics, color, weight)
        } else {
            self.clear(ray, event, optics, color, weight)
        }
    }

    fn opaque(
        &mut self,
        ray: &Branch,
        event: &Event,
        optics: &Optics,
        color: Rgb,
        weight: f64,
    ) -> Seen {
        let world = self.finder.world();
        let surface = Opaque::new(optics, color, event.normal, ray.direction, event.cosine);
        let mut light = surface.ambient() * world.ambient;
        light += self.direct(event, |toward| surface.lit(toward));
        if optics.smoothness <= 0.0 && optics.shininess > 0.0 {
            let share = surface.gloss.at(event.cosine);
            let mirrored = self.child(&Branch {
                origin: event.before(),
                direction: reflected(ray.direction, event.normal, event.cosine),
                medium: event.near,
                weight: weight * share.max_element(),
                depth: ray.depth + 1,
            });
            light += share * mirrored.over(world.background);
        }
        Seen { color: light, coverage: 1.0 }
    }

    fn clear(
        &mut self,
        ray: &Branch,
        event: &Event,
        optics: &Optics,
        color: Rgb,
        weight: f64,
    ) -> Seen {
        let world = self.finder.world();
        let share = optics.shininess;
        let mut light = Rgb::ZERO;
        if share < 1.0 {
            let body = (1.0 - share) * color;
            light += body * world.ambient;
            light += self.direct(event, |toward| body * event.normal.dot(toward));
        }
        if share <= 0.0 {
            return Seen { color: light, coverage: 1.0 };
        }
        let index = |medium| world.medium(medium).map_or(1.0, |medium| medium.index);
        let (n1, n2) = (index(event.near), index(event.far));
        let straight = is_fake(optics);
        let (reflects, cosine) =
            if straight { (0.0, event.cosine) } else { reflectance(n1, n2, event.cosine) };
        if reflects > 0.0 {
            light +=
                share * self.reflection(ray, event, optics, (n1, n2, reflects), weight * share);
        }
        let through = share * (1.0 - reflects);
        if through <= 0.0 {
            return Seen { color: light, coverage: 1.0 };
        }
        let behind = self.child(&Branch {
            origin: event.behind(),
            direction: if straight {
                ray.direction
            } else {
                refracted(ray.direction, event.normal, n1 / n2, event.cosine, cosine)
            },
            medium: event.far,
            weight: weight * through,
            depth: ray.depth + 1,
        });
        if straight {
            behind.filtered(Rgb::splat(through), world.background).plus(light)
        } else {
            let color = light + through * behind.over(world.background);
            Seen { color, coverage: 1.0 }
        }
    }

    /// The mirrored light of a clear surface: traced if it is smoothest, else the highlights of the lights.
    fn reflection(
        &mut self,
        ray: &Branch,
        event: &Event,
        optics: &Optics,
        (n1, n2, reflects): (f64, f64, f64),
        weight: f64,
    ) -> Rgb {
        let world = self.finder.world();
        let (view, m) = (-ray.direction, optics.smoothness);
        if m > 0.0 {
            let at_normal = reflectance(n1, n2, 1.0).0;
            let highlights = self.direct(event, |toward| {
                let half = view + toward;
                let vh = view.dot(half) / half.length();
                let facets = std::f64::consts::PI * lobe(event.normal, view, toward, m);
                Rgb::splat(reflectance(n1, n2, vh).0 * facets)
            });
            return highlights + at_normal * world.ambient;
        }
        let sparks =
            self.direct(event, |toward| Rgb::splat(reflects * spark(view, event.normal, toward)));
        let mirrored = self.child(&Branch {
            origin: event.before(),
            direction: reflected(ray.direction, event.normal, event.cosine),
            medium: event.near,
            weight: weight * reflects,
            depth: ray.depth + 1,
        });
        sparks + reflects * mirrored.over(world.background)
    }

    /// A branch, unless it is too deep or too faint; what is cut is counted.
    fn child(&mut self, ray: &Branch) -> Seen {
        if ray.depth > self.depth_limit {
            self.stats.cut_by_depth += 1;
            self.stats.weight_cut_by_depth += ray.weight;
            return Seen::BACKGROUND;
        }
        if ray.weight < self.min_weight {
            self.stats.cut_by_weight += 1;
            self.stats.weight_cut_by_weight += ray.weight;
            return Seen::DARK;
        }
        self.stats.secondary += 1;
        self.trace(&self.finder.world().whole, ray)
    }

    /// The light of all lights that reaches the surface, by what the surface makes of each direction.
    fn direct(&mut self, event: &Event, response: impl Fn(DVec3) -> Rgb) -> Rgb {
        let world = self.finder.world();
        let origin = event.before();
        let mut sum = Rgb::ZERO;
        for light in &world.lights {
            let Some(arriving) = arriving(light, origin) else { continue };
            if event.normal.dot(arriving.toward) <= 0.0 {
                continue;
            }
            let lit = arriving.color * response(arriving.toward);
            if lit.max_element() <= 0.0 {
                continue;
            }
            let open = if light.shadows {
                self.open_share(origin, arriving.toward, arriving.distance, event.near)
            } else {
                Rgb::ONE
            };
            sum += lit * open;
        }
        sum
    }

    /// The share of light that comes straight through whatever stands in the way.
    fn open_share(
        &mut self,
        mut origin: DVec3,
        direction: DVec3,
        mut distance: f64,
        mut medium: MediumId,
    ) -> Rgb {
        self.stats.shadow += 1;
        let world = self.finder.world();
        let mut share = Rgb::ONE;
        while let Some(event) = self.finder.event(&world.whole, origin, direction, distance, medium)
        {
            if event.far == MediumId::OPAQUE {
                return Rgb::ZERO;
            }
            let leaf = &world.leaves[event.owner.leaf as usize];
            let optics = &world.surfaces[leaf.surface as usize];
            if let Some(body) = world.medium(event.near) {
                share *= transmittance(body, event.t);
            }
            let reflects = if is_fake(optics) {
                0.0
            } else {
                let index = |medium| world.medium(medium).map_or(1.0, |medium| medium.index);
                reflectance(index(event.near), index(event.far), event.cosine).0
            };
            share *= optics.shininess * (1.0 - reflects);
            if share.max_element() <= 0.0 {
                return Rgb::ZERO;
            }
            origin = event.behind();
            distance -= event.t;
            medium = event.far;
        }
        // A light inside a body: the last stretch absorbs, too.
        match world.medium(medium) {
            Some(body) if distance.is_finite() && medium != MediumId::OPAQUE => {
                share * transmittance(body, distance)
            }
            _ => share,
        }
    }
}

fn is_fake(optics: &Optics) -> bool {
    optics.transparency.is_some_and(|transparency| transparency.index == Index::Fake)
}
