//! Boxes rounded outward to single precision: half the memory, and what is tested against them loses nothing.

use glam::DVec3;
use scene::Bounds;

/// A box about something.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Box32 {
    pub(super) low: [f32; 3],
    pub(super) high: [f32; 3],
}

impl Box32 {
    /// The least such box about another; empty and unbounded ones stay what they are.
    pub(crate) fn about(bounds: &Bounds) -> Self {
        Self { low: round_down(bounds.low), high: round_up(bounds.high) }
    }

    /// The same box, exactly.
    pub(crate) fn bounds(&self) -> Bounds {
        let corner = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        Bounds { low: corner(self.low), high: corner(self.high) }
    }

    /// The least and the greatest corner.
    #[inline(always)]
    pub(crate) fn corners(&self) -> ([f32; 3], [f32; 3]) {
        (self.low, self.high)
    }

    /// If a point is no farther off than `tolerance` along each axis.
    #[inline(always)]
    pub(crate) fn nears(&self, point: DVec3, tolerance: f64) -> bool {
        self.bounds().nears(point, tolerance)
    }
}

pub(super) fn round_down(v: DVec3) -> [f32; 3] {
    v.to_array().map(|x| {
        #[expect(clippy::cast_possible_truncation, reason = "rounded outward below")]
        let y = x as f32;
        if f64::from(y) > x { y.next_down() } else { y }
    })
}

pub(super) fn round_up(v: DVec3) -> [f32; 3] {
    round_down(-v).map(|x| -x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_rounded_outward_by_a_unit_in_the_last_place() {
        for decade in -40..40 {
            let unit = libm::exp10(f64::from(decade));
            let bounds = Bounds {
                low: DVec3::new(-1.1, 1.1, -1e-9) * unit,
                high: DVec3::new(-1.0, 1.3, 1e-9) * unit,
            };
            let outer = Box32::about(&bounds).bounds();
            for (inner, outer) in [(bounds.low, outer.low), (-bounds.high, -outer.high)] {
                for (inner, outer) in inner.to_array().into_iter().zip(outer.to_array()) {
                    assert!(outer <= inner, "{outer} {inner}");
                    let ulp = f64::from(f32::EPSILON) * inner.abs() + 1.5e-45;
                    assert!(inner - outer <= ulp || inner.abs() > 1e38, "{outer} {inner}");
                }
            }
        }
        let empty = Box32::about(&Bounds::EMPTY).bounds();
        assert!(empty.is_empty(), "{empty:?}");
        assert_eq!(Box32::about(&Bounds::ALL).bounds(), Bounds::ALL);
    }
}
