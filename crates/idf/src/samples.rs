//! Samples of one plane, in memory and as the bytes of a data file.

use std::borrow::Cow;
use std::ops::Range;

use rayon::prelude::*;

use crate::transfer::{Quantizer, Transfer, rounded_16};

/// Samples that a thread takes at once.
const CHUNK: usize = 1 << 14;

/// How a sample is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Depth {
    /// Eight bits, 0 to 255 for 0 to 1.
    U8,
    /// Sixteen bits, 0 to 65535 for 0 to 1.
    U16,
    /// 32-bit floating point, not clamped.
    F32,
}

impl Depth {
    /// All depths, shallow to deep.
    pub const ALL: [Self; 3] = [Self::U8, Self::U16, Self::F32];

    /// The word in the description.
    pub fn word(self) -> &'static str {
        match self {
            Self::U8 => "8",
            Self::U16 => "16",
            Self::F32 => "32f",
        }
    }

    /// The depth that `word` names.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|depth| depth.word() == word)
    }

    /// Bytes of a sample in a data file.
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 => 2,
            Self::F32 => 4,
        }
    }

    /// The transfer of light stored at this depth where nothing says otherwise: a display's for
    /// integers, none for floating point.
    pub fn usual_transfer(self) -> Transfer {
        match self {
            Self::U8 | Self::U16 => Transfer::Srgb,
            Self::F32 => Transfer::Linear,
        }
    }
}

/// Samples of one plane, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// Eight bits each.
    U8(Vec<u8>),
    /// Sixteen bits each.
    U16(Vec<u16>),
    /// Floating point.
    F32(Vec<f32>),
}

impl Samples {
    /// Number of samples.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(samples) => samples.len(),
            Self::U16(samples) => samples.len(),
            Self::F32(samples) => samples.len(),
        }
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How they are stored.
    pub fn depth(&self) -> Depth {
        match self {
            Self::U8(_) => Depth::U8,
            Self::U16(_) => Depth::U16,
            Self::F32(_) => Depth::F32,
        }
    }

    /// The samples at `positions`, in that order.
    ///
    /// # Panics
    ///
    /// If a position is not below [`Samples::len`].
    #[must_use]
    pub fn gathered(&self, positions: impl Iterator<Item = usize>) -> Self {
        match self {
            Self::U8(samples) => Self::U8(positions.map(|at| samples[at]).collect()),
            Self::U16(samples) => Self::U16(positions.map(|at| samples[at]).collect()),
            Self::F32(samples) => Self::F32(positions.map(|at| samples[at]).collect()),
        }
    }

    /// Linear values, where 1 is the largest integer sample.
    pub fn decoded(&self, transfer: Transfer) -> Vec<f32> {
        match self {
            Self::U8(samples) => {
                let table = decode_table(transfer, 255);
                samples.iter().map(|&sample| table[usize::from(sample)]).collect()
            }
            Self::U16(samples) => {
                let table = decode_table(transfer, 65_535);
                samples.iter().map(|&sample| table[usize::from(sample)]).collect()
            }
            Self::F32(samples) if transfer == Transfer::Linear => samples.clone(),
            Self::F32(samples) => {
                samples.par_iter().map(|&v| narrow(transfer.decode(f64::from(v)))).collect()
            }
        }
    }

    /// Samples of `depth` from linear values. Integers hold 0 to 1 and are rounded to the nearest,
    /// halves up; what is not a number is refused, by its position.
    ///
    /// # Errors
    ///
    /// The position of the first value that is not a number.
    pub fn encoded(values: &[f32], depth: Depth, transfer: Transfer) -> Result<Self, usize> {
        if let Some(position) = values.iter().position(|value| value.is_nan()) {
            return Err(position);
        }
        Ok(match depth {
            Depth::U8 => {
                let quantizer = Quantizer::new(transfer);
                let mut bytes = vec![0; values.len()];
                let chunks = bytes.par_chunks_mut(CHUNK).zip(values.par_chunks(CHUNK));
                chunks.for_each(|(bytes, values)| quantizer.fill(values, bytes));
                Self::U8(bytes)
            }
            Depth::U16 => {
                Self::U16(values.par_iter().map(|&v| rounded_16(transfer, f64::from(v))).collect())
            }
            Depth::F32 if transfer == Transfer::Linear => Self::F32(values.to_vec()),
            Depth::F32 => Self::F32(
                values.par_iter().map(|&v| narrow(transfer.encode(f64::from(v)))).collect(),
            ),
        })
    }

    /// Some of the samples.
    pub(crate) fn part(&self, part: Range<usize>) -> Self {
        match self {
            Self::U8(samples) => Self::U8(samples[part].to_vec()),
            Self::U16(samples) => Self::U16(samples[part].to_vec()),
            Self::F32(samples) => Self::F32(samples[part].to_vec()),
        }
    }

    /// Bytes of some of the samples in a `raw` data file: little-endian.
    pub(crate) fn raw_bytes(&self, part: Range<usize>) -> Cow<'_, [u8]> {
        match self {
            Self::U8(samples) => Cow::Borrowed(&samples[part]),
            Self::U16(samples) => to_bytes(&samples[part], |s| s.to_le_bytes()).into(),
            Self::F32(samples) => to_bytes(&samples[part], |s| s.to_le_bytes()).into(),
        }
    }

    /// Rows as they are run-length coded: in each row the byte planes, most significant first.
    /// `part` is whole rows.
    pub(crate) fn planar_bytes(&self, columns: usize, part: Range<usize>) -> Cow<'_, [u8]> {
        match self {
            Self::U8(samples) => Cow::Borrowed(&samples[part]),
            Self::U16(samples) => split(&samples[part], columns, |s| s.to_be_bytes()).into(),
            Self::F32(samples) => split(&samples[part], columns, |s| s.to_be_bytes()).into(),
        }
    }
}

