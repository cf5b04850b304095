//! Where eight rays cross boundaries, before it is known what lies on either side.

use glam::DVec3;
use scene::transform::unit;
use scene::{Eight, EightMask, Face, Lanes};

use super::sides::EightProbes;
use super::{EightHits, EightSeekers};
use crate::trace::classify::{Owner, magnitude_near};
use crate::trace::event::{Event, Finder};
use crate::trace::scope::ScopeId;
use crate::world::region::Region;
use crate::world::{LeafId, ROUNDING};

/// A boundary in each active lane.
#[derive(Clone, Copy, Debug)]
pub(in crate::trace) struct EightCrossings {
    hits: EightHits,
    point: [Eight; 3],
    /// Unit, against the ray.
    normal: [Eight; 3],
    cosine: Eight,
    /// Rounding bound at the point.
    offset: Eight,
    active: EightMask,
}

impl EightCrossings {
    pub(in crate::trace) fn new(
        finder: &mut Finder<'_>,
        region: &Region,
        rays: &EightSeekers<'_, '_>,
        hits: EightHits,
        active: EightMask,
    ) -> Self {
        let world = rays.world;
        let ([ox, oy, oz], [dx, dy, dz]) = (rays.rays.ray.origin, rays.rays.ray.direction);
        let point = [ox + hits.t * dx, oy + hits.t * dy, oz + hits.t * dz];
        let zero = Eight::splat(0.0);
        let (mut outward, mut magnitude) = ([zero; 3], zero);
        // Rays side by side mostly meet the same leaf.
        let numbers = hits.leaf.to_array();
        let mut left = active;
        while left.any() {
            let number = numbers[left.bits().trailing_zeros() as usize];
            let leaf = &world.leaves[leaf_id(number) as usize];
            let here = Eight::and(left, hits.leaf.is(number));
            let gradient = leaf.gradient(point, hits.face);
            for (along, gradient) in outward.iter_mut().zip(gradient) {
                *along = Eight::select(here, gradient, *along);
            }
            magnitude = Eight::select(here, Eight::splat(leaf.magnitude), magnitude);
            left = Eight::and(left, Eight::not(here));
        }
        let [x, y, z] = units(outward, active);
        let away = zero.less(x * dx + y * dy + z * dz);
        let normal = [x, y, z].map(|x| Eight::select(away, -x, x));
        let least = [point, rays.rays.ray.origin]
            .into_iter()
            .flatten()
            .fold(magnitude, |least, x| least.max(x.abs()));
        let [x, y, z] = normal;
        // Two unit vectors: rounding alone takes it out of range.
        let one = Eight::splat(1.0);
        let cosine = -(x * dx + y * dy + z * dz);
        let cosine = Eight::select(one.less(cosine), one, cosine);
        let mut crossings = Self { hits, point, normal, cosine, offset: least, active };
        let fine = Eight::and(active, least.less(Eight::splat(world.magnitude)));
        if fine.any() && !world.trusts_boundaries {
            let mut found = least.to_array();
            for lane in (0..Eight::LANES).filter(|lane| fine.bits() >> lane & 1 == 1) {
                let point = DVec3::from_array(point.map(|x| x.to_array()[lane]));
                let scopes = finder.scopes_mut();
                found[lane] = magnitude_near(world, region, scopes, point, found[lane]);
            }
            crossings.offset = Eight::new(found);
        }
        crossings.offset = Eight::splat(ROUNDING) * crossings.offset;
        crossings
    }

    /// The points to either side.
    pub(in crate::trace) fn probes(&self) -> EightProbes {
        let off = self.normal.map(|n| self.offset * n);
        let sides = [
            std::array::from_fn(|k| self.point[k] + off[k]),
            std::array::from_fn(|k| self.point[k] - off[k]),
        ];
        EightProbes::new(sides, self.point, self.offset, self.active)
    }

    /// The boundaries lane by lane.
    #[inline(always)]
    pub(in crate::trace) fn lanes(&self) -> Crossings {
        Crossings {
            t: self.hits.t.to_array(),
            point: self.point.map(Eight::to_array),
            normal: self.normal.map(Eight::to_array),
            cosine: self.cosine.to_array(),
            offset: self.offset.to_array(),
            leaf: self.hits.leaf.to_array(),
            face: self.hits.face.to_array(),
        }
    }
}

/// [`EightCrossings`] in memory.
#[derive(Clone, Copy, Debug)]
pub(in crate::trace) struct Crossings {
    t: [f64; Eight::LANES],
    point: [[f64; Eight::LANES]; 3],
    normal: [[f64; Eight::LANES]; 3],
    cosine: [f64; Eight::LANES],
    offset: [f64; Eight::LANES],
    leaf: [f64; Eight::LANES],
    face: [f64; Eight::LANES],
}

impl Crossings {
    /// How far along its ray the boundary of a lane is, and how many rounding bounds behind the plane of the start.
    #[inline(always)]
    pub(in crate::trace) fn ways(&self, lane: usize) -> (f64, f64) {
        (self.t[lane], self.t[lane] * self.cosine[lane] / self.offset[lane])
    }

    /// Writes the boundary of one lane as if it were the event; media are left as they are.
    #[inline(always)]
    pub(in crate::trace) fn write(&self, lane: usize, event: &mut Event) {
        let vector = |v: &[[f64; Eight::LANES]; 3]| DVec3::new(v[0][lane], v[1][lane], v[2][lane]);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a face")]
        let face = Face(self.face[lane] as u32);
        event.t = self.t[lane];
        event.point = vector(&self.point);
        event.normal = vector(&self.normal);
        event.cosine = self.cosine[lane];
        event.offset = self.offset[lane];
        event.owner = Owner { leaf: leaf_id(self.leaf[lane]), scope: ScopeId::SCENE };
        event.face = face;
    }
}

fn leaf_id(number: f64) -> LeafId {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a LeafId as a number"
    )]
    let leaf = number as LeafId;
    leaf
}

/// [`unit`] in lanes; planes across an axis, most floors and walls, come out exact.
#[inline(always)]
fn units(v: [Eight; 3], active: EightMask) -> [Eight; 3] {
    let (zero, one) = (Eight::splat(0.0), Eight::splat(1.0));
    let [x, y, z] = v;
    let square = x * x + y * y + z * z;
    let usual = Eight::and(Eight::splat(1e-200).less(square), square.less(Eight::splat(1e200)));
    let factor = one / square.sqrt();
    let mut units = v.map(|x| x * factor);
    let odd = Eight::and(active, Eight::not(usual));
    for lane in (0..Eight::LANES).filter(|lane| odd.bits() >> lane & 1 == 1) {
        let alone = unit(DVec3::from_array(v.map(|x| x.to_array()[lane])));
        for (several, alone) in units.iter_mut().zip(alone.to_array()) {
            let mut lanes = several.to_array();
            lanes[lane] = alone;
            *several = Eight::new(lanes);
        }
    }
    let still = v.map(|x| x.is(0.0));
    let across =
        |a: EightMask, b: EightMask, c: EightMask| Eight::and(Eight::not(a), Eight::and(b, c));
    let plane = Eight::or(
        across(still[0], still[1], still[2]),
        Eight::or(across(still[1], still[0], still[2]), across(still[2], still[0], still[1])),
    );
    std::array::from_fn(|k| {
        let sign = Eight::select(v[k].less(zero), -one, one);
        Eight::select(plane, Eight::select(still[k], v[k], sign), units[k])
    })
}
