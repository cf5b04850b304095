//! The mappings against the definition, worked out step by step for each pixel.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small numbers, written as the definition has them"
)]

use super::*;

/// What scikit-image's `equalize_adapthist` says, as shares of the range: the picture is carried
/// on by reflection, half a tile before and the rest after; tiles lie on the picture, blocks of
/// interpolation half a tile before them.
fn plain(values: &[f64], columns: usize, parameters: &[f64]) -> Vec<f64> {
    let rows = values.len() / columns;
    let tiles = parameters[0] as usize;
    let (width, height) = ((columns / tiles).max(1), (rows / tiles).max(1));
    let bins = parameters[2] as usize;
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let bin: Vec<usize> = values
        .iter()
        .map(|v| ((v - least) / (most - least) * 16_383.0).round_ties_even() as usize)
        .map(|level| level / (1 + 16_384 / bins))
        .collect();
    let (across, down) = (columns.div_ceil(width), rows.div_ceil(height));
    let mirror = |at: usize, length: usize| if at < length { at } else { 2 * length - 2 - at };
    let mut maps = Vec::new();
    for tile in 0..across * down {
        let (x, y) = (tile % across * width, tile / across * height);
        let mut counts = vec![0_i64; bins];
        for row in y..y + height {
            for column in x..x + width {
                counts[bin[mirror(row, rows) * columns + mirror(column, columns)]] += 1;
            }
        }
        let pixels = (width * height) as i64;
        let limit = if parameters[1] > 0.0 {
            ((parameters[1] * pixels as f64) as i64).max(1)
        } else {
            pixels
        };
        plain_excess(&mut counts, limit);
        let mut sum = 0;
        let level = |count: &i64| {
            sum += count;
            (sum as f64 * (16_383.0 / pixels as f64)).min(16_383.0).floor()
        };
        maps.push(counts.iter().map(level).collect::<Vec<f64>>());
    }
    let mapped: Vec<f64> = (0..values.len())
        .map(|at| {
            let place = |at: usize, size: usize, count: usize| {
                let padded = at + size / 2;
                let block = (padded / size) as i64;
                let clamped = |tile: i64| tile.clamp(0, count as i64 - 1) as usize;
                let share = (padded % size) as f64 / size as f64;
                [(clamped(block - 1), 1.0 - share), (clamped(block), share)]
            };
            let mut value = 0.0;
            for (y, down_share) in place(at / columns, height, down) {
                for (x, across_share) in place(at % columns, width, across) {
                    value += maps[y * across + x][bin[at]] * down_share * across_share;
                }
            }
            value.floor()
        })
        .collect();
    let least = mapped.iter().copied().fold(f64::INFINITY, f64::min);
    let most = mapped.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    mapped.iter().map(|value| (value - least) / (most - least)).collect()
}

fn plain_excess(counts: &mut [i64], limit: i64) {
    let bins = counts.len() as i64;
    let mut excess: i64 = counts.iter().map(|count| (count - limit).max(0)).sum();
    for count in counts.iter_mut() {
        *count = (*count).min(limit);
    }
    // Bins are looked at again after they got their share: the library's own order.
    let each = excess / bins;
    let upper = limit - each;
    let low: Vec<bool> = counts.iter().map(|count| *count < upper).collect();
    for (count, _) in counts.iter_mut().zip(&low).filter(|(_, low)| **low) {
        *count += each;
        excess -= each;
    }
    let middle: Vec<bool> = counts.iter().map(|c| *c >= upper && *c < limit).collect();
    for (count, _) in counts.iter_mut().zip(&middle).filter(|(_, middle)| **middle) {
        excess -= limit - *count;
        *count = limit;
    }
    loop {
        let before = excess;
        for first in 0..counts.len() {
            if excess <= 0 {
                return;
            }
            let open = counts.iter().filter(|count| **count < limit).count() as i64;
            let step = (open / excess).max(1) as usize;
            for at in (first..counts.len()).step_by(step) {
                if counts[at] < limit {
                    counts[at] += 1;
                    excess -= 1;
                }
            }
        }
        if before == excess {
            return;
        }
    }
}

/// Waves over a slope, with some noise: no two tiles alike.
fn picture(columns: usize, rows: usize) -> Vec<u8> {
    let mut seed = 7_u32;
    let pixel = |at: usize| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let (x, y) = ((at % columns) as f64, (at / columns) as f64);
        let wave = 30.0 * libm::sin(x / 7.0) + 20.0 * libm::cos(y / 5.0);
        (40.0 + 100.0 * x / columns as f64 + wave + f64::from(seed >> 28)).clamp(0.0, 255.0) as u8
    };
    (0..columns * rows).map(pixel).collect()
}

