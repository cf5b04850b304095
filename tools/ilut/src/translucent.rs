//! Counts of colours that are not opaque.

use crate::unique::{Counts, packed};

/// Counts of colours of alpha below 255; by ever larger groups where they are many.
///
/// How large the groups are depends on the colours alone: groups are made larger only when their
/// number exceeds [`MOST`], and what is counted in parts never needs larger ones than the whole.
#[derive(Debug)]
pub(crate) struct Translucent {
    counts: Counts,
    /// Low bits of each channel that are dropped.
    dropped: u32,
    clear: bool,
}

/// Most groups; with four bits of each channel they cannot be more.
const MOST: usize = 1 << 16;

impl Default for Translucent {
    fn default() -> Self {
        Self { counts: Counts::new(1 << 8), dropped: 0, clear: false }
    }
}

impl Translucent {
    /// Counts a colour several `times`.
    pub(crate) fn add(&mut self, color: [u8; 4], times: u8) {
        if color[3] == 0 {
            self.clear = true;
        } else {
            self.add_times(packed(color), u32::from(times));
        }
    }

    fn add_times(&mut self, color: u32, times: u32) {
        self.counts.add(color & kept(self.dropped), times);
        if self.counts.is_full() {
            self.grow();
        }
    }

    /// Whether there were colours of alpha 0.
    pub(crate) fn clear(&self) -> bool {
        self.clear
    }

    /// Adds the colours of `other`.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.clear |= other.clear;
        while self.dropped < other.dropped {
            self.drop_bit();
        }
        for (color, times) in other.counts.iter() {
            self.add_times(color, times);
        }
    }

    /// Colours, or the middles of their groups, with their counts; ascending by bytes.
    pub(crate) fn sorted(&self) -> Vec<([u8; 4], u32)> {
        let colors = self.counts.iter().map(|(color, times)| (color.to_le_bytes(), times));
        let middle = if self.dropped > 0 { 1 << (self.dropped - 1) } else { 0 };
        // The highest group of alpha has a middle below 255, and none has one of 0.
        let mut colors: Vec<_> =
            colors.map(|(color, times)| (color.map(|byte| byte | middle), times)).collect();
        colors.sort_unstable();
        colors
    }

    /// Makes room: for more groups, or by larger ones.
    fn grow(&mut self) {
        if self.counts.len() <= MOST {
            let mut counts = Counts::new(2 * self.counts.len());
            self.counts.iter().for_each(|(color, times)| counts.add(color, times));
            self.counts = counts;
        }
        while self.counts.len() > MOST {
            self.drop_bit();
        }
    }

    fn drop_bit(&mut self) {
        self.dropped += 1;
        let mut counts = Counts::new(MOST);
        let kept = kept(self.dropped);
        self.counts.iter().for_each(|(color, times)| counts.add(color & kept, times));
        self.counts = counts;
    }
}

/// The bits of four bytes that are kept.
fn kept(dropped: u32) -> u32 {
    0x0101_0101 * (0xff << dropped & 0xff)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_do_not_depend_on_how_the_colors_are_shared_out() {
        let spread = |at: u32| at.wrapping_mul(2_654_435_761).to_le_bytes();
        let colors: Vec<[u8; 4]> = (0..150_000).map(spread).filter(|c| c[3] < 255).collect();
        let counted = |share: usize| {
            let mut all = Translucent::default();
            for colors in colors.chunks(share) {
                let mut some = Translucent::default();
                colors.iter().for_each(|&color| some.add(color, 1));
                all.merge(&some);
            }
            all
        };
        let whole = counted(colors.len()).sorted();
        assert!(whole.len() <= MOST && whole.len() > 1 << 12, "{}", whole.len());
        let covered = colors.iter().filter(|color| color[3] > 0).count();
        assert_eq!(whole.iter().map(|(_, times)| *times as usize).sum::<usize>(), covered);
        assert!(whole.iter().all(|(color, _)| (1..255).contains(&color[3])));
        assert!(counted(40_000).sorted() == whole && counted(999).sorted() == whole);
        assert!(counted(999).clear());
    }
}
