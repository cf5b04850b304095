//! Numbers that depend on a seed and a place in a row alone.

/// A sequence of numbers: `SplitMix64` (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Random {
    state: u64,
}

/// 2⁶⁴ over the golden ratio, odd.
const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

impl Random {
    /// The sequence of star `index` of a sky.
    pub(crate) fn new(seed: u64, index: u64) -> Self {
        Self { state: mixed(mixed(seed.wrapping_add(STEP)) ^ index.wrapping_mul(STEP)) }
    }

    fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(STEP);
        mixed(self.state)
    }

    /// From 0, exclusive, to 1, inclusive; a whole number of 2⁻⁵³.
    pub(crate) fn share(&mut self) -> f64 {
        ((self.bits() >> 11) + 1) as f64 / 9_007_199_254_740_992.0
    }
}

fn mixed(state: u64) -> u64 {
    let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_values() {
        // The first outputs for seed 0, as the authors' program has them.
        let mut random = Random { state: 0 };
        assert_eq!(random.bits(), 0xe220_a839_7b1d_cdaf);
        assert_eq!(random.bits(), 0x6e78_9e6a_a1b9_65f4);
        assert_eq!(random.bits(), 0x06c4_5d18_8009_454f);
    }

    #[test]
    fn shares_are_spread_evenly() {
        let mut tenths = [0; 10];
        for index in 0..100_000 {
            let share = Random::new(7, index).share();
            assert!(share > 0.0 && share <= 1.0, "{share}");
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 9")]
            let tenth = (share * 9.999_999) as usize;
            tenths[tenth] += 1;
        }
        // The standard deviation of each is 95.
        assert!(tenths.iter().all(|count| (9500..10_500).contains(count)), "{tenths:?}");
    }
}
