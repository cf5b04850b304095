//! Which pixels get more samples: those where a sample takes most off the error for what it costs.

use rayon::prelude::*;

/// What pilots tell about each pixel, row by row.
#[derive(Clone, Debug, Default)]
pub(crate) struct Survey {
    /// Over the background, in display steps.
    pub(crate) shown: Vec<[f32; 3]>,
    /// Variance of single samples of the pixel, the mean of the channels, in squared display steps.
    pub(crate) within: Vec<f32>,
}

/// The share of the variance between neighbours that is taken for a pixel's own where that is less: a detail that all
/// samples of a pixel missed was met beside it.
const NEIGHBOURS: f32 = 0.02;
/// The share of the mean variance of the picture that every pixel has: where pilots saw nothing there may be something
/// that all of them missed.
const UNSEEN: f32 = 0.02;

impl Survey {
    /// The variance of a sample in each pixel, pooled over 3 × 3 pixels; above 0 if it is anywhere.
    pub(crate) fn variances(&self, columns: usize) -> Vec<f32> {
        let rows = self.within.len() / columns.max(1);
        let around = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
        let variance = |at: usize| {
            let (mut sum, mut square, mut within, mut count) = ([0.0; 3], [0.0; 3], 0.0, 0.0);
            for row in around(at / columns, rows) {
                for column in around(at % columns, columns) {
                    let beside = row * columns + column;
                    for (k, shown) in self.shown[beside].into_iter().enumerate() {
                        // Off the pixel's own, so that few digits cancel.
                        let shown = shown - self.shown[at][k];
                        sum[k] += shown;
                        square[k] += shown * shown;
                    }
                    within += self.within[beside];
                    count += 1.0;
                }
            }
            let channel = |k: usize| square[k] - sum[k] * sum[k] / count;
            let between = (channel(0) + channel(1) + channel(2)) / 3.0;
            let between = if count > 1.0 { between / (count - 1.0) } else { 0.0 };
            let share = NEIGHBOURS * between;
            let within = within / count;
            if within > share { within } else { share }
        };
        let mut pooled: Vec<f32> = (0..self.within.len()).into_par_iter().map(variance).collect();
        let sum = pooled.iter().map(|&variance| f64::from(variance)).sum::<f64>();
        #[expect(clippy::cast_possible_truncation, reason = "as the others")]
        let least = UNSEEN * (sum / pooled.len().max(1) as f64) as f32;
        for variance in &mut pooled {
            *variance = if *variance > least { *variance } else { least };
        }
        pooled
    }
}

/// Where to stop doubling.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Goal {
    /// The share of the squared error that should be left.
    Left(f64),
    /// New samples, about.
    Samples(f64),
}

/// One half of a pixel.
#[derive(Clone, Copy, Debug)]
struct Need {
    variance: f64,
    /// Of a sample.
    cost: f64,
    count: f64,
    /// New samples if they are doubled.
    more: u32,
}

impl Need {
    /// What the first new sample takes off the squared error of the pixel, for each unit of cost.
    fn rate(&self) -> f64 {
        if self.more > 0 { self.variance / (self.cost * self.count * self.count) } else { 0.0 }
    }
}

/// What is known of all pixels of about the same rate.
#[derive(Clone, Copy, Debug, Default)]
struct Bin {
    /// Sums of the squared errors, of the roots of variance and cost, and of the new samples of doubling.
    error: f64,
    root: f64,
    more: f64,
}

/// How many samples each pixel should have in either half after a round: what is worth most is doubled. None has more than
/// `most`. `costs` are those of a sample.
///
/// The least cost for an error has all rates v / (c n²) alike: n is the root of v / (λ c) where that is more than there
/// are. A round doubles where that asks for it, and so comes near it from below.
pub(crate) fn allot(
    counts: &[u32],
    variances: &[f32],
    costs: &[f32],
    goal: Goal,
    most: u32,
) -> Vec<u32> {
    let need = |at: usize| {
        let count = counts[at];
        Need {
            variance: f64::from(variances[at]),
            cost: f64::from(costs[at]),
            count: f64::from(count),
            more: count.min(most - count.min(most)),
        }
    };
    // Sixteen bins to a factor of two: sorting would take longer than tracing.
    let number = |rate: f64| (rate.to_bits() >> BIN_BITS) as usize;
    let mut bins = vec![Bin::default(); number(f64::INFINITY) + 1];
    let mut whole = 0.0;
    for at in 0..counts.len() {
        let need = need(at);
        let error = need.variance / need.count;
        whole += error;
        let rate = need.rate();
        if rate > 0.0 {
            let bin = &mut bins[number(rate)];
            bin.error += error;
            bin.root += (need.variance * need.cost).sqrt();
            bin.more += 2.0 * f64::from(need.more);
        }
    }
    let least = least_rate(&bins, whole, counts.len() as f64, goal);
    let raised = |at: usize| {
        let need = need(at);
        let raise = need.rate() > 0.0 && need.rate() >= least;
        counts[at] + if raise { need.more } else { 0 }
    };
    (0..counts.len()).into_par_iter().map(raised).collect()
}

