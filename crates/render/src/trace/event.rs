//! The next boundary along a ray that counts: where the medium changes, or an opaque body begins.
//!
//! Whatever is found first along the ray is tried by one question about the two points a rounding bound to either side
//! of it. If both lie in the same medium nothing happens there and the search goes on along the same ray. Media are
//! never carried by flags, so a boundary that rounding hides or doubles does no harm.

use std::rc::Rc;

use glam::DVec3;
use scene::transform::unit;
use scene::{Eight, EightMask, Face, FacedSpan, Lanes, Ray, Sight};

use super::Hit;
use super::classify::{Owner, Probe, magnitude_near, medium_at, sides};
use super::merge::Lists;
use super::packet::crossing::{Crossings, EightCrossings};
use super::packet::{self, EightSeekers, Spans};
use super::scope::{ScopeId, Scopes};
use super::seek::{Seeker, box_ray};
use crate::options::Accel;
use crate::world::hierarchy::EightBoxRays;
use crate::world::region::Region;
use crate::world::{Leaf, LeafId, MediumId, ROUNDING, World};

/// A surface that a ray meets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Event {
    pub(crate) t: f64,
    pub(crate) point: DVec3,
    /// Unit, against the ray.
    pub(crate) normal: DVec3,
    /// Cosine of the angle between the normal and the way back, in 0…1.
    pub(crate) cosine: f64,
    /// Rounding bound at the point: child rays start this far off the surface.
    pub(crate) offset: f64,
    /// The medium the ray comes through.
    pub(crate) near: MediumId,
    /// The medium it meets.
    pub(crate) far: MediumId,
    /// Whose surface it is.
    pub(crate) owner: Owner,
    pub(crate) face: Face,
}

impl Event {
    /// Stands where there is none.
    pub(crate) const NONE: Self = Self {
        t: f64::INFINITY,
        point: DVec3::ZERO,
        normal: DVec3::ZERO,
        cosine: 0.0,
        offset: 0.0,
        near: MediumId::AIR,
        far: MediumId::AIR,
        owner: Owner { leaf: LeafId::MAX, scope: ScopeId::SCENE },
        face: Face(0),
    };

    /// The way behind the event; 0 where it is up to rounding before the ray's start.
    pub(crate) fn way(&self) -> f64 {
        if self.t > 0.0 { self.t } else { 0.0 }
    }

    /// The parameter that rays which spring from here begin at. Where another surface is as far off as they start, rounding
    /// may have them start behind it, though the point between is in the medium before it. So they look back by half of
    /// the way to the surface that they spring from, which is many roundings.
    pub(crate) fn start(&self) -> f64 {
        -0.5 * self.offset
    }

    /// A point off the surface on the side the ray comes from.
    pub(crate) fn before(&self) -> DVec3 {
        self.point + self.offset * self.normal
    }

    /// A point off the surface on the other side.
    pub(crate) fn behind(&self) -> DVec3 {
        self.point - self.offset * self.normal
    }
}

/// A ray that looks for an event.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quest {
    pub(crate) origin: DVec3,
    /// Unit.
    pub(crate) direction: DVec3,
    /// Boundaries count after this parameter: a ray that springs from a surface looks a little back, see [`Event::start`].
    pub(crate) start: f64,
    /// Events count before this parameter.
    pub(crate) limit: f64,
    /// Where the ray is thought to start: a hint on what to try first.
    pub(crate) medium: MediumId,
}

/// What several rays met.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Events {
    /// Bit k is set where ray k met something.
    met: u32,
    events: [Event; WIDTH],
}

impl Events {
    pub(crate) fn new() -> Self {
        Self { met: 0, events: [Event::NONE; WIDTH] }
    }

    pub(crate) fn get(&self, number: usize) -> Option<&Event> {
        (self.met >> number & 1 == 1).then_some(&self.events[number])
    }
}

/// Most rays sought together.
const WIDTH: usize = Eight::LANES;

/// Finds events, by one way or another.
pub(crate) struct Finder<'w> {
    pub(crate) seeker: Seeker<'w>,
    accel: Accel,
    lists: Lists,
    /// Several rays at a time.
    together: bool,
    spans: Rc<Spans>,
}

impl<'w> Finder<'w> {
    pub(crate) fn new(world: &'w World, accel: Accel) -> Self {
        let together = accel == Accel::Bvh
            && world.instances.is_empty()
            && EightBoxRays::can_trace(world.magnitude);
        Self {
            seeker: Seeker::new(world),
            accel,
            lists: Lists::new(world, accel),
            together,
            spans: Rc::new(Spans::new()),
        }
    }

