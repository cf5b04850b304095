//! Curves over whole planes: tables for integers, the formula for floating point.

use idf::transfer::{rounded_8, rounded_16};
use idf::{Image, ImageError, Samples, Transfer};
use rayon::prelude::*;

use crate::light::{Light, narrow};

/// Samples that a thread takes at once.
const CHUNK: usize = 1 << 16;

/// Samples whose coverage is looked at together.
const BLOCK: usize = 64;

/// Samples from which a table of pairs is worth its 65 536 entries.
const MANY: usize = 1 << 18;

/// The light with `curve` applied to its display values. Bytes and words are changed in place,
/// through one table for all channels.
pub(crate) fn mapped(
    mut light: Light,
    curve: impl Fn(f64) -> f64 + Sync,
) -> Result<Image, ImageError> {
    let transfer = light.transfer;
    let multiplied = light.is_multiplied();
    // Exact where samples are display values: no way through linear light and back.
    let display = |stored: f64| match transfer {
        Transfer::Srgb => curve(stored),
        _ => Transfer::Srgb.decode(curve(Transfer::Srgb.encode(transfer.decode(stored)))),
    };
    let kept = if transfer == Transfer::Srgb { Transfer::Linear } else { transfer };
    match (light.steps(), multiplied) {
        (Some(255), false) => {
            let table = table_8(|s| rounded_8(kept, display(f64::from(s) / 255.0)));
            light.planes.iter_mut().for_each(|plane| {
                if let Samples::U8(samples) = &mut plane.samples {
                    through_8(samples, &table);
                }
            });
            light.into_same()
        }
        (Some(255), true) => {
            let table = covered_table(transfer, &curve);
            let row = table.last_chunk().expect("256 rows of 256 bytes");
            let whole = Pairs::new(row);
            let (planes, coverage) = light.planes_and_coverage();
            for plane in planes {
                if let (Samples::U8(samples), Some(Samples::U8(shares))) =
                    (&mut plane.samples, coverage)
                {
                    through_covered(samples, shares, &table, &whole);
                }
            }
            light.into_same()
        }
        (Some(65_535), false) => {
            let entry = |s: u16| rounded_16(kept, display(f64::from(s) / 65_535.0));
            let table: Vec<u16> = (0..=u16::MAX).into_par_iter().map(entry).collect();
            light.planes.iter_mut().for_each(|plane| {
                if let Samples::U16(samples) = &mut plane.samples {
                    through_16(samples, &table);
                }
            });
            light.into_same()
        }
        _ => {
            let changed = light.take_display().into_iter().enumerate().map(|(channel, display)| {
                let Samples::F32(mut values) = display else {
                    unreachable!("what is not stored as display values becomes floating point")
                };
                values.par_iter_mut().for_each(|value| *value = narrow(curve(f64::from(*value))));
                light.stored(channel, Samples::F32(values))
            });
            let changed = changed.collect::<Result<_, ImageError>>()?;
            light.into_image(changed)
        }
    }
}

fn table_8(entry: impl Fn(u8) -> u8) -> [u8; 256] {
    let mut table = [0; 256];
    for (new, stored) in table.iter_mut().zip(0..=255) {
        *new = entry(stored);
    }
    table
}

/// Replaces every sample by its entry.
///
/// Large planes take two samples at a time: one load where two were.
pub(crate) fn through_8(samples: &mut [u8], table: &[u8; 256]) {
    if samples.len() < MANY {
        return samples.iter_mut().for_each(|sample| *sample = table[usize::from(*sample)]);
    }
    let pairs = Pairs::new(table);
    samples.par_chunks_mut(CHUNK).for_each(|samples| pairs.replace(samples));
}

/// A table of 65 536 pairs, which stays in the second cache.
struct Pairs(Box<[u16; 65_536]>);

impl Pairs {
    fn new(table: &[u8; 256]) -> Self {
        let pair =
            |pair: u16| u16::from_le_bytes(pair.to_le_bytes().map(|byte| table[usize::from(byte)]));
        let pairs: Box<[u16]> = (0..=u16::MAX).map(pair).collect();
        Self(pairs.try_into().expect("one for each pair of bytes"))
    }

