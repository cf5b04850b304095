//! Reflection and refraction at the interface of two clear media, and the reflectance of opaque surfaces.

use glam::DVec3;
use scene::transform::unit;
use scene::{Optics, Rgb};

/// Reflected share of unpolarised light that meets an interface from index `n1` to `n2` at `cosine`, and the cosine of
/// the refracted ray, 0 where all is reflected. Equal indices reflect nothing, to the bit.
pub(crate) fn reflectance(n1: f64, n2: f64, cosine: f64) -> (f64, f64) {
    let ratio = n1 / n2;
    if (ratio - 1.0).abs() <= 0.0 {
        return (0.0, cosine);
    }
    // 1 − ratio² sin², written so that nothing cancels where the indices are nearly alike.
    let below = (n2 - n1) / n2 * (1.0 + ratio) + (ratio * cosine) * (ratio * cosine);
    if below <= 0.0 {
        return (1.0, 0.0);
    }
    let refracted = below.sqrt();
    let across = (n1 * cosine - n2 * refracted) / (n1 * cosine + n2 * refracted);
    let along = (n2 * cosine - n1 * refracted) / (n2 * cosine + n1 * refracted);
    (0.5 * (across * across + along * along), refracted)
}

/// The mirrored direction, unit length; `cosine` is −normal · direction.
pub(crate) fn reflected(direction: DVec3, normal: DVec3, cosine: f64) -> DVec3 {
    let d = direction + 2.0 * cosine * normal;
    unit(d)
}

/// The refracted direction, unit length, for the indices' `ratio` n1 / n2 and the cosine from [`reflectance`].
pub(crate) fn refracted(
    direction: DVec3,
    normal: DVec3,
    ratio: f64,
    cosine: f64,
    refracted: f64,
) -> DVec3 {
    let d = ratio * direction + (ratio * cosine - refracted) * normal;
    unit(d)
}

fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Reflectance of an opaque surface between normal incidence and grazing (Schlick).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Schlick {
    normal: Rgb,
    grazing: f64,
}

impl Schlick {
    /// Shininess at the normal, tinted where the material is pure; at grazing 1, for faint gloss less.
    pub(crate) fn new(optics: &Optics, color: Rgb) -> Self {
        let s = optics.shininess;
        let grazing = if 20.0 * s < 1.0 { 20.0 * s } else { 1.0 };
        Self { normal: if optics.pure { s * color } else { Rgb::splat(s) }, grazing }
    }

    pub(crate) fn at(&self, cosine: f64) -> Rgb {
        let m = 1.0 - cosine;
        let fifth = (m * m) * (m * m) * m;
        self.normal + (self.grazing - self.normal) * fifth
    }

    /// The share that facets of slope `m` leave of what [`Schlick::at`] leaves to the body.
    ///
    /// Between 40° and 70° the mean over the facets is more than the value at their mean, where the curve bends up:
    /// without this, white bodies of faint gloss would send back up to 0.4 % more than they get. The loss is a bound
    /// of that gain over all angles, in three straight pieces of m and m²; past 0.36 the grooves take more than the
    /// bend gives.
    pub(crate) fn left_by_facets(&self, m: f64) -> f64 {
        let loss = lesser(0.4 * m * m, lesser(0.0039, 0.0244 * (0.36 - m)));
        if loss > 0.0 { 1.0 - loss * self.grazing } else { 1.0 }
    }

    pub(crate) fn at_normal(&self) -> Rgb {
        self.normal
    }

