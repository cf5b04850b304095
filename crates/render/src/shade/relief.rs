//! A surface that looks raised: its normal by three points of the raised surface (Blinn, "Simulation of Wrinkled
//! Surfaces", 1978).

use glam::DVec3;
use scene::transform::unit;

use crate::trace::event::Event;

/// Which way a surface faces where light is reckoned with; rays leave it by its own normal all the same.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facing {
    /// Unit, against the ray.
    pub(crate) normal: DVec3,
    /// Cosine of the angle between the normal and the way back, in 0…1.
    pub(crate) cosine: f64,
}

impl Facing {
    /// As the surface is.
    pub(crate) fn of(event: &Event) -> Self {
        Self { normal: event.normal, cosine: event.cosine }
    }
}

/// How much higher the raised surface is one step away than at the point, in the coordinates of the paint.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Relief {
    rise: [f64; 2],
}

impl Relief {
    /// Raises the surface by `height` times a weight, which is returned for the point itself.
    pub(crate) fn raise(
        &mut self,
        height: f64,
        steps: [DVec3; 2],
        weight: impl Fn(DVec3) -> f64,
    ) -> f64 {
        let here = weight(DVec3::ZERO);
        for (rise, step) in self.rise.iter_mut().zip(steps) {
            *rise += height * (weight(step) - here);
        }
        here
    }

    pub(crate) fn is_flat(&self) -> bool {
        self.rise.iter().all(|rise| rise.abs() <= 0.0)
    }

    /// Which way the raised surface faces; `raised` is the way from the surface to what lies so high above it.
    pub(crate) fn facing(
        &self,
        event: &Event,
        direction: DVec3,
        steps: [DVec3; 2],
        raised: impl Fn(f64) -> DVec3,
    ) -> Facing {
        let [first, second] = [0, 1].map(|i| steps[i] + raised(self.rise[i]));
        let across = first.cross(second);
        if !across.is_finite() || across == DVec3::ZERO {
            return Facing::of(event);
        }
        let normal = unit(across);
        let normal = if normal.dot(event.normal) < 0.0 { -normal } else { normal };
        let cosine = -normal.dot(direction);
        if cosine > 0.0 {
            let cosine = if cosine > 1.0 { 1.0 } else { cosine };
            return Facing { normal, cosine };
        }
        // What is turned away from the eye is not seen; what is seen in its place has the slant of the surface.
        let normal = unit(normal + (cosine - event.cosine) * direction);
        Facing { normal, cosine: -normal.dot(direction) }
    }
}

/// `out` on the side of the surface that `normal` is on: a raised surface can send a ray into its own body.
pub(crate) fn kept_above(out: DVec3, normal: DVec3) -> DVec3 {
    let above = out.dot(normal);
    if above < 0.0 { out - 2.0 * above * normal } else { out }
}
