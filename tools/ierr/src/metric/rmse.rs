//! Root mean square difference.

use super::{Measured, Viewing};
use crate::pair::Pair;

/// The root of the mean square of all samples' differences.
pub(super) fn measured(pair: &Pair, _viewing: &Viewing) -> Option<Measured> {
    pair.of_means(|difference| difference * difference, f64::sqrt)
}
