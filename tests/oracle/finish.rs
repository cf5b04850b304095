//! What surfaces make of light that comes from a light and goes to the eye, from the formulas of Cook and Torrance
//! (1982), Schlick (1994) and Beckmann's distribution.

use super::dd::{Dd, Vec3, dot, sin_cos_degrees, unit};

type Color = [f64; 3];

/// How a surface shines, and what it is painted with.
#[derive(Clone, Debug)]
pub(crate) struct Finish {
    /// Slope of the facets; 0 is a mirror.
    pub(crate) slope: f64,
    /// Reflects in its own colour.
    pub(crate) pure: bool,
    pub(crate) coats: Vec<super::paint::Coat>,
}

impl Finish {
    /// What is there where nothing is said.
    pub(crate) const PLAIN: Self = Self { slope: 0.25, pure: false, coats: Vec::new() };
}

/// An opaque surface: its body's colour below a gloss.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Opaque {
    color: Color,
    shininess: f64,
    slope: f64,
    pure: bool,
}

impl Opaque {
    pub(crate) fn new(color: Color, shininess: f64, finish: &Finish) -> Self {
        Self { color, shininess, slope: finish.slope, pure: finish.pure }
    }

    /// F0 and F90 of a channel.
    fn ends(&self, channel: usize) -> (f64, f64) {
        let f0 = if self.pure { self.shininess * self.color[channel] } else { self.shininess };
        (f0, f64::min(1.0, 20.0 * self.shininess))
    }

    /// The share of a channel reflected at an angle.
    pub(crate) fn reflects(&self, channel: usize, cosine: f64) -> f64 {
        let (f0, f90) = self.ends(channel);
        let m = 1.0 - cosine;
        f0 + (f90 - f0) * (m * m * m * m * m)
    }

    /// What a body that nothing shines upon would send back of light from everywhere; less what the gloss keeps of it.
    fn below(&self, channel: usize, view: f64) -> f64 {
        let (_, f90) = self.ends(channel);
        let m = self.slope;
        // A bound of what facets reflect above the value at their mean.
        let gain = [0.4 * m * m, 0.0039, 0.0244 * (0.36 - m)].into_iter().fold(1.0, f64::min);
        self.color[channel] * (1.0 - self.reflects(channel, view)) * (1.0 - f90 * gain.max(0.0))
    }

    /// Light of the body, of light that meets it at one angle and leaves it at another, per unit of the light's cosine.
    fn body(&self, channel: usize, light: f64, view: f64) -> f64 {
        let (f0, f90) = self.ends(channel);
        let mean = f0 + (f90 - f0) / 21.0;
        if mean >= 1.0 {
            return 0.0;
        }
        self.below(channel, view) * (1.0 - self.reflects(channel, light)) / (1.0 - mean)
    }

    /// What comes back to the eye of light from `toward`; all directions are units that point away from the surface.
    pub(crate) fn lit(&self, normal: &Vec3, view: &Vec3, toward: &Vec3) -> Color {
        let (nl, nv) = (dot(normal, toward).value(), dot(normal, view).value());
        let gloss = if self.shininess <= 0.0 {
            0.0
        } else if self.slope <= 0.0 {
            spark(normal, view, toward)
        } else {
            std::f64::consts::PI * lobe(normal, view, toward, self.slope)
        };
        let angle = if self.slope <= 0.0 { nv } else { half_angle(view, toward) };
        std::array::from_fn(|k| self.body(k, nl, nv) * nl + self.reflects(k, angle) * gloss)
    }

    /// What comes back to the eye of light from everywhere, but for what is traced.
    pub(crate) fn ambient(&self, view: f64) -> Color {
        std::array::from_fn(|k| {
            let (f0, f90) = self.ends(k);
            let body = if f0 + (f90 - f0) / 21.0 < 1.0 { self.below(k, view) } else { 0.0 };
            body + if self.shininess > 0.0 && self.slope > 0.0 { f0 } else { 0.0 }
        })
    }
}

/// The direction midway.
fn half(view: &Vec3, toward: &Vec3) -> Vec3 {
    unit(&std::array::from_fn(|k| view[k] + toward[k]))
}

/// cos of half the angle between the view and the light.
pub(crate) fn half_angle(view: &Vec3, toward: &Vec3) -> f64 {
    dot(view, &half(view, toward)).value()
}

/// D · G / (4 (N·V)), with Beckmann's distribution and the shadows of V-shaped grooves.
#[expect(clippy::disallowed_methods, reason = "the oracle shares nothing with the tracer")]
pub(crate) fn lobe(normal: &Vec3, view: &Vec3, toward: &Vec3, slope: f64) -> f64 {
    let half = half(view, toward);
    let (nl, nv) = (dot(normal, toward), dot(normal, view));
    let (nh, vh) = (dot(normal, &half), dot(view, &half));
    if nl <= Dd::ZERO || nv <= Dd::ZERO {
        return 0.0;
    }
    let square = nh * nh;
    let tangent = ((Dd::ONE - square) / square).value();
    let flat = slope * slope;
    let distribution =
        (-tangent / flat).exp() / (std::f64::consts::PI * flat * (square * square).value());
    let two = Dd::from(2.0);
    let [masked, shadowed] = [nv, nl].map(|cosine| (two * nh * cosine / vh).value());
    let open = f64::min(1.0, f64::min(masked, shadowed));
    distribution * open / (4.0 * nv.value())
}

/// The image of a light in a mirror: a disc of 0.25° about its direction that sends as much as the light does.
pub(crate) fn spark(normal: &Vec3, view: &Vec3, toward: &Vec3) -> f64 {
    let (rim, cosine) = sin_cos_degrees(0.25);
    let twice = dot(normal, view) + dot(normal, view);
    let mirrored: Vec3 = std::array::from_fn(|k| twice * normal[k] - view[k]);
    if dot(&unit(&mirrored), toward) >= cosine { 1.0 / (rim * rim).value() } else { 0.0 }
}
