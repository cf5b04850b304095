//! The light of an image as display values of the covered part, and back.

use std::sync::OnceLock;

use idf::plane::{COLOR, Role};
use idf::{Depth, Image, ImageError, Kind, Matte, Plane, Properties, Samples, Transfer};
use rayon::prelude::*;

/// Display values of one channel, or of luma.
#[derive(Clone, Copy, Debug)]
pub struct Tones<'a> {
    /// Row by row. Integers are steps of the display value, floating point is the value.
    pub samples: &'a Samples,
    /// The largest integer of the samples of the image; without it they are floating point.
    pub steps: Option<u16>,
    /// Share of each pixel that is covered, in 65535ths; without it, all are covered.
    pub weights: Option<&'a [u16]>,
    /// Samples of a row.
    pub columns: usize,
}

/// The light of an image as display values of the covered part.
///
/// Integers that are stored as sRGB, and not multiplied by a coverage below 1, are taken as they
/// are. All else becomes floating point, so that the only rounding is that of [`Light::stored`].
#[derive(Debug)]
pub(crate) struct Light {
    /// Red, green and blue, or grey.
    pub(crate) planes: Vec<Plane>,
    /// All else but indices and their table, which show the old light.
    others: Vec<Plane>,
    columns: u32,
    rows: u32,
    properties: Properties,
    depth: Depth,
    /// How the light is stored.
    pub(crate) transfer: Transfer,
    /// Whether a pixel is not wholly covered.
    partial: bool,
    /// Coverage as shares, once it is asked for.
    shares: OnceLock<Vec<f32>>,
}

impl Light {
    /// The light of `image`: of its colours, its grey, or its indices.
    ///
    /// # Errors
    ///
    /// If it has none, or only a part of a colour, or indices without their table.
    pub(crate) fn of(mut image: Image) -> Result<Self, ImageError> {
        // New samples, and the bins or values that they come from.
        idf::check_memory(image.bytes().saturating_mul(3))?;
        if image.light_kinds()?.is_empty() {
            image = image.resolved()?;
        }
        let kinds = image.light_kinds()?;
        if kinds.is_empty() {
            return Err(ImageError::Missing { kind: Kind::Grg, present: image.kinds() });
        }
        let depth = image.depth();
        let mut used = kinds.iter().chain(&[Kind::Cvg]).filter_map(|&kind| image.plane(kind));
        if used.any(|samples| samples.depth() != depth) {
            image = image.at_depth(depth)?;
        }
        let partial = match image.plane(Kind::Cvg) {
            None => false,
            Some(Samples::U8(shares)) => shares.iter().any(|&share| share < u8::MAX),
            Some(Samples::U16(shares)) => shares.iter().any(|&share| share < u16::MAX),
            Some(Samples::F32(shares)) => !shares.iter().all(|&share| share >= 1.0),
        };
        let ([columns, rows], transfer) = (image.size(), image.transfer(depth));
        let properties = std::mem::take(&mut image.properties);
        let (planes, mut others): (Vec<Plane>, Vec<Plane>) =
            image.into_planes().into_iter().partition(|plane| kinds.contains(&plane.kind));
        // Grey beside a colour shows the old light too.
        others.retain(|plane| !matches!(plane.kind.role(), Role::Light | Role::Index));
        let shares = OnceLock::new();
        Ok(Self { planes, others, columns, rows, properties, depth, transfer, partial, shares })
    }

    /// Whether the light is a colour.
    pub(crate) fn is_color(&self) -> bool {
        self.planes.len() == COLOR.len()
    }

    /// The largest integer of a sample, or nothing for floating point.
    pub(crate) fn steps(&self) -> Option<u16> {
        match self.depth {
            Depth::U8 => Some(255),
            Depth::U16 => Some(65_535),
            Depth::F32 => None,
        }
    }

    /// Whether light is stored multiplied by a coverage that is not 1 everywhere.
    pub(crate) fn is_multiplied(&self) -> bool {
        self.partial && self.properties.matte == Matte::Premultiplied
    }

    /// Coverage as it is stored, where a pixel is not wholly covered.
    pub(crate) fn coverage(&self) -> Option<&Samples> {
        let coverage = self.others.iter().find(|plane| plane.kind == Kind::Cvg);
        coverage.filter(|_| self.partial).map(|plane| &plane.samples)
    }

