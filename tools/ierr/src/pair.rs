//! Two images as channels that can be compared.

use std::error::Error;
use std::fmt;
use std::sync::Arc;

use idf::plane::COLOR;
use idf::{Depth, Image, ImageError, Kind, Matte, Samples, Transfer};
use rayon::prelude::*;

use crate::values::Values;

/// What the values of a [`Pair`] are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Display values: sRGB, 0 to 1.
    Display,
    /// Linear light, where either image is floating point; 1 is white, more is brighter.
    Linear,
}

/// Two images of one size as channels of values. Of bytes no value is stored, but it is made of them
/// when it is asked for.
///
/// Light is multiplied by coverage, so that what is not seen does not count. Grey is compared with a colour as red, green and blue alike,
/// and an image without coverage as one that is covered everywhere.
#[derive(Clone, Debug)]
pub struct Pair {
    /// Columns.
    pub columns: usize,
    /// Rows.
    pub rows: usize,
    /// What the values are.
    pub scale: Scale,
    /// The channels, light first, then coverage if either image has it.
    pub channels: Vec<Channel>,
}

/// One channel of both images. Values are in 255ths: a byte is exact.
#[derive(Clone, Debug)]
pub struct Channel {
    /// What it holds.
    pub kind: Kind,
    /// Of the first image, the reference.
    pub reference: Values,
    /// Of the second.
    pub test: Values,
}

/// Why two images cannot be compared.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum PairError {
    /// Sizes differ.
    Size {
        /// Columns and rows of the first.
        reference: [u32; 2],
        /// Columns and rows of the second.
        test: [u32; 2],
    },
    /// One has nothing to see.
    Image {
        /// Whether it is the second.
        second: bool,
        /// What is wrong.
        error: ImageError,
    },
    /// One has light, the other coverage alone.
    Kinds,
}

/// The value 1 in the unit of [`Channel`].
pub const ONE: f32 = 255.0;

impl Pair {
    /// Takes two images together.
    ///
    /// # Errors
    ///
    /// If their sizes differ, or one has neither light nor coverage, or one alone has light.
    pub fn new(reference: &Image, test: &Image) -> Result<Self, PairError> {
        let (size, scale) = common(reference, test)?;
        Self::of_seen(size, scale, Seen::of(reference, scale), Seen::of(test, scale))
    }

    /// The same of images that are not needed any more: only one of them is in memory twice at a time.
    ///
    /// # Errors
    ///
    /// As [`Pair::new`].
    pub fn of([reference, test]: [Image; 2]) -> Result<Self, PairError> {
        let (size, scale) = common(&reference, &test)?;
        let a = Seen::of(&reference, scale);
        drop(reference);
        let b = Seen::of(&test, scale);
        drop(test);
        Self::of_seen(size, scale, a, b)
    }

    fn of_seen(
        size: [usize; 2],
        scale: Scale,
        a: Result<Seen, ImageError>,
        b: Result<Seen, ImageError>,
    ) -> Result<Self, PairError> {
        let error = |second| move |error| PairError::Image { second, error };
        let (a, b) = (a.map_err(error(false))?, b.map_err(error(true))?);
        if a.light.is_empty() != b.light.is_empty() {
            return Err(PairError::Kinds);
        }
        let kinds = if a.light.len() == 1 && b.light.len() == 1 {
            vec![Kind::Grg]
        } else if a.light.is_empty() {
            Vec::new()
        } else {
            COLOR.to_vec()
        };
        let mut channels: Vec<Channel> = kinds
            .into_iter()
            .enumerate()
            .map(|(at, kind)| {
                let [reference, test] =
                    [&a, &b].map(|seen| seen.light[at.min(seen.light.len() - 1)].clone());
                Channel { kind, reference, test }
            })
            .collect();
        if a.coverage.is_some() || b.coverage.is_some() {
            let [columns, rows] = size;
            let ones = || Values::ones(columns * rows);
            let all = |coverage: Option<Values>| coverage.unwrap_or_else(ones);
            let (reference, test) = (all(a.coverage), all(b.coverage));
            channels.push(Channel { kind: Kind::Cvg, reference, test });
        }
        let [columns, rows] = size;
        Ok(Self { columns, rows, scale, channels })
    }

    /// Values of a row of a channel, of the reference and of the other.
    pub(crate) fn row(&self, channel: &Channel, row: usize) -> [Vec<f32>; 2] {
        let part = row * self.columns..(row + 1) * self.columns;
        [channel.reference.part(part.clone()), channel.test.part(part)]
    }

    /// Red, green and blue of a row of both as display values, 0 to 1: grey alike in all three,
    /// light beyond the range at its ends, coverage alone as grey.
    pub fn display(&self, row: usize) -> [[Vec<f32>; 3]; 2] {
        [false, true].map(|is_test| self.display_of(is_test, row))
    }

