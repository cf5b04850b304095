//! From squares to discs.

/// A point of the unit square on the unit disc, area by area; the middle of one is the middle of the other (Shirley and
/// Chiu, "A Low Distortion Map Between Disk and Square", 1997).
pub(crate) fn on_disc([x, y]: [f64; 2]) -> [f64; 2] {
    let (x, y) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    if x == 0.0 && y == 0.0 {
        return [0.0; 2];
    }
    const QUARTER: f64 = std::f64::consts::FRAC_PI_4;
    let (radius, angle) = if x.abs() > y.abs() {
        (x, QUARTER * (y / x))
    } else {
        (y, 2.0 * QUARTER - QUARTER * (x / y))
    };
    let (sine, cosine) = libm::sincos(angle);
    [radius * cosine, radius * sine]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_become_discs_of_their_area() {
        let near = |point, expected: [f64; 2]| {
            let found = on_disc(point);
            let off = (found[0] - expected[0]).abs() + (found[1] - expected[1]).abs();
            assert!(off < 1e-12, "{point:?} {found:?}");
        };
        let half = 0.5_f64.sqrt();
        near([0.5, 0.5], [0.0, 0.0]);
        near([1.0, 0.5], [1.0, 0.0]);
        near([0.5, 0.0], [0.0, -1.0]);
        near([1.0, 1.0], [half, half]);
        near([0.0, 1.0], [-half, half]);
        // As much of the square lies within each radius as of the disc: r².
        let steps = 400;
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(steps);
        for radius in [0.2_f64, 0.5, 0.9] {
            let within = |&(i, j): &(u32, u32)| {
                let [x, y] = on_disc([at(i), at(j)]);
                x * x + y * y < radius * radius
            };
            let all = (0..steps).flat_map(|i| (0..steps).map(move |j| (i, j)));
            #[expect(clippy::cast_precision_loss, reason = "a count")]
            let share = all.filter(within).count() as f64 / f64::from(steps * steps);
            assert!((share - radius * radius).abs() < 0.005, "{radius}: {share}");
        }
    }
}