    /// The mean over the hemisphere, weighted by the cosine.
    pub(crate) fn mean(&self) -> Rgb {
        self.normal + (self.grazing - self.normal) / 21.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cos(degrees: f64) -> f64 {
        scene::transform::sin_cos_degrees(degrees).1
    }

    #[test]
    fn published_values() {
        // Reference page on Fresnel: from, to, angle, reflected share, angle of refraction.
        for (n1, n2, angle, expected, refracted) in [
            (1.0, 1.65, 0.0, 0.060_163_759, 0.0),
            (1.0, 1.65, 30.0, 0.061_924_633, 17.639_70),
            (1.0, 1.65, 45.0, 0.071_651_391, 25.375_55),
            (1.0, 1.65, 60.0, 0.112_894_634, 31.659_08),
            (1.65, 1.0, 30.0, 0.094_508_348, 55.588_49),
            (1.36, 1.0, 45.0, 0.202_556_942, 74.084_09),
            (1.65, 1.36, 30.0, 0.011_043_873, 37.345_34),
            (1.36, 1.65, 60.0, 0.036_131_709, 45.546_16),
            (1.65, 1.36, 0.0, 0.009_282_458, 0.0),
            (1.0, 1.36, 0.0, 0.023_269_176, 0.0),
            (1.0, 1.5, 0.0, 0.04, 0.0),
        ] {
            let (r, c) = reflectance(n1, n2, cos(angle));
            assert!((r - expected).abs() < 1e-9, "{n1}→{n2} at {angle}°: {r}");
            assert!((c - cos(refracted)).abs() < 1e-7, "{n1}→{n2} at {angle}°: cosine {c}");
        }
        assert_eq!(reflectance(1.65, 1.0, cos(45.0)), (1.0, 0.0), "total");
        assert_eq!(reflectance(1.5, 1.5, 0.3), (0.0, 0.3), "matched");
    }

    #[test]
    fn published_shares_toward_grazing() {
        for (n1, n2, angle, expected) in [
            (1.0, 1.65, 75.0, 0.276_378_347),
            (1.0, 1.65, 85.0, 0.624_494_112),
            (1.0, 1.65, 89.0, 0.906_671_092),
            (1.0, 1.36, 45.0, 0.031_339_246),
            (1.0, 1.36, 60.0, 0.064_719_485),
            (1.0, 1.36, 75.0, 0.220_507_302),
            (1.65, 1.36, 45.0, 0.033_432_601),
            (1.0, 1.5, 60.0, 0.089_186_713),
        ] {
            let (r, _) = reflectance(n1, n2, cos(angle));
            assert!((r - expected).abs() < 1e-9, "{n1}→{n2} at {angle}°: {r}");
        }
        for (n1, n2, critical) in [
            (1.65, 1.0, 37.305_201),
            (1.36, 1.0, 47.332_075),
            (1.65, 1.36, 55.511_760),
            (1.5, 1.0, 41.810_315),
        ] {
            let at = |angle| reflectance(n1, n2, cos(angle)).0;
            assert!(at(critical - 1e-5) < 1.0 && at(critical + 1e-5) >= 1.0, "{n1}→{n2}");
        }
    }

    #[test]
    fn means_over_the_hemisphere() {
        let mean = |n1: f64, n2: f64| {
            let (mut sum, steps) = (0.0, 100_000);
            for i in 0..steps {
                let c = (f64::from(i) + 0.5) / f64::from(steps);
                sum += 2.0 * c * reflectance(n1, n2, c).0 / f64::from(steps);
            }
            sum
        };
        for (n, published) in [(1.65, 0.113_328), (1.36, 0.070_643), (1.5, 0.091_778)] {
            let (into, out) = (mean(1.0, n), mean(n, 1.0));
            assert!((into - published).abs() < 1e-6, "into {n}: {into}");
            // What comes out is as much as went in, from a solid angle that is n² times narrower.
            let expected = 1.0 - (1.0 - into) / (n * n);
            assert!((out - expected).abs() < 1e-6, "out of {n}: {out}, expected {expected}");
        }
    }

    #[test]
    fn both_ways_reflect_alike() {
        let (forward, c) = reflectance(1.0, 1.65, cos(50.0));
        let (back, _) = reflectance(1.65, 1.0, c);
        assert!((forward - back).abs() < 1e-15, "{forward} {back}");
        assert!((forward - 0.079_713_321_1).abs() < 1e-10, "{forward}");
    }

    /// The transmitted share by its own amplitudes, not as what is left.
    fn transmittance(n1: f64, n2: f64, cosine: f64, refracted: f64) -> f64 {
        let across = 2.0 * n1 * cosine / (n1 * cosine + n2 * refracted);
        let along = 2.0 * n1 * cosine / (n2 * cosine + n1 * refracted);
        n2 * refracted / (n1 * cosine) * 0.5 * (across * across + along * along)
    }

    #[test]
    fn what_is_not_reflected_goes_through() {
        let mut most = 0.0_f64;
        for i in 0..60 {
            for j in 0..60 {
                // From 0.01 to 100, and nearly alike.
                let n1 = libm::exp10(f64::from(i) / 15.0 - 2.0);
                let n2 =
                    if j == 0 { n1 * 1.000_001 } else { libm::exp10(f64::from(j) / 15.0 - 2.0) };
                for k in 1..=180 {
                    let cosine = cos(90.0 - 0.5 * f64::from(k));
                    let (reflected, refracted) = reflectance(n1, n2, cosine);
                    assert!((0.0..=1.0).contains(&reflected), "{n1}→{n2} at {cosine}: {reflected}");
                    if refracted > 0.0 && n1.to_bits() != n2.to_bits() {
                        let through = transmittance(n1, n2, cosine, refracted);
                        most = most.max((reflected + through - 1.0).abs());
                    }
                }
            }
        }
        assert!(most < 1e-12, "{most:e}");
    }

    #[test]
    fn directions_by_hand() {
        let (d, n) = (DVec3::new(0.6, -0.8, 0.0), DVec3::Y);
        let (_, c) = reflectance(1.0, 1.65, 0.8);
        let t = refracted(d, n, 1.0 / 1.65, 0.8, c);
        assert!(t.abs_diff_eq(DVec3::new(0.363_636_36, -0.931_540_98, 0.0), 1e-8), "{t}");
        assert!(reflected(d, n, 0.8).abs_diff_eq(DVec3::new(0.6, 0.8, 0.0), 1e-15), "mirror");
    }

    #[test]
    fn the_mean_is_the_integral() {
        let optics = Optics { shininess: 0.3, ..Optics::DEFAULT };
        let schlick = Schlick::new(&optics, Rgb::ONE);
        let steps = 100_000;
        let mut sum = 0.0;
        for i in 0..steps {
            let c = (f64::from(i) + 0.5) / f64::from(steps);
            sum += 2.0 * c * schlick.at(c).x / f64::from(steps);
        }
        assert!((sum - schlick.mean().x).abs() < 1e-8, "{sum}");
    }
}
