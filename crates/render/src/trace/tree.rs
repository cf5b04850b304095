//! The tree of rays below a primary ray (Whitted, "An Improved Illumination Model for Shaded Display", 1980), a
//! generation of a batch of rays at a time: rays that lie beside each other are sought together.

use glam::DVec3;
use scene::{Optics, Rgb, Sight};

use super::event::{Event, Events, Finder, Quest};
use super::record::{Behind, Between, Beyond, Clear, Gloss, Met, Mirrored, Record, Seen, Sprung};
use super::shadow::{Lamps, Lit};
use crate::options::Accel;
use crate::sampling::sequence::Draw;
use crate::shade::clear::RoughClear;
use crate::shade::facet::{Glint, glint};
use crate::shade::fog::clear_share;
use crate::shade::footprint::Cone;
use crate::shade::fresnel::{reflectance, reflected, refracted};
use crate::shade::light::may_show;
use crate::shade::opaque::Opaque;
use crate::shade::paint::painted;
use crate::shade::relief::{Facing, kept_above};
use crate::shade::spark::Spark;
use crate::shade::transmission::transmittance;
use crate::stats::RayStats;
use crate::world::region::Region;
use crate::world::{MediumId, World, is_fake};

/// Rays followed together: enough to fill lanes, and few enough that what is known of them stays near the processor.
pub(crate) const BATCH: usize = 256;

/// Where a ray of the tree starts and what it may still add.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Branch {
    quest: Quest,
    /// The largest share of a channel that can reach the eye.
    weight: f64,
    depth: u32,
    cone: Cone,
    /// What it chooses.
    draw: Draw,
}

/// What is known of one generation of a batch.
#[derive(Debug, Default)]
struct Generation {
    records: Vec<Record>,
    clears: Vec<Clear>,
    lamps: Lamps,
    /// Rays of the next generation, and what they see: first those that were mirrored.
    sprung: Vec<Branch>,
    /// Rays of the next generation that go through surfaces, until they are put behind the others: what goes the same
    /// way at neighbours stays beside each other.
    through: Vec<Branch>,
    seen: Vec<Seen>,
}

/// Follows rays through one world; each thread has its own.
pub(crate) struct Tracer<'w> {
    finder: Finder<'w>,
    depth_limit: u32,
    min_weight: f64,
    eye_medium: MediumId,
    /// The objects that rays from the eye met first, counted from 1, or 0, where they are asked for.
    pub(crate) firsts: Option<Vec<usize>>,
    /// What is brighter than white is shown as white.
    clamp: bool,
    /// Memory of generations that are done.
    spare: Vec<Generation>,
    pub(crate) stats: RayStats,
}

impl<'w> Tracer<'w> {
    pub(crate) fn new(world: &'w World, accel: Accel, depth_limit: u32, min_weight: f64) -> Self {
        let mut finder = Finder::new(world, accel);
        let eye_medium = finder.medium_at(world.eye);
        let (firsts, clamp) = (None, false);
        let (spare, stats) = (Vec::new(), RayStats::default());
        Self { finder, depth_limit, min_weight, eye_medium, firsts, clamp, spare, stats }
    }

    /// For samples that are clamped to display white, or not.
    pub(crate) fn clamped(self, clamp: bool) -> Self {
        Self { clamp, ..self }
    }

    /// A ray from the eye, or from beside it, the cone it stands for, and what it chooses.
    pub(crate) fn primary(&mut self, sight: Sight, cone: Cone, draw: Draw) -> Branch {
        let quest = self.finder.quest(sight, self.eye_medium);
        Branch { quest, weight: 1.0, depth: 0, cone, draw }
    }

    /// Appends to `seen` what is seen along each of a batch of rays from the eye, which meet nothing outside of `region`.
    pub(crate) fn look(&mut self, region: &Region, rays: &[Branch], seen: &mut Vec<Seen>) {
        self.stats.primary += rays.len() as u64;
        self.follow(region, rays, seen);
    }

