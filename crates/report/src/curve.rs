//! Error against seconds: slopes, the efficient frontier, and what is reached in a given time.

/// A measured picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// What it took, above 0.
    pub seconds: f64,
    /// How far off it is, above 0.
    pub error: f64,
}

/// The exponent k of the power law `error = c · seconds^k` by least squares of logarithms; none for fewer than two
/// different times.
#[must_use]
pub fn slope(points: &[Point]) -> Option<f64> {
    power(points.iter().map(|point| (point.seconds, point.error)))
}

/// The exponent of y = c · x^k by least squares of logarithms. What is not above 0, or not finite, is passed over; none
/// where fewer than two different x are left.
pub fn power(pairs: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let is_plain = |x: f64| x > 0.0 && x.is_finite();
    let logs: Vec<(f64, f64)> = pairs
        .filter(|&(x, y)| is_plain(x) && is_plain(y))
        .map(|(x, y)| (libm::log(x), libm::log(y)))
        .collect();
    #[expect(clippy::cast_precision_loss, reason = "a few points")]
    let count = logs.len() as f64;
    let (sum_x, sum_y) = logs.iter().fold((0.0, 0.0), |(a, b), &(x, y)| (a + x, b + y));
    let (mean_x, mean_y) = (sum_x / count, sum_y / count);
    let (mut along, mut across) = (0.0, 0.0);
    for &(x, y) in &logs {
        along += (x - mean_x) * (x - mean_x);
        across += (x - mean_x) * (y - mean_y);
    }
    let first = logs.first()?.0;
    let differ = logs.iter().any(|(x, _)| x.to_bits() != first.to_bits());
    differ.then(|| across / along)
}

/// Places of the points that no other beats in both time and error, by rising time.
#[must_use]
pub fn frontier(points: &[Point]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    let key = |&place: &usize| (points[place].seconds, points[place].error);
    order.sort_by(|a, b| {
        let (a, b) = (key(a), key(b));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let mut least = f64::INFINITY;
    order.retain(|&place| {
        let beats = points[place].error < least;
        if beats {
            least = points[place].error;
        }
        beats
    });
    order
}

/// The place of the point that takes least time of those with an error of at most `most`.
#[must_use]
pub fn fastest(points: &[Point], most: f64) -> Option<usize> {
    let good = (0..points.len()).filter(|&place| points[place].error <= most);
    good.min_by(|&a, &b| points[a].seconds.total_cmp(&points[b].seconds))
}

/// The error that a method reaches in `seconds`: along the lines between the points of its frontier, in logarithms; the
/// last point's where there is more time than it takes. None where there is not even time for the first.
#[must_use]
pub fn error_after(points: &[Point], seconds: f64) -> Option<f64> {
    let frontier: Vec<Point> = frontier(points).into_iter().map(|place| points[place]).collect();
    let next = frontier.partition_point(|point| point.seconds <= seconds);
    let before = frontier.get(next.checked_sub(1)?)?;
    let Some(after) = frontier.get(next) else { return Some(before.error) };
    let along = libm::log(seconds / before.seconds) / libm::log(after.seconds / before.seconds);
    Some(before.error * libm::exp(along * libm::log(after.error / before.error)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(pairs: &[(f64, f64)]) -> Vec<Point> {
        pairs.iter().map(|&(seconds, error)| Point { seconds, error }).collect()
    }

    #[test]
    fn slopes_are_exponents() {
        for exponent in [-2.0, -0.75, 0.0, 0.5] {
            let law = |x: f64| (x, 3.7 * libm::pow(x, exponent));
            let found = power([1e-6, 2e-3, 1.0, 77.0, 1e9].into_iter().map(law)).unwrap();
            assert!((found - exponent).abs() < 1e-12, "{exponent}: {found}");
        }
        // By hand: logarithms to base 2 are (0, 0), (1, 2), (2, 2); the slope is (1 · 2 + …) / 2 = 1.
        let found = slope(&points(&[(1.0, 1.0), (2.0, 4.0), (4.0, 4.0)])).unwrap();
        assert!((found - 1.0).abs() < 1e-12, "{found}");
    }

    #[test]
    fn there_is_no_slope_without_two_times() {
        assert_eq!(slope(&[]), None);
        assert_eq!(slope(&points(&[(1.0, 2.0)])), None);
        assert_eq!(slope(&points(&[(0.1, 2.0), (0.1, 3.0), (0.1, 5.0)])), None);
        assert_eq!(slope(&points(&[(1.0, 2.0), (0.0, 3.0), (2.0, f64::NAN)])), None);
    }

    #[test]
    fn the_frontier_is_what_nothing_beats() {
        // 0 is first; 1 is slower and worse than 3; 2 is on it; 4 is as fast as 3 and worse; 5 brings nothing more.
        let all = points(&[(1.0, 9.0), (3.0, 8.0), (7.0, 1.0), (2.0, 4.0), (2.0, 5.0), (9.0, 1.0)]);
        assert_eq!(frontier(&all), [0, 3, 2]);
        assert_eq!(fastest(&all, 4.5), Some(3));
        assert_eq!(fastest(&all, 1.0), Some(2));
        assert_eq!(fastest(&all, 0.5), None);
        assert!(frontier(&[]).is_empty());
    }

    #[test]
    fn between_points_errors_follow_the_power_law() {
        let all = points(&[(1.0, 8.0), (4.0, 4.0), (2.0, 30.0)]);
        // Half way in logarithms: √(8 · 4) at 2 seconds.
        let expected =
            [(0.5, None), (1.0, Some(8.0)), (2.0, Some(32.0_f64.sqrt())), (9.0, Some(4.0))];
        for (seconds, expected) in expected {
            let found = error_after(&all, seconds);
            let near = found.zip(expected).is_some_and(|(a, b): (f64, f64)| (a - b).abs() < 1e-12);
            assert!(near || found == expected, "{seconds}: {found:?}, not {expected:?}");
        }
    }
}
