//! Which pixels get more samples: those where a sample takes most off the error for what it costs.

use rayon::prelude::*;

/// What one half of the samples tells about each pixel, row by row.
#[derive(Clone, Debug, Default)]
pub(crate) struct Survey {
    /// Over the background, in display steps.
    pub(crate) shown: Vec<[f32; 3]>,
    /// Variance of single samples of the pixel, the mean of the channels, in squared display steps.
    pub(crate) within: Vec<f32>,
    pub(crate) counts: Vec<u32>,
}

/// Pixels with so few samples do not know their own variance.
const FEW: u32 = 4;
/// The share of the variance between neighbours that is taken for a pixel's own where that is less: a detail that all
/// samples of a pixel missed was met beside it.
const NEIGHBOURS: f32 = 0.02;

impl Survey {
    /// The variance of a sample in each pixel, pooled over 3 × 3 pixels.
    pub(crate) fn variances(&self, columns: usize) -> Vec<f32> {
        let rows = self.counts.len() / columns.max(1);
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
            let share = if self.counts[at] < FEW { between } else { NEIGHBOURS * between };
            let within = within / count;
            if within > share { within } else { share }
        };
        (0..self.counts.len()).into_par_iter().map(variance).collect()
    }
}

/// What doubling the samples of one half of a pixel is worth.
#[derive(Clone, Copy, Debug)]
struct Worth {
    /// Taken off the sum of the squared errors, for each unit of cost.
    rate: f64,
    /// Taken off altogether.
    gain: f64,
    /// New samples.
    samples: u32,
}

/// Where to stop doubling.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Goal {
    /// The share of the squared error that should be left.
    Left(f64),
    /// New samples, about.
    Samples(f64),
}

