//! Distinct colours and how often they come, as long as they are few.

use rayon::prelude::*;

use crate::Pixels;
use crate::histogram::{Piece, pieces};
use crate::visibility::Flatness;

/// Distinct colours with their counts, in a table of open addressing.
#[derive(Debug)]
pub(crate) struct Counts {
    /// Colours as [`packed`], and how often they came; 0 where the place is free.
    slots: Vec<(u32, u32)>,
    len: usize,
    /// Bits of a hash that are dropped.
    shift: u32,
}

/// Pixels that are worth a thread.
const SHARE: usize = 1 << 17;
/// Beyond this, to add up the counts takes longer than what is left to count.
const MOST_SHARES: usize = 8;

/// One number for a colour. All colours of alpha 0 are the same.
#[inline(always)]
pub(crate) fn packed(color: [u8; 4]) -> u32 {
    if color[3] == 0 { 0 } else { u32::from_le_bytes(color) }
}

/// The colours of `pictures` with their counts, in no order; nothing where they are more than
/// `most`. With `is_visual`, pixels of flat areas count several times.
///
/// Each thread counts the colours of some rows; then each adds up some of the colours.
pub(crate) fn counted(
    pictures: &[&Pixels],
    most: usize,
    is_visual: bool,
) -> Option<Vec<([u8; 4], u32)>> {
    if exceeds(pictures, most) {
        return None;
    }
    let pixels: usize = pictures.iter().map(|picture| picture.colors().len()).sum();
    let shares = rayon::current_num_threads().min(pixels.div_ceil(SHARE)).clamp(1, MOST_SHARES);
    let pieces = pieces(pictures, pixels.div_ceil(shares));
    let counted = pieces.into_par_iter().map(|pieces| counts(&pieces, most, is_visual));
    let counted: Vec<Option<Counts>> = counted.collect();
    let counted: Vec<Counts> = counted.into_iter().collect::<Option<_>>()?;
    let merged = if counted.len() > 1 { merged(&counted, most)? } else { counted };
    let found: usize = merged.iter().map(Counts::len).sum();
    let colors = merged.iter().flat_map(Counts::iter);
    (found <= most).then(|| colors.map(|(color, times)| (color.to_le_bytes(), times)).collect())
}

/// The counts of all shares together, in as many parts, each of other colours; nothing where one
/// part has more than `most`.
fn merged(counted: &[Counts], most: usize) -> Option<Vec<Counts>> {
    let parts = counted.len();
    let total: usize = counted.iter().map(Counts::len).sum();
    let merged = (0..parts).into_par_iter().map(|part| {
        let mut counts = Counts::new(total.min(most + 1));
        for (color, times) in counted.iter().flat_map(Counts::iter) {
            // Bits that colours are not placed by.
            if (color.wrapping_mul(0x85eb_ca6b) >> 16) as usize % parts == part {
                counts.add(color, times);
                if counts.len > most {
                    return None;
                }
            }
        }
        Some(counts)
    });
    merged.collect()
}

/// Counts the colours of some rows; nothing where they are more than `most`.
fn counts(pieces: &[Piece<'_>], most: usize, is_visual: bool) -> Option<Counts> {
    let mut counts = Counts::new(most + 1);
    let mut flatness = Flatness::default();
    for (picture, rows) in pieces {
        let columns = picture.columns() as usize;
        for row in rows.clone() {
            let colors = &picture.colors()[row * columns..][..columns];
            let times = if is_visual { flatness.row(picture, row) } else { &[] };
            let times = times.iter().copied().chain(std::iter::repeat(1));
            let mut run = (0, 0);
            for (&color, times) in colors.iter().zip(times) {
                let color = packed(color);
                if color == run.0 {
                    run.1 += u32::from(times);
                } else {
                    counts.add(run.0, run.1);
                    if counts.len > most {
                        return None;
                    }
                    run = (color, u32::from(times));
                }
            }
            counts.add(run.0, run.1);
        }
    }
    (counts.len <= most).then_some(counts)
}

/// Whether a sample of the pixels shows that there are far more than `most` colours; to count
/// them until there are too many costs 2 to 6 ms.
///
/// From the colours that the sample has once and twice follows how many it has not (Chao,
/// "Nonparametric estimation of the number of classes in a population", 1984). With 8192 pixels
/// of 150 000 colours that is right to about 7 %; a quarter is allowed for.
fn exceeds(pictures: &[&Pixels], most: usize) -> bool {
    const SAMPLE: usize = 1 << 13;
    let pixels: usize = pictures.iter().map(|picture| picture.colors().len()).sum();
    if pixels < 4 * SAMPLE {
        return false;
    }
    let mut counts = Counts::new(2 * SAMPLE);
    for picture in pictures {
        let sampled = picture.colors().iter().step_by(pixels / SAMPLE);
        sampled.take(SAMPLE).for_each(|&color| counts.add(packed(color), 1));
    }
    let of = |count| counts.iter().filter(|&(_, times)| times == count).count();
    let (once, twice) = (of(1), of(2));
    counts.len + once * once / (2 * (twice + 1)) > most + most / 4
}

impl Counts {
    /// A table with room for `most` colours.
    pub(crate) fn new(most: usize) -> Self {
        // At most half full, so that runs of taken places stay short.
        let slots = (2 * most).next_power_of_two().max(2);
        Self { slots: vec![(0, 0); slots], len: 0, shift: 32 - slots.trailing_zeros() }
    }

    /// Number of distinct colours.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Whether there are more colours than there was room for; there is yet room for as many.
    pub(crate) fn is_full(&self) -> bool {
        2 * self.len > self.slots.len()
    }

    /// Colours and counts, in no order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.slots.iter().copied().filter(|slot| slot.1 > 0)
    }

    /// Counts a colour `times` times more.
    #[inline]
    pub(crate) fn add(&mut self, color: u32, times: u32) {
        if times == 0 {
            return;
        }
        // Fibonacci hashing: 2^32 divided by the golden ratio.
        let mut at = (color.wrapping_mul(0x9e37_79b1) >> self.shift) as usize;
        loop {
            let slot = &mut self.slots[at];
            if slot.1 == 0 {
                *slot = (color, times);
                self.len += 1;
                return;
            }
            if slot.0 == color {
                slot.1 = slot.1.saturating_add(times);
                return;
            }
            at = (at + 1) % self.slots.len();
        }
    }
}
