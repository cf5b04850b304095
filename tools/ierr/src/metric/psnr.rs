//! Peak signal-to-noise ratio.

use super::{Measured, Viewing};
use crate::pair::Pair;

/// `10 log10(1 / MSE)`, infinite for equal images. The peak is 1 for light without bounds too.
pub(super) fn measured(pair: &Pair, _viewing: &Viewing) -> Option<Measured> {
    pair.of_means(|difference| difference * difference, |square| -10.0 * libm::log10(square))
}