    fn follow(&mut self, region: &Region, rays: &[Branch], seen: &mut Vec<Seen>) {
        let world = self.finder.world();
        let mut generation = self.spare.pop().unwrap_or_default();
        generation.clear();
        let width = self.finder.width();
        self.finder.at_level(rays.first().map_or(0, |ray| ray.depth));
        let mut events = Events::new();
        for rays in rays.chunks(width) {
            self.finder.events(region, rays.len(), |number| &rays[number].quest, &mut events);
            for (number, ray) in rays.iter().enumerate() {
                if ray.depth == 0 {
                    self.note_first(events.get(number));
                }
                let record = match events.get(number) {
                    Some(event) => self.met(&mut generation, ray, event),
                    None => Record::Missed,
                };
                generation.records.push(record);
            }
        }
        let Generation { records, clears, lamps, sprung, through, seen: beyond } = &mut generation;
        self.stats.shadow += lamps.follow(&mut self.finder);
        let mirrored = sprung.len();
        sprung.append(through);
        self.stats.secondary += sprung.len() as u64;
        for batch in sprung.chunks(BATCH) {
            self.follow(&world.whole, batch, beyond);
        }
        let (mirrored, through) = beyond.split_at(mirrored);
        let beyond = Beyond { mirrored, through };
        seen.extend(records.iter().map(|record| record.seen(world, lamps, clears, beyond)));
        self.spare.push(generation);
    }

    /// Keeps the object that a ray from the eye meets, if it is asked for.
    #[inline(always)]
    fn note_first(&mut self, event: Option<&Event>) {
        let Some(firsts) = &mut self.firsts else { return };
        let world = self.finder.world();
        firsts.push(event.map_or(0, |event| {
            let leaf = &world.leaves[event.owner.leaf as usize];
            world.object_of(self.finder.scopes().get(event.owner.scope).rank + leaf.rank)
        }));
    }

    #[inline(always)]
    fn met(&mut self, generation: &mut Generation, ray: &Branch, event: &Event) -> Record {
        let world = self.finder.world();
        let (between, clear) = if event.near == MediumId::AIR {
            match world.fog_half_distance {
                Some(half_distance) => {
                    let clear = clear_share(half_distance, event.way());
                    (Between::Fog(clear), clear)
                }
                None => (Between::Nothing, 1.0),
            }
        } else {
            match world.medium(event.near) {
                Some(medium) => {
                    let share = transmittance(medium, event.way());
                    (Between::Body(share), share.max_element())
                }
                None => (Between::Nothing, 1.0),
            }
        };
        let leaf = &world.leaves[event.owner.leaf as usize];
        let optics = &world.surfaces[leaf.surface as usize];
        let Branch { quest: Quest { direction, .. }, cone, .. } = *ray;
        generation.lamps.draw = ray.draw;
        let painted = painted(world, self.finder.scopes(), event, direction, cone, optics.color);
        let mut surface = Surface {
            tracer: self,
            generation,
            world,
            ray,
            event,
            optics,
            color: painted.color,
            raised: painted.raised,
            turned: None,
            slope: roughened(optics.smoothness, painted.roughening),
            weight: ray.weight * clear,
        };
        let met = if event.far == MediumId::OPAQUE { surface.opaque() } else { surface.clear() };
        Record::Met(Met { between, ..met })
    }
}

impl Generation {
    fn clear(&mut self) {
        self.records.clear();
        self.clears.clear();
        self.lamps.clear();
        self.sprung.clear();
        self.through.clear();
        self.seen.clear();
    }
}

/// Where a ray goes from a surface.
#[derive(Clone, Copy, Debug)]
enum Way {
    Mirrored,
    /// Through it, and turned by `bend` times as much as its normal turns.
    Through {
        bend: f64,
    },
}

impl Way {
    /// How much of a turn of the normal the ray turns.
    fn bend(self) -> f64 {
        match self {
            Self::Mirrored => 2.0,
            Self::Through { bend } => bend,
        }
    }
}

/// The slope of facets on a relief, of which a ray takes in slopes with the variance `by`. A mirror stays one.
fn roughened(slope: f64, by: f64) -> f64 {
    if slope > 0.0 && by > 0.0 {
        let rough = (slope * slope + by).sqrt();
        if rough < 1.0 { rough } else { 1.0 }
    } else {
        slope
    }
}

/// A surface that a ray met, and where what is found of it goes.
struct Surface<'t, 'w> {
    tracer: &'t mut Tracer<'w>,
    generation: &'t mut Generation,
    world: &'w World,
    ray: &'t Branch,
    event: &'t Event,
    optics: &'w Optics,
    color: Rgb,
    /// The surface with its relief, if it has one: what is lit and what is seen goes by it, and rays start by the event.
    raised: Option<Facing>,
    /// By how much the normal turns over what the ray takes in, once that was asked.
    turned: Option<f64>,
    /// Of the facets; 0 is a mirror.
    slope: f64,
    weight: f64,
}

impl Surface<'_, '_> {
    #[inline(always)]
    fn facing(&self) -> Facing {
        match self.raised {
            Some(facing) => facing,
            None => Facing::of(self.event),
        }
    }

