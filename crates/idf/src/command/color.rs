//! Colours on command lines.

use std::str::FromStr;

use super::ArgumentError;

/// A colour of display values: `#rrggbb`, `#rgb` with each digit twice, or three numbers from 0 to 1 with commas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Color(pub [f64; 3]);

impl Color {
    /// What is expected of one, for messages.
    pub const EXPECTED: &str = "#rgb, #rrggbb or three numbers from 0 to 1";
}

impl FromStr for Color {
    type Err = ArgumentError;

    fn from_str(text: &str) -> Result<Self, ArgumentError> {
        let color = text.strip_prefix('#').map_or_else(|| of_numbers(text), of_digits);
        color.map(Self).ok_or_else(|| {
            ArgumentError::new(format!("expected {}, found `{text}`", Self::EXPECTED))
        })
    }
}

fn of_digits(digits: &str) -> Option<[f64; 3]> {
    let digits = digits.chars().map(|digit| digit.to_digit(16)).collect::<Option<Vec<u32>>>()?;
    let bytes = match digits[..] {
        [r, g, b] => [r, g, b].map(|digit| 17 * digit),
        [r1, r0, g1, g0, b1, b0] => {
            [[r1, r0], [g1, g0], [b1, b0]].map(|[high, low]| 16 * high + low)
        }
        _ => return None,
    };
    Some(bytes.map(|byte| f64::from(byte) / 255.0))
}

fn of_numbers(text: &str) -> Option<[f64; 3]> {
    let numbers = text.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>().ok()?;
    let color: [f64; 3] = numbers.try_into().ok()?;
    color.iter().all(|value| (0.0..=1.0).contains(value)).then_some(color)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_have_three_digits_or_six_or_three_numbers() {
        let color = |text: &str| text.parse::<Color>().map(|Color(color)| color);
        assert_eq!(color("#fff"), Ok([1.0; 3]));
        assert_eq!(color("#C30"), color("#cc3300"));
        assert_eq!(color("#336600"), Ok([0.2, 0.4, 0.0]));
        assert_eq!(color("0.25,1,0"), Ok([0.25, 1.0, 0.0]));
        for wrong in [
            "", "#", "#ff", "#ffff", "#fffff", "#ffffff0", "#ggg", "#+ff", "#äöü", "1,1",
            "1,1,1,1", "-1,0,0", "0,0,nan", "fff",
        ] {
            let error = color(wrong).unwrap_err().to_string();
            let expected = "expected #rgb, #rrggbb or three numbers from 0 to 1, found";
            assert_eq!(error, format!("{expected} `{wrong}`"));
        }
    }
}
