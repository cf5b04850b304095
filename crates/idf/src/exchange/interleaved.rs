//! Samples pixel by pixel, as raster formats have them: integers, sRGB, straight coverage.

use super::{EncodeError, picture_kinds};
use crate::convert::Form;
use crate::error::Cause;
use crate::image::{Image, Matte, Plane};
use crate::lut::Lut;
use crate::plane::{COLOR, Kind};
use crate::samples::{Depth, Samples};
use crate::transfer::Transfer;

/// The channels of a pixel: grey or colour, and coverage.
pub(super) fn kinds(color: bool, covered: bool) -> Vec<Kind> {
    let mut kinds = if color { COLOR.to_vec() } else { vec![Kind::Grg] };
    kinds.extend(covered.then_some(Kind::Cvg));
    kinds
}

/// The image of pixels whose channels are `kinds`; `sample` makes one of `N` bytes.
pub(super) fn image<T, const N: usize>(
    [columns, rows]: [u32; 2],
    kinds: &[Kind],
    pixels: &[u8],
    sample: impl Fn([u8; N]) -> T,
    samples: impl Fn(Vec<T>) -> Samples,
) -> Result<Image, Cause> {
    let plane = |(position, &kind): (usize, &Kind)| {
        let bytes = pixels.as_chunks().0.iter().skip(position).step_by(kinds.len());
        Plane { kind, samples: samples(bytes.map(|&bytes| sample(bytes)).collect()) }
    };
    let mut image = Image::new(columns, rows, kinds.iter().enumerate().map(plane).collect())?;
    if kinds.contains(&Kind::Cvg) {
        image.properties.matte = Matte::Straight;
    }
    Ok(image)
}

/// The image of indices into `lut`.
pub(super) fn indexed(
    [columns, rows]: [u32; 2],
    indices: Vec<u8>,
    lut: Lut,
) -> Result<Image, Cause> {
    let colors = lut.colors().len();
    if let Some(found) = indices.iter().find(|&&index| usize::from(index) >= colors) {
        return Err(format!("index {found}, expected one of {colors} colours").into());
    }
    let plane = Plane { kind: Kind::Enc, samples: Samples::U8(indices) };
    let mut image = Image::new(columns, rows, vec![plane])?;
    if lut.coverage().is_some() {
        image.properties.matte = Matte::Straight;
    }
    image.lut = Some(lut);
    Ok(image)
}

/// The indices of an image and its table as sRGB, where it has these and no other picture.
pub(super) fn indices(image: &Image) -> Result<Option<(&[u8], Lut)>, EncodeError> {
    let (Some(Samples::U8(indices)), Some(lut)) = (image.plane(Kind::Enc), &image.lut) else {
        return Ok(None);
    };
    if !image.light_kinds()?.is_empty() || image.plane(Kind::Cvg).is_some() {
        return Ok(None);
    }
    let colors = lut.colors().len();
    if let Some(&found) = indices.iter().find(|&&index| usize::from(index) >= colors) {
        return Err(crate::image::ImageError::Index { found, colors }.into());
    }
    Ok(Some((indices, lut.restored(image.transfer(Depth::U8), Transfer::Srgb))))
}

/// A picture as a file has it.
pub(super) struct Interleaved {
    pub(super) channels: usize,
    pub(super) is_deep: bool,
    samples: Vec<u16>,
}

impl Interleaved {
    /// Samples of 8 bits, or 16 where the image is deeper.
    pub(super) fn new(image: &Image) -> Result<Self, EncodeError> {
        let kinds = picture_kinds(image)?;
        let depth = if image.depth() == Depth::U8 { Depth::U8 } else { Depth::U16 };
        let form = Form { depth, transfer: Transfer::Srgb, matte: Matte::Straight };
        let image = image.converted(form)?;
        let channels = kinds.len();
        let pixels = image.columns() as usize * image.rows() as usize;
        let mut samples = vec![0; channels * pixels];
        for (position, &kind) in kinds.iter().enumerate() {
            let places = samples.iter_mut().skip(position).step_by(channels);
            match image.needed(kind)? {
                Samples::U8(plane) => places.zip(plane).for_each(|(p, &s)| *p = u16::from(s)),
                Samples::U16(plane) => places.zip(plane).for_each(|(p, &s)| *p = s),
                Samples::F32(_) => {}
            }
        }
        Ok(Self { channels, is_deep: depth == Depth::U16, samples })
    }

    /// One byte for each sample, or two, the more significant first.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        if self.is_deep {
            return self.samples.iter().flat_map(|sample| sample.to_be_bytes()).collect();
        }
        self.samples.iter().map(|sample| sample.to_be_bytes()[1]).collect()
    }
}
