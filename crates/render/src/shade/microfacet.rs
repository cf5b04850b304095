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

/// The share of light from everywhere that a surface sends to a view at `angle` degrees, where `response` is what it
/// sends of the light of a direction: sums over facets of slope `m` by their own distribution, which no sharpness
/// defeats.
#[cfg(test)]
pub(super) fn furnace(
    m: f64,
    angle: f64,
    steps: u32,
    response: impl Fn(DVec3, DVec3) -> f64,
) -> f64 {
    use scene::transform::sin_cos_degrees;
    let (s, c) = sin_cos_degrees(angle);
    let view = DVec3::new(s, 0.0, c);
    let mut sum = 0.0;
    for i in 0..steps {
        let share = (f64::from(i) + 0.5) / f64::from(steps);
        let tangent_squared = -m * m * libm::log(share);
        let nh = 1.0 / (1.0 + tangent_squared).sqrt();
        let across = (1.0 - nh * nh).sqrt();
        let density = share / (std::f64::consts::PI * m * m * nh * nh * nh);
        for j in 0..steps {
            let (s, c) = sin_cos_degrees((f64::from(j) + 0.5) * 180.0 / f64::from(steps));
            let half = DVec3::new(across * c, across * s, nh);
            let vh = view.dot(half);
            let light = 2.0 * vh * half - view;
            if vh > 0.0 && light.z > 0.0 {
                sum += response(view, light) * 4.0 * vh / density;
            }
        }
    }
    sum / f64::from(steps * steps)
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
    fn published_widths() {
        // Angles at which the distribution is half of what it is at the normal; light and view in one direction.
        for (m, half) in
            [(0.05, 2.39), (0.1, 4.81), (0.2, 9.84), (0.3, 15.36), (0.4, 21.66), (0.6, 37.24)]
        {
            let at = |angle: f64| {
                let view = direction(angle, 0.0);
                lobe(DVec3::Z, view, view, m) * 4.0 * view.z * std::f64::consts::PI * m * m
            };
            assert!((at(0.0) - 1.0).abs() < 1e-12, "{m}: {}", at(0.0));
            assert!(at(half - 0.01) > 0.5 && at(half + 0.01) < 0.5, "{m}: {}", at(half));
        }
    }

    fn albedo(m: f64, angle: f64, steps: u32) -> f64 {
        furnace(m, angle, steps, |view, light| lobe(DVec3::Z, view, light, m))
    }

    #[test]
    fn published_shares_of_a_white_furnace() {
        for (m, angle, expected) in [
            (0.05, 0.0, 1.0),
            (0.05, 75.0, 0.999),
            (0.2, 60.0, 0.966),
            (0.4, 0.0, 0.964),
            (0.4, 60.0, 0.901),
            (0.6, 0.0, 0.798),
        ] {
            let found = albedo(m, angle, 300);
            assert!((found - expected).abs() < 6e-4, "m {m} at {angle}°: {found}");
        }
    }

    #[test]
    fn a_white_furnace_gives_back_no_more_than_it_gets() {
        for m in [0.001, 0.01, 0.02, 0.05, 0.12, 0.25, 0.4, 0.6, 0.8, 1.0] {
            for angle in [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0, 89.0, 89.9] {
                let found = albedo(m, angle, 80);
                assert!(found < 1.0 + 1e-9 && found > 0.3, "m {m} at {angle}°: {found}");
            }
        }
    }
}
