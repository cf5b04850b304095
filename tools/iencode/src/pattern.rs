//! Blue noise on a coarse table: each pixel takes one of a pattern of entries whose mean is its
//! colour.
//!
//! Of few entries two rarely have a colour between them. A pattern takes as many as it needs: each
//! of its entries makes up for the error of those before it (Knoll, "Pattern dithering", US patent
//! 6606166, 1999, expired). In order of lightness, a threshold of the mask picks one.

use ilut::{Metric, Pixels, Table};
use rayon::prelude::*;

use crate::grid::{Grids, places};
use crate::hull::Hull;
use crate::mask;

/// Entries of a pattern. With 8, soft shades show steps; 32 take twice the time.
const LENGTH: usize = 16;

/// Replaces the nearest entries of opaque pixels.
pub(crate) fn dither(
    pixels: &Pixels,
    table: &Table,
    metric: Metric,
    strength: f32,
    (grids, hull): (&Grids, &Hull),
    indices: &mut [u8],
) {
    let columns = pixels.columns() as usize;
    let (ranks, by_rank) = ranks(table);
    let rows = indices.par_chunks_mut(columns).zip(pixels.colors().par_chunks(columns));
    rows.enumerate().for_each(|(row, (indices, colors))| {
        let mut goals = vec![[0.0; 4]; columns];
        places(colors, metric, &mut goals);
        let thresholds = mask::row(row);
        grids.with(|grid| {
            let bounds = grid.bounds();
            for (column, (index, &goal)) in indices.iter_mut().zip(&goals).enumerate() {
                let near = table.colors()[usize::from(*index)];
                if colors[column][3] < u8::MAX || near[3] < u8::MAX || near == colors[column] {
                    continue;
                }
                let goal = hull.pulled(goal);
                let mut pattern = [0; LENGTH];
                let mut off = [0.0; 4];
                for rank in &mut pattern {
                    let wanted = std::array::from_fn(|axis| goal[axis] + strength * off[axis]);
                    let entry = usize::from(grid.nearest(bounds.clamped(wanted)));
                    for axis in 0..3 {
                        off[axis] += goal[axis] - grid.places()[entry][axis];
                    }
                    *rank = ranks[entry];
                }
                pattern.sort_unstable();
                let threshold = thresholds[column % mask::SIDE];
                *index = by_rank[usize::from(pattern[place_in_pattern(threshold)])];
            }
        });
    });
}

/// The rank of each entry in order of lightness, and the entry of each rank.
fn ranks(table: &Table) -> (Vec<u8>, Vec<u8>) {
    let lightness = |entry: u8| {
        let [red, green, blue, _] = table.colors()[usize::from(entry)];
        ilut::oklab::from_srgb([red, green, blue])[0]
    };
    let mut by_rank: Vec<u8> = (0..=u8::MAX).take(table.colors().len()).collect();
    by_rank.sort_by(|&a, &b| lightness(a).total_cmp(&lightness(b)));
    let mut ranks = vec![0; by_rank.len()];
    for (rank, &entry) in (0_u8..=u8::MAX).zip(&by_rank) {
        ranks[usize::from(entry)] = rank;
    }
    (ranks, by_rank)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "thresholds are between 0 and 1"
)]
fn place_in_pattern(threshold: f32) -> usize {
    (threshold * LENGTH as f32) as usize
}
