//! What a ray stands for: a cone, and the piece of a surface that it takes in (Amanatides, "Ray Tracing with Cones", 1984).

use glam::DVec3;

use crate::trace::event::Event;

/// The cone of a ray: how wide it is, and how much wider it gets.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Cone {
    /// From edge to edge, where the ray starts.
    pub(crate) width: f64,
    /// Growth for each unit of length.
    pub(crate) spread: f64,
}

impl Cone {
    /// Of a ray that springs from where this one ends: `turned` is by how much the normal turns over its width there, and
    /// `bend` how much of that the new ray turns.
    pub(crate) fn sprung(&self, length: f64, turned: f64, bend: f64) -> Self {
        Self { width: self.width_at(length), spread: self.spread + bend * turned }
    }

    /// How wide it is at a length.
    pub(crate) fn width_at(&self, length: f64) -> f64 {
        self.width + self.spread * length
    }

    /// What it takes in of the surface it meets.
    pub(crate) fn footprint(&self, event: &Event, direction: DVec3) -> Footprint {
        let width = self.width_at(event.way());
        // Both are in the plane of the surface; the first is across the ray, the second as long as it is slanted.
        let across = event.normal.cross(direction);
        let sine = across.length();
        let across = if sine > 0.0 { across / sine } else { event.normal.any_orthonormal_vector() };
        let along = event.normal.cross(across);
        let slant = if event.cosine > LEAST_COSINE { event.cosine } else { LEAST_COSINE };
        Footprint { across: width * across, along: width / slant * along }
    }
}

/// Seen at less than this a surface is less than a pixel high: longer footprints see the same of it.
const LEAST_COSINE: f64 = 1.0 / 1024.0;

/// The edges of the piece of a surface that a ray takes in, in its tangent plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footprint {
    /// Across the ray.
    pub(crate) across: DVec3,
    /// Along it.
    pub(crate) along: DVec3,
}

impl Footprint {
    /// Both edges taken to another space.
    pub(crate) fn moved(&self, by: impl Fn(DVec3) -> DVec3) -> Self {
        Self { across: by(self.across), along: by(self.along) }
    }

    /// Into how many pieces along its length it is to be cut so that none is much longer than wide; what is longer than
    /// [`Self::PIECES`] widths is left so.
    pub(crate) fn pieces(&self) -> f64 {
        let (width, length) = (self.across.length(), self.along.length());
        let pieces = libm::floor(2.0 * length / width - 0.5);
        // Also where there is no width.
        if pieces > 1.0 { if pieces < Self::PIECES { pieces } else { Self::PIECES } } else { 1.0 }
    }

    const PIECES: f64 = 32.0;

    /// One of its `pieces`, and how far its middle is from the whole's.
    pub(crate) fn piece(&self, number: f64, pieces: f64) -> (Self, DVec3) {
        let along = self.along / pieces;
        (Self { along, ..*self }, (number + 0.5 - 0.5 * pieces) * along)
    }

    /// How long it is along each axis: of a piece in any position the mean square is that of an upright one.
    pub(crate) fn extent(&self) -> DVec3 {
        let square = self.across * self.across + self.along * self.along;
        DVec3::new(square.x.sqrt(), square.y.sqrt(), square.z.sqrt())
    }
}
