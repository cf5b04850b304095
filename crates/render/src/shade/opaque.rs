//! Opaque surfaces under lights: a matte body below a gloss whose share grows toward grazing.

use glam::DVec3;
use scene::{Optics, Rgb};

use super::fresnel::Schlick;
use super::microfacet::lobe;

/// A surface at a point, with what does not depend on the light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Opaque {
    color: Rgb,
    pub(crate) gloss: Schlick,
    /// Slope of the facets; 0 is a mirror.
    slope: f64,
    shiny: bool,
    /// Share of the light that enters the body and comes out toward the eye, but for the way in.
    out: Rgb,
    view: DVec3,
    normal: DVec3,
}

impl Opaque {
    pub(crate) fn new(
        optics: &Optics,
        color: Rgb,
        normal: DVec3,
        direction: DVec3,
        cosine: f64,
    ) -> Self {
        let gloss = Schlick::new(optics, color);
        let shiny = optics.shininess > 0.0;
        let matte = Self {
            color,
            gloss,
            slope: optics.smoothness,
            shiny,
            out: Rgb::ZERO,
            view: -direction,
            normal,
        };
        if !shiny {
            return matte;
        }
        let room = 1.0 - gloss.mean();
        // A perfect mirror leaves nothing to the body.
        let entered = (1.0 - gloss.at(cosine)) * gloss.left_by_facets(optics.smoothness) / room;
        let out = Rgb::select(room.cmpgt(Rgb::ZERO), entered, Rgb::ZERO);
        Self { out, ..matte }
    }

    /// Radiance toward the eye per unit of light from direction `toward` (unit, N·L above 0), but for what a mirror shows.
    pub(crate) fn lit(&self, toward: DVec3) -> Rgb {
        let nl = self.normal.dot(toward);
        if !self.shiny {
            return self.color * nl;
        }
        self.body(nl) + self.highlight(toward)
    }

    /// What the body under the gloss sends back.
    fn body(&self, nl: f64) -> Rgb {
        self.color * (1.0 - self.gloss.at(nl)) * self.out * nl
    }

    /// What the gloss sends back, unless it is a mirror.
    fn highlight(&self, toward: DVec3) -> Rgb {
        if self.slope <= 0.0 {
            return Rgb::ZERO;
        }
        let half = self.view + toward;
        let vh = self.view.dot(half) / half.length();
        let highlight = std::f64::consts::PI * lobe(self.normal, self.view, toward, self.slope);
        self.gloss.at(vh) * highlight
    }

    /// Radiance per unit of ambient light.
    pub(crate) fn ambient(&self) -> Rgb {
        if !self.shiny {
            return self.color;
        }
        let body = self.body_ambient();
        if self.slope <= 0.0 { body } else { body + self.gloss.at_normal() }
    }