    /// The light, to be changed, and [`Light::coverage`].
    pub(crate) fn planes_and_coverage(&mut self) -> (&mut [Plane], Option<&Samples>) {
        let coverage = self.others.iter().find(|plane| plane.kind == Kind::Cvg);
        (&mut self.planes, coverage.filter(|_| self.partial).map(|plane| &plane.samples))
    }

    /// Coverage, where light is stored multiplied by it.
    fn multiplied_by(&self) -> Option<&[f32]> {
        let coverage = self.coverage().filter(|_| self.is_multiplied())?;
        Some(self.shares.get_or_init(|| coverage.decoded(Transfer::Linear)))
    }

    /// Whether integers are display values as they are.
    fn is_direct(&self) -> bool {
        let srgb = self.transfer == Transfer::Srgb;
        self.steps().is_some() && srgb && !self.is_multiplied()
    }

    /// Coverage of each pixel in 65535ths, where not all is covered.
    pub(crate) fn weights(&self) -> Option<Vec<u16>> {
        Some(match self.coverage()? {
            Samples::U8(shares) => shares.iter().map(|&share| u16::from(share) * 257).collect(),
            Samples::U16(shares) => shares.clone(),
            Samples::F32(shares) => shares.iter().map(|&share| weight(share)).collect(),
        })
    }

    /// `samples` with what they mean here; `weights` are [`Light::weights`].
    pub(crate) fn tones<'a>(&self, samples: &'a Samples, weights: Option<&'a [u16]>) -> Tones<'a> {
        Tones { samples, steps: self.steps(), weights, columns: self.columns as usize }
    }

    /// Linear light of the covered part of each pixel, of the plane at `channel`.
    pub(crate) fn linear(&self, channel: usize) -> Vec<f32> {
        let mut values = self.planes[channel].samples.decoded(self.transfer);
        if let Some(coverage) = self.multiplied_by() {
            let pairs = values.par_iter_mut().zip(coverage);
            pairs.for_each(|(value, &c)| *value = if c > 0.0 { *value / c } else { 0.0 });
        }
        values
    }

    /// Display values of the covered part of each pixel, of each plane: integers where they are
    /// stored so, which are taken out.
    pub(crate) fn take_display(&mut self) -> Vec<Samples> {
        let channels = 0..self.planes.len();
        let taken = |channel: usize| {
            if self.is_direct() {
                let plane = &mut self.planes[channel];
                return std::mem::replace(&mut plane.samples, Samples::U8(Vec::new()));
            }
            let mut values = self.linear(channel);
            values
                .par_iter_mut()
                .for_each(|value| *value = narrow(Transfer::Srgb.encode(f64::from(*value))));
            Samples::F32(values)
        };
        channels.map(taken).collect()
    }

    /// Samples to store from display values of the covered part. Those of uncovered pixels stay.
    pub(crate) fn stored(&self, channel: usize, display: Samples) -> Result<Samples, ImageError> {
        match display {
            Samples::F32(mut values) => {
                values
                    .par_iter_mut()
                    .for_each(|value| *value = narrow(Transfer::Srgb.decode(f64::from(*value))));
                self.stored_linear(channel, values)
            }
            direct => Ok(direct),
        }
    }

    /// Samples to store from linear light of the covered part. Those of uncovered pixels stay.
    pub(crate) fn stored_linear(
        &self,
        channel: usize,
        mut values: Vec<f32>,
    ) -> Result<Samples, ImageError> {
        if let Some(coverage) = self.multiplied_by() {
            values.par_iter_mut().zip(coverage).for_each(|(value, &c)| *value *= c);
        }
        let transfer = self.transfer;
        let Plane { kind, samples: old } = &self.planes[channel];
        let mut samples = if self.steps().is_some() {
            Samples::encoded(&values, self.depth, transfer).map_err(|position| {
                let columns = self.columns as usize;
                let (column, row) = (position % columns, position / columns);
                ImageError::NotANumber { kind: *kind, column, row }
            })?
        } else {
            if transfer != Transfer::Linear {
                values
                    .par_iter_mut()
                    .for_each(|value| *value = narrow(transfer.encode(f64::from(*value))));
            }
            Samples::F32(values)
        };
        if let Some(coverage) = self.multiplied_by() {
            match (&mut samples, old) {
                (Samples::U8(new), Samples::U8(old)) => keep_uncovered(new, old, coverage),
                (Samples::U16(new), Samples::U16(old)) => keep_uncovered(new, old, coverage),
                (Samples::F32(new), Samples::F32(old)) => keep_uncovered(new, old, coverage),
                _ => unreachable!("samples keep their depth"),
            }
        }
        Ok(samples)
    }

