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
    /// cos of the angle of the view.
    pub(crate) cosine: f64,
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
            cosine,
        };
        if !shiny {
            return matte;
        }
        let room = 1.0 - gloss.mean();
        // A perfect mirror leaves nothing to the body.
        let entered = (1.0 - gloss.at(cosine)) / room;
        let out = Rgb::select(room.cmpgt(Rgb::ZERO), entered, Rgb::ZERO);
        Self { out, ..matte }
    }

    /// Radiance toward the eye per unit of light from direction `toward` (unit, N·L above 0), traced mirrors excepted.
    pub(crate) fn lit(&self, toward: DVec3) -> Rgb {
        let nl = self.normal.dot(toward);
        if !self.shiny {
            return self.color * nl;
        }
        let body = self.color * (1.0 - self.gloss.at(nl)) * self.out * nl;
        if self.slope <= 0.0 {
            return body + self.gloss.at(self.cosine) * spark(self.view, self.normal, toward);
        }
        let half = self.view + toward;
        let vh = self.view.dot(half) / half.length();
        let highlight = std::f64::consts::PI * lobe(self.normal, self.view, toward, self.slope);
        body + self.gloss.at(vh) * highlight
    }

    /// Radiance per unit of ambient light.
    pub(crate) fn ambient(&self) -> Rgb {
        if !self.shiny {
            return self.color;
        }
        // The mean of 1 − R over the hemisphere cancels against the room it is divided by.
        let albedo = self.color * self.out * (1.0 - self.gloss.mean());
        if self.slope <= 0.0 { albedo } else { albedo + self.gloss.at_normal() }
    }
}

/// sin² of the angular radius of a light in a mirror, 0.25°.
const DISC: f64 = 1.903_846_791_786_376e-5;
/// The square of the chord to its rim: 4 sin² of half the angle.
const CHORD_SQUARED: f64 = 1.903_855_852_977_164e-5;

/// The image of a light of intensity 1 in a mirror: its disc is bright by as much as it is small.
pub(crate) fn spark(view: DVec3, normal: DVec3, toward: DVec3) -> f64 {
    let mirrored = 2.0 * normal.dot(view) * normal - view;
    if (mirrored - toward).length_squared() <= CHORD_SQUARED { 1.0 / DISC } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::transform::sin_cos_degrees;

    #[test]
    fn the_disc_is_a_quarter_degree() {
        let s = libm::sin(0.25 * std::f64::consts::PI / 180.0);
        let h = libm::sin(0.125 * std::f64::consts::PI / 180.0);
        assert!((DISC / (s * s) - 1.0).abs() < 1e-9, "{}", s * s);
        assert!((CHORD_SQUARED / (4.0 * h * h) - 1.0).abs() < 1e-9, "{}", 4.0 * h * h);
    }

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
        for shininess in [0.05, 0.2, 0.5, 0.8] {
            let (ls, lc) = sin_cos_degrees(65.0);
            let (vs, vc) = sin_cos_degrees(20.0);
            let forth = surface(shininess, 0.25, 20.0).lit(DVec3::new(-ls, 0.0, lc)) / lc;
            let back = surface(shininess, 0.25, 65.0).lit(DVec3::new(-vs, 0.0, vc)) / vc;
            assert!(forth.abs_diff_eq(back, 1e-13), "{shininess}: {forth} {back}");
        }
    }

    #[test]
    fn no_more_comes_back_than_went_in() {
        for shininess in [0.0, 0.05, 0.2, 0.5, 0.8, 1.0] {
            for angle in [0.0, 45.0, 75.0, 87.0] {
                let optics = Optics { shininess, smoothness: 0.25, ..Optics::DEFAULT };
                let (s, c) = sin_cos_degrees(angle);
                let white = Opaque::new(&optics, Rgb::ONE, DVec3::Z, DVec3::new(-s, 0.0, -c), c);
                let (mut sum, n) = (0.0, 200);
                for i in 0..n {
                    for j in 0..2 * n {
                        let z = (f64::from(i) + 0.5) / f64::from(n);
                        let (s, c) = sin_cos_degrees((f64::from(j) + 0.5) * 180.0 / f64::from(n));
                        let r = (1.0 - z * z).sqrt();
                        sum += white.lit(DVec3::new(r * c, r * s, z)).x;
                    }
                }
                let albedo = sum / f64::from(n * n);
                // The body is dimmed by the reflectance at the view, the gloss is its mean over the facets, which is
                // a little more where the one curves: up to 0.5 % above 1 for white bodies of faint gloss.
                assert!(albedo < 1.005 && albedo > 0.5, "s {shininess} at {angle}°: {albedo}");
                let ambient = white.ambient().x;
                assert!(ambient <= 1.0 + 1e-12, "ambient s {shininess} at {angle}°: {ambient}");
            }
        }
    }
}
