//! Light as a display shows it, in steps of 8 bits, quickly: errors are measured in these.

use std::sync::OnceLock;

use idf::Transfer;

/// The value of display white.
pub(crate) const WHITE: f64 = 255.0;

/// Values at equal steps of the root of linear light, where the curve is nearly straight.
const ENTRIES: usize = 4096;

/// Linear light to display steps: sRGB, clamped to 0…255, within 0.001 of a step.
#[derive(Debug)]
pub(crate) struct Display {
    table: Vec<f32>,
}

impl Display {
    /// The one of this process.
    pub(crate) fn get() -> &'static Self {
        static DISPLAY: OnceLock<Display> = OnceLock::new();
        DISPLAY.get_or_init(|| {
            let value = |entry: usize| {
                let root = entry as f64 / ENTRIES as f64;
                #[expect(clippy::cast_possible_truncation, reason = "24 bits are plenty")]
                let value = (Transfer::Srgb.encode(root * root) * WHITE) as f32;
                value
            };
            Self { table: (0..=ENTRIES).map(value).collect() }
        })
    }

    /// In steps.
    #[inline]
    pub(crate) fn steps(&self, linear: f32) -> f32 {
        // Not a number is dark.
        if linear.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
            return 0.0;
        }
        if linear >= 1.0 {
            return 255.0;
        }
        let place = linear.sqrt() * ENTRIES as f32;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
        let entry = place as usize;
        let (low, high) = (self.table[entry], self.table[(entry + 1).min(ENTRIES)]);
        low + (place - entry as f32) * (high - low)
    }

    /// Steps for a unit of linear light, near `linear`.
    pub(crate) fn slope(&self, linear: f32) -> f32 {
        let root = if linear > 0.0 { linear.min(1.0).sqrt() } else { 0.0 };
        // As wide as a step is there.
        let (low, high) = ((root - 0.01).max(0.0), (root + 0.01).min(1.0));
        let (low, high) = (low * low, high * high);
        (self.steps(high) - self.steps(low)) / (high - low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_those_of_the_curve() {
        let display = Display::get();
        let mut most = 0.0_f64;
        for i in 0..=100_000_u32 {
            let linear = f64::from(i) / 100_000.0;
            let linear = linear * linear * linear;
            #[expect(clippy::cast_possible_truncation, reason = "a sample")]
            let found = f64::from(display.steps(linear as f32));
            most = most.max((found - Transfer::Srgb.encode(linear) * WHITE).abs());
        }
        assert!(most < 1e-3, "{most}");
        for (linear, expected) in [
            (-1.0, 0.0),
            (f32::NAN, 0.0),
            (0.0, 0.0),
            (1.0, 255.0),
            (7.0, 255.0),
            (f32::INFINITY, 255.0),
        ] {
            assert!((display.steps(linear) - expected).abs() < 1e-6, "{linear}");
        }
    }

    #[test]
    fn slopes_are_steps_by_light() {
        let display = Display::get();
        for (linear, expected) in [
            // 255 · 12.92 in the straight piece; by the derivative of the power elsewhere.
            (0.0, 255.0 * 12.92),
            (0.2, 255.0 * 1.055 / 2.4 * libm::pow(0.2, 1.0 / 2.4 - 1.0)),
            (0.7, 255.0 * 1.055 / 2.4 * libm::pow(0.7, 1.0 / 2.4 - 1.0)),
        ] {
            #[expect(clippy::cast_possible_truncation, reason = "a sample")]
            let found = f64::from(display.slope(linear as f32));
            assert!((found / expected - 1.0).abs() < 0.01, "{linear}: {found}, not {expected}");
        }
        assert!(display.slope(1.0) > 100.0, "there is an inside of white");
    }
}
