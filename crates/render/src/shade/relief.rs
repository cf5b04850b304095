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
    /// Variance of the rise over a unit of length, of both steps together: slopes that a ray takes in as one.
    scatter: f64,
}

impl Relief {
    /// Raises the surface by `height` times a weight, the mean over `pieces` of what the ray takes in, and returns that;
    /// `weight` is asked for the number of a piece and for a point, by how far that is away from the piece's middle.
    pub(crate) fn raise(
        &mut self,
        height: f64,
        steps: [DVec3; 2],
        pieces: f64,
        weight: impl Fn(f64, DVec3) -> f64,
    ) -> f64 {
        let (mut here, mut sum, mut square, mut piece) = (0.0, [0.0; 2], 0.0, 0.0);
        while piece < pieces {
            let middle = weight(piece, DVec3::ZERO);
            here += middle;
            for (sum, step) in sum.iter_mut().zip(steps) {
                let rise = weight(piece, step) - middle;
                *sum += rise;
                square += rise * rise / step.length_squared();
            }
            piece += 1.0;
        }
        let mut scatter = square / pieces;
        for (index, step) in steps.into_iter().enumerate() {
            let mean = sum[index] / pieces;
            self.rise[index] += height * mean;
            scatter -= mean * mean / step.length_squared();
        }
        // Less is rounding; also where it is not a number.
        self.scatter += if scatter > 0.0 { height * height * scatter } else { 0.0 };
        here / pieces
    }

    /// What the slopes that are taken in as one add to the square of the facets' slope, when `raised` is how far above
    /// the surface that lies which is raised by 1: Beckmann's m² is the variance of both slopes together (as normal maps
    /// are filtered by Olano and Baker, "LEAN Mapping", 2010).
    pub(crate) fn roughening(&self, raised: f64) -> f64 {
        let added = raised * raised * self.scatter;
        if added > 0.0 { added } else { 0.0 }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::MediumId;
    use glam::DMat3;
    use scene::Placement;
    use scene::transform::{apply, apply_transposed};

    fn event(normal: DVec3, direction: DVec3) -> Event {
        let cosine = -normal.dot(direction);
        Event { normal, cosine, far: MediumId::OPAQUE, ..Event::NONE }
    }

    /// The facing of a plane through the origin with the unit normal `n` in the coordinates of the paint, raised by
    /// `height · slope · p`, under the matrix `outer`, seen from in front.
    fn raised(n: DVec3, slope: DVec3, height: f64, outer: &DMat3, cofactor: &DMat3) -> Facing {
        let normal = unit(apply_transposed(cofactor, n));
        let event = event(normal, -normal);
        let across = normal.any_orthonormal_vector();
        let steps = [1e-3 * across, 1e-3 * normal.cross(across)];
        let mut relief = Relief::default();
        relief.raise(height, steps, 1.0, |_, away| slope.dot(apply(cofactor, away)));
        relief.facing(&event, -normal, steps, |high| apply(outer, high * n))
    }

    #[test]
    fn three_tangent_points_agree_with_the_cofactor() {
        let mut checked = 0;
        for i in 0..400_u32 {
            let f = f64::from(i);
            let n = unit(DVec3::new(f * 0.618 % 1.0 - 0.5, f * 0.377 % 1.0 - 0.5, 0.6));
            let slope =
                DVec3::new(f * 0.271 % 2.0 - 1.0, f * 0.119 % 2.0 - 1.0, f * 0.7 % 2.0 - 1.0);
            let map = Placement {
                scale: DVec3::new(if i % 3 == 0 { -1.3 } else { 0.7 }, 0.2 + f * 0.01, 2.0),
                rotation_degrees: DVec3::new(f * 7.0, f * 13.0, f * 29.0),
                ..Placement::default()
            }
            .map();
            let height = 0.1 * f64::from(i % 7);
            let facing = raised(n, slope, height, &map.linear, &map.inverse);
            // The level n·p = height · slope·p within the plane: its gradient, taken outward as gradients are.
            let gradient = n - height * (slope - slope.dot(n) * n);
            let expected = unit(map.gradient_outward(gradient));
            if expected.dot(unit(map.gradient_outward(n))) < 0.05 {
                continue;
            }
            checked += 1;
            assert!(
                facing.normal.abs_diff_eq(expected, 1e-10),
                "{i}: {} {expected}",
                facing.normal
            );
            assert!((facing.normal.length() - 1.0).abs() < 1e-14, "{i}: unit");
        }
        assert!(checked > 300, "{checked} raised planes face the eye");
    }

    #[test]
    fn what_turns_away_is_seen_at_the_slant_of_the_surface() {
        let direction = unit(DVec3::new(1.0, 0.0, -0.2));
        let event = event(DVec3::Z, direction);
        let steps = [DVec3::X, DVec3::Y];
        let mut relief = Relief::default();
        relief.raise(5.0, steps, 1.0, |_, away| -away.x);
        let facing = relief.facing(&event, direction, steps, |high| DVec3::Z * high);
        assert!(facing.cosine > 0.0 && facing.cosine <= 1.0, "{facing:?}");
        assert!((facing.cosine + facing.normal.dot(direction)).abs() < 1e-15, "{facing:?}");
    }

    #[test]
    fn slopes_that_are_taken_in_as_one_roughen() {
        // A roof: half of it rises by 0.5 over x, the other half falls by as much, and all rises by 0.2 over y.
        let steps = [1e-3 * DVec3::X, 2e-3 * DVec3::Y];
        let mut relief = Relief::default();
        relief.raise(2.0, steps, 8.0, |piece, away| {
            0.2 * away.y + if piece < 4.0 { 0.5 * away.x } else { -0.5 * away.x }
        });
        assert!(relief.rise[0].abs() < 1e-15, "{relief:?}");
        assert!((relief.rise[1] / 2e-3 - 0.4).abs() < 1e-12, "{relief:?}");
        // Slopes of ±1, three times as steep where a unit of height is 3.
        assert!((relief.roughening(3.0) - 9.0).abs() < 1e-9, "{relief:?}");
        let mut plane = Relief::default();
        plane.raise(2.0, steps, 8.0, |_, away| away.x - away.y);
        assert!(plane.roughening(3.0) < 1e-12, "{plane:?}");
    }

    #[test]
    fn rays_stay_on_their_side() {
        let below = unit(DVec3::new(1.0, 0.0, -0.3));
        let kept = kept_above(below, DVec3::Z);
        assert!(kept.abs_diff_eq(DVec3::new(below.x, 0.0, -below.z), 1e-15), "{kept}");
        assert_eq!(kept_above(-below, DVec3::Z), -below, "already there");
    }
}