    /// Ambient and direct light that a matte body of a colour throws back.
    #[inline(always)]
    fn matte(&mut self, body: Rgb) -> (Rgb, Lit) {
        let (world, normal) = (self.world, self.facing().normal);
        let lamps = &mut self.generation.lamps;
        let direct = lamps.add(world, self.event, |light| body * normal.dot(light.toward));
        (body * world.ambient, direct)
    }

    fn opaque(&mut self) -> Met {
        let (world, event, optics) = (self.world, self.event, self.optics);
        if optics.shininess <= 0.0 {
            let (ambient, direct) = self.matte(self.color);
            return Met { between: Between::Nothing, ambient, direct, mirrored: None, clear: None };
        }
        let (direction, Facing { normal, cosine }) = (self.ray.quest.direction, self.facing());
        let rougher;
        let optics = if self.slope > optics.smoothness {
            rougher = Optics { smoothness: self.slope, ..optics.clone() };
            &rougher
        } else {
            optics
        };
        let surface = Opaque::new(optics, self.color, normal, direction, cosine);
        let is_mirror = optics.smoothness <= 0.0;
        let is_glossy = world.glossy && !is_mirror;
        let ambient = if is_glossy { surface.body_ambient() } else { surface.ambient() };
        let share = surface.gloss.at(cosine);
        let direct = if is_mirror {
            let spark = self.spark();
            self.generation.lamps.add(world, event, |light| {
                surface.lit(light.toward) + spark.shine(-direction, normal, light, share)
            })
        } else {
            self.generation.lamps.add(world, event, |light| surface.lit(light.toward))
        };
        let mirrored = if is_mirror {
            Some((self.mirrored(), share))
        } else if is_glossy {
            let glint = self.glint(optics.smoothness);
            glint.map(|(toward, glint)| (toward, surface.gloss.at(glint.cosine) * glint.share))
        } else {
            None
        };
        let mirrored = mirrored.map(|(toward, share)| {
            let ray = self.mirror(toward, self.weight * share.max_element());
            Mirrored { share, ray }
        });
        let ambient = ambient * world.ambient;
        Met { between: Between::Nothing, ambient, direct, mirrored, clear: None }
    }

    fn clear(&mut self) -> Met {
        let share = self.optics.shininess;
        let (ambient, direct) = if share < 1.0 {
            self.matte((1.0 - share) * self.color)
        } else {
            (Rgb::ZERO, Lit::default())
        };
        let clear = (share > 0.0).then(|| {
            let clear = self.passage(share);
            let clears = &mut self.generation.clears;
            clears.push(clear);
            u32::try_from(clears.len() - 1).expect("a batch has few surfaces")
        });
        Met { between: Between::Nothing, ambient, direct, mirrored: None, clear }
    }

    /// The share of the surface that light goes through.
    fn passage(&mut self, share: f64) -> Clear {
        let (world, event) = (self.world, self.event);
        let direction = self.ray.quest.direction;
        let index = |medium| world.medium(medium).map_or(1.0, |medium| medium.index);
        let (n1, n2) = (index(event.near), index(event.far));
        let (straight, facing) = (is_fake(self.optics), self.facing());
        let (reflects, cosine) =
            if straight { (0.0, facing.cosine) } else { reflectance(n1, n2, facing.cosine) };
        let gloss = (reflects > 0.0).then(|| self.gloss(n1, n2, reflects, self.weight * share));
        let through = share * (1.0 - reflects);
        let behind = (through > 0.0).then(|| {
            let direction = if straight {
                direction
            } else {
                let bent = refracted(direction, facing.normal, n1 / n2, facing.cosine, cosine);
                kept_above(bent, -event.normal)
            };
            let origin = event.behind();
            let (start, limit) = (event.start(), f64::INFINITY);
            let quest = Quest { origin, direction, start, limit, medium: event.far };
            let bend = if straight { 0.0 } else { (n1 / n2 - 1.0).abs() };
            let ray = self.spring(quest, self.weight * through, Way::Through { bend });
            Behind { share: through, straight, ray }
        });
        Clear { share, gloss, behind }
    }

