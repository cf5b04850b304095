//! Distinct colours and how often they come, as long as they are few.

use rayon::prelude::*;

use crate::Pixels;
use crate::histogram::{Piece, pieces};
use crate::key::key;
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
/// Beyond this, to merge the counts takes longer than what is left to count.
const MOST_SHARES: usize = 8;

/// One number for a colour. All colours of alpha 0 are the same.
#[inline(always)]
pub(crate) fn packed(color: [u8; 4]) -> u32 {
    if color[3] == 0 { 0 } else { u32::from_le_bytes(color) }
}

/// Distinct colours with their counts.
#[derive(Debug, Default)]
pub(crate) struct Counted {
    /// Keys of opaque colours, ascending.
    pub(crate) opaque: Vec<(u32, u32)>,
    /// Colours of alpha 1 to 254, ascending.
    pub(crate) translucent: Vec<([u8; 4], u32)>,
    /// Whether there are pixels of alpha 0.
    pub(crate) clear: bool,
}

/// The colours of `pictures` with their counts; nothing where they are more than `most`. With
/// `is_visual`, pixels of flat areas count several times.
///
/// Each thread counts the colours of some rows and sorts them; then each merges a stretch of keys.
pub(crate) fn counted(pictures: &[&Pixels], most: usize, is_visual: bool) -> Option<Counted> {
    if exceeds(pictures, most) {
        return None;
    }
    let pixels: usize = pictures.iter().map(|picture| picture.colors().len()).sum();
    let shares = rayon::current_num_threads().min(pixels.div_ceil(SHARE)).clamp(1, MOST_SHARES);
    let pieces = pieces(pictures, pixels.div_ceil(shares));
    let counted = pieces
        .into_par_iter()
        .map(|pieces| counts(&pieces, most, is_visual).map(|counts| Counted::of(&counts)));
    let mut counted = counted.collect::<Option<Vec<Counted>>>()?;
    let whole = if counted.len() > 1 { merged(&counted) } else { counted.pop()? };
    let found = whole.opaque.len() + whole.translucent.len() + usize::from(whole.clear);
    (found <= most).then_some(whole)
}

impl Counted {
    fn of(counts: &Counts) -> Self {
        let mut opaque = Vec::with_capacity(counts.len());
        let mut found = Self::default();
        for (color, times) in counts.iter() {
            let color = color.to_le_bytes();
            match color[3] {
                // One number sorts faster than two.
                u8::MAX => opaque.push(u64::from(key(color)) << 32 | u64::from(times)),
                0 => found.clear = true,
                _ => found.translucent.push((color, times)),
            }
        }
        opaque.sort_unstable();
        #[expect(clippy::cast_possible_truncation, reason = "the halves of 64 bits")]
        let halves = opaque.into_iter().map(|both| ((both >> 32) as u32, both as u32));
        found.opaque = halves.collect();
        found.translucent.sort_unstable();
        found
    }
}

/// The counts of all shares together.
fn merged(counted: &[Counted]) -> Counted {
    let opaque: Vec<_> = counted.iter().map(|share| &share.opaque[..]).collect();
    let translucent: Vec<_> = counted.iter().map(|share| &share.translucent[..]).collect();
    Counted {
        opaque: together(&opaque),
        translucent: together(&translucent),
        clear: counted.iter().any(|share| share.clear),
    }
}

/// Ascending lists in one, where what is in several is once, with its counts added up. Lists are
/// cut at the same places, so that threads share the work.
fn together<T: Copy + Ord + Send + Sync>(lists: &[&[(T, u32)]]) -> Vec<(T, u32)> {
    let longest = lists.iter().max_by_key(|list| list.len()).copied().unwrap_or_default();
    let parts = (longest.len() / STRETCH).clamp(1, 4 * lists.len());
    let ends = (1..=parts).map(|part| longest.get(part * longest.len() / parts).map(|one| one.0));
    let mut rest = lists.to_vec();
    let part = |end: Option<T>| {
        let (lows, highs): (Vec<_>, Vec<_>) = rest
            .iter()
            .map(|list| {
                let below = end.map_or(list.len(), |end| list.partition_point(|one| one.0 < end));
                list.split_at(below)
            })
            .unzip();
        rest = highs;
        lows
    };
    let parts: Vec<Vec<&[(T, u32)]>> = ends.map(part).collect();
    let merged = parts.into_par_iter().map(|lists| {
        let mut all = lists.concat();
        // It finds the lists and merges them.
        all.sort();
        all.dedup_by(|next, one| {
            let is_same = next.0 == one.0;
            if is_same {
                one.1 = one.1.saturating_add(next.1);
            }
            is_same
        });
        all
    });
    merged.collect::<Vec<_>>().concat()
}

/// Colours that are worth a part of their own in merging.
const STRETCH: usize = 1 << 10;

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

/// Whether there are far more than `most` colours; to count them until there are too many costs
/// 2 to 6 ms, on each thread.
///
/// A small sample of the pixels tells of most pictures. The estimate from it is never much too
/// large, so a quarter is allowed for; but where many colours are rare it is several times too
/// small, and then all pixels are looked at for one colour in [`CLASSES`].
fn exceeds(pictures: &[&Pixels], most: usize) -> bool {
    let pixels: usize = pictures.iter().map(|picture| picture.colors().len()).sum();
    let sample = if most < SMALL { 1 << 10 } else { 1 << 13 };
    if pixels < 4 * sample {
        return false;
    }
    let estimated = estimated(pictures, pixels, sample);
    estimated > most + most / 4
        || most >= LARGE && estimated > most / RARE && exceeds_by_class(pictures, most)
}