    pub(crate) fn world(&self) -> &'w World {
        self.seeker.world
    }

    /// The medium at a point well off every surface.
    pub(crate) fn medium_at(&mut self, point: DVec3) -> MediumId {
        self.seeker.scopes.clear();
        medium_at(self.seeker.world, &mut self.seeker.scopes, point)
    }

    /// A ray of the picture, where `eye_medium` is around the eye.
    pub(crate) fn quest(&mut self, sight: Sight, eye_medium: MediumId) -> Quest {
        let Sight { offset, direction } = sight;
        let origin = self.world().eye + offset;
        let medium = if offset == DVec3::ZERO { eye_medium } else { self.medium_at(origin) };
        Quest { origin, direction, start: 0.0, limit: f64::INFINITY, medium }
    }

    /// The rays to come are at this level of their trees.
    pub(crate) fn at_level(&mut self, level: u32) {
        self.lists.coherence.at_level(level);
    }

    /// The rays to come go to this light.
    pub(crate) fn at_light(&mut self, light: usize) {
        self.lists.coherence.at_light(light);
    }

    /// How many rays are sought together.
    pub(crate) fn width(&self) -> usize {
        if self.together { WIDTH } else { 1 }
    }

    /// The instances that the latest ray entered; with more than one ray sought together, there are none.
    pub(crate) fn scopes(&self) -> &Scopes {
        &self.seeker.scopes
    }

    pub(super) fn scopes_mut(&mut self) -> &mut Scopes {
        &mut self.seeker.scopes
    }

    /// The first event on each of `count` rays, at most [`Finder::width`], that meet nothing outside of `region`.
    pub(crate) fn events<'q>(
        &mut self,
        region: &Region,
        count: usize,
        quest: impl Fn(usize) -> &'q Quest,
        found: &mut Events,
    ) {
        found.met = 0;
        if self.together {
            self.events_together(region, count, quest, found);
        } else if let Some(event) = self.event(region, quest(0)) {
            found.met = 1;
            found.events[0] = event;
        }
    }

    fn events_together<'q>(
        &mut self,
        region: &Region,
        count: usize,
        quest: impl Fn(usize) -> &'q Quest,
        found: &mut Events,
    ) {
        let world = self.seeker.world;
        let spans = Rc::clone(&self.spans);
        let rays = EightSeekers::new(world, &spans, count, &quest);
        let mut from = rays.start;
        let mut active = EightMask::first(count);
        loop {
            let hits = rays.next(region, from, active);
            // Boundaries come in order: whatever rounding does, the search ends.
            active = Eight::and(active, Eight::and(from.less(hits.t), hits.t.less(rays.limit)));
            if !active.any() {
                return;
            }
            let crossings = EightCrossings::new(self, region, &rays, hits, active);
            if world.trusts_boundaries {
                self.trust(&crossings.lanes(), &quest, active, found);
                return;
            }
            let sides = packet::sides::sides(world, region, &crossings.probes());
            let (crossings, sides) = (crossings.lanes(), sides.lanes());
            let mut on = [0.0; WIDTH];
            for lane in (0..WIDTH).filter(|lane| active.bits() >> lane & 1 == 1) {
                let (near, far, owner) = sides.get(world, lane);
                if near != quest(lane).medium {
                    let (media, (t, way)) = ((near, far), crossings.ways(lane));
                    let through = self.medium_come_through(region, quest(lane), media, t, way);
                    if through != near {
                        let Some(media) = self.media_of_event(through, far) else {
                            on[lane] = 1.0;
                            continue;
                        };
                        // Whose surface would lie between other media is none of this ray's.
                        found.met |= 1 << lane;
                        let event = &mut found.events[lane];
                        crossings.write(lane, event);
                        (event.near, event.far) = media;
                        continue;
                    }
                }
                let Some((near, far)) = self.media_of_event(near, far) else {
                    on[lane] = 1.0;
                    continue;
                };
                found.met |= 1 << lane;
                let event = &mut found.events[lane];
                crossings.write(lane, event);
                let own = event.owner;
                (event.near, event.far, event.owner) = (near, far, owner.unwrap_or(own));
                if event.owner != own {
                    self.move_to_owner(&rays.lane(lane), event);
                }
            }
            active = Eight::splat(0.5).less(Eight::new(on));
            if !active.any() {
                return;
            }
            from = hits.t;
        }
    }

    /// Takes boundaries for events: each leads into its solid's medium, or out of it into air.
    #[inline(never)]
    fn trust<'q>(
        &self,
        crossings: &Crossings,
        quest: &impl Fn(usize) -> &'q Quest,
        active: EightMask,
        found: &mut Events,
    ) {
        let world = self.seeker.world;
        for lane in (0..WIDTH).filter(|lane| active.bits() >> lane & 1 == 1) {
            found.met |= 1 << lane;
            let event = &mut found.events[lane];
            crossings.write(lane, event);
            let own = world.leaves[event.owner.leaf as usize].medium;
            event.near = quest(lane).medium;
            event.far = if own == event.near { MediumId::AIR } else { own };
        }
    }

    /// The first event on a ray.
    fn event(&mut self, region: &Region, quest: &Quest) -> Option<Event> {
        let Quest { origin, direction, start, limit, medium } = *quest;
        self.seeker.scopes.clear();
        let ray = box_ray(origin, direction);
        if self.accel != Accel::Bvh {
            self.lists.find(&mut self.seeker, &ray, start);
        }
        let mut from = start;
        loop {
            let hit = match self.accel {
                Accel::Bvh => self.seeker.next(region, &ray, from, limit, medium),
                Accel::None
                | Accel::Boxes
                | Accel::Flat
                | Accel::Slanted
                | Accel::Coherence
                | Accel::Remembered => self.lists.next(from, limit),
            }?;
            if hit.t <= from {
                return None;
            }
            if let Some(event) = self.examine(region, quest, &ray.ray, &hit) {
                return Some(event);
            }
            from = hit.t;
            if self.accel == Accel::Bvh {
                self.seeker.scopes.clear();
            }
        }
    }

    /// Tries a boundary; `None` if the medium is the same on both sides.
    fn examine(&mut self, region: &Region, quest: &Quest, ray: &Ray, hit: &Hit) -> Option<Event> {
        let mut event = self.crossing(region, ray, hit);
        let probe = Probe {
            near: event.before(),
            far: event.behind(),
            middle: event.point,
            tolerance: event.offset,
        };
        let sides = sides(self.seeker.world, region, &mut self.seeker.scopes, &probe);
        let (mut near, mut owner) = (sides.near.medium, sides.owner);
        if near != quest.medium {
            let way = event.t * event.cosine / event.offset;
            let media = (near, sides.far.medium);
            let through = self.medium_come_through(region, quest, media, event.t, way);
            owner = owner.filter(|_| through == near);
            near = through;
        }
        (event.near, event.far) = self.media_of_event(near, sides.far.medium)?;
        if let Some(owner) = owner
            && owner != event.owner
        {
            event.owner = owner;
            self.move_to_owner(ray, &mut event);
        }
        Some(event)
    }

    /// The medium that a ray comes through to a boundary at `t`, `way` rounding bounds behind the plane of its start,
    /// where the point before the boundary is not in the medium that the ray started in.
    ///
    /// Less than one bound behind the start, that point lies before the start: the ray never was there. Else a bound of
    /// rounding hides a boundary in between, next to the start or to this one, and what fills the way is asked in its
    /// middle.
    #[inline(never)]
    fn medium_come_through(
        &mut self,
        region: &Region,
        quest: &Quest,
        (near, far): (MediumId, MediumId),
        t: f64,
        way: f64,
    ) -> MediumId {
        let world = self.seeker.world;
        if quest.medium == MediumId::OPAQUE || world.alike(near, quest.medium) {
            near
        } else if near == MediumId::OPAQUE {
            if way < 1.0 { quest.medium } else { near }
        } else if way < 2.0 {
            // From before an opaque surface light goes to where it is lit from: what is there counts.
            if far == MediumId::OPAQUE { near } else { quest.medium }
        } else {
            let middle = quest.origin + 0.5 * t * quest.direction;
            let probe = Probe { near: middle, far: middle, middle, tolerance: 0.0 };
            sides(world, region, &mut self.seeker.scopes, &probe).near.medium
        }
    }

    /// A boundary that is still to be judged, as if it were the event.
    fn crossing(&mut self, region: &Region, ray: &Ray, hit: &Hit) -> Event {
        let (world, scopes) = (self.seeker.world, &mut self.seeker.scopes);
        let owner = Owner { leaf: hit.leaf, scope: hit.scope };
        let leaf = &world.leaves[hit.leaf as usize];
        let surface = Surface { leaf, owner, t: hit.t, face: hit.face, exists: true };
        let point = ray.at(hit.t);
        let normal = surface.normal_against(scopes, point, ray);
        let least = scopes
            .magnitude(hit.scope, leaf.magnitude)
            .max(point.abs().max_element())
            .max(DVec3::from_array(ray.origin).abs().max_element());
        let offset = ROUNDING * magnitude_near(world, region, scopes, point, least);
        let cosine = cosine(normal, ray);
        Event { t: hit.t, point, normal, cosine, offset, owner, face: hit.face, ..Event::NONE }
    }

    /// By how much the normal at an event turns over a width in the surface, between the ways across and along the ray.
    #[inline(never)]
    pub(crate) fn turned(&self, event: &Event, width: f64) -> f64 {
        let Event { owner, point, normal, face, .. } = *event;
        let leaf = &self.seeker.world.leaves[owner.leaf as usize];
        if leaf.is_flat() {
            return 0.0;
        }
        let surface = Surface { leaf, owner, t: event.t, face, exists: true };
        let across = normal.any_orthonormal_vector();
        let way = std::f64::consts::FRAC_1_SQRT_2 * width * (across + normal.cross(across));
        let there = surface.normal_at(&self.seeker.scopes, point + way);
        (if there.dot(normal) < 0.0 { there + normal } else { there - normal }).length()
    }

    /// The media that meet at an event; `None` if light cannot tell them apart.
    #[inline(always)]
    fn media_of_event(&self, near: MediumId, far: MediumId) -> Option<(MediumId, MediumId)> {
        if near == MediumId::OPAQUE {
            // Once inside an opaque body, whatever lies behind its face, the ray ends there.
            return Some((MediumId::AIR, MediumId::OPAQUE));
        }
        (!self.seeker.world.alike(near, far)).then_some((near, far))
    }

    /// Moves an event to its owner's own surface.
    fn move_to_owner(&self, ray: &Ray, event: &mut Event) {
        let scopes = &self.seeker.scopes;
        let surface = Surface::at(self.seeker.world, scopes, event.owner, ray, event.t);
        // The owner's root is at the hit, up to rounding seen at this angle; if its span grazed away, the surface
        // that was hit stands in.
        let off = (surface.t - event.t).abs() * event.cosine;
        if !surface.exists || off > 4.0 * event.offset {
            return;
        }
        (event.t, event.face, event.point) = (surface.t, surface.face, ray.at(surface.t));
        event.normal = surface.normal_against(scopes, event.point, ray);
        event.cosine = cosine(event.normal, ray);
    }
}