    /// The same of one image.
    pub(crate) fn display_of(&self, is_test: bool, row: usize) -> [Vec<f32>; 3] {
        let light: Vec<&Channel> =
            self.channels.iter().filter(|channel| channel.kind != Kind::Cvg).collect();
        let shown = if light.is_empty() { self.channels.iter().collect() } else { light };
        let part = row * self.columns..(row + 1) * self.columns;
        let encode = |value: f32| {
            let value = f64::from(value / ONE);
            let value = match self.scale {
                Scale::Linear => Transfer::Srgb.encode(value),
                Scale::Display => value,
            };
            narrow(if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) })
        };
        let display = |channel: &&Channel| -> Vec<f32> {
            let values = if is_test { &channel.test } else { &channel.reference };
            values.part(part.clone()).into_iter().map(encode).collect()
        };
        let rows: Vec<Vec<f32>> = shown.iter().map(display).collect();
        [0, 1, 2].map(|at| rows[at.min(rows.len() - 1)].clone())
    }
}

/// The size of two images, and what their values are to be.
fn common(reference: &Image, test: &Image) -> Result<([usize; 2], Scale), PairError> {
    if reference.size() != test.size() {
        return Err(PairError::Size { reference: reference.size(), test: test.size() });
    }
    let float = [reference, test].iter().any(|image| image.depth() == Depth::F32);
    let scale = if float { Scale::Linear } else { Scale::Display };
    Ok((reference.size().map(|length| length as usize), scale))
}

/// One image as it is compared.
struct Seen {
    light: Vec<Values>,
    coverage: Option<Values>,
}

impl Seen {
    fn of(image: &Image, scale: Scale) -> Result<Self, ImageError> {
        let resolved;
        let image = if image.light_kinds()?.is_empty() {
            resolved = image.resolved()?;
            &resolved
        } else {
            image
        };
        let kinds = image.light_kinds()?;
        let stored = image.plane(Kind::Cvg);
        if kinds.is_empty() && stored.is_none() {
            return Err(ImageError::Missing { kind: Kind::Grg, present: image.kinds() });
        }
        let straight = image.properties.matte == Matte::Straight;
        let shares = stored.filter(|_| straight);
        let byte_shares = match shares {
            Some(Samples::U8(shares)) => Some(Arc::new(shares.clone())),
            _ => None,
        };
        let light = kinds.iter().map(|&kind| {
            let samples = image.needed(kind)?;
            let transfer = image.transfer(samples.depth());
            let stored_so = scale == Scale::Display && transfer == Transfer::Srgb;
            if stored_so && shares.is_none() {
                // Bytes as they are, to the bit.
                return Ok(Values::stored(samples));
            }
            let seen = |linear: f32, share: f64| {
                let linear = f64::from(linear) * share;
                let seen = match scale {
                    Scale::Linear => linear,
                    Scale::Display => Transfer::Srgb.encode(linear),
                };
                narrow(seen * f64::from(ONE))
            };
            Ok(match (samples, &byte_shares) {
                (Samples::U8(samples), None) if shares.is_none() => {
                    let light = light_of_bytes(transfer);
                    Values::of_bytes(samples, |byte| seen(light[usize::from(byte)], 1.0))
                }
                (Samples::U8(samples), Some(shares)) => {
                    let light = light_of_bytes(transfer);
                    Values::of_shares(samples, shares, |byte, share| {
                        seen(light[usize::from(byte)], f64::from(f32::from(share) / ONE))
                    })
                }
                _ => {
                    let shares = shares.map(|shares| Values::stored(shares).all());
                    let mut values = samples.decoded(transfer);
                    values.par_iter_mut().enumerate().for_each(|(at, value)| {
                        let share = shares.as_ref().map_or(1.0, |s| f64::from(s[at] / ONE));
                        *value = seen(*value, share);
                    });
                    Values::floats(values)
                }
            })
        });
        let light = light.collect::<Result<_, ImageError>>()?;
        Ok(Self { light, coverage: stored.map(Values::stored) })
    }
}

/// Linear light of all bytes.
fn light_of_bytes(transfer: Transfer) -> Vec<f32> {
    Samples::U8((0..=u8::MAX).collect()).decoded(transfer)
}

#[expect(clippy::cast_possible_truncation, reason = "channels hold 32-bit values by definition")]
fn narrow(value: f64) -> f32 {
    value as f32
}

impl fmt::Display for PairError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size { reference: [a, b], test: [c, d] } => write!(
                f,
                "expected two images of one size, found {a} x {b} and {c} x {d} pixels; \
                 `icopy --resize` or `--crop` makes them alike"
            ),
            Self::Image { second, error } => {
                write!(f, "the {} image: {error}", if *second { "second" } else { "first" })
            }
            Self::Kinds => write!(f, "expected light in both images, found coverage alone in one"),
        }
    }
}