/// A sample of one depth, as it is read from a data file.
pub(crate) trait Sample: Copy + Default + Send + Sync {
    /// The samples as the bytes of a `raw` file, where they are the same.
    fn as_bytes(samples: &mut [Self]) -> Option<&mut [u8]> {
        let _: &mut [Self] = samples;
        None
    }

    /// Fills `samples` from the bytes of a `raw` file.
    fn from_raw(bytes: &[u8], samples: &mut [Self]);

    /// Fills `samples`, a row, from its byte planes; see [`Samples::planar_bytes`].
    fn from_planar(row: &[u8], samples: &mut [Self]);
}

impl Sample for u8 {
    fn as_bytes(samples: &mut [Self]) -> Option<&mut [u8]> {
        Some(samples)
    }

    fn from_raw(bytes: &[u8], samples: &mut [Self]) {
        samples.copy_from_slice(bytes);
    }

    fn from_planar(row: &[u8], samples: &mut [Self]) {
        samples.copy_from_slice(row);
    }
}

impl Sample for u16 {
    fn from_raw(bytes: &[u8], samples: &mut [Self]) {
        for (sample, &bytes) in samples.iter_mut().zip(bytes.as_chunks().0) {
            *sample = Self::from_le_bytes(bytes);
        }
    }

    fn from_planar(row: &[u8], samples: &mut [Self]) {
        join(row, samples, Self::from_be_bytes);
    }
}

impl Sample for f32 {
    fn from_raw(bytes: &[u8], samples: &mut [Self]) {
        for (sample, &bytes) in samples.iter_mut().zip(bytes.as_chunks().0) {
            *sample = Self::from_le_bytes(bytes);
        }
    }

    fn from_planar(row: &[u8], samples: &mut [Self]) {
        join(row, samples, Self::from_be_bytes);
    }
}

/// The bytes of all samples, one after the other.
fn to_bytes<T: Copy + Sync, const N: usize>(
    samples: &[T],
    bytes_of: impl Fn(T) -> [u8; N] + Sync,
) -> Vec<u8> {
    let mut bytes = vec![0; N * samples.len()];
    let chunks = bytes.par_chunks_mut(N * CHUNK).zip(samples.par_chunks(CHUNK));
    chunks.for_each(|(bytes, samples)| {
        for (bytes, &sample) in bytes.as_chunks_mut().0.iter_mut().zip(samples) {
            *bytes = bytes_of(sample);
        }
    });
    bytes
}