/// Bits of a number that those of its bin leave out.
const BIN_BITS: u32 = 48;
/// The share of the pixels that a round has samples for, at least.
const LEAST_ROUND: f64 = 0.01;

/// The rate from which on samples are doubled.
fn least_rate(bins: &[Bin], whole: f64, pixels: f64, goal: Goal) -> f64 {
    let (mut sum, mut doubled) = (Bin::default(), 0.0);
    // Those of at least twice the final rate are doubled: an octave above.
    let octave = 1 << (52 - BIN_BITS);
    for (number, bin) in bins.iter().enumerate().rev() {
        let rate = f64::from_bits((number as u64) << BIN_BITS);
        sum.error += bin.error;
        sum.root += bin.root;
        sum.more += bin.more;
        match goal {
            Goal::Samples(wanted) => {
                if sum.more >= wanted {
                    return rate;
                }
            }
            Goal::Left(share) => {
                doubled += bins.get(number + octave).map_or(0.0, |bin| bin.more);
                // If all of the rates above came down to this one.
                let left = rate.sqrt() * sum.root + whole - sum.error;
                if left <= share * whole && doubled >= LEAST_ROUND * pixels {
                    return 2.0 * rate;
                }
            }
        }
    }
    0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variances_by_hand() {
        // A black row between white ones: the middle pixel of 3 × 3 has six neighbours apart by 100.
        let mut survey = Survey { shown: vec![[100.0; 3]; 9], within: vec![0.0; 9] };
        for at in 3..6 {
            survey.shown[at] = [0.0; 3];
        }
        // Σx² − (Σx)²/9 over 8: (6 · 100² − 600²/9) / 8 = 2500.
        let pooled = survey.variances(3)[4];
        assert!((pooled - 0.02 * 2500.0).abs() < 1e-3, "{pooled}");
        survey.within = vec![90.0; 9];
        assert!((survey.variances(3)[4] - 90.0).abs() < 1e-3, "their own is more");
        let alone = Survey { shown: vec![[1.0; 3]], within: vec![4.0] };
        assert!((alone.variances(1)[0] - 4.0).abs() < 1e-6);
        // One pixel of 100 has all of it: its neighbours a ninth or more, the others 2 % of the mean.
        let mut spot = Survey { shown: vec![[0.0; 3]; 100], within: vec![0.0; 100] };
        spot.within[55] = 900.0;
        let pooled = spot.variances(10);
        assert!((pooled[55] - 100.0).abs() < 1e-3 && (pooled[44] - 100.0).abs() < 1e-3);
        assert!((pooled[0] - 0.02 * 9.0).abs() < 1e-5, "{}", pooled[0]);
    }

    const COUNTS: [u32; 4] = [8, 8, 8, 16];

    #[test]
    fn what_is_worth_most_comes_first() {
        // Rates are 1/64, 100/64, 0, 800/256.
        let variances = [1.0, 100.0, 0.0, 800.0];
        let counts = |goal, most| allot(&COUNTS, &variances, &[1.0; 4], goal, most);
        assert_eq!(counts(Goal::Samples(1.0), 1000), [8, 8, 8, 32]);
        assert_eq!(counts(Goal::Samples(33.0), 1000), [8, 16, 8, 32], "16 in either half, and 8");
        // Nothing is spent where there is no variance.
        assert_eq!(counts(Goal::Samples(1e9), 1000), [16, 16, 8, 32]);
        let dear = allot(&COUNTS, &variances, &[1.0, 1.0, 1.0, 10.0], Goal::Samples(1.0), 1000);
        assert_eq!(dear, [8, 16, 8, 16], "by cost");
        assert_eq!(counts(Goal::Samples(1.0), 20), [8, 8, 8, 20], "up to the limit");
        assert_eq!(counts(Goal::Samples(1.0), 16), [8, 16, 8, 16], "what is at it is left");
    }

    #[test]
    fn only_what_the_goal_asks_for_is_doubled() {
        let variances = [1.0, 100.0, 0.0, 800.0];
        let counts = |share| allot(&COUNTS, &variances, &[1.0; 4], Goal::Left(share), 1000);
        // Errors are 1/8, 100/8, 0, 800/16: 62.625. At a final rate of 0.5 the two of 100/64 and 800/256 leave
        // (10 + 28.28) · √0.5 = 27.1, the other 0.125: 0.434 of the whole. Those whose rate is twice 0.5 are doubled.
        assert_eq!(counts(0.45), [8, 16, 8, 32]);
        // At 1.5 they leave 38.28 · √1.5 + 0.125 = 47.0, 0.75; only one rate is twice that.
        assert_eq!(counts(0.76), [8, 8, 8, 32]);
        // However far the goal is, flat pixels are left alone.
        assert_eq!(counts(1e-6), [16, 16, 8, 32]);
    }
}