impl Error for PairError {}

#[cfg(test)]
mod tests {
    use super::*;
    use idf::Plane;

    fn image(planes: &[(Kind, Samples)]) -> Image {
        let columns = u32::try_from(planes[0].1.len()).unwrap();
        let planes =
            planes.iter().map(|(kind, samples)| Plane { kind: *kind, samples: samples.clone() });
        Image::new(columns, 1, planes.collect()).unwrap()
    }

    fn bytes(values: &[u8]) -> Samples {
        Samples::U8(values.into())
    }

    #[test]
    fn bytes_and_words_are_exact_display_steps() {
        let a = image(&[(Kind::Grg, bytes(&[0, 7, 255]))]);
        let b = image(&[(Kind::Grg, Samples::U16(vec![0, 7 * 257, 65_535]))]);
        let pair = Pair::new(&a, &b).unwrap();
        assert_eq!(pair.scale, Scale::Display);
        assert_eq!(pair.channels.len(), 1);
        assert_eq!(pair.channels[0].reference.all(), [0.0, 7.0, 255.0]);
        assert_eq!(pair.channels[0].test.all(), [0.0, 7.0, 255.0]);
    }

    #[test]
    fn floating_point_makes_both_linear() {
        let a = image(&[(Kind::Grg, bytes(&[0, 128, 255]))]);
        let b = image(&[(Kind::Grg, Samples::F32(vec![0.0, 0.5, 4.0]))]);
        let pair = Pair::new(&a, &b).unwrap();
        assert_eq!(pair.scale, Scale::Linear);
        assert!((pair.channels[0].reference.all()[1] / 255.0 - 0.215_860_5).abs() < 1e-6);
        assert_eq!(pair.channels[0].test.all(), [0.0, 127.5, 1020.0]);
        let [[_, _, shown], [_, _, other]] = pair.display(0);
        assert!((shown[1] - 128.0 / 255.0).abs() < 1e-6, "{shown:?}");
        assert!((other[2] - 1.0).abs() < 1e-6, "light beyond white is shown white");
    }

    #[test]
    fn grey_is_compared_with_color_and_no_coverage_with_all() {
        let grey = image(&[(Kind::Grg, bytes(&[9]))]);
        let color = image(&[
            (Kind::Red, bytes(&[1])),
            (Kind::Grn, bytes(&[2])),
            (Kind::Blu, bytes(&[3])),
            (Kind::Cvg, bytes(&[200])),
        ]);
        let pair = Pair::new(&grey, &color).unwrap();
        let kinds: Vec<Kind> = pair.channels.iter().map(|channel| channel.kind).collect();
        assert_eq!(kinds, [Kind::Red, Kind::Grn, Kind::Blu, Kind::Cvg]);
        let of =
            |at: usize| (pair.channels[at].reference.all()[0], pair.channels[at].test.all()[0]);
        assert_eq!([of(0), of(2), of(3)], [(9.0, 1.0), (9.0, 3.0), (255.0, 200.0)]);
    }

    #[test]
    fn straight_light_is_multiplied_by_coverage() {
        let planes = [(Kind::Grg, bytes(&[255, 255, 90])), (Kind::Cvg, bytes(&[128, 0, 255]))];
        let premultiplied = [(Kind::Grg, bytes(&[188, 0, 90])), (Kind::Cvg, bytes(&[128, 0, 255]))];
        let mut straight = image(&planes);
        straight.properties.matte = Matte::Straight;
        let pair = Pair::new(&straight, &image(&premultiplied)).unwrap();
        let [reference, test] = pair.row(&pair.channels[0], 0);
        for (a, b) in reference.iter().zip(&test) {
            assert!((a - b).abs() < 0.5, "{reference:?} {test:?}");
        }
        assert!(reference[1].abs() < 1e-9, "what is not covered is black");
    }

    #[test]
    fn sizes_and_kinds_have_to_agree() {
        let small = image(&[(Kind::Grg, bytes(&[0]))]);
        let large = image(&[(Kind::Grg, bytes(&[0, 0]))]);
        let error = Pair::new(&small, &large).unwrap_err();
        assert_eq!(error, PairError::Size { reference: [1, 1], test: [2, 1] });
        assert!(error.to_string().contains("found 1 x 1 and 2 x 1 pixels"), "{error}");
        let coverage = image(&[(Kind::Cvg, bytes(&[0]))]);
        assert_eq!(Pair::new(&small, &coverage).unwrap_err(), PairError::Kinds);
        assert!(Pair::new(&coverage, &coverage).is_ok());
        let depth = image(&[(Kind::Dep, bytes(&[0]))]);
        assert!(matches!(
            Pair::new(&small, &depth),
            Err(PairError::Image { second: true, error: ImageError::Missing { .. } })
        ));
    }
}