fn tones(samples: &Samples, columns: usize) -> Tones<'_> {
    let steps = match samples {
        Samples::U8(_) => Some(255),
        Samples::U16(_) => Some(65_535),
        Samples::F32(_) => None,
    };
    Tones { samples, steps, weights: None, columns }
}

/// Greatest difference of the found and the expected, as a share of the range.
fn farthest(found: &Samples, expected: &[f64]) -> f64 {
    let found: Vec<f64> = match found {
        Samples::U8(samples) => samples.iter().map(|&s| f64::from(s) / 255.0).collect(),
        Samples::U16(samples) => samples.iter().map(|&s| f64::from(s) / 65_535.0).collect(),
        Samples::F32(samples) => samples.iter().map(|&s| f64::from(s)).collect(),
    };
    assert_eq!(found.len(), expected.len());
    found.iter().zip(expected).map(|(f, e)| (f - e).abs()).fold(0.0, f64::max)
}

#[test]
fn every_depth_agrees_with_the_definition() {
    for (columns, rows, parameters) in [
        (64, 48, [8.0, 0.01, 256.0]),
        (67, 45, [8.0, 0.02, 256.0]),
        (67, 45, [3.0, 0.0, 64.0]),
        (40, 90, [5.0, 0.001, 1000.0]),
        (9, 7, [64.0, 0.5, 256.0]),
        (30, 1, [4.0, 0.1, 16.0]),
        (31, 31, [1.0, 1.0, 2.0]),
    ] {
        let bytes = picture(columns, rows);
        let values: Vec<f64> = bytes.iter().map(|&byte| f64::from(byte)).collect();
        let expected = plain(&values, columns, &parameters);
        // Half a step of the result, and one level of 16 383.
        let level = 1.0 / 16_000.0;
        let deep = Samples::U16(bytes.iter().map(|&byte| u16::from(byte) * 257).collect());
        let float = Samples::F32(bytes.iter().map(|&byte| f32::from(byte) * 0.5 - 9.0).collect());
        for (samples, bound) in
            [(Samples::U8(bytes), 0.5 / 255.0 + level), (deep, 2.0 * level), (float, 2.0 * level)]
        {
            let found = equalized(&tones(&samples, columns), &parameters);
            let far = farthest(&found, &expected);
            assert!(far <= bound, "{columns} x {rows}, {parameters:?}: {far} of {bound}");
        }
    }
}

#[test]
fn a_flat_picture_stays() {
    let flat = Samples::U8(vec![77; 64 * 64]);
    assert_eq!(equalized(&tones(&flat, 64), &[8.0, 0.01, 256.0]), flat);
}

#[test]
fn what_is_not_covered_changes_nothing() {
    // Two pictures that differ only where nothing is covered: a whole tile and a part of others.
    let (columns, rows) = (64, 64);
    let covered = |at: usize| at % columns > 20 || at / columns > 20;
    let weights: Vec<u16> =
        (0..columns * rows).map(|at| if covered(at) { 300 } else { 0 }).collect();
    let original = picture(columns, rows);
    let second: Vec<u8> = original
        .iter()
        .enumerate()
        .map(|(at, &v)| if covered(at) { v } else { 255 - v / 2 })
        .collect();
    let [first, second] = [original.clone(), second].map(|bytes| {
        let samples = Samples::U8(bytes);
        let tones = Tones { weights: Some(&weights), ..tones(&samples, columns) };
        match equalized(&tones, &[8.0, 0.01, 256.0]) {
            Samples::U8(bytes) => bytes,
            other => panic!("{other:?}"),
        }
    });
    let mut changed = 0;
    for at in (0..columns * rows).filter(|&at| covered(at)) {
        assert_eq!(first[at], second[at], "at {at}");
        changed += usize::from(first[at] != original[at]);
    }
    assert!(changed > 1000, "{changed}");
}

#[test]
fn wholly_covered_is_as_without_coverage() {
    let samples = Samples::U8(picture(50, 40));
    let all = vec![u16::MAX; 2000];
    let bare = tones(&samples, 50);
    let covered = Tones { weights: Some(&all), ..bare };
    let parameters = [8.0, 0.01, 256.0];
    assert_eq!(equalized(&covered, &parameters), equalized(&bare, &parameters));
}

#[test]
fn what_is_not_a_number_stays_and_does_not_count() {
    let mut values: Vec<f32> = picture(32, 32).into_iter().map(f32::from).collect();
    values[100] = f32::NAN;
    let samples = Samples::F32(values);
    let Samples::F32(found) = equalized(&tones(&samples, 32), &[4.0, 0.01, 256.0]) else {
        panic!("not float");
    };
    assert_eq!(found.iter().filter(|value| value.is_nan()).count(), 1);
    assert!(found[100].is_nan());
    let range = range(&found, None).unwrap();
    assert_eq!(range.map(f32::to_bits), [0.0_f32, 1.0].map(f32::to_bits));
}
