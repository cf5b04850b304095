//! What each tile of a picture costs, and how long more threads than there are would take.

use crate::tile::Frame;
use crate::{Options, Rate, RenderError, Sampling, World, pool};

/// Seconds that each tile of a picture takes alone on one thread, in the order in which threads take tiles: from the
/// middle of the picture to its rim. Samples in rounds, [`Rate::Error`] and [`Rate::Time`], count as one a pixel.
///
/// # Errors
///
/// As [`crate::render`].
pub fn tile_seconds(world: &World, options: &Options) -> Result<Vec<f64>, RenderError> {
    let sampling = match options.sampling {
        Sampling::Stochastic(Rate::Error(_) | Rate::Time(_)) => {
            Sampling::Stochastic(Rate::Samples(1))
        }
        other => other,
    };
    let options = Options { sampling, ..*options };
    let view = world.view_from.view(options.columns, options.rows);
    Ok(pool(world, &options, 1)?.install(|| Frame::new(world, view, &options).seconds()))
}

/// Seconds until the last of `threads` is done where each takes the next tile when it is free, as [`crate::render`] does
/// it; nothing else is counted. With no thread it never ends. At most the sum over the number of threads and the longest
/// (Graham, "Bounds on Multiprocessing Timing Anomalies", 1969).
#[must_use]
pub fn scheduled(seconds: &[f64], threads: usize) -> f64 {
    let mut free = vec![0.0_f64; threads];
    for cost in seconds {
        let Some(first) = free.iter_mut().min_by(|a, b| a.total_cmp(b)) else {
            return f64::INFINITY;
        };
        *first += cost;
    }
    free.into_iter().fold(0.0, |most, end| if end > most { end } else { most })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_take_the_next_tile_when_they_are_free() {
        // On two: 3 and then 4 on the first, 1, 1 and 2 on the second. On three: 3, 1 and 2, 1 and 4.
        let tiles = [3.0, 1.0, 1.0, 2.0, 4.0];
        for (threads, expected) in [(1, 11.0), (2, 7.0), (3, 5.0), (9, 4.0)] {
            let found = scheduled(&tiles, threads);
            assert!((found - expected).abs() < 1e-12, "{threads} threads: {found}");
        }
        assert!(scheduled(&tiles, 0).is_infinite());
        assert!(scheduled(&[], 4).abs() < 1e-12);
    }

    #[test]
    fn the_last_ends_within_grahams_bound() {
        let mut state = 7_u32;
        let mut lot = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24)
        };
        for workers in 1..=20 {
            for count in [0, 1, 7, 64] {
                let costs: Vec<f64> = (0..count).map(|_| lot()).collect();
                let sum: f64 = costs.iter().sum();
                let longest = costs.iter().copied().fold(0.0, f64::max);
                let share = sum / f64::from(u32::try_from(workers).unwrap());
                let found = scheduled(&costs, workers);
                let least = share.max(longest) * (1.0 - 1e-12);
                assert!((least..=share + longest).contains(&found), "{workers} {count}: {found}");
            }
        }
    }

    #[test]
    fn every_tile_has_its_time() {
        let mut scene = scene::Scene { ambient: scene::Rgb::ONE, ..scene::Scene::default() };
        let solid = scene::Solid::primitive(scene::Primitive::Sphere, scene::Placement::default());
        scene.add_object(None, solid);
        scene.camera = Some(scene::Camera {
            parallel: false,
            position: glam::DVec3::new(0.0, 0.0, 9.0),
            target: glam::DVec3::ZERO,
            focal_length_mm: 50.0,
        });
        let world = World::load(&scene).unwrap();
        for sampling in [
            Sampling::Grid(2),
            Sampling::Subdivided { levels: 1 },
            Sampling::Stochastic(Rate::Error(1.0)),
        ] {
            let options = Options { columns: 70, rows: 33, sampling, ..Options::default() };
            let seconds = tile_seconds(&world, &options).unwrap();
            // Three tiles across, two down.
            assert_eq!(seconds.len(), 6, "{sampling:?}");
            assert!(seconds.iter().all(|&cost| cost > 0.0), "{seconds:?}");
        }
    }
}
