//! Where a leaf stands, in as little memory as its rays need: most solids are scaled and moved, and turned by right angles
//! at most.

use glam::{DMat3, DVec3};
use scene::transform::apply_transposed;
use scene::{Lanes, Map, Ray};

/// The map between a leaf's own space and the outer one.
#[derive(Debug, PartialEq)]
pub(crate) enum Place {
    /// Local axes run along those of the outer space.
    Along(Along),
    /// In any other way.
    Turned(Box<Map>),
}

/// An axis of the outer space; few values leave room to tell places apart.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(u8)]
enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];
}

/// Of each local axis the outer one that it runs along, and the factors both ways.
#[derive(Debug, PartialEq)]
pub(crate) struct Along {
    axes: [Axis; 3],
    outward: [f64; 3],
    inward: [f64; 3],
    place: DVec3,
}

impl Along {
    fn of(map: &Map) -> Option<Self> {
        let rows = [DVec3::X, DVec3::Y, DVec3::Z].map(|row| apply_transposed(&map.inverse, row));
        let (mut axes, mut inward) = ([Axis::X; 3], [0.0; 3]);
        for (k, row) in rows.iter().enumerate() {
            let row = Axis::ALL.into_iter().zip(row.to_array());
            let mut used = row.filter(|&(_, factor)| factor.abs() > 0.0);
            let (Some(only), None) = (used.next(), used.next()) else { return None };
            (axes[k], inward[k]) = only;
        }
        let outward = std::array::from_fn(|k| map.linear.col(k)[axes[k] as usize]);
        let along = Self { axes, outward, inward, place: map.place };
        let whole = along.map();
        (whole.linear == map.linear && whole.inverse == map.inverse).then_some(along)
    }

    fn map(&self) -> Map {
        let (mut linear, mut inverse) = (DMat3::ZERO, DMat3::ZERO);
        for (k, axis) in self.axes.map(|axis| axis as usize).into_iter().enumerate() {
            linear.col_mut(k)[axis] = self.outward[k];
            inverse.col_mut(axis)[k] = self.inward[k];
        }
        let mirrored = linear.determinant() < 0.0;
        let magnitude = self.place.abs().max_element();
        Map { linear, inverse, place: self.place, mirrored, magnitude }
    }

    #[inline(always)]
    fn inward_lanes<L: Lanes>(&self, point: [L; 3]) -> [L; 3] {
        let place = self.place.to_array();
        std::array::from_fn(|k| {
            let axis = self.axes[k] as usize;
            (point[axis] - L::splat(place[axis])) * L::splat(self.inward[k])
        })
    }
}

impl Place {
    pub(super) fn of(map: Map) -> Self {
        match Along::of(&map) {
            Some(along) => Self::Along(along),
            None => Self::Turned(Box::new(map)),
        }
    }

    /// The whole map; the largest coordinate that entered it is no longer known.
    pub(crate) fn map(&self) -> Map {
        match self {
            Self::Along(along) => along.map(),
            Self::Turned(map) => **map,
        }
    }

    /// A ray of the outer space in the leaf's own.
    #[inline(always)]
    pub(super) fn ray_inward<L: Lanes>(&self, ray: &Ray<L>) -> Ray<L> {
        let along = match self {
            Self::Along(along) => along,
            Self::Turned(map) => return map.ray_inward(ray),
        };
        // The general map adds products with zero to these: the same bits.
        let direction = std::array::from_fn(|k| {
            ray.direction[along.axes[k] as usize] * L::splat(along.inward[k])
        });
        Ray { origin: along.inward_lanes(ray.origin), direction }
    }

    /// A point of the outer space in the leaf's own.
    #[inline(always)]
    pub(super) fn inward_lanes<L: Lanes>(&self, point: [L; 3]) -> [L; 3] {
        match self {
            Self::Along(along) => along.inward_lanes(point),
            Self::Turned(map) => map.inward_lanes(point),
        }
    }

    /// A gradient of the leaf's own space in the outer space.
    #[inline(always)]
    pub(super) fn gradient_outward_lanes<L: Lanes>(&self, gradient: [L; 3]) -> [L; 3] {
        let along = match self {
            Self::Along(along) => along,
            Self::Turned(map) => return map.gradient_outward_lanes(gradient),
        };
        let mut outward = [L::splat(0.0); 3];
        for (k, slope) in gradient.into_iter().enumerate() {
            outward[along.axes[k] as usize] = slope * L::splat(along.inward[k]);
        }
        outward
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Placement;

    #[test]
    fn right_angles_are_kept_short_and_give_the_same_bits() {
        let mut short = 0;
        for turn in 0..64_u32 {
            let quarter = |k: u32| f64::from(turn >> (2 * k) & 3) * 90.0;
            let odd = if turn % 5 == 0 { 1e-3 } else { 0.0 };
            let placement = Placement {
                scale: DVec3::new(0.3, -7.0, 1e-6),
                rotation_degrees: DVec3::new(quarter(0) + odd, quarter(1), quarter(2)),
                place: DVec3::new(1e9, -0.1, 3.0),
            };
            let map = placement.map();
            let place = Place::of(map);
            let is_short = matches!(place, Place::Along(_));
            assert_eq!(is_short, odd <= 0.0, "{turn}");
            short += u32::from(is_short);
            let whole = place.map();
            assert!(whole.linear == map.linear && whole.inverse == map.inverse, "{turn}");
            assert_eq!((whole.place, whole.mirrored), (map.place, map.mirrored), "{turn}");
            let ray = Ray::new(DVec3::new(0.7, 1e9, -3.3), DVec3::new(0.36, 0.48, -0.8));
            let bits = |ray: &Ray| [ray.origin, ray.direction].map(|v| v.map(f64::to_bits));
            assert_eq!(bits(&place.ray_inward(&ray)), bits(&map.ray_inward(&ray)), "{turn}");
            let slope = [0.1, -0.7, 2.0];
            let [short, whole] =
                [place.gradient_outward_lanes(slope), map.gradient_outward_lanes(slope)];
            assert_eq!(short.map(f64::to_bits), whole.map(f64::to_bits), "{turn}");
        }
        assert_eq!(short, 51, "of 64");
    }
}
