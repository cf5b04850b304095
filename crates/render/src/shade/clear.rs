//! Rough surfaces of clear bodies: what they reflect, by a lobe and by a mirror, is what goes through taken from 1.

use glam::DVec3;

use super::fresnel::reflectance;
use super::microfacet::lobe;

/// The reflection of a clear surface that is not a perfect mirror, seen at one angle.
///
/// Of the reflected share R the facets throw back what a surface reflects that is met straight on, F0: light of the
/// lamps as a lobe, and of ambient light F0. What R is beyond that, up to all of it in total reflection, is mirrored: a
/// clear body loses no light within.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoughClear {
    n1: f64,
    n2: f64,
    slope: f64,
    /// R at the angle of the view.
    reflects: f64,
    /// The share of ambient light that is thrown back.
    pub(crate) ambient: f64,
    /// The share that is mirrored; with `ambient` R.
    pub(crate) mirrored: f64,
}

fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

impl RoughClear {
    /// From index `n1` to `n2`, with facets of a slope above 0, where the share `reflects` of the view is reflected.
    pub(crate) fn new(n1: f64, n2: f64, slope: f64, reflects: f64) -> Self {
        // Of high indices R falls below F0 before it rises.
        let ambient = lesser(reflectance(n1, n2, 1.0).0, reflects);
        Self { n1, n2, slope, reflects, ambient, mirrored: reflects - ambient }
    }

    /// Radiance toward the eye per unit of light from `toward`; all directions are units that point away from the surface.
    ///
    /// Facets reflect by their own angle, but no more than the surface does at the angles of view and light: their mean
    /// would be above R where the curve bends up, most of all before total reflection, and more would come back than
    /// there was. The least of the three is the same when light and eye change places.
    pub(crate) fn highlight(&self, normal: DVec3, view: DVec3, toward: DVec3) -> f64 {
        let facets = lobe(normal, view, toward, self.slope);
        if facets <= 0.0 {
            return 0.0;
        }
        let half = view + toward;
        let reflects = |cosine| reflectance(self.n1, self.n2, cosine).0;
        let share = lesser(reflects(view.dot(half) / half.length()), reflects(normal.dot(toward)));
        std::f64::consts::PI * facets * lesser(share, self.reflects)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shade::microfacet::furnace;
    use scene::transform::sin_cos_degrees;

    const INDICES: [(f64, f64); 8] = [
        (1.0, 1.5),
        (1.5, 1.0),
        (1.0, 1.65),
        (1.65, 1.36),
        (1.0, 2.4),
        (2.4, 1.0),
        (1.0, 20.0),
        (20.0, 1.0),
    ];

    fn direction(angle: f64, azimuth: f64) -> DVec3 {
        let ((s, c), (sa, ca)) = (sin_cos_degrees(angle), sin_cos_degrees(azimuth));
        DVec3::new(s * ca, s * sa, c)
    }

    fn surface((n1, n2): (f64, f64), slope: f64, cosine: f64) -> RoughClear {
        RoughClear::new(n1, n2, slope, reflectance(n1, n2, cosine).0)
    }

    #[test]
    fn nothing_is_lost() {
        for indices in INDICES {
            let straight = surface(indices, 0.25, 1.0);
            assert!(straight.mirrored.abs() <= 0.0, "{indices:?}: a lobe alone, seen straight on");
            for tenth in 0..900 {
                let cosine = direction(0.1 * f64::from(tenth), 0.0).z;
                let (reflected, _) = reflectance(indices.0, indices.1, cosine);
                let seen = surface(indices, 0.25, cosine);
                let off = (seen.ambient + seen.mirrored - reflected).abs();
                assert!(off < 1e-15 && seen.mirrored >= 0.0, "{indices:?} at {cosine}: {seen:?}");
            }
        }
        let total = surface((1.5, 1.0), 0.25, 0.5);
        assert!((total.ambient - 0.04).abs() < 1e-15, "{total:?}");
        assert!((total.mirrored - 0.96).abs() < 1e-15, "{total:?}");
    }

    /// The share of light from everywhere that comes back to a view at `angle` from the lobe.
    fn albedo(indices: (f64, f64), m: f64, angle: f64, steps: u32) -> f64 {
        let surface = surface(indices, m, direction(angle, 0.0).z);
        let response = |view, light| surface.highlight(DVec3::Z, view, light);
        furnace(m, angle, steps, response) / std::f64::consts::PI
    }

    #[test]
    fn lamps_all_around_give_back_no_more_than_is_reflected() {
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        for indices in INDICES {
            for m in [0.01, 0.05, 0.12, 0.25, 0.4, 0.6, 1.0] {
                for angle in [0.0, 20.0, 30.0, 37.0, 41.0, 45.0, 60.0, 75.0, 85.0, 89.0] {
                    let view = direction(angle, 0.0).z;
                    let (reflected, _) = reflectance(indices.0, indices.1, view);
                    let found = albedo(indices, m, angle, 60);
                    let what = format!("{indices:?} m {m} at {angle}°: {found} of {reflected}");
                    assert!(found <= reflected * (1.0 + 1e-9), "{what}");
                    most = most.max(found / reflected);
                    if m < 0.06 && (20.0..76.0).contains(&angle) {
                        least = least.min(found / reflected);
                    }
                }
            }
        }
        assert!(most > 0.999, "the bound is met: {most}");
        assert!(least > 0.6, "sharp lobes hold most of it: {least}");
    }

    #[test]
    fn light_and_eye_can_change_places() {
        let mut most = 0.0_f64;
        let angles = [0.0, 3.0, 20.0, 38.0, 45.0, 65.0, 80.0, 89.0];
        for indices in INDICES {
            for m in [0.02, 0.12, 0.25, 0.6] {
                for (v, l, azimuth) in angles.iter().flat_map(|v| {
                    angles.iter().flat_map(move |l| [0.0, 100.0, 180.0].map(|a| (*v, *l, a)))
                }) {
                    let (view, light) = (direction(v, 0.0), direction(l, azimuth));
                    let lit = |view: DVec3, light: DVec3| {
                        surface(indices, m, view.z).highlight(DVec3::Z, view, light) / light.z
                    };
                    let (forth, back) = (lit(view, light), lit(light, view));
                    most = most.max((forth - back).abs() / forth.max(1e-9));
                }
            }
        }
        assert!(most < 1e-12, "{most:e}");
    }
}
