//! The blue noise mask: a tile of thresholds whose every level is spread as evenly as can be.
//!
//! Made by void and cluster (Ulichney, "The void-and-cluster method for dither array generation",
//! 1993). The test of this file makes it again and compares.

/// Columns and rows of the mask, which repeats.
pub(crate) const SIDE: usize = 64;

/// The ranks of the places, row by row, in two bytes each, low byte first.
static RANKS: &[u8; 2 * SIDE * SIDE] = include_bytes!("mask.u16");

/// One row of thresholds, above 0 and below 1, evenly spaced over the mask.
pub(crate) fn row(row: usize) -> [f32; SIDE] {
    let bytes = &RANKS[row % SIDE * 2 * SIDE..][..2 * SIDE];
    std::array::from_fn(|column| {
        let rank = u16::from_le_bytes([bytes[2 * column], bytes[2 * column + 1]]);
        (f32::from(rank) + 0.5) / 4096.0
    })
}

#[expect(clippy::cast_possible_truncation, reason = "small numbers of the tests")]
#[cfg(test)]
mod tests {
    use super::*;

    const PLACES: usize = SIDE * SIDE;
    /// Ones of the first pattern: about a tenth (Ulichney, section 3).
    const FIRST: usize = PLACES / 10;
    /// Standard deviation of the filter that finds voids and clusters, in pixels (Ulichney:
    /// 1.5 is best).
    const SIGMA: f64 = 1.5;

    /// A pattern of ones on a torus, and at each place the filtered ones about it. Weights are
    /// whole numbers, so sums are exact in any order and a tie is a tie.
    #[derive(Clone)]
    struct Pattern {
        ones: Vec<bool>,
        density: Vec<i64>,
        filter: Vec<i64>,
    }

    impl Pattern {
        fn new() -> Self {
            let around = |distance: usize| distance.min(SIDE - distance) as f64;
            let weight = |place: usize| {
                let (x, y) = (around(place % SIDE), around(place / SIDE));
                (libm::exp(-(x * x + y * y) / (2.0 * SIGMA * SIGMA)) * 1_099_511_627_776.0) as i64
            };
            Self {
                ones: vec![false; PLACES],
                density: vec![0; PLACES],
                filter: (0..PLACES).map(weight).collect(),
            }
        }

        fn set(&mut self, place: usize, one: bool) {
            self.ones[place] = one;
            let sign = if one { 1 } else { -1 };
            let (column, row) = (place % SIDE, place / SIDE);
            for y in 0..SIDE {
                let line = (y + SIDE - row) % SIDE * SIDE;
                for x in 0..SIDE {
                    let weight = self.filter[line + (x + SIDE - column) % SIDE];
                    self.density[y * SIDE + x] += sign * weight;
                }
            }
        }

        fn tightest_cluster(&self) -> usize {
            let ones = (0..PLACES).filter(|&place| self.ones[place]);
            ones.max_by_key(|&place| (self.density[place], PLACES - place)).unwrap()
        }

        fn largest_void(&self) -> usize {
            let zeros = (0..PLACES).filter(|&place| !self.ones[place]);
            zeros.min_by_key(|&place| (self.density[place], place)).unwrap()
        }
    }

    /// Ranks of all places. The largest void among the zeros is also their tightest cluster's
    /// opposite, as the filtered zeros are a constant less the filtered ones; so the two last of
    /// the paper's three phases are one.
    fn void_and_cluster() -> Vec<u16> {
        let mut pattern = Pattern::new();
        let mut state = 1_993_u64;
        let mut left = FIRST;
        while left > 0 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let place = (state >> 33) as usize % PLACES;
            if !pattern.ones[place] {
                pattern.set(place, true);
                left -= 1;
            }
        }
        loop {
            let cluster = pattern.tightest_cluster();
            pattern.set(cluster, false);
            let void = pattern.largest_void();
            pattern.set(void, true);
            if void == cluster {
                break;
            }
        }
        let mut ranks = vec![0; PLACES];
        let mut removed = pattern.clone();
        for rank in (0..FIRST).rev() {
            let place = removed.tightest_cluster();
            removed.set(place, false);
            ranks[place] = rank as u16;
        }
        for rank in FIRST..PLACES {
            let place = pattern.largest_void();
            pattern.set(place, true);
            ranks[place] = rank as u16;
        }
        ranks
    }

    fn ranks() -> Vec<u16> {
        RANKS.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect()
    }

    #[test]
    fn the_mask_is_what_void_and_cluster_makes() {
        let made = void_and_cluster();
        if std::env::var_os("UPDATE_REFERENCE").is_some() {
            let bytes: Vec<u8> = made.iter().flat_map(|rank| rank.to_le_bytes()).collect();
            std::fs::write(concat!(env!("CARGO_MANIFEST_DIR"), "/src/mask.u16"), bytes).unwrap();
        }
        assert!(made == ranks(), "set UPDATE_REFERENCE to write it");
    }

    #[test]
    fn each_rank_comes_once_and_thresholds_lie_between_0_and_1() {
        let mut sorted = ranks();
        sorted.sort_unstable();
        assert!(sorted.iter().enumerate().all(|(place, &rank)| usize::from(rank) == place));
        let thresholds: Vec<f32> = (0..SIDE).flat_map(row).collect();
        assert!(thresholds.iter().all(|&threshold| threshold > 0.0 && threshold < 1.0));
        assert_eq!(row(3).map(f32::to_bits), row(3 + SIDE).map(f32::to_bits));
        assert!((thresholds.iter().sum::<f32>() / 4096.0 - 0.5).abs() < 1e-4);
    }

    /// At a tenth, two and a half tenths and a half, the power of the lowest frequencies
    /// (up to 6 cycles a tile) is far below that of white noise.
    #[test]
    fn every_level_lacks_low_frequencies() {
        let ranks = ranks();
        for ones in [PLACES / 10, PLACES / 4, PLACES / 2] {
            let share = ones as f64 / PLACES as f64;
            let (mut power, mut frequencies) = (0.0, 0);
            for (u, v) in (0..7_i32).flat_map(|u| (-6..7_i32).map(move |v| (u, v))) {
                if u * u + v * v > 36 || (u, v) == (0, 0) {
                    continue;
                }
                let (mut real, mut imaginary) = (0.0, 0.0);
                for (place, &rank) in ranks.iter().enumerate() {
                    if usize::from(rank) < ones {
                        let turns = f64::from(u) * (place % SIDE) as f64
                            + f64::from(v) * (place / SIDE) as f64;
                        let angle = turns / SIDE as f64 * std::f64::consts::TAU;
                        real += libm::cos(angle);
                        imaginary += libm::sin(angle);
                    }
                }
                power += real * real + imaginary * imaginary;
                frequencies += 1;
            }
            let white = PLACES as f64 * share * (1.0 - share);
            let ratio = power / f64::from(frequencies) / white;
            assert!(ratio < 0.1, "{ones}: {ratio} of white noise");
        }
    }
}
