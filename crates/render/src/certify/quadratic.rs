//! Quadratic functions of the place in the picture: silhouettes and rims of solids are where they vanish.

use super::sheet::{Cell, Form};

/// By the powers of the place less `about`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quadratic {
    about: [f64; 2],
    constant: f64,
    slope: [f64; 2],
    /// Of x², xy and y².
    bend: [f64; 3],
}

/// What is known of a quadratic over a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Range {
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// In the middle of the cell.
    pub(crate) middle: f64,
    /// In the middle of the cell, per pixel.
    pub(crate) slope: [f64; 2],
    /// It grows one way all over the cell: where it vanishes is one curve without a turn.
    pub(crate) steady: bool,
}

/// Rounding of a value, relative to the sum of its terms.
const SLACK: f64 = 1e-12;

impl Quadratic {
    pub(crate) const ZERO: Self =
        Self { about: [0.0; 2], constant: 0.0, slope: [0.0; 2], bend: [0.0; 3] };

    /// The product of two linear forms, which are given about the place `about`.
    pub(crate) fn product(about: [f64; 2], f: Form, g: Form) -> Self {
        Self {
            about,
            constant: f[0] * g[0],
            slope: [f[0] * g[1] + f[1] * g[0], f[0] * g[2] + f[2] * g[0]],
            bend: [f[1] * g[1], f[1] * g[2] + f[2] * g[1], f[2] * g[2]],
        }
    }

    /// With `factor` times another about the same place.
    pub(crate) fn plus(self, factor: f64, other: &Self) -> Self {
        let add = |a: f64, b: f64| a + factor * b;
        Self {
            about: other.about,
            constant: add(self.constant, other.constant),
            slope: std::array::from_fn(|k| add(self.slope[k], other.slope[k])),
            bend: std::array::from_fn(|k| add(self.bend[k], other.bend[k])),
        }
    }

    /// Bounds over a cell, rounding included.
    pub(crate) fn over(&self, cell: &Cell) -> Range {
        let [u, v] = [cell.middle[0] - self.about[0], cell.middle[1] - self.about[1]];
        let ([x, y], [xx, xy, yy], h) = (self.slope, self.bend, cell.half);
        let middle = self.constant + u * (x + u * xx + v * xy) + v * (y + v * yy);
        let slope = [x + 2.0 * u * xx + v * xy, y + 2.0 * v * yy + u * xy];
        let bent = (xx.abs() + xy.abs() + yy.abs()) * h * h;
        let (u, v) = (u.abs() + h, v.abs() + h);
        let terms = self.constant.abs()
            + u * (x.abs() + u * xx.abs() + v * xy.abs())
            + v * (y.abs() + v * yy.abs());
        let reach = (slope[0].abs() + slope[1].abs()) * h + bent + SLACK * terms;
        let grows = |slope: f64, own: f64| slope.abs() > h * (2.0 * own.abs() + xy.abs());
        let steady = grows(slope[0], xx) || grows(slope[1], yy);
        Range { low: middle - reach, high: middle + reach, middle, slope, steady }
    }

    /// The area where it is positive, in pixels, if that is an ellipse about the place it is given about.
    pub(crate) fn area(&self) -> Option<f64> {
        let [xx, xy, yy] = self.bend;
        let square = xx * yy - 0.25 * xy * xy;
        (self.constant > 0.0 && xx < 0.0 && square > 0.0)
            .then(|| std::f64::consts::PI * self.constant / square.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_is_bounded_and_measured() {
        // 25 − (x − 3)² − (y + 2)².
        let about = [3.0, -2.0];
        let x = Quadratic::product(about, [0.0, 1.0, 0.0], [0.0, 1.0, 0.0]);
        let y = Quadratic::product(about, [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
        let whole = Quadratic::product(about, [5.0, 0.0, 0.0], [5.0, 0.0, 0.0]);
        let circle = Quadratic::ZERO.plus(1.0, &whole).plus(-1.0, &x).plus(-1.0, &y);
        let area = circle.area().expect("it is an ellipse");
        assert!((area - 25.0 * std::f64::consts::PI).abs() < 1e-12, "{area}");
        let at = |x: f64, y: f64| 25.0 - (x - 3.0) * (x - 3.0) - (y + 2.0) * (y + 2.0);
        for (middle, half) in [([3.0, -2.0], 1.0), ([8.0, -2.0], 0.5), ([-4.0, 7.0], 2.0)] {
            let cell = Cell { middle, half };
            let range = circle.over(&cell);
            assert!((range.middle - at(middle[0], middle[1])).abs() < 1e-12, "{range:?}");
            for i in 0..=10 {
                for j in 0..=10 {
                    let [dx, dy] = [i, j].map(|k| half * (f64::from(k) / 5.0 - 1.0));
                    let value = at(middle[0] + dx, middle[1] + dy);
                    assert!(range.low <= value && value <= range.high, "{value}: {range:?}");
                }
            }
        }
        let over = |middle, half| circle.over(&Cell { middle, half });
        assert!(over([8.0, -2.0], 0.5).steady, "one curve through the cell");
        assert!(!over([3.5, -2.0], 1.0).steady, "the middle is in it");
        assert!(over([3.0, -2.0], 1.0).low > 0.0 && over([9.0, 4.0], 0.5).high < 0.0, "in and out");
    }
}
