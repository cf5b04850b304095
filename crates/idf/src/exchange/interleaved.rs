//! Samples pixel by pixel, as raster formats have them: integers, sRGB, straight coverage.

use std::borrow::Cow;

use rayon::prelude::*;

use super::{EncodeError, picture_kinds};
use crate::convert::Form;
use crate::error::Cause;
use crate::image::{Image, ImageError, Matte, Plane};
use crate::lut::Lut;
use crate::memory;
use crate::plane::{COLOR, Kind, Role};
use crate::samples::{Depth, Samples};
use crate::transfer::Transfer;

/// The channels of a pixel: grey or colour, and coverage.
pub(super) fn kinds(color: bool, covered: bool) -> Vec<Kind> {
    let mut kinds = if color { COLOR.to_vec() } else { vec![Kind::Grg] };
    kinds.extend(covered.then_some(Kind::Cvg));
    kinds
}

/// Pixels that a thread takes at once.
const TASK: usize = 1 << 14;

/// The image of pixels whose channels are `kinds`; `sample` makes one of `N` bytes.
pub(super) fn image<T: Copy + Default + Send, const N: usize>(
    [columns, rows]: [u32; 2],
    kinds: &[Kind],
    pixels: &[u8],
    sample: impl Fn([u8; N]) -> T + Sync,
    samples: impl Fn(Vec<T>) -> Samples,
) -> Result<Image, Cause> {
    let mut planes = empty(kinds.len(), pixels.len() / (N * kinds.len()));
    split(pixels, &mut planes, 0, sample);
    let planes = kinds.iter().zip(planes);
    let planes = planes.map(|(&kind, plane)| Plane { kind, samples: samples(plane) }).collect();
    let mut image = Image::new(columns, rows, planes)?;
    if kinds.contains(&Kind::Cvg) {
        image.properties.matte = Matte::Straight;
    }
    Ok(image)
}

/// Planes whose memory is not touched yet, as that of a copy would be.
pub(super) fn empty<T: Copy + Default>(planes: usize, pixels: usize) -> Vec<Vec<T>> {
    (0..planes).map(|_| vec![T::default(); pixels]).collect()
}

/// Puts pixels into their planes, from the pixel `at` on.
pub(super) fn split<T: Copy + Send, const N: usize>(
    pixels: &[u8],
    planes: &mut [Vec<T>],
    at: usize,
    sample: impl Fn([u8; N]) -> T + Sync,
) {
    match planes.len() {
        1 => split_into::<T, N, 1>(pixels, planes, at, sample),
        2 => split_into::<T, N, 2>(pixels, planes, at, sample),
        3 => split_into::<T, N, 3>(pixels, planes, at, sample),
        _ => split_into::<T, N, 4>(pixels, planes, at, sample),
    }
}

fn split_into<T: Copy + Send, const N: usize, const C: usize>(
    pixels: &[u8],
    planes: &mut [Vec<T>],
    at: usize,
    sample: impl Fn([u8; N]) -> T + Sync,
) {
    let count = pixels.len() / (N * C);
    let mut tasks: Vec<(&[u8], Vec<&mut [T]>)> =
        pixels.chunks(N * C * TASK).map(|pixels| (pixels, Vec::new())).collect();
    for plane in planes {
        let parts = tasks.iter_mut().zip(plane[at..at + count].chunks_mut(TASK));
        parts.for_each(|((_, parts), part)| parts.push(part));
    }
    tasks.into_par_iter().for_each(|(pixels, mut parts)| {
        let pixels = pixels.as_chunks::<N>().0.as_chunks::<C>().0;
        for (channel, part) in parts.iter_mut().enumerate().take(C) {
            part.iter_mut().zip(pixels).for_each(|(new, pixel)| *new = sample(pixel[channel]));
        }
    });
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
        return Err(ImageError::Index { found, colors }.into());
    }
    Ok(Some((indices, lut.restored(image.transfer(Depth::U8), Transfer::Srgb))))
}

/// A picture as files have it: samples of 8 bits, or of 16 where the image is deeper.
pub(super) struct Interleaved<'a> {
    image: Cow<'a, Image>,
    kinds: Vec<Kind>,
    /// Two bytes a sample, the more significant first, not one.
    pub(super) is_deep: bool,
}

impl<'a> Interleaved<'a> {
    pub(super) fn new(image: &'a Image) -> Result<Self, EncodeError> {
        let lit = match image.plane(Kind::Enc) {
            Some(_) if image.light_kinds()?.is_empty() => Cow::Owned(image.resolved()?),
            _ => Cow::Borrowed(image),
        };
        let kinds = picture_kinds(&lit)?;
        let is_deep = lit.depth() != Depth::U8;
        let depth = if is_deep { Depth::U16 } else { Depth::U8 };
        let form = Form { depth, transfer: Transfer::Srgb, matte: Matte::Straight };
        let image = if is_so(&lit, &kinds, form)? { lit } else { Cow::Owned(lit.converted(form)?) };
        Ok(Self { image, kinds, is_deep })
    }