    #[inline]
    fn replace(&self, samples: &mut [u8]) {
        let (eights, rest) = samples.as_chunks_mut::<8>();
        for bytes in eights {
            let eight = u64::from_le_bytes(*bytes);
            let pair = |at: u32| {
                let [low, high, ..] = (eight >> at).to_le_bytes();
                u64::from(self.0[usize::from(u16::from_le_bytes([low, high]))]) << at
            };
            *bytes = (pair(0) | pair(16) | pair(32) | pair(48)).to_le_bytes();
        }
        for sample in rest {
            *sample = self.0[usize::from(*sample)].to_le_bytes()[0];
        }
    }
}

/// Replaces every sample by its entry of a table of 65 536.
pub(crate) fn through_16(samples: &mut [u16], table: &[u16]) {
    let table: &[u16; 65_536] = table.try_into().expect("one entry for each sample");
    samples.par_chunks_mut(CHUNK).for_each(|samples| {
        samples.iter_mut().for_each(|sample| *sample = table[usize::from(*sample)]);
    });
}

/// The new byte for each pair of a byte of light, multiplied by coverage, and one of coverage.
fn covered_table(transfer: Transfer, curve: &(impl Fn(f64) -> f64 + Sync)) -> Vec<u8> {
    let entry = |pair: u16| {
        let [sample, share] = pair.to_le_bytes();
        if share == 0 {
            return sample;
        }
        let share = f64::from(share) / 255.0;
        let covered = transfer.decode(f64::from(sample) / 255.0) / share;
        let new = Transfer::Srgb.decode(curve(Transfer::Srgb.encode(covered)));
        rounded_8(transfer, new * share)
    };
    (0..=u16::MAX).into_par_iter().map(entry).collect()
}

/// Replaces bytes by the entries of [`covered_table`]: most of a matte is 0, which changes nothing,
/// or all, for which one row of the table is enough.
fn through_covered(samples: &mut [u8], coverage: &[u8], table: &[u8], whole: &Pairs) {
    let table: &[u8; 65_536] = table.try_into().expect("one for each pair of bytes");
    let chunks = samples.par_chunks_mut(CHUNK).zip(coverage.par_chunks(CHUNK));
    chunks.for_each(|(samples, coverage)| {
        for (samples, coverage) in samples.chunks_mut(BLOCK).zip(coverage.chunks(BLOCK)) {
            if coverage.iter().fold(u8::MAX, |all, share| all & share) == u8::MAX {
                whole.replace(samples);
            } else if coverage.iter().fold(0, |any, share| any | share) > 0 {
                for (sample, &share) in samples.iter_mut().zip(coverage) {
                    *sample = table[usize::from(u16::from_le_bytes([*sample, share]))];
                }
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_of_all_and_of_nothing_are_as_single_samples() {
        let table: Vec<u8> = (0..=u16::MAX)
            .map(|pair| {
                let [sample, share] = pair.to_le_bytes();
                if share == 0 { sample } else { sample.wrapping_mul(7) ^ share }
            })
            .collect();
        let whole = Pairs::new(table.last_chunk().unwrap());
        // Long stretches of each, their ends within blocks, and noise; no multiple of a block.
        let coverage: Vec<u8> = (0..3001_u32)
            .map(|at| [0, 255, 255, (at * at % 251).to_le_bytes()[0]][at as usize / 300 % 4])
            .collect();
        let samples: Vec<u8> = (0..3001_u32).map(|at| (at * 37 % 256).to_le_bytes()[0]).collect();
        let entry =
            |(&sample, &share): (&u8, &u8)| table[usize::from(share) * 256 + usize::from(sample)];
        let expected: Vec<u8> = samples.iter().zip(&coverage).map(entry).collect();
        let mut found = samples;
        through_covered(&mut found, &coverage, &table, &whole);
        assert!(found == expected, "blocks");
    }

    #[test]
    fn pairs_and_single_samples_give_the_same() {
        let table = table_8(|byte| byte.wrapping_mul(37) ^ 0x5a);
        // Every pair of bytes, and a length that is no multiple of 8.
        let samples: Vec<u8> =
            (0..=u16::MAX).cycle().take(MANY).flat_map(u16::to_le_bytes).chain([1, 2, 3]).collect();
        let expected: Vec<u8> = samples.iter().map(|&s| table[usize::from(s)]).collect();
        let mut few = samples[..999].to_vec();
        through_8(&mut few, &table);
        assert_eq!(few, expected[..999]);
        let mut many = samples;
        through_8(&mut many, &table);
        assert!(many == expected, "pairs");
    }
}
