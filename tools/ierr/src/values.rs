//! The values of one channel, in no more memory than the samples that they come of take.

use std::ops::Range;
use std::sync::Arc;

use idf::{Samples, Transfer};

use crate::pair::ONE;

/// Values of pixels in 255ths, row by row from the top. A clone is the same memory.
#[derive(Clone, Debug)]
pub struct Values(Arc<Stored>);

#[derive(Debug)]
enum Stored {
    /// Bytes, and the value of each.
    Bytes(Vec<u8>, Arc<Vec<f32>>),
    /// Bytes and their coverage, and the value of both: of 256 bytes for each coverage.
    Shared(Vec<u8>, Arc<Vec<u8>>, Arc<Vec<f32>>),
    /// 257ths of the values.
    Words(Vec<u16>),
    Floats(Vec<f32>),
    /// So many times [`ONE`].
    Ones(usize),
}

impl Values {
    /// Whole coverage of so many pixels.
    pub(crate) fn ones(count: usize) -> Self {
        Self(Arc::new(Stored::Ones(count)))
    }

    /// Values as they are.
    pub(crate) fn floats(values: Vec<f32>) -> Self {
        Self(Arc::new(Stored::Floats(values)))
    }

    /// Samples as they are stored, bytes exactly; floating point as linear values.
    pub(crate) fn stored(samples: &Samples) -> Self {
        Self(Arc::new(match samples {
            Samples::U8(samples) => Stored::Bytes(samples.clone(), bytes(f32::from)),
            Samples::U16(samples) => Stored::Words(samples.clone()),
            Samples::F32(_) => {
                let values = samples.decoded(Transfer::Linear);
                Stored::Floats(values.iter().map(|value| value * ONE).collect())
            }
        }))
    }

    /// The value of each byte by `value`.
    pub(crate) fn of_bytes(samples: &[u8], value: impl Fn(u8) -> f32) -> Self {
        Self(Arc::new(Stored::Bytes(samples.to_vec(), bytes(value))))
    }

    /// The value of each byte and its coverage, by `value`.
    pub(crate) fn of_shares(
        samples: &[u8],
        shares: &Arc<Vec<u8>>,
        value: impl Fn(u8, u8) -> f32,
    ) -> Self {
        let all = (0..=u8::MAX).flat_map(|share| (0..=u8::MAX).map(move |byte| (byte, share)));
        let table = Arc::new(all.map(|(byte, share)| value(byte, share)).collect());
        Self(Arc::new(Stored::Shared(samples.to_vec(), Arc::clone(shares), table)))
    }

    /// Number of pixels.
    pub fn len(&self) -> usize {
        match &*self.0 {
            Stored::Bytes(samples, _) | Stored::Shared(samples, ..) => samples.len(),
            Stored::Words(samples) => samples.len(),
            Stored::Floats(values) => values.len(),
            Stored::Ones(count) => *count,
        }
    }

    /// Whether there are no pixels.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The values of some pixels.
    ///
    /// # Panics
    ///
    /// If not all are below [`Values::len`].
    pub fn part(&self, part: Range<usize>) -> Vec<f32> {
        match &*self.0 {
            Stored::Bytes(samples, table) => {
                samples[part].iter().map(|&byte| table[usize::from(byte)]).collect()
            }
            Stored::Shared(samples, shares, table) => {
                let pairs = samples[part.clone()].iter().zip(&shares[part]);
                let place = |(&byte, &share)| usize::from(share) << 8 | usize::from(byte);
                pairs.map(|pair| table[place(pair)]).collect()
            }
            Stored::Words(samples) => {
                samples[part].iter().map(|&sample| f32::from(sample) / 257.0).collect()
            }
            Stored::Floats(values) => values[part].to_vec(),
            Stored::Ones(count) => {
                assert!(part.end <= *count, "{part:?} of {count} pixels");
                vec![ONE; part.len()]
            }
        }
    }

    /// All values.
    pub fn all(&self) -> Vec<f32> {
        self.part(0..self.len())
    }
}

fn bytes(value: impl Fn(u8) -> f32) -> Arc<Vec<f32>> {
    Arc::new((0..=u8::MAX).map(value).collect())
}