fn cosine(normal: DVec3, ray: &Ray) -> f64 {
    let c = -normal.dot(DVec3::from_array(ray.direction));
    // Two unit vectors: rounding alone takes it out of range.
    if c > 1.0 { 1.0 } else { c }
}

/// One leaf's surface where a ray crosses it.
struct Surface<'w> {
    leaf: &'w Leaf,
    owner: Owner,
    t: f64,
    face: Face,
    exists: bool,
}

impl<'w> Surface<'w> {
    /// The end of the leaf's span nearest to `t`.
    fn at(world: &'w World, scopes: &Scopes, owner: Owner, ray: &Ray, t: f64) -> Self {
        let leaf = &world.leaves[owner.leaf as usize];
        let span: FacedSpan = if owner.scope == ScopeId::SCENE {
            leaf.span_about(ray, t)
        } else {
            leaf.span_about(&scopes.get(owner.scope).map.ray_inward(ray), t)
        };
        let enters = (span.from - t).abs() < (span.to - t).abs();
        let (t, face) = if enters { (span.from, span.entered()) } else { (span.to, span.left()) };
        Self { leaf, owner, t, face, exists: span.from < span.to }
    }

    /// The unit normal at a point, against the ray.
    #[inline(always)]
    fn normal_against(&self, scopes: &Scopes, point: DVec3, ray: &Ray) -> DVec3 {
        let normal = self.normal_at(scopes, point);
        if normal.dot(DVec3::from_array(ray.direction)) > 0.0 { -normal } else { normal }
    }

    /// The outward unit normal.
    #[inline(always)]
    fn normal_at(&self, scopes: &Scopes, point: DVec3) -> DVec3 {
        let inner = scopes.inward(self.owner.scope, point).to_array();
        let outward = DVec3::from_array(self.leaf.gradient(inner, self.face.number()));
        let outward = if self.owner.scope == ScopeId::SCENE {
            outward
        } else {
            scopes.get(self.owner.scope).map.gradient_outward(outward)
        };
        // Planes across an axis, most floors and walls: exact, and without a root.
        let across = outward.abs().cmpgt(DVec3::ZERO);
        if across.bitmask().count_ones() == 1 {
            outward.signum() * DVec3::select(across, DVec3::ONE, DVec3::ZERO)
        } else {
            unit(outward)
        }
    }
}