/// The counts of each half of each pixel after a round: what is worth most is doubled until `goal` is reached. `variances`
/// are those that decide for each half, and `costs` of a sample in each pixel. None has more than `most`.
pub(crate) fn allot(
    surveys: &[Survey; 2],
    variances: &[Vec<f32>; 2],
    costs: &[f32],
    goal: Goal,
    most: u32,
) -> [Vec<u32>; 2] {
    let worth = |half: usize, at: usize| {
        let count = surveys[half].counts[at];
        let samples = count.min(most - count.min(most));
        let (variance, n) = (f64::from(variances[half][at]), f64::from(count));
        let gain = variance * (1.0 / n - 1.0 / (n + f64::from(samples)));
        let cost = f64::from(costs[at]) * f64::from(samples);
        Worth { rate: if samples > 0 { gain / cost } else { 0.0 }, gain, samples }
    };
    let pixels = costs.len();
    let all = || (0..2).flat_map(|half| (0..pixels).map(move |at| (half, at)));
    // By bins of the rate, sixteen to a factor of two: sorting would take longer than tracing.
    let bin = |rate: f64| (rate.to_bits() >> 48) as usize;
    let mut bins = vec![(0.0, 0_u64); bin(f64::INFINITY) + 1];
    let mut whole = 0.0;
    for (half, at) in all() {
        let count = surveys[half].counts[at];
        whole += f64::from(variances[half][at]) / f64::from(count);
        let worth = worth(half, at);
        if worth.rate > 0.0 {
            let (gain, samples) = &mut bins[bin(worth.rate)];
            *gain += worth.gain;
            *samples += u64::from(worth.samples);
        }
    }
    let mut least = bins.len();
    let (mut left, mut samples) = (whole, 0_u64);
    for (number, bin) in bins.iter().enumerate().rev() {
        #[expect(clippy::cast_precision_loss, reason = "counts below 2⁵³")]
        let enough = match goal {
            Goal::Left(share) => left <= share * whole && samples as f64 * 100.0 > pixels as f64,
            Goal::Samples(wanted) => samples as f64 >= wanted,
        };
        if enough {
            break;
        }
        left -= bin.0;
        samples += bin.1;
        least = number;
    }
    [0, 1].map(|half| {
        let raised = |at: usize| {
            let worth = worth(half, at);
            let raise = worth.rate > 0.0 && bin(worth.rate) >= least;
            surveys[half].counts[at] + if raise { worth.samples } else { 0 }
        };
        (0..pixels).into_par_iter().map(raised).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variances_by_hand() {
        // A black row between white ones: the middle pixel of 3 × 3 has six neighbours apart by 100.
        let mut survey =
            Survey { shown: vec![[100.0; 3]; 9], within: vec![0.0; 9], counts: vec![8; 9] };
        for at in 3..6 {
            survey.shown[at] = [0.0; 3];
        }
        // Σx² − (Σx)²/9 over 8: (6 · 100² − 600²/9) / 8 = 2500.
        let pooled = survey.variances(3)[4];
        assert!((pooled - 0.02 * 2500.0).abs() < 1e-3, "{pooled}");
        survey.counts[4] = 3;
        assert!((survey.variances(3)[4] - 2500.0).abs() < 1e-2, "few samples take all of it");
        survey.within = vec![90.0; 9];
        survey.counts[4] = 8;
        assert!((survey.variances(3)[4] - 90.0).abs() < 1e-3, "their own is more");
        let alone = Survey { shown: vec![[1.0; 3]], within: vec![4.0], counts: vec![1] };
        assert!((alone.variances(1)[0] - 4.0).abs() < 1e-6);
    }

    fn surveys(counts: &[u32]) -> [Survey; 2] {
        let shown = vec![[0.0; 3]; counts.len()];
        let within = vec![0.0; counts.len()];
        [0, 1].map(|_| Survey {
            shown: shown.clone(),
            within: within.clone(),
            counts: counts.to_vec(),
        })
    }

    #[test]
    fn what_is_worth_most_comes_first() {
        let surveys = surveys(&[8, 8, 8, 16]);
        let variances = [vec![1.0, 100.0, 0.0, 100.0], vec![1.0, 50.0, 0.0, 800.0]];
        let costs = [1.0; 4];
        // Doubling takes variance / n² / 2 for each sample: 0.0078, 0.78, 0, 0.195; 0.0078, 0.39, 0, 1.56.
        let counts = |goal| allot(&surveys, &variances, &costs, goal, 1000);
        assert_eq!(counts(Goal::Samples(1.0)), [vec![8, 8, 8, 16], vec![8, 8, 8, 32]]);
        assert_eq!(counts(Goal::Samples(24.0)), [vec![8, 16, 8, 16], vec![8, 8, 8, 32]]);
        // Nothing is spent where there is no variance.
        assert_eq!(counts(Goal::Samples(1e9)), [vec![16, 16, 8, 32], vec![16, 16, 8, 32]]);
        // Sums are 1/8 + 100/8 + 100/16 + 1/8 + 50/8 + 800/16 = 75.25; the largest leaves 50.25, the next 44.
        assert_eq!(counts(Goal::Left(0.7)), [vec![8, 8, 8, 16], vec![8, 8, 8, 32]]);
        assert_eq!(counts(Goal::Left(0.6)), [vec![8, 16, 8, 16], vec![8, 8, 8, 32]]);
        let dear = [1.0, 1.0, 1.0, 10.0];
        let found = allot(&surveys, &variances, &dear, Goal::Samples(1.0), 1000);
        assert_eq!(found, [vec![8, 16, 8, 16], vec![8, 8, 8, 16]], "by cost");
        let found = allot(&surveys, &variances, &costs, Goal::Samples(1.0), 20);
        assert_eq!(found[1], [8, 8, 8, 20], "up to the limit");
        let found = allot(&surveys, &variances, &costs, Goal::Samples(1.0), 16);
        assert_eq!(found, [vec![8, 16, 8, 16], vec![8, 8, 8, 16]], "what is at its limit is left");
    }
}
