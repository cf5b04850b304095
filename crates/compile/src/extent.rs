//! How far the maps of a solid reach, so that no matrix of a scene leaves the range of numbers.

use scene::{Frame, Placement};

/// Scales and places multiply to less than this; the cube of a length is then still a number.
pub(crate) const LIMIT: f64 = 1e100;

/// Bounds on the maps into a space. They hold for every entry of the matrices: rotations have norm 1, and the norm of
/// a product is at most the product of the norms.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    /// Largest stretch of a map.
    stretch: f64,
    /// Largest stretch of an inverse.
    shrink: f64,
    /// Largest distance of an origin.
    place: f64,
}

impl Extent {
    /// Of a space with nothing in it.
    pub(crate) const NONE: Self = Self { stretch: 1.0, shrink: 1.0, place: 0.0 };

    pub(crate) fn of(placement: &Placement) -> Self {
        let scale = placement.scale.abs();
        let place = placement.place.abs();
        Self {
            stretch: scale.max_element(),
            shrink: 1.0 / scale.min_element(),
            place: place.x + place.y + place.z,
        }
    }

    /// Of what is `inner` in a space that lies so.
    pub(crate) fn then(self, inner: Self) -> Self {
        Self {
            stretch: self.stretch * inner.stretch,
            shrink: self.shrink * inner.shrink,
            place: self.place + self.stretch * inner.place,
        }
    }

    /// Of both.
    pub(crate) fn with(self, other: Self) -> Self {
        Self {
            stretch: self.stretch.max(other.stretch),
            shrink: self.shrink.max(other.shrink),
            place: self.place.max(other.place),
        }
    }

    /// True if all matrices are well within the range of numbers.
    pub(crate) fn is_fit(self) -> bool {
        self.stretch <= LIMIT && self.shrink <= LIMIT && self.place <= LIMIT
    }
}

/// The extent of each frame in the space of its solid.
pub(crate) fn extents(frames: &[Frame]) -> Vec<Extent> {
    let mut extents: Vec<Extent> = Vec::with_capacity(frames.len());
    for frame in frames {
        let own = Extent::of(&frame.placement);
        extents.push(frame.parent_index().map_or(own, |parent| extents[parent].then(own)));
    }
    extents
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use scene::{AttributesId, FrameId};

    use super::*;

    fn frame(parent: Option<u32>, scale: f64, x: f64) -> Frame {
        let placement = Placement {
            scale: DVec3::splat(scale),
            place: DVec3::new(x, 0.0, 0.0),
            ..Placement::default()
        };
        Frame { parent: parent.map(FrameId), placement, attributes: AttributesId::NONE }
    }

    #[test]
    fn scales_multiply_and_places_are_stretched() {
        let all = extents(&[frame(None, 10.0, 5.0), frame(Some(0), -0.5, 7.0)]);
        assert!((all[1].stretch - 5.0).abs() < 1e-12, "10 × 0.5");
        assert!((all[1].shrink - 0.2).abs() < 1e-12, "0.1 × 2");
        assert!((all[1].place - 75.0).abs() < 1e-12, "5 + 10 × 7");
    }

    #[test]
    fn what_overflows_is_not_fit() {
        assert!(extents(&[frame(None, 1e99, 1e99)])[0].is_fit(), "large");
        for frames in [
            vec![frame(None, 1e60, 0.0), frame(Some(0), 1e60, 0.0)],
            vec![frame(None, 1e-200, 0.0), frame(Some(0), 1e-200, 0.0)],
            vec![frame(None, 1.0, f64::MAX)],
        ] {
            assert!(!extents(&frames).last().unwrap().is_fit(), "{frames:?}");
        }
    }
}
