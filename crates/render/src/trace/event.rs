//! The next boundary along a ray that counts: where the medium changes, or an opaque body begins.
//!
//! Whatever is found first along the ray is tried by one question about the two points a rounding bound to either side
//! of it. If both lie in the same medium nothing happens there and the search goes on along the same ray. Media are
//! never carried by flags, so a boundary that rounding hides or doubles does no harm.

use glam::DVec3;
use scene::transform::unit;
use scene::{Face, FacedSpan};

use super::Hit;
use super::classify::{Owner, Probe, magnitude_near, medium_at, sides};
use super::merge::Lists;
use super::seek::{Seeker, box_ray};
use crate::options::Accel;
use crate::world::hierarchy::BoxRay;
use crate::world::region::Region;
use crate::world::{Leaf, MediumId, ROUNDING, World};

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
    /// A point off the surface on the side the ray comes from.
    pub(crate) fn before(&self) -> DVec3 {
        self.point + self.offset * self.normal
    }

    /// A point off the surface on the other side.
    pub(crate) fn behind(&self) -> DVec3 {
        self.point - self.offset * self.normal
    }
}

/// Finds events, by one way or another.
pub(crate) struct Finder<'w> {
    pub(crate) seeker: Seeker<'w>,
    accel: Accel,
    lists: Lists,
}

impl<'w> Finder<'w> {
    pub(crate) fn new(world: &'w World, accel: Accel) -> Self {
        Self { seeker: Seeker::new(world), accel, lists: Lists::default() }
    }

    pub(crate) fn world(&self) -> &'w World {
        self.seeker.world
    }

    /// The medium at a point well off every surface.
    pub(crate) fn medium_at(&mut self, point: DVec3) -> MediumId {
        self.seeker.scopes.clear();
        medium_at(self.seeker.world, &mut self.seeker.scopes, point)
    }

    /// The first event before `limit` on the ray from `origin` along the unit vector `direction`, which meets nothing
    /// outside of `region`. `medium` is where the ray is thought to start.
    pub(crate) fn event(
        &mut self,
        region: &Region,
        origin: DVec3,
        direction: DVec3,
        limit: f64,
        medium: MediumId,
    ) -> Option<Event> {
        self.seeker.scopes.clear();
        let ray = box_ray(origin, direction);
        if self.accel != Accel::Bvh {
            self.lists.find(&mut self.seeker, region, &ray, self.accel == Accel::Boxes);
        }
        let mut from = 0.0;
        loop {
            let hit = match self.accel {
                Accel::Bvh => self.seeker.next(region, &ray, from, limit, medium),
                Accel::None | Accel::Boxes => self.lists.next(from, limit),
            }?;
            if let Some(event) = self.examine(region, &ray, direction, &hit) {
                return Some(event);
            }
            from = hit.t;
        }
    }

    /// Tries a boundary; `None` if the medium is the same on both sides.
    fn examine(
        &mut self,
        region: &Region,
        ray: &BoxRay,
        direction: DVec3,
        hit: &Hit,
    ) -> Option<Event> {
        let world = self.seeker.world;
        let scopes = &mut self.seeker.scopes;
        let own = Owner { leaf: hit.leaf, scope: hit.scope };
        let leaf = &world.leaves[hit.leaf as usize];
        let surface = Surface { leaf, owner: own, t: hit.t, face: hit.face, exists: true };
        let point = ray.ray.at(hit.t);
        let normal = surface.normal_at(scopes, point);
        let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
        let least = scopes
            .magnitude(hit.scope, leaf.magnitude)
            .max(point.abs().max_element())
            .max(DVec3::from_array(ray.ray.origin).abs().max_element());
        let offset = ROUNDING * magnitude_near(world, region, scopes, point, least);
        let probe = Probe {
            near: point + offset * normal,
            far: point - offset * normal,
            middle: point,
            tolerance: offset,
        };
        let sides = sides(world, region, scopes, &probe);
        let (near, far) = (sides.near.medium, sides.far.medium);
        if near != MediumId::OPAQUE && world.alike(near, far) {
            return None;
        }
        // Once inside an opaque body, whatever lies behind its face, the ray ends there.
        let (near, far) =
            if near == MediumId::OPAQUE { (MediumId::AIR, MediumId::OPAQUE) } else { (near, far) };
        let owner = sides.owner.unwrap_or(own);
        let mut event = Event {
            t: hit.t,
            point,
            normal,
            cosine: cosine(normal, direction),
            offset,
            near,
            far,
            owner,
            face: surface.face,
        };
        if owner != own {
            let surface = Surface::at(world, scopes, owner, ray, hit.t);
            // The owner's root is at the hit, up to rounding seen at this angle; if its span grazed away, the surface
            // that was hit stands in.
            let off = (surface.t - hit.t).abs() * event.cosine;
            if surface.exists && off <= 4.0 * offset {
                let point = ray.ray.at(surface.t);
                let normal = surface.normal_at(scopes, point);
                let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
                event = Event {
                    t: surface.t,
                    point,
                    normal,
                    cosine: cosine(normal, direction),
                    face: surface.face,
                    ..event
                };
            }
        }
        Some(event)
    }
}

fn cosine(normal: DVec3, direction: DVec3) -> f64 {
    let c = -normal.dot(direction);
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
    fn at(
        world: &'w World,
        scopes: &super::scope::Scopes,
        owner: Owner,
        ray: &BoxRay,
        t: f64,
    ) -> Self {
        let leaf = &world.leaves[owner.leaf as usize];
        let span: FacedSpan = if owner.scope == super::scope::ScopeId::SCENE {
            leaf.span(&ray.ray)
        } else {
            leaf.span(&scopes.get(owner.scope).map.ray_inward(&ray.ray))
        };
        let enters = (span.from - t).abs() < (span.to - t).abs();
        let (t, face) = if enters { (span.from, span.entered()) } else { (span.to, span.left()) };
        Self { leaf, owner, t, face, exists: span.from < span.to }
    }

    /// The outward unit normal.
    #[inline(always)]
    fn normal_at(&self, scopes: &super::scope::Scopes, point: DVec3) -> DVec3 {
        let local = self.leaf.inward(scopes.inward(self.owner.scope, point));
        let gradient = self.leaf.kind.gradient(local, self.face);
        let outward = self.leaf.gradient_outward(gradient);
        let outward = if self.owner.scope == super::scope::ScopeId::SCENE {
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