    pub(super) fn channels(&self) -> usize {
        self.kinds.len()
    }

    /// All samples, pixel by pixel.
    pub(super) fn bytes(&self) -> Result<Vec<u8>, EncodeError> {
        let pixels = self.image.columns() as usize * self.image.rows() as usize;
        let length = self.length(pixels);
        // And as much again for what is made of them, which may not become shorter.
        memory::check((length as u64).saturating_mul(2)).map_err(ImageError::from)?;
        let mut bytes = vec![0; length];
        self.put(0, &mut bytes)?;
        Ok(bytes)
    }

    /// Bytes of so many pixels.
    pub(super) fn length(&self, pixels: usize) -> usize {
        self.channels() * pixels * if self.is_deep { 2 } else { 1 }
    }

    /// Samples of the pixels from `start` on, as many as there is room for.
    pub(super) fn put(&self, start: usize, bytes: &mut [u8]) -> Result<(), EncodeError> {
        let planes = self.kinds.iter().map(|&kind| self.image.needed(kind));
        let planes = planes.collect::<Result<Vec<_>, _>>()?;
        match self.channels() {
            1 => join::<1>(&planes, start, self.is_deep, bytes),
            2 => join::<2>(&planes, start, self.is_deep, bytes),
            3 => join::<3>(&planes, start, self.is_deep, bytes),
            _ => join::<4>(&planes, start, self.is_deep, bytes),
        }
        Ok(())
    }
}

/// Whether these channels are stored so already.
fn is_so(image: &Image, kinds: &[Kind], form: Form) -> Result<bool, ImageError> {
    if kinds.contains(&Kind::Cvg) && image.properties.matte != form.matte {
        return Ok(false);
    }
    for &kind in kinds {
        let depth = image.needed(kind)?.depth();
        let lit = kind.role() == Role::Light;
        if depth != form.depth || lit && image.plane_transfer(kind, depth) != form.transfer {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Planes of bytes, or of two bytes each, pixel by pixel from `start` on.
fn join<const C: usize>(planes: &[&Samples], start: usize, is_deep: bool, bytes: &mut [u8]) {
    let width = if is_deep { 2 } else { 1 };
    bytes.par_chunks_mut(C * width * TASK).enumerate().for_each(|(task, bytes)| {
        for (channel, plane) in planes.iter().enumerate().take(C) {
            match plane {
                Samples::U8(plane) => {
                    let pixels = bytes.as_chunks_mut::<C>().0.iter_mut();
                    let pairs = pixels.zip(&plane[start + task * TASK..]);
                    pairs.for_each(|(pixel, &sample)| pixel[channel] = sample);
                }
                Samples::U16(plane) => {
                    let pixels = bytes.as_chunks_mut::<2>().0.as_chunks_mut::<C>().0.iter_mut();
                    let pairs = pixels.zip(&plane[start + task * TASK..]);
                    pairs.for_each(|(pixel, &sample)| pixel[channel] = sample.to_be_bytes());
                }
                Samples::F32(_) => {}
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_come_apart_and_together() {
        // More than two tasks, the last one not full.
        let [columns, rows] = [401_u32, 97];
        let count = (columns * rows) as usize;
        for (color, covered) in [(false, false), (false, true), (true, false), (true, true)] {
            let kinds = kinds(color, covered);
            let byte = |at: usize| (at * 31 % 253).to_le_bytes()[0];
            let bytes: Vec<u8> = (0..2 * count * kinds.len()).map(byte).collect();
            let shallow = &bytes[..count * kinds.len()];
            let size = [columns, rows];
            let image_8 = image(size, &kinds, shallow, |[byte]| byte, Samples::U8).unwrap();
            let image_16 = image(size, &kinds, &bytes, u16::from_be_bytes, Samples::U16).unwrap();
            for (position, &kind) in kinds.iter().enumerate() {
                for at in [0, 1, count / 2, count - 1] {
                    let place = at * kinds.len() + position;
                    let Some(Samples::U8(plane)) = image_8.plane(kind) else { panic!("{kind}") };
                    assert_eq!(plane[at], byte(place), "{kind} {at}");
                    let Some(Samples::U16(plane)) = image_16.plane(kind) else { panic!("{kind}") };
                    let word = u16::from_be_bytes([byte(2 * place), byte(2 * place + 1)]);
                    assert_eq!(plane[at], word, "{kind} {at}");
                }
            }
            for (image, bytes) in [(image_8, shallow), (image_16, &bytes[..])] {
                let Ok(picture) = Interleaved::new(&image) else { panic!("{kinds:?}") };
                assert_eq!(picture.channels(), kinds.len());
                assert!(picture.bytes().is_ok_and(|found| found == *bytes), "{kinds:?}");
                let mut some = vec![0; picture.length(20_000)];
                assert!(picture.put(7777, &mut some).is_ok());
                let start = picture.length(7777);
                assert!(some == bytes[start..start + some.len()], "{kinds:?}, some of it");
            }
        }
    }
}
