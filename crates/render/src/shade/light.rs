//! What arrives from a light where nothing stands in between.

use glam::DVec3;
use scene::transform::{sin_cos_degrees, unit};
use scene::{LightKind, Rgb};

use super::spark::Spark;
use crate::sampling::disc::on_disc;
use crate::world::LoadedLight;

/// Light at a point: unit direction toward it, how far it is, and its strength there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arriving {
    pub(crate) toward: DVec3,
    pub(crate) distance: f64,
    pub(crate) color: Rgb,
}

/// The light that reaches `point` of a surface with this normal, or `None` where the light does not shine on it.
#[inline(always)]
pub(crate) fn arriving(light: &LoadedLight, point: DVec3, normal: DVec3) -> Option<Arriving> {
    let (at, concentration) = match light.kind {
        LightKind::Beam { .. } => {
            let toward = -light.axis;
            let lit = normal.dot(toward) > 0.0;
            return lit.then_some(Arriving { toward, distance: f64::INFINITY, color: light.color });
        }
        LightKind::Point { at } => (at, None),
        LightKind::Spot { at, concentration, .. } => (at, Some(concentration)),
    };
    let offset = at - point;
    if surely_dark(light, offset, normal) || offset == DVec3::ZERO {
        return None;
    }
    let toward = unit(offset);
    if normal.dot(toward) <= 0.0 {
        return None;
    }
    let distance = offset.dot(toward);
    let mut color = light.color;
    if let Some(concentration) = concentration {
        let cosine = -toward.dot(light.axis);
        if cosine < light.edge {
            return None;
        }
        color *= power(cosine, concentration);
    }
    Some(Arriving { toward, distance, color })
}

impl LoadedLight {
    /// A light of the scene, with the eye at the origin.
    pub(crate) fn new(light: &scene::Light, eye: DVec3) -> Self {
        let (kind, axis, edge) = match light.kind {
            LightKind::Point { at } => (LightKind::Point { at: at - eye }, DVec3::ZERO, -1.0),
            LightKind::Beam { at, toward } => {
                (LightKind::Beam { at: at - eye, toward: toward - eye }, unit(toward - at), -1.0)
            }
            LightKind::Spot { at, toward, concentration, half_angle_degrees } => (
                LightKind::Spot {
                    at: at - eye,
                    toward: toward - eye,
                    concentration,
                    half_angle_degrees,
                },
                unit(toward - at),
                sin_cos_degrees(half_angle_degrees).1,
            ),
        };
        Self { kind, color: light.color, shadows: light.shadows, radius: light.radius, axis, edge }
    }

    /// The light as it is seen from `origin`, drawn together in one point of its extent: a sphere shows the same disc to
    /// all sides, and a beam comes from a disc about where it begins.
    pub(crate) fn seen_at(&self, origin: DVec3, point: [f64; 2]) -> Self {
        let [x, y] = on_disc(point).map(|at| self.radius * at);
        let beside = |axis: DVec3| {
            let (right, up) = axis.any_orthonormal_pair();
            x * right + y * up
        };
        let from = |at: DVec3| {
            let offset = at - origin;
            if offset == DVec3::ZERO { at } else { at + beside(unit(offset)) }
        };
        let (kind, axis) = match self.kind {
            LightKind::Point { at } => (LightKind::Point { at: from(at) }, self.axis),
            LightKind::Spot { at, toward, concentration, half_angle_degrees } => {
                let at = from(at);
                (LightKind::Spot { at, toward, concentration, half_angle_degrees }, self.axis)
            }
            LightKind::Beam { at, toward } => {
                let at = at + beside(self.axis);
                (LightKind::Beam { at, toward }, unit(toward - at))
            }
        };
        Self { kind, axis, ..*self }
    }
}

/// False only if `spark` does not show a light in the unit `direction` from `point`: most it does not, and are found so
/// without a root.
pub(crate) fn may_show(spark: &Spark, light: &LoadedLight, point: DVec3, direction: DVec3) -> bool {
    let (LightKind::Point { at } | LightKind::Spot { at, .. }) = light.kind else { return true };
    if light.radius > 0.0 {
        return true;
    }
    spark.may_hold(at - point, direction)
}

/// True only if a surface is turned away from a light, or outside its cone, by more than rounding could say: most that
/// are dark are found so, without a root.
fn surely_dark(light: &LoadedLight, offset: DVec3, normal: DVec3) -> bool {
    const SLACK: f64 = 1e-9;
    let square = offset.length_squared();
    if !(1e-200..1e200).contains(&square) {
        return false;
    }
    // A signed square compares like the cosine it belongs to.
    let signed_square = |x: f64| x * x.abs();
    signed_square(normal.dot(offset)) < -SLACK * square
        || -signed_square(light.axis.dot(offset)) < (signed_square(light.edge) - SLACK) * square
}

/// cos^c: 1 everywhere for c = 0, nothing behind the light otherwise (Warn 1983).
fn power(cosine: f64, concentration: f64) -> f64 {
    if concentration <= 0.0 {
        1.0
    } else if cosine <= 0.0 {
        0.0
    } else if concentration.to_bits() == 1.0_f64.to_bits() {
        cosine
    } else {
        libm::pow(cosine, concentration)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::transform::sin_cos_degrees;

    fn spot(concentration: f64, half_angle_degrees: f64) -> LoadedLight {
        // The light of the paper's listing.
        let (at, toward) = (DVec3::new(0.0, 1000.0, -100.0), DVec3::new(0.0, 0.0, -2000.0));
        LoadedLight {
            kind: LightKind::Spot { at, toward, concentration, half_angle_degrees },
            color: Rgb::ONE,
            shadows: true,
            radius: 0.0,
            axis: (toward - at).normalize(),
            edge: sin_cos_degrees(half_angle_degrees).1,
        }
    }

    #[test]
    fn the_listings_spot() {
        let at = |x, y, z| {
            let point = DVec3::new(x, y, z);
            let light = spot(1.0, 62.0);
            let LightKind::Spot { at, .. } = light.kind else { unreachable!("a spot") };
            arriving(&light, point, (at - point).normalize()).map(|a| a.color.x)
        };
        assert!(at(0.0, 0.0, -104.0).is_none(), "62.012° off axis");
        assert!(at(0.0, 400.0, 0.0).is_none(), "the glass is dark");
        assert!((at(0.0, 1000.0, -1980.0).unwrap() - 0.8849).abs() < 1e-4, "27.759°");
        assert!((at(2000.0, 0.0, -1980.0).unwrap() - 0.7289).abs() < 1e-4, "43.206°");
        assert!((at(0.0, 0.0, -2000.0).unwrap() - 1.0).abs() < 1e-12, "on axis");
    }

    #[test]
    fn concentration_is_an_exponent() {
        for (c, angle, expected) in
            [(1.0, 60.0, 0.5), (4.0, 30.0, 0.5625), (16.0, 30.0, 0.100_112_915), (0.0, 120.0, 1.0)]
        {
            let value = power(sin_cos_degrees(angle).1, c);
            assert!((value - expected).abs() < 1e-8, "cos^{c} {angle}° = {value}");
        }
        assert!(power(-0.1, 1.0).abs() < 1e-300, "behind");
    }
}
