//! Counting samples into bins, each by the covered share of its pixel.

use rayon::prelude::*;

/// Samples that a thread counts at once.
const CHUNK: usize = 1 << 18;

/// How much of the picture is in each of `bins` bins: pixels, or with `weights` 65535ths of
/// pixels. A sample that has no bin does not count.
pub(crate) fn counts<T: Copy + Sync>(
    samples: &[T],
    weights: Option<&[u16]>,
    bins: usize,
    bin: impl Fn(T) -> Option<usize> + Sync,
) -> Vec<u64> {
    let chunks = samples.par_chunks(CHUNK).enumerate();
    let counted = chunks.fold(
        || vec![0_u64; bins],
        |mut counts, (number, chunk)| {
            match weights {
                None => {
                    for bin in chunk.iter().filter_map(|&sample| bin(sample)) {
                        counts[bin] += 1;
                    }
                }
                Some(weights) => {
                    let weights = &weights[number * CHUNK..];
                    for (&sample, &weight) in chunk.iter().zip(weights) {
                        if let Some(bin) = bin(sample) {
                            counts[bin] += u64::from(weight);
                        }
                    }
                }
            }
            counts
        },
    );
    counted.reduce(|| vec![0; bins], |a, b| a.iter().zip(b).map(|(a, b)| a + b).collect())
}

/// [`counts`] of bytes, each in its own bin.
///
/// Four tables in turn, so that equal neighbours do not wait for each other's sum.
pub(crate) fn byte_counts(samples: &[u8], weights: Option<&[u16]>) -> Vec<u64> {
    if weights.is_some() {
        return counts(samples, weights, 256, |sample| Some(usize::from(sample)));
    }
    let chunks = samples.par_chunks(CHUNK).map(four_tables);
    chunks.reduce(|| vec![0; 256], |a, b| a.iter().zip(b).map(|(a, b)| a + b).collect())
}

/// Counts of at most 2^32 bytes.
fn four_tables(samples: &[u8]) -> Vec<u64> {
    let mut tables = [[0_u32; 256]; 4];
    let (fours, rest) = samples.as_chunks::<4>();
    for four in fours {
        for (table, &sample) in tables.iter_mut().zip(four) {
            table[usize::from(sample)] += 1;
        }
    }
    for &sample in rest {
        tables[0][usize::from(sample)] += 1;
    }
    (0..256).map(|at| tables.iter().map(|table| u64::from(table[at])).sum()).collect()
}

/// Least and greatest of the finite values that count; nothing where there are none.
pub(crate) fn range(values: &[f32], weights: Option<&[u16]>) -> Option<[f32; 2]> {
    let counted = values
        .iter()
        .enumerate()
        .filter(|&(at, value)| value.is_finite() && weights.is_none_or(|weights| weights[at] > 0));
    counted.fold(None, |range, (_, &value)| match range {
        None => Some([value, value]),
        Some([least, most]) => Some([
            if value < least { value } else { least },
            if value > most { value } else { most },
        ]),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_counted_alike_in_every_way() {
        let samples: Vec<u8> = (0..1_000_003_u32)
            .map(|i| (i.wrapping_mul(2_654_435_761) >> 25).to_le_bytes()[0])
            .collect();
        let mut expected = vec![0_u64; 256];
        for &sample in &samples {
            expected[usize::from(sample)] += 1;
        }
        assert_eq!(byte_counts(&samples, None), expected);
        let ones = vec![1; samples.len()];
        assert_eq!(byte_counts(&samples, Some(&ones)), expected);
    }

    #[test]
    fn weights_count_and_samples_without_a_bin_do_not() {
        let bin = |value: f32| (value >= 0.0).then_some(usize::from(value > 0.5));
        let counted = counts(&[0.1, 0.9, f32::NAN, 0.7], Some(&[10, 20, 40, 80]), 2, bin);
        assert_eq!(counted, [10, 100]);
    }

    #[test]
    fn the_range_is_of_what_is_finite_and_covered() {
        let values = [f32::NAN, 0.5, -3.0, 9.0, f32::INFINITY];
        assert_eq!(range(&values, None), Some([-3.0, 9.0]));
        assert_eq!(range(&values, Some(&[9, 1, 2, 0, 9])), Some([-3.0, 0.5]));
        assert_eq!(range(&values[..1], None), None);
    }
}
