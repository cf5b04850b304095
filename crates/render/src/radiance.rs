//! What is seen at single places of a picture, in full precision: for tests, and for who points at a picture.

use scene::Rgb;

use crate::options::Options;
use crate::sampling::place::sight;
use crate::sampling::sequence::Draw;
use crate::shade::footprint::Cone;
use crate::trace::tree::{BATCH, Tracer};
use crate::world::World;
use crate::{RenderError, pool};

/// The light seen at a place of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radiance {
    /// Linear, not clamped, without the background where it is seen straight:
    /// `color + (1 − coverage) · background` is the whole.
    pub color: Rgb,
    /// 0…1, the share of the background that is not seen straight.
    pub coverage: f64,
}

/// What is seen at each of `places` of a picture of `options`' size; (0, 0) is its top left corner, and units are pixels.
/// The centre of the first pixel is (0.5, 0.5). Places have no extent: paint is not smoothed as it is over a pixel.
///
/// # Errors
///
/// [`RenderError::Threads`] when there is no thread to be had.
pub fn radiance(
    world: &World,
    options: &Options,
    places: &[(f64, f64)],
) -> Result<Vec<Radiance>, RenderError> {
    let size = (options.columns, options.rows);
    let view = world.view_from.view(options.columns, options.rows);
    let Options { accel, depth, min_weight, .. } = *options;
    Ok(pool(world, options, 1)?.install(|| {
        let mut tracer = Tracer::new(world, accel, depth, min_weight);
        let mut seen = Vec::with_capacity(places.len());
        for places in places.chunks(BATCH) {
            let ray =
                |&place| tracer.primary(sight(&view, place, size), Cone::default(), Draw::MIDDLE);
            let rays: Vec<_> = places.iter().map(ray).collect();
            tracer.look(&world.whole, &rays, &mut seen);
        }
        seen.iter().map(|seen| Radiance { color: seen.color, coverage: seen.coverage }).collect()
    }))
}
