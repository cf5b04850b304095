//! Which points of a pixel are looked at, where that does not depend on what is seen.

use super::sequence::{Draw, hash};
use crate::options::{Rate, Sampling};

/// A point of a pixel and the half of the picture its sample belongs to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// Position within the pixel, 0…1 each way.
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) half: usize,
    /// What else it chooses: a point of the lens, of each light.
    pub(crate) draw: Draw,
}

/// The same number of samples in every pixel.
#[derive(Clone, Debug)]
pub(crate) enum Pattern {
    /// The same points in every pixel. One in the middle chooses the middle of everything.
    Grid { samples: Vec<Sample>, counts: [u32; 2], seed: u32 },
    /// Drawn by lot, so many in either half; each pixel and either half has a seed of its own.
    Scrambled { counts: [u32; 2], seed: u32 },
}

impl Pattern {
    /// None where the number depends on what is seen.
    pub(crate) fn new(sampling: Sampling, seed: u32) -> Option<Self> {
        match sampling {
            Sampling::Grid(side) => {
                let samples = grid(side);
                let mut counts = [0; 2];
                for sample in &samples {
                    counts[sample.half] += 1;
                }
                Some(Self::Grid { samples, counts, seed })
            }
            Sampling::Stochastic(Rate::Samples(count)) => {
                Some(Self::Scrambled { counts: [count.div_ceil(2), count / 2], seed })
            }
            Sampling::Subdivided { .. } | Sampling::Stochastic(_) => None,
        }
    }

    /// Samples in the halves of each pixel.
    pub(crate) fn counts(&self) -> [u32; 2] {
        let (Self::Grid { counts, .. } | Self::Scrambled { counts, .. }) = self;
        *counts
    }

    /// The side of the square that a sample stands for, in pixels.
    pub(crate) fn side(&self) -> f64 {
        let counts = self.counts();
        match self {
            Self::Grid { .. } => 1.0 / f64::from(counts[0] + counts[1]).sqrt(),
            Self::Scrambled { .. } => stochastic_side(counts[0] + counts[1]),
        }
    }

    /// The samples of a pixel, by its column and row in the whole picture.
    pub(crate) fn samples(&self, pixel: [u32; 2]) -> impl Iterator<Item = Sample> + '_ {
        let [first, second] = self.counts();
        let (Self::Grid { seed, .. } | Self::Scrambled { seed, .. }) = self;
        // Nothing is drawn for one sample in the middle.
        let drawn = !matches!(self, Self::Grid { samples, .. } if samples.len() == 1);
        let seeds = [0, 1].map(|half| if drawn { pixel_seed(pixel, half, *seed) } else { 0 });
        (0..first + second).map(move |number| match self {
            Self::Grid { samples, .. } if samples.len() == 1 => samples[0],
            Self::Grid { samples, .. } => {
                Sample { draw: Draw::new(number, seeds[0]), ..samples[number as usize] }
            }
            Self::Scrambled { .. } => {
                let (half, number) = if number < first { (0, number) } else { (1, number - first) };
                let draw = Draw::new(number, seeds[half]);
                let [x, y, ..] = draw.start();
                Sample { x, y, half, draw }
            }
        })
    }
}

/// The side of the square that a sample stands for if `count` of a pixel are drawn by lot, in pixels.
///
/// Less than the gap between them. Paint that is smoothed over that much is off by something that all samples share, and
/// no half of them tells of it: it has to fall faster than the error of the samples, which goes with n^(−3/4).
pub(crate) fn stochastic_side(count: u32) -> f64 {
    let n = f64::from(count);
    1.0 / (n * n.sqrt())
}

/// What the samples of one half of a pixel are drawn by. Pixels to the left of the picture or above it count down from 2³².
pub(crate) fn pixel_seed([column, row]: [u32; 2], half: u32, seed: u32) -> u32 {
    hash(hash(column, row), hash(seed, half))
}

/// The centres of a `side` × `side` grid over a pixel; neighbours belong to different halves.
fn grid(side: u32) -> Vec<Sample> {
    let step = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
    let point = |i: u32| Sample {
        x: step(i % side),
        y: step(i / side),
        half: ((i % side + i / side) % 2) as usize,
        draw: Draw::MIDDLE,
    };
    (0..side * side).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sample_is_at_the_centre_and_halves_share_the_rest() {
        let one = grid(1);
        assert_eq!((one.len(), one[0].x, one[0].y, one[0].half), (1, 0.5, 0.5, 0), "centre");
        let sixteen = grid(4);
        assert_eq!(sixteen.iter().filter(|s| s.half == 0).count(), 8, "halves");
        let mean: f64 = sixteen.iter().map(|s| s.x + s.y).sum::<f64>() / 32.0;
        assert!((mean - 0.5).abs() < 1e-15, "balanced about the centre: {mean}");
    }

    #[test]
    fn lots_depend_on_pixel_half_and_seed() {
        let samples = |seed, pixel| -> Vec<_> {
            let pattern =
                Pattern::new(Sampling::Stochastic(Rate::Samples(7)), seed).expect("a pattern");
            assert_eq!(pattern.counts(), [4, 3]);
            pattern.samples(pixel).map(|s| (s.x.to_bits(), s.y.to_bits(), s.half)).collect()
        };
        let usual = samples(0, [3, 5]);
        assert_eq!(usual.iter().map(|s| s.2).collect::<Vec<_>>(), [0, 0, 0, 0, 1, 1, 1]);
        assert!(usual[0].0 != usual[4].0, "halves differ");
        assert_eq!(samples(0, [3, 5]), usual, "always the same");
        for (seed, pixel) in [(1, [3, 5]), (0, [5, 3]), (0, [4, 5]), (0, [u32::MAX, 5])] {
            assert!(samples(seed, pixel)[0].0 != usual[0].0, "{seed} {pixel:?}");
        }
    }
}
