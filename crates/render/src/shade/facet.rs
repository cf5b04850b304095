//! What one facet of a rough surface mirrors, drawn by lot: many make the lobe of `microfacet` (Heitz and d'Eon,
//! "Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible Normals", 2014, for V-shaped grooves).

use glam::DVec3;

use crate::sampling::sequence::Draw;

/// Light of one direction, and the share of it that goes to the view but for the reflectance at `cosine`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Glint {
    /// Unit, away from the surface.
    pub(crate) toward: DVec3,
    /// Of the angle between either direction and the facet.
    pub(crate) cosine: f64,
    /// 0…1: what the grooves let out of what they let in.
    pub(crate) share: f64,
}

/// The light that a facet throws into the unit direction `view`, from a surface of slope `m` above 0 with this normal.
///
/// The mean of share × light over draws is the sum of [`lobe`](super::microfacet::lobe) × light over all directions. The
/// middle of all draws is the facet that lies as the surface does. None where the facet sees only the surface itself.
pub(crate) fn glint(normal: DVec3, view: DVec3, m: f64, draw: Draw) -> Option<Glint> {
    let facet = if draw == Draw::MIDDLE { normal } else { visible(normal, view, m, draw) };
    let cosine = view.dot(facet);
    let toward = 2.0 * cosine * facet - view;
    let (nl, nv, nh) = (normal.dot(toward), normal.dot(view), normal.dot(facet));
    // Also where the view lies in the surface, and nothing is a number.
    if !(nl > 0.0 && nv > 0.0 && cosine > 0.0) {
        return None;
    }
    let seen = lesser(1.0, 2.0 * nh * nv / cosine);
    let lit = lesser(1.0, 2.0 * nh * nl / cosine);
    Some(Glint { toward, cosine, share: lesser(seen, lit) / seen })
}

/// A facet by Beckmann's distribution, as often as the view sees it: each has another that makes a groove with it, and
/// the two are seen by how much they face the view.
fn visible(normal: DVec3, view: DVec3, m: f64, draw: Draw) -> DVec3 {
    let [height, turn] = draw.pair(0);
    let [choice, _] = draw.pair(1);
    let tangent = m * (-libm::log(1.0 - height)).sqrt();
    let (sine, cosine) = libm::sincos(std::f64::consts::TAU * turn);
    let (across, along) = normal.any_orthonormal_pair();
    let slant = tangent * (cosine * across + sine * along);
    let up = 1.0 / (1.0 + tangent * tangent).sqrt();
    let [facet, other] = [slant, -slant].map(|slant| up * (normal + slant));
    let [seen, hidden] = [facet, other].map(|facet| greater(view.dot(facet), 0.0));
    // Both are drawn as often; the better seen one is kept, so that draws that lie evenly stay even where they can.
    if choice * (seen + hidden) < hidden - seen { other } else { facet }
}

fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shade::microfacet::{furnace, lobe};
    use scene::transform::sin_cos_degrees;

    const SLOPES: [f64; 6] = [0.01, 0.05, 0.2, 0.4, 0.6, 1.0];
    const ANGLES: [f64; 5] = [0.0, 30.0, 60.0, 80.0, 88.0];

    fn view(angle: f64) -> DVec3 {
        let (s, c) = sin_cos_degrees(angle);
        DVec3::new(s, 0.0, c)
    }

    /// The mean over draws of share × light.
    fn mean(m: f64, view: DVec3, light: impl Fn(&Glint) -> f64) -> f64 {
        let draws = 1 << 16;
        let glint = |number| glint(DVec3::Z, view, m, Draw::new(number, 77));
        let glints = (0..draws).filter_map(glint);
        glints.map(|glint| glint.share * light(&glint)).sum::<f64>() / f64::from(draws)
    }

    #[test]
    fn many_are_the_lobe() {
        // Light that grows to one side and upward, and a reflectance that depends on the facet.
        type Light = fn(DVec3, f64) -> f64;
        let lights: [Light; 3] = [|_, _| 1.0, |l, _| (1.0 + l.x) * l.z, |_, cosine| 1.0 - cosine];
        for m in SLOPES {
            for angle in ANGLES {
                let view = view(angle);
                for (number, light) in lights.iter().enumerate() {
                    let found = mean(m, view, |glint| light(glint.toward, glint.cosine));
                    let summed = furnace(m, angle, 300, |view, toward| {
                        let cosine = view.dot((view + toward).normalize());
                        lobe(DVec3::Z, view, toward, m) * light(toward, cosine)
                    });
                    let off = (found - summed).abs();
                    assert!(off < 3e-3, "m {m} at {angle}°, light {number}: {found} for {summed}");
                }
            }
        }
    }

    #[test]
    fn all_are_mirrors_that_add_nothing() {
        for m in SLOPES {
            for angle in ANGLES {
                let view = view(angle);
                for number in 0..2000 {
                    let Some(glint) = glint(DVec3::Z, view, m, Draw::new(number, 3)) else {
                        continue;
                    };
                    let Glint { toward, cosine, share } = glint;
                    assert!((0.0..=1.0).contains(&share), "{share}");
                    assert!((toward.length() - 1.0).abs() < 1e-12 && toward.z > 0.0, "{toward}");
                    let half = (view + toward).normalize();
                    assert!((view.dot(half) - cosine).abs() < 1e-9, "{cosine}");
                }
            }
        }
    }

    #[test]
    fn the_middle_is_a_mirror() {
        for angle in ANGLES {
            let view = view(angle);
            let found = glint(DVec3::Z, view, 0.4, Draw::MIDDLE).expect("it is seen");
            let mirrored = DVec3::new(-view.x, 0.0, view.z);
            assert!((found.toward - mirrored).length() < 1e-15, "{angle}°: {}", found.toward);
            assert!((found.share - 1.0).abs() < 1e-15, "{angle}°: {}", found.share);
        }
    }

    #[test]
    fn a_view_within_the_surface_sees_nothing() {
        assert!(glint(DVec3::Z, DVec3::X, 0.3, Draw::MIDDLE).is_none());
        for number in 0..100 {
            assert!(glint(DVec3::Z, -DVec3::Z, 0.3, Draw::new(number, 1)).is_none());
        }
    }
}
