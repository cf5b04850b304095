//! How far off a picture is, by its own two halves.

use rayon::prelude::*;

use super::display::Display;
use crate::film::Half;

/// What a half shows over the background, in display steps.
pub(crate) fn shown(half: &Half, background: [f32; 3], display: &Display) -> [f32; 3] {
    let open = 1.0 - half.coverage;
    std::array::from_fn(|k| display.steps(half.color[k] + open * background[k]))
}

/// The root of the mean square error of a picture in display steps, estimated from the means of its halves, which know
/// nothing of each other and have `counts` samples: the variance of a difference is the sum of theirs. None if a half has
/// no samples.
pub(crate) fn error(halves: [&[Half]; 2], counts: [u32; 2], background: [f32; 3]) -> Option<f64> {
    if counts.contains(&0) || halves[0].is_empty() {
        return None;
    }
    let display = Display::get();
    // Pieces of a fixed size, summed in their order: the same on any number of threads.
    let pieces = halves[0].par_chunks(4096).zip(halves[1].par_chunks(4096));
    let sums: Vec<f64> = pieces
        .map(|(a, b)| {
            let square = |(a, b): (&Half, &Half)| {
                let (a, b) = (shown(a, background, display), shown(b, background, display));
                (0..3).map(|k| f64::from(a[k] - b[k]) * f64::from(a[k] - b[k])).sum::<f64>()
            };
            a.iter().zip(b).map(square).sum()
        })
        .collect();
    let mean = sums.iter().sum::<f64>() / (3.0 * halves[0].len() as f64);
    let [a, b] = counts.map(f64::from);
    Some((mean * a * b).sqrt() / (a + b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::sequence::hash;

    #[test]
    fn errors_by_hand() {
        let grey = |color: f32, coverage: f32| Half { color: [color; 3], coverage };
        // Linear 0.214041 is half of display white; 1 is white.
        let (dark, half, white) = (grey(0.0, 1.0), grey(0.214_041, 1.0), grey(1.0, 1.0));
        let error = |a: &[Half], b: &[Half], counts| error([a, b], counts, [1.0; 3]);
        let found = error(&[dark, half], &[half, half], [1, 1]).unwrap();
        // One of two pixels differs by 127.5: the root of 127.5² / 2 / 4.
        assert!((found - 127.5 / 8.0_f64.sqrt()).abs() < 0.01, "{found}");
        let found = error(&[white], &[dark], [3, 1]).unwrap();
        assert!((found - 255.0 * 3.0_f64.sqrt() / 4.0).abs() < 0.01, "{found}");
        let found = error(&[grey(0.0, 0.0)], &[white], [1, 1]).unwrap();
        assert!(found < 1e-6, "white over a white background: {found}");
        assert_eq!(error(&[white], &[], [1, 0]), None, "one half tells nothing");
    }

    #[test]
    fn noise_is_estimated_as_it_is() {
        // Pixels whose samples are white or black by chance, 8 in each half, many pixels.
        let mean = |pixel: u32, half: u32| {
            let light = |k: u32| f32::from(u8::from(hash(pixel, hash(half, k)) % 10 < 3));
            let sum: f32 = (0..8).map(light).sum();
            Half { color: [sum / 8.0; 3], coverage: 1.0 }
        };
        let halves: [Vec<Half>; 2] =
            [0, 1].map(|half| (0..50_000).map(|pixel| mean(pixel, half)).collect());
        let estimated = error([&halves[0], &halves[1]], [1, 1], [0.0; 3]).unwrap();
        // The mean of two encoded halves about its own mean over all pixels.
        let display = Display::get();
        let shown = |half: &Half| f64::from(display.steps(half.color[0]));
        let means: Vec<f64> =
            halves[0].iter().zip(&halves[1]).map(|(a, b)| 0.5 * (shown(a) + shown(b))).collect();
        let middle = means.iter().sum::<f64>() / means.len() as f64;
        let square = means.iter().map(|m| (m - middle) * (m - middle)).sum::<f64>();
        let actual = (square / means.len() as f64).sqrt();
        assert!((estimated / actual - 1.0).abs() < 0.02, "{estimated}, not {actual}");
    }
}