fn decode_table(transfer: Transfer, steps: u16) -> Vec<f32> {
    (0..=steps).map(|step| narrow(transfer.decode(f64::from(step) / f64::from(steps)))).collect()
}

#[expect(clippy::cast_possible_truncation, reason = "planes hold 32-bit values by definition")]
fn narrow(value: f64) -> f32 {
    value as f32
}

fn split<T: Copy + Sync, const N: usize>(
    samples: &[T],
    columns: usize,
    bytes: impl Fn(T) -> [u8; N] + Sync,
) -> Vec<u8> {
    let mut planar = vec![0; N * samples.len()];
    let rows = planar.par_chunks_mut(N * columns).zip(samples.par_chunks(columns));
    rows.with_min_len((CHUNK / columns).max(1)).for_each(|(planar, row)| {
        for (plane, planar) in planar.chunks_mut(columns).enumerate() {
            planar.iter_mut().zip(row).for_each(|(byte, &s)| *byte = bytes(s)[plane]);
        }
    });
    planar
}

fn join<T, const N: usize>(row: &[u8], samples: &mut [T], sample: impl Fn([u8; N]) -> T) {
    let columns = samples.len();
    let planes: [&[u8]; N] = std::array::from_fn(|plane| &row[plane * columns..][..columns]);
    for (column, target) in samples.iter_mut().enumerate() {
        *target = sample(std::array::from_fn(|plane| planes[plane][column]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn raw_bytes_are_little_endian() {
        let words = [0x0102, 0xff00];
        assert_eq!(*Samples::U16(words.into()).raw_bytes(0..2), [2, 1, 0, 0xff]);
        let mut back = [0_u16; 2];
        Sample::from_raw(&[2, 1, 0, 0xff], &mut back);
        assert_eq!(back, words);
        assert_eq!(*Samples::F32(vec![9.0, 1.0]).raw_bytes(1..2), [0, 0, 0x80, 0x3f]);
    }

    #[test]
    fn coded_rows_put_the_most_significant_bytes_first() {
        let samples = Samples::U16(vec![0x0102, 0x0304, 0x0506, 0x0708]);
        assert_eq!(*samples.planar_bytes(2, 0..4), [1, 3, 2, 4, 5, 7, 6, 8]);
        let mut row = [0_u16; 2];
        Sample::from_planar(&[5, 7, 6, 8], &mut row);
        assert_eq!(Samples::U16(row.into()), samples.part(2..4));
        let float = Samples::F32(vec![1.0, -2.0]);
        assert_eq!(*float.planar_bytes(2, 0..2), [0x3f, 0xc0, 0x80, 0, 0, 0, 0, 0]);
        let mut row = [0_f32; 2];
        Sample::from_planar(&[0x3f, 0xc0, 0x80, 0, 0, 0, 0, 0], &mut row);
        assert_eq!(Samples::F32(row.into()), float);
    }

    #[test]
    fn integers_come_back_from_linear_values() {
        for transfer in [Transfer::Srgb, Transfer::Linear, Transfer::Gamma(2.2)] {
            let bytes = Samples::U8((0..=255).collect());
            let back = Samples::encoded(&bytes.decoded(transfer), Depth::U8, transfer);
            assert_eq!(back, Ok(bytes), "{transfer:?}");
            let words = Samples::U16((0..=65_535).collect());
            let back = Samples::encoded(&words.decoded(transfer), Depth::U16, transfer);
            assert_eq!(back, Ok(words), "{transfer:?}");
        }
    }

    #[test]
    fn what_is_not_a_number_is_refused() {
        let values = [0.5, f32::NAN];
        assert_eq!(Samples::encoded(&values, Depth::U8, Transfer::Srgb), Err(1));
    }
}
