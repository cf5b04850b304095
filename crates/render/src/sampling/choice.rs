//! The way of sampling that suits a scene, where nothing is said of it.

use scene::Scene;

use crate::options::{Rate, Sampling};

/// Samples of a pixel that are drawn by lot; and how often a pixel is divided, which makes as many squares at most.
const SAMPLES: u32 = 16;
const LEVELS: u32 = SAMPLES.ilog2() / 2;

impl Sampling {
    /// What suits a scene where nothing is said of sampling, and of a glossy render ([`crate::LoadOptions::glossy`]):
    /// 16 samples by lot where the scene has [`noise`], for corners that differ by little hide it, and up to 16
    /// squares where corners differ in others, which have less error in the same time.
    #[must_use]
    pub fn fitting(scene: &Scene, glossy: bool) -> Self {
        match noise(scene, glossy) {
            Some(_) => Self::Stochastic(Rate::Samples(SAMPLES)),
            None => Self::Subdivided { levels: LEVELS },
        }
    }
}

/// What every ray draws a point or a direction of, if there is anything: neighbouring pixels then differ by chance.
#[must_use]
pub fn noise(scene: &Scene, glossy: bool) -> Option<&'static str> {
    // Parallel rays have no lens.
    let has_lens = scene.lens.is_some() && !scene.camera.is_some_and(|camera| camera.parallel);
    let kinds = [
        (scene.lights.iter().any(|light| light.radius > 0.0), "soft lights"),
        (has_lens, "a lens"),
        (glossy, "glossy surfaces"),
    ];
    kinds.into_iter().find_map(|(is_there, what)| is_there.then_some(what))
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{Camera, Lens, Light, LightKind, Rgb};

    const DIVIDED: Sampling = Sampling::Subdivided { levels: 2 };
    const DRAWN: Sampling = Sampling::Stochastic(Rate::Samples(16));

    #[test]
    fn what_is_drawn_for_each_ray_is_sampled_by_lot() {
        let light = |radius| Light {
            kind: LightKind::Point { at: glam::DVec3::Y },
            color: Rgb::ONE,
            shadows: true,
            radius,
        };
        let camera = |parallel| Camera {
            position: glam::DVec3::Z,
            target: glam::DVec3::ZERO,
            focal_length_mm: 50.0,
            parallel,
        };
        let lens = Lens { aperture: 8.0, focus: glam::DVec3::ZERO };
        let hard =
            Scene { lights: vec![light(0.0)], camera: Some(camera(false)), ..Scene::default() };
        let soft = Scene { lights: vec![light(0.0), light(0.1)], ..hard.clone() };
        let wide = Scene { lens: Some(lens), ..hard.clone() };
        let parallel = Scene { camera: Some(camera(true)), ..wide.clone() };
        for (scene, glossy, expected) in [
            (&hard, false, DIVIDED),
            (&hard, true, DRAWN),
            (&soft, false, DRAWN),
            (&wide, false, DRAWN),
            (&parallel, false, DIVIDED),
        ] {
            assert_eq!(Sampling::fitting(scene, glossy), expected, "{scene:?} {glossy}");
        }
    }
}
