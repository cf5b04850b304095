//! The tones of an image: histogram equalisation, whole and in tiles, curves of display values,
//! saturation and hue, histograms.
//!
//! Operations are rows of [`TABLE`]. They work on display values (sRGB, 0 to 1) of the covered part of
//! each pixel: light that was multiplied by coverage is divided by it first, and the result is
//! multiplied again and rounded once. What is not covered does not count and stays as it is.
//! Integers are clamped to their range; floating point is not. Colours of indices become light.
//!
//! ```
//! use idf::{Image, Kind, Plane, Samples};
//! use ieq::{Operation, toned};
//!
//! let grey = Plane { kind: Kind::Grg, samples: Samples::U8(vec![0, 51, 102, 255]) };
//! let image = Image::new(2, 2, vec![grey])?;
//! let brighter = toned(image, &Operation::new("brightness", &[0.2])?)?;
//! assert_eq!(brighter.plane(Kind::Grg), Some(&Samples::U8(vec![51, 102, 153, 255])));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod clahe;
mod color;
pub mod command;
mod count;
mod curve;
mod equalize;
mod histogram;
mod light;
mod operation;
mod picture;
mod point;
mod recent;

use idf::{Image, ImageError, Samples};
use rayon::prelude::*;

use crate::light::{Light, follow, luma};
use crate::recent::Recent;

pub use histogram::{Channel, Histogram, PERCENTILES, histogram};
pub use light::Tones;
pub use operation::{Operation, OperationError, Parameter, Row, TABLE, Work};

/// The image with other tones; for `histogram`, the picture of its histogram.
///
/// Planes that are not light stay as they are, indices and their table are left out. Light and
/// coverage of different depths come out at the deepest.
///
/// # Errors
///
/// If there is no light, only a part of a colour, or indices without their table.
pub fn toned(image: Image, operation: &Operation) -> Result<Image, ImageError> {
    let parameters = operation.parameters();
    match operation.row().work {
        Work::Histogram => histogram(image, whole(parameters[0])).map(|found| found.drawn()),
        Work::Curve(curve) => point::mapped(Light::of(image)?, |value| curve(value, parameters)),
        Work::Color(turn) => recolored(Light::of(image)?, &turn(parameters)),
        Work::Tones(spread) => {
            let light = Light::of(image)?;
            let weights = light.weights();
            retoned(light, operation.per_channel, |samples, light| {
                spread(&light.tones(samples, weights.as_deref()), parameters)
            })
        }
    }
}

/// Each channel through `spread`; a colour by its luma, unless each channel is to go by itself.
fn retoned(
    mut light: Light,
    per_channel: bool,
    spread: impl Fn(&Samples, &Light) -> Samples,
) -> Result<Image, ImageError> {
    let mut channels = light.take_display();
    if light.is_color() && !per_channel {
        let from = luma([&channels[0], &channels[1], &channels[2]]);
        let to = spread(&from, &light);
        channels.iter_mut().for_each(|channel| follow(channel, &from, &to));
    } else {
        channels.iter_mut().for_each(|channel| *channel = spread(channel, &light));
    }
    let channels = channels.into_iter().enumerate();
    let stored = channels.map(|(channel, samples)| light.stored(channel, samples));
    let stored = stored.collect::<Result<_, ImageError>>()?;
    light.into_image(stored)
}

/// Every colour with a and b turned. Grey has no colour and stays.
fn recolored(mut light: Light, turn: &color::Turn) -> Result<Image, ImageError> {
    /// Pixels that a thread takes at once.
    const CHUNK: usize = 1 << 14;
    if !light.is_color() {
        return light.into_same();
    }
    if !light.is_multiplied()
        && let [r, g, b] = light.planes.as_mut_slice()
        && let (Samples::U8(r), Samples::U8(g), Samples::U8(b)) =
            (&mut r.samples, &mut g.samples, &mut b.samples)
    {
        let bytes = color::Bytes::new(light.transfer);
        let chunks =
            r.par_chunks_mut(CHUNK).zip(g.par_chunks_mut(CHUNK)).zip(b.par_chunks_mut(CHUNK));
        chunks.for_each_init(Recent::new, |recent, ((r, g), b)| {
            recent.change(&bytes, [r, g, b], turn);
        });
        return light.into_same();
    }
    let bounded = light.is_bounded();
    let [mut r, mut g, mut b] = [0, 1, 2].map(|channel| light.linear(channel));
    let chunks = r.par_chunks_mut(CHUNK).zip(g.par_chunks_mut(CHUNK)).zip(b.par_chunks_mut(CHUNK));
    chunks.for_each(|((r, g), b)| color::change([r, g, b], turn, bounded));
    let values = [r, g, b].into_iter().enumerate();
    let stored = values.map(|(channel, values)| light.stored_linear(channel, values));
    let stored = stored.collect::<Result<_, ImageError>>()?;
    light.into_image(stored)
}

/// The whole number that a parameter is.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "whole and positive by the table of operations"
)]
fn whole(parameter: f64) -> usize {
    parameter as usize
}