/// Colours of which a sample has enough twice, if it is a small one.
const SMALL: usize = 1 << 12;
/// Colours of which one in [`CLASSES`] tells how many there are.
const LARGE: usize = 1 << 15;
/// Beyond all that estimates are too small by: six times, of a photograph of 12 megapixels.
const RARE: usize = 12;

/// The number of colours by a sample of the pixels.
///
/// From the colours that the sample has once and twice follows how many it has not (Chao,
/// "Nonparametric estimation of the number of classes in a population", 1984). With 8192 pixels
/// of 150 000 colours that come as often as each other it is right to about 7 %.
fn estimated(pictures: &[&Pixels], pixels: usize, sample: usize) -> usize {
    let mut counts = Counts::new(2 * sample);
    for picture in pictures {
        let sampled = picture.colors().iter().step_by(pixels / sample);
        sampled.take(sample).for_each(|&color| counts.add(packed(color), 1));
    }
    let of = |count| counts.iter().filter(|&(_, times)| times == count).count();
    let (once, twice) = (of(1), of(2));
    // What is there once stands for no more colours than pixels.
    counts.len + (once * once / (2 * (twice + 1))).min(once * (pixels / sample))
}

/// Whether of one colour in [`CLASSES`], picked by a hash, there are more than an equal share of
/// `most` and an eighth of it: three standard deviations for [`LARGE`] colours.
fn exceeds_by_class(pictures: &[&Pixels], most: usize) -> bool {
    let most = (most + most / 8) / CLASSES as usize;
    let pixels: usize = pictures.iter().map(|picture| picture.colors().len()).sum();
    let pieces = pieces(pictures, pixels.div_ceil(rayon::current_num_threads()));
    let found = pieces.into_par_iter().map(|pieces| class_of(&pieces, most));
    let Some(found) = found.collect::<Option<Vec<Counts>>>() else { return true };
    let mut all = Counts::new(most + 1);
    for (color, _) in found.iter().flat_map(Counts::iter) {
        all.add(color, 1);
        if all.len > most {
            return true;
        }
    }
    false
}

/// Classes of colours of which one is looked at.
const CLASSES: u32 = 64;

/// The colours of one class; nothing where they are more than `most`.
fn class_of(pieces: &[Piece<'_>], most: usize) -> Option<Counts> {
    const LANES: usize = 8;
    let is_of_class = |color: [u8; 4]| {
        let color = packed(color);
        (color ^ color >> 15).wrapping_mul(0x2c1b_3c6d) >> (32 - CLASSES.trailing_zeros()) == 0
    };
    let mut counts = Counts::new(most + 1);
    for (picture, rows) in pieces {
        let columns = picture.columns() as usize;
        let colors = &picture.colors()[columns * rows.start..columns * rows.end];
        for colors in colors.chunks(LANES) {
            // Most have none.
            if colors.iter().fold(false, |any, &color| any | is_of_class(color)) {
                let colors = colors.iter().filter(|color| is_of_class(**color));
                colors.for_each(|&color| counts.add(packed(color), 1));
                if counts.len > most {
                    return None;
                }
            }
        }
    }
    Some(counts)
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use rayon::ThreadPoolBuilder;

    use super::*;

    const SIDE: u32 = 600;

    /// `rare` pixels of a colour of their own, scattered; the others share a few.
    fn picture(rare: u32) -> Pixels {
        let color = |at: u32| {
            let place = at.wrapping_mul(7919) % (SIDE * SIDE);
            let own = if place < rare { place + 1000 } else { place % 200 };
            let [a, b, c, _] = (own.wrapping_mul(0x9e_3779) & 0xff_ffff).to_le_bytes();
            // Some of alpha 0 and some of others.
            [a, b, c, if place.is_multiple_of(50) { a / 64 * 85 } else { u8::MAX }]
        };
        Pixels::new(SIDE, SIDE, (0..SIDE * SIDE).map(color).collect()).unwrap()
    }

    fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
        ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
    }

    #[test]
    fn colors_are_counted_on_any_number_of_threads() {
        let picture = picture(50_000);
        let mut expected: BTreeMap<[u8; 4], u32> = BTreeMap::new();
        for &color in picture.colors() {
            *expected.entry(if color[3] == 0 { [0; 4] } else { color }).or_default() += 1;
        }
        assert!(!exceeds(&[&picture], expected.len()));
        for threads in [1, 2, 3] {
            let counted = |most| with_threads(threads, || counted(&[&picture], most, false));
            let found = counted(expected.len()).unwrap();
            assert!(found.clear && found.opaque.is_sorted() && found.translucent.is_sorted());
            let opaque = found.opaque.iter().map(|&(key, times)| {
                let [red, green, blue] = crate::key::color(key);
                ([red, green, blue, u8::MAX], times)
            });
            let clear = ([0; 4], expected[&[0; 4]]);
            let all: BTreeMap<_, _> =
                opaque.chain(found.translucent.iter().copied()).chain([clear]).collect();
            assert!(all == expected, "{threads} threads");
            assert!(counted(expected.len() - 1).is_none(), "{threads} threads");
        }
    }

    #[test]
    fn many_rare_colors_are_noticed() {
        let (few, many) = (picture(60_000), picture(90_000));
        for threads in [1, 3] {
            let exceeds = |picture| with_threads(threads, || exceeds_by_class(&[picture], 65_536));
            assert!(exceeds(&many) && !exceeds(&few), "{threads} threads");
        }
    }
}