    /// What a clear surface reflects: mirrored, with the highlights of the lights; a rough one mirrors a part of it.
    fn gloss(&mut self, n1: f64, n2: f64, reflects: f64, weight: f64) -> Gloss {
        let (world, event) = (self.world, self.event);
        let (view, m) = (-self.ray.quest.direction, self.slope);
        let normal = self.facing().normal;
        if m > 0.0 {
            let rough = RoughClear::new(n1, n2, m, reflects);
            let highlights = self
                .generation
                .lamps
                .add(world, event, |light| Rgb::splat(rough.highlight(normal, view, light.toward)));
            // Where facets are drawn they mirror all that is reflected, so that no light is lost within.
            let (ambient, share) =
                if world.glossy { (0.0, reflects) } else { (rough.ambient, rough.mirrored) };
            let mirrored = (share > 0.0).then(|| {
                let glint = if world.glossy { self.glint(m) } else { None };
                let toward = glint.map_or_else(|| self.mirrored(), |(toward, _)| toward);
                Mirrored { share: Rgb::splat(share), ray: self.mirror(toward, weight * share) }
            });
            return Gloss { highlights, ambient: ambient * world.ambient, mirrored };
        }
        let mirrored = self.mirrored();
        let widest = if self.tracer.clamp { Spark::WIDEST } else { self.spark() };
        let shows = |light| may_show(&widest, light, event.before(), mirrored);
        let highlights = if world.lights.iter().any(shows) {
            let (spark, share) = (self.spark(), Rgb::splat(reflects));
            let lamps = &mut self.generation.lamps;
            lamps.add(world, event, |light| spark.shine(view, normal, light, share))
        } else {
            Lit::default()
        };
        let ray = self.mirror(mirrored, weight * reflects);
        let mirrored = Some(Mirrored { share: Rgb::splat(reflects), ray });
        Gloss { highlights, ambient: Rgb::ZERO, mirrored }
    }

    /// The direction light comes from that a facet mirrors, drawn by lot for a surface of slope `m`.
    fn glint(&self, m: f64) -> Option<(DVec3, Glint)> {
        let (view, draw) = (-self.ray.quest.direction, self.ray.draw.sprung(2));
        let glint = glint(self.facing().normal, view, m, draw)?;
        Some((kept_above(glint.toward, self.event.normal), glint))
    }

    /// The direction light comes from that is mirrored.
    fn mirrored(&self) -> DVec3 {
        let Facing { normal, cosine } = self.facing();
        kept_above(reflected(self.ray.quest.direction, normal, cosine), self.event.normal)
    }

    fn mirror(&mut self, direction: DVec3, weight: f64) -> Sprung {
        let (origin, medium) = (self.event.before(), self.event.near);
        let (start, limit) = (self.event.start(), f64::INFINITY);
        let quest = Quest { origin, direction, start, limit, medium };
        self.spring(quest, weight, Way::Mirrored)
    }

    /// How lights look in the surface, if it is a mirror.
    fn spark(&mut self) -> Spark {
        // A picture that holds all light holds it where it is: what one ray stands for may be thousands of times white.
        if !self.tracer.clamp {
            return Spark::seen_by(0.0, f64::INFINITY);
        }
        // No more of a light is seen than the eye's rays can bring.
        Spark::seen_by(self.cone(Way::Mirrored).spread, 1.0 / self.weight)
    }

    /// What a ray that goes this way stands for, in a scene where that can be seen.
    #[inline(always)]
    fn cone(&mut self, way: Way) -> Cone {
        // Lights alone are shown too sharp behind bent glass, and a quarter of the rays saved some work.
        let counts = match way {
            Way::Mirrored => self.world.cones,
            Way::Through { .. } => !self.world.paints.is_empty(),
        };
        if !counts {
            return self.ray.cone;
        }
        let turned = match self.turned {
            Some(turned) => turned,
            None => self.turn(),
        };
        self.ray.cone.sprung(self.event.way(), turned, way.bend())
    }

    #[inline(never)]
    fn turn(&mut self) -> f64 {
        let width = self.ray.cone.width_at(self.event.way());
        let turned = self.tracer.finder.turned(self.event, width);
        self.turned = Some(turned);
        turned
    }

    /// A ray of the next generation, unless it is too deep or too faint; what is cut is counted.
    #[inline(always)]
    fn spring(&mut self, quest: Quest, weight: f64, way: Way) -> Sprung {
        let depth = self.ray.depth + 1;
        let stats = &mut self.tracer.stats;
        if depth > self.tracer.depth_limit {
            stats.cut_by_depth += 1;
            stats.weight_cut_by_depth += weight;
            return Sprung::Background;
        }
        if weight < self.tracer.min_weight {
            stats.cut_by_weight += 1;
            stats.weight_cut_by_weight += weight;
            return Sprung::Dark;
        }
        let cone = self.cone(way);
        let (rays, place, number): (_, fn(u32) -> Sprung, u32) = match way {
            Way::Mirrored => (&mut self.generation.sprung, Sprung::Mirrored, 0),
            Way::Through { .. } => (&mut self.generation.through, Sprung::Through, 1),
        };
        let draw = self.ray.draw.sprung(number);
        rays.push(Branch { quest, weight, depth, cone, draw });
        place(u32::try_from(rays.len() - 1).expect("a batch has few rays"))
    }
}