    /// The image with new light, one for each plane.
    pub(crate) fn into_image(mut self, light: Vec<Samples>) -> Result<Image, ImageError> {
        for (plane, samples) in self.planes.iter_mut().zip(light) {
            plane.samples = samples;
        }
        self.into_same()
    }

    /// The image with the light as it is now.
    pub(crate) fn into_same(mut self) -> Result<Image, ImageError> {
        self.planes.extend(self.others);
        let mut image = Image::new(self.columns, self.rows, self.planes)?;
        image.properties = self.properties;
        Ok(image)
    }

    /// Whether samples have an upper end.
    pub(crate) fn is_bounded(&self) -> bool {
        self.steps().is_some()
    }
}

/// `new` where something is covered, `old` where nothing is.
fn keep_uncovered<T: Copy>(new: &mut [T], old: &[T], coverage: &[f32]) {
    for ((new, &old), &share) in new.iter_mut().zip(old).zip(coverage) {
        if share <= 0.0 {
            *new = old;
        }
    }
}

/// Rec. 709 luma of display values: 0.2126 R + 0.7152 G + 0.0722 B. Integers are rounded.
pub(crate) fn luma(channels: [&Samples; 3]) -> Samples {
    match channels {
        [Samples::U8(r), Samples::U8(g), Samples::U8(b)] => Samples::U8(
            (r.par_iter().zip(g).zip(b))
                .map(|((&r, &g), &b)| {
                    let tenths = 2126 * u32::from(r) + 7152 * u32::from(g) + 722 * u32::from(b);
                    u8::try_from((tenths + 5000) / 10_000).expect("a mean of bytes is a byte")
                })
                .collect(),
        ),
        [Samples::U16(r), Samples::U16(g), Samples::U16(b)] => Samples::U16(
            (r.par_iter().zip(g).zip(b))
                .map(|((&r, &g), &b)| {
                    let tenths = 2126 * u32::from(r) + 7152 * u32::from(g) + 722 * u32::from(b);
                    u16::try_from((tenths + 5000) / 10_000).expect("a mean of words is a word")
                })
                .collect(),
        ),
        [Samples::F32(r), Samples::F32(g), Samples::F32(b)] => Samples::F32(
            (r.par_iter().zip(g).zip(b))
                .map(|((&r, &g), &b)| {
                    narrow(0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b))
                })
                .collect(),
        ),
        _ => unreachable!("channels have one depth"),
    }
}

/// Moves each sample of a channel as far as luma moved.
pub(crate) fn follow(samples: &mut Samples, from: &Samples, to: &Samples) {
    match (samples, from, to) {
        (Samples::U8(samples), Samples::U8(from), Samples::U8(to)) => {
            (samples.par_iter_mut().zip(from).zip(to)).for_each(|((sample, &from), &to)| {
                // One of the two differences is 0.
                let (gain, loss) = (to.saturating_sub(from), from.saturating_sub(to));
                *sample = sample.saturating_add(gain).saturating_sub(loss);
            });
        }
        (Samples::U16(samples), Samples::U16(from), Samples::U16(to)) => {
            (samples.par_iter_mut().zip(from).zip(to)).for_each(|((sample, &from), &to)| {
                let (gain, loss) = (to.saturating_sub(from), from.saturating_sub(to));
                *sample = sample.saturating_add(gain).saturating_sub(loss);
            });
        }
        (Samples::F32(samples), Samples::F32(from), Samples::F32(to)) => {
            (samples.par_iter_mut().zip(from).zip(to))
                .for_each(|((sample, &from), &to)| *sample += to - from);
        }
        _ => unreachable!("luma has the depth of its channels"),
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and 65535.5, or not a number, which becomes 0"
)]
fn weight(share: f32) -> u16 {
    (f64::from(share).clamp(0.0, 1.0) * 65_535.0 + 0.5) as u16
}

#[expect(clippy::cast_possible_truncation, reason = "planes hold 32-bit values by definition")]
pub(crate) fn narrow(value: f64) -> f32 {
    value as f32
}
