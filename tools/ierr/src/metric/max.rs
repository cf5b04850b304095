//! The greatest difference and its place.

use rayon::prelude::*;

use super::{Measured, Place, Viewing, difference};
use crate::pair::{Channel, ONE, Pair};

/// The greatest absolute difference of a sample; of equal ones the first from the top left, in
/// the first channel.
pub(super) fn measured(pair: &Pair, _viewing: &Viewing) -> Option<Measured> {
    let greatest: Vec<(f64, Place)> =
        pair.channels.iter().map(|channel| greatest(pair, channel)).collect();
    let channels = pair.channels.iter().zip(&greatest).map(|(c, found)| (c.kind, found.0));
    let channels = channels.collect();
    let (value, place) = greatest.into_iter().reduce(greater)?;
    Some(Measured { value, channels, worst: Some(place), map: None })
}

fn greatest(pair: &Pair, channel: &Channel) -> (f64, Place) {
    let kind = &channel.kind;
    let found: Vec<(f64, Place)> = (0..pair.rows)
        .into_par_iter()
        .map(|row| {
            let [reference, test] = pair.row(channel, row);
            let place = |column| Place { column, row, kind: Some(*kind) };
            let pairs = reference.iter().zip(&test).enumerate();
            let differences = pairs.filter_map(|(column, (&a, &b))| {
                Some((difference(a, b)?.abs() / f64::from(ONE), place(column)))
            });
            differences.fold((0.0, place(0)), greater)
        })
        .collect();
    let first = (0.0, Place { column: 0, row: 0, kind: Some(*kind) });
    found.into_iter().fold(first, greater)
}

/// The later of two only where it is greater.
fn greater(first: (f64, Place), second: (f64, Place)) -> (f64, Place) {
    if second.0 > first.0 { second } else { first }
}
