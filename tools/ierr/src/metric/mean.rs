//! Mean absolute difference.

use super::{Measured, Viewing};
use crate::pair::Pair;

/// The mean of all samples' absolute differences.
pub(super) fn measured(pair: &Pair, _viewing: &Viewing) -> Option<Measured> {
    pair.of_means(f64::abs, |mean| mean)
}