    /// Of that what the body of a shiny surface sends back.
    pub(crate) fn body_ambient(&self) -> Rgb {
        // The mean of 1 − R over the hemisphere cancels against the room it is divided by.
        self.color * self.out * (1.0 - self.gloss.mean())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::transform::sin_cos_degrees;

    fn surface(shininess: f64, smoothness: f64, angle: f64) -> Opaque {
        let (s, c) = sin_cos_degrees(angle);
        let optics = Optics { shininess, smoothness, ..Optics::DEFAULT };
        Opaque::new(&optics, Rgb::splat(0.8), DVec3::Z, DVec3::new(-s, 0.0, -c), c)
    }

    #[test]
    fn matte_is_lambertian_to_the_bit() {
        let (s, c) = sin_cos_degrees(50.0);
        let lit = surface(0.0, 0.25, 70.0).lit(DVec3::new(0.0, s, c));
        assert_eq!(lit, Rgb::splat(0.8) * c, "cosine law");
    }

    #[test]
    fn light_and_eye_can_change_places() {
        let direction = |angle: f64, azimuth: f64| {
            let ((s, c), (sa, ca)) = (sin_cos_degrees(angle), sin_cos_degrees(azimuth));
            DVec3::new(s * ca, s * sa, c)
        };
        let colors = [Rgb::splat(0.8), Rgb::new(1.0, 0.3, 0.0)];
        let angles = [0.0, 3.0, 20.0, 45.0, 65.0, 80.0, 89.0];
        let mut most = 0.0_f64;
        for shininess in [0.0, 0.01, 0.05, 0.2, 0.5, 0.8, 1.0] {
            for smoothness in [0.02, 0.05, 0.12, 0.25, 0.4, 0.6, 1.0] {
                for (pure, color) in [(false, colors[0]), (true, colors[1])] {
                    let optics = Optics { shininess, smoothness, pure, ..Optics::DEFAULT };
                    for (v, l, azimuth) in angles.iter().flat_map(|v| {
                        angles.iter().flat_map(move |l| [0.0, 100.0, 180.0].map(|a| (*v, *l, a)))
                    }) {
                        let (view, light) = (direction(v, 0.0), direction(l, azimuth));
                        let lit = |view: DVec3, light: DVec3| {
                            Opaque::new(&optics, color, DVec3::Z, -view, view.z).lit(light)
                                / light.z
                        };
                        let (forth, back) = (lit(view, light), lit(light, view));
                        let off = (forth - back).abs() / forth.max(Rgb::splat(1e-9));
                        most = most.max(off.max_element());
                    }
                }
            }
        }
        assert!(most < 1e-12, "{most:e}");
    }

    /// The share of light from everywhere that a surface sends to a view at `angle`, for channel x: facets by the
    /// distribution itself, which no sharpness defeats.
    fn albedo(optics: &Optics, color: Rgb, angle: f64, steps: u32) -> f64 {
        let (s, c) = sin_cos_degrees(angle);
        let view = DVec3::new(s, 0.0, c);
        let surface = Opaque::new(optics, color, DVec3::Z, -view, c);
        let (mut body, mut gloss) = (0.0, 0.0);
        let m = optics.smoothness;
        for i in 0..steps {
            let share = (f64::from(i) + 0.5) / f64::from(steps);
            // Directions of equal cosine, their share of light from everywhere.
            body += 2.0 * surface.body(share).x / f64::from(steps);
            let tangent_squared = -m * m * libm::log(share);
            let nh = 1.0 / (1.0 + tangent_squared).sqrt();
            let across = (1.0 - nh * nh).sqrt();
            let density = libm::exp(-tangent_squared / (m * m))
                / (std::f64::consts::PI * m * m * nh * nh * nh);
            for j in 0..steps {
                let (sa, ca) = sin_cos_degrees((f64::from(j) + 0.5) * 180.0 / f64::from(steps));
                let half = DVec3::new(across * ca, across * sa, nh);
                let vh = view.dot(half);
                let light = 2.0 * vh * half - view;
                if vh > 0.0 && light.z > 0.0 {
                    gloss += surface.highlight(light).x * 4.0 * vh / density;
                }
            }
        }
        body + gloss / (std::f64::consts::PI * f64::from(steps * steps))
    }

    #[test]
    fn no_more_comes_back_than_went_in() {
        let angles = [0.0, 20.0, 35.0, 42.0, 48.0, 53.0, 58.0, 62.0, 66.0, 70.0, 75.0, 82.0, 88.0];
        let mut most = 0.0_f64;
        for m in [0.02, 0.05, 0.07, 0.1, 0.12, 0.14, 0.16, 0.19, 0.25, 0.3, 0.34, 0.4, 0.6, 1.0] {
            for shininess in [0.01, 0.05, 0.07, 0.2, 0.8, 1.0] {
                for angle in angles {
                    let optics = Optics { shininess, smoothness: m, ..Optics::DEFAULT };
                    let white = albedo(&optics, Rgb::ONE, angle, 60);
                    assert!(white < 1.0 + 1e-5, "m {m} s {shininess} at {angle}°: {white}");
                    most = most.max(white);
                    for color in [0.1, 0.5, 0.9] {
                        let optics = Optics { pure: true, ..optics };
                        let metal = albedo(&optics, Rgb::splat(color), angle, 16);
                        assert!(
                            metal < 1.0,
                            "pure {color} m {m} s {shininess} at {angle}°: {metal}"
                        );
                    }
                }
            }
        }
        assert!(most > 0.9999, "the bound is near: {most}");
    }

    #[test]
    fn light_from_everywhere_is_no_more_than_it_was() {
        for shininess in [0.0, 0.05, 0.2, 0.5, 0.8, 1.0] {
            for smoothness in [0.0, 0.1, 0.25, 0.6] {
                for angle in [0.0, 45.0, 75.0, 87.0] {
                    let (s, c) = sin_cos_degrees(angle);
                    let optics = Optics { shininess, smoothness, ..Optics::DEFAULT };
                    let down = DVec3::new(-s, 0.0, -c);
                    let ambient = Opaque::new(&optics, Rgb::ONE, DVec3::Z, down, c).ambient().x;
                    let what = format!("s {shininess} m {smoothness} at {angle}°: {ambient}");
                    assert!(ambient <= 1.0 + 1e-12, "{what}");
                    assert!(smoothness <= 0.0 || ambient > 0.05, "{what}");
                }
            }
        }
    }
}
