//! The Cook-Torrance lobe with Beckmann's distribution (Cook and Torrance, "A Reflectance Model for Computer Graphics",
//! 1982), in the form that is normalised to 1.

use glam::DVec3;

/// D · G / (4 (N·L) (N·V)) · (N·L) for slope `m` above 0: times the reflectance at V·H and π times the light's
/// intensity it is the radiance of the highlight.
///
/// `view` and `light` point away from the surface. The factor N·V is cancelled against the shadowing of the V-shaped
/// grooves, so grazing views stay finite.
pub(crate) fn lobe(normal: DVec3, view: DVec3, light: DVec3, m: f64) -> f64 {
    let (nl, nv) = (normal.dot(light), normal.dot(view));
    if nl <= 0.0 || nv <= 0.0 {
        return 0.0;
    }
    let half = view + light;
    let half = half / half.length();
    let (nh, vh) = (normal.dot(half), view.dot(half));
    // By the cross product: 1 − cos² has no digits left where the lobe is sharp.
    let tangent_squared = normal.cross(half).length_squared() / (nh * nh);
    let distribution = libm::exp(-tangent_squared / (m * m))
        / (std::f64::consts::PI * m * m * (nh * nh) * (nh * nh));
    let open = 1.0 / (4.0 * nv);
    let masked = nh / (2.0 * vh);
    let shadowed = nh * nl / (2.0 * vh * nv);
    let grooves = if open < masked { open } else { masked };
    distribution * if grooves < shadowed { grooves } else { shadowed }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::transform::sin_cos_degrees;

    fn direction(angle: f64, azimuth: f64) -> DVec3 {
        let ((s, c), (sa, ca)) = (sin_cos_degrees(angle), sin_cos_degrees(azimuth));
        DVec3::new(s * ca, s * sa, c)
    }

    #[test]
    fn published_values() {
        // Reference page on Cook-Torrance: D G / (4 NL NV) at angles of light and view, azimuth between, slope.
        for (l, v, azimuth, m, expected) in [
            (30.0, 30.0, 180.0, 0.2, 2.652_582_38),
            (45.0, 45.0, 180.0, 0.4, 0.994_718_394),
            (60.0, 20.0, 180.0, 0.3, 0.553_852_877),
            (30.0, 30.0, 90.0, 0.2, 0.055_976_03),
            (0.0, 0.0, 0.0, 0.05, 31.830_988_6),
        ] {
            let (light, view) = (direction(l, 0.0), direction(v, azimuth));
            let value = lobe(DVec3::Z, view, light, m) / light.z;
            assert!((value / expected - 1.0).abs() < 1e-7, "{l} {v} {azimuth} {m}: {value}");
        }
    }

    #[test]
    fn a_white_furnace_gives_back_no_more_than_it_gets() {
        for m in [0.05, 0.12, 0.25, 0.4, 0.6] {
            for angle in [0.0, 30.0, 60.0, 75.0, 85.0, 89.0] {
                let view = direction(angle, 0.0);
                let (mut sum, n) = (0.0, 300);
                for i in 0..n {
                    for j in 0..2 * n {
                        let z = (f64::from(i) + 0.5) / f64::from(n);
                        let (s, c) = sin_cos_degrees((f64::from(j) + 0.5) * 180.0 / f64::from(n));
                        let r = (1.0 - z * z).sqrt();
                        sum += lobe(DVec3::Z, view, DVec3::new(r * c, r * s, z), m);
                    }
                }
                let albedo = sum * std::f64::consts::TAU / f64::from(2 * n * n);
                // The sharpest lobe is coarsely integrated: 2 %.
                assert!(albedo < 1.02 && albedo > 0.3, "m {m} at {angle}°: {albedo}");
            }
        }
    }
}
