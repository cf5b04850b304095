//! Pixels to pixels. Each fast way has its plain counterpart, and agrees with it.

pub(crate) mod bytes;
pub(crate) mod coded;
pub(crate) mod float;
pub(crate) mod plain;
pub(crate) mod straight;
pub(crate) mod weighted;

use idf::{Image, ImageError, Kind, Samples};

use crate::operator::Share;
use crate::plan::Plan;

/// A stretch of a plane that is filled.
#[derive(Debug)]
pub(crate) enum Target<'a> {
    /// Bytes.
    U8(&'a mut [u8]),
    /// 16 bits.
    U16(&'a mut [u16]),
    /// Floating point.
    F32(&'a mut [f32]),
}

impl Target<'_> {
    /// Stretches of `length` samples, the last one what is left.
    pub(crate) fn stretches(samples: &mut Samples, length: usize) -> Vec<Target<'_>> {
        match samples {
            Samples::U8(samples) => samples.chunks_mut(length).map(Target::U8).collect(),
            Samples::U16(samples) => samples.chunks_mut(length).map(Target::U16).collect(),
            Samples::F32(samples) => samples.chunks_mut(length).map(Target::F32).collect(),
        }
    }

    /// Number of samples.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::U8(samples) => samples.len(),
            Self::U16(samples) => samples.len(),
            Self::F32(samples) => samples.len(),
        }
    }

    /// Sets each sample by its position, from a whole number or from a value.
    #[expect(clippy::cast_possible_truncation, reason = "planes hold 32-bit values by definition")]
    fn fill(&mut self, whole: impl Fn(usize) -> u16, value: impl Fn(usize) -> f64) {
        match self {
            Self::U8(samples) => {
                let whole = |at| whole(at).to_le_bytes()[0];
                samples.iter_mut().enumerate().for_each(|(at, sample)| *sample = whole(at));
            }
            Self::U16(samples) => {
                samples.iter_mut().enumerate().for_each(|(at, sample)| *sample = whole(at));
            }
            Self::F32(samples) => {
                samples.iter_mut().enumerate().for_each(|(at, sample)| *sample = value(at) as f32);
            }
        }
    }
}

/// Shares of a stretch of bytes; see [`Share::of`]. `other` is the coverage of the other picture.
pub(crate) fn shares(share: Share, other: &[u8], shares: &mut [u8]) {
    match (share.constant, share.slope) {
        (constant, 0) => shares.fill(if constant == 0 { 0 } else { u8::MAX }),
        (0, _) => shares.copy_from_slice(other),
        _ => shares.iter_mut().zip(other).for_each(|(share, &other)| *share = u8::MAX - other),
    }
}

/// The bytes of a layer's plane from `start` on, as many as `like` has; `instead` where the layer has
/// no such plane.
pub(crate) fn bytes_of<'a>(
    plane: Option<Kind>,
    image: &'a Image,
    start: usize,
    instead: &'a [u8],
) -> Result<&'a [u8], ImageError> {
    let Some(kind) = plane else { return Ok(instead) };
    match image.needed(kind)? {
        Samples::U8(samples) => Ok(&samples[start..start + instead.len()]),
        Samples::U16(_) | Samples::F32(_) => Err(unexpected(kind, image)),
    }
}

/// A plane of another depth than the plan has it.
pub(crate) fn unexpected(kind: Kind, image: &Image) -> ImageError {
    ImageError::Missing { kind, present: image.kinds() }
}

/// What is left of two layers of bytes, and their coverage.
pub(crate) struct Left<'a> {
    pub(crate) coverage: [&'a [u8]; 2],
    pub(crate) shares: [Vec<u8>; 2],
}

impl<'a> Left<'a> {
    pub(crate) fn new(
        plan: &Plan,
        [share_a, share_b]: [Share; 2],
        images: &[&'a Image],
        start: usize,
        full: &'a [u8],
    ) -> Result<Self, ImageError> {
        let coverage = |layer: usize| {
            let kind = plan.layers[layer].coverage.as_ref().map(|plane| plane.0);
            bytes_of(kind, images[layer], start, full)
        };
        let coverage = [coverage(0)?, coverage(1)?];
        let mut left = [vec![0; full.len()], vec![0; full.len()]];
        shares(share_a, coverage[1], &mut left[0]);
        shares(share_b, coverage[0], &mut left[1]);
        Ok(Self { coverage, shares: left })
    }
}
