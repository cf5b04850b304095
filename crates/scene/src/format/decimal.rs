//! Decimal numbers in a text: which there is, and whether it rounds to a given `f64`.
//!
//! Half of the numbers in a compiled scene, and most of its digits, follow from the others, so the reader knows what they have to be. Whether a
//! decimal rounds to a known number is one comparison of whole numbers; what it rounds to takes three times as long.

/// Most digits that a `u64` holds, whatever they are.
const DIGITS: usize = 19;

/// Bits of the fraction of an `f64`, without the leading one.
const FRACTION: u32 = f64::MANTISSA_DIGITS - 1;

/// The exponent field of the numbers from 2⁵² to 2⁵³, whose last place counts ones.
const ONES: u64 = 1023 + FRACTION as u64;

/// Five to the power of the index, as far as it is below 2⁷², so that twice its product with 53 bits is below 2¹²⁶.
const POWERS_OF_FIVE: [u128; 32] = {
    let mut powers = [1; 32];
    let mut i = 1;
    while i < powers.len() {
        powers[i] = 5 * powers[i - 1];
        i += 1;
    }
    powers
};

/// Ten to the power of the index, as far as an `f64` holds it exactly.
const POWERS_OF_TEN: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// `digits / 10^places` with its sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Decimal {
    negative: bool,
    digits: u64,
    /// How many of the digits stand behind the point when there is no exponent.
    places: usize,
}

impl Decimal {
    /// The decimal that `text` begins with, and how many bytes it has; nothing if there is none or it has too many
    /// digits. With `e` there has to be a minus behind it, and one or two digits. What follows may make another number
    /// of it.
    #[inline(always)]
    pub(super) fn scan(text: &[u8]) -> Option<(Self, usize)> {
        let negative = text.first() == Some(&b'-');
        let begin = usize::from(negative);
        let (digits, whole) = append_singly(0, &text[begin..]);
        let point = begin + whole;
        if text.get(point) != Some(&b'.') {
            let known = (1..=DIGITS).contains(&whole);
            return known.then_some((Self { negative, digits, places: 0 }, point));
        }
        let (all, places) = append(digits, &text[point + 1..]);
        // A zero in front of the point takes no room; more of them never come from a writer.
        let count = places + if digits == 0 && whole == 1 { 0 } else { whole };
        let known = whole > 0 && count <= DIGITS;
        let end = point + 1 + places;
        let (down, length) = match text[end..] {
            [b'e', b'-', ref exponent @ ..] => match append_singly(0, exponent) {
                (down, digits @ 1..=2) => (usize::try_from(down).ok()?, 2 + digits),
                _ => return None,
            },
            _ => (0, 0),
        };
        known.then_some((Self { negative, digits: all, places: places + down }, end + length))
    }

    /// The value, where it takes a single division that is exact but for its rounding.
    #[inline]
    pub(super) fn plain_value(self) -> Option<f64> {
        let power = POWERS_OF_TEN.get(self.places)?;
        if self.digits >> f64::MANTISSA_DIGITS != 0 {
            return None;
        }
        let value = self.digits as f64 / power;
        Some(if self.negative { -value } else { value })
    }

    /// True if this decimal rounds to `value`. It may be false all the same: of zeros, of numbers below the normal
    /// range, without a fraction of a binary digit, or half-way between two.
    ///
    /// With value = m 2^−s and decimal = d / 10^k this holds if |d / 10^k − m 2^−s| < 2^−s / 2, which is
    /// |d 2^(s−k+1) − 2 m 5^k| < 5^k after multiplication with 2^(s+1) 5^k / 2^s. Below a power of two the numbers lie
    /// twice as close, so there half of that is asked for.
    #[inline(always)]
    pub(super) fn rounds_to(self, value: f64) -> bool {
        let bits = value.to_bits();
        let (exponent, fraction) = ((bits << 1) >> (FRACTION + 1), bits & ((1 << FRACTION) - 1));
        let Some(&five) = POWERS_OF_FIVE.get(self.places) else { return false };
        // s − k + 1, at least 0 and small enough for the digits to fit.
        let shift = (ONES + 1).checked_sub(exponent + self.places as u64);
        let Some(shift) = shift else { return false };
        let room = u64::from(self.digits.leading_zeros()) + 63;
        if exponent == 0 || shift > room || value.is_sign_negative() != self.negative {
            return false;
        }
        let mantissa = fraction | (1 << FRACTION);
        let product = (u128::from(mantissa) * five) << 1;
        let distance = (u128::from(self.digits) << shift).abs_diff(product);
        distance << u32::from(fraction == 0) < five
    }
}

/// `value` with the digits behind it that `text` begins with, and how many these are; it wraps if they are too many.
#[inline(always)]
fn append(mut value: u64, text: &[u8]) -> (u64, usize) {
    let mut count = 0;
    while let Some(eight) = text[count..].first_chunk() {
        let (digits, n) = leading_digits(u64::from_le_bytes(*eight));
        value = value.wrapping_mul(TENS[n]).wrapping_add(digits);
        count += n;
        if n < 8 {
            return (value, count);
        }
    }
    let (value, rest) = append_singly(value, &text[count..]);
    (value, count + rest)
}

/// [`append`], one digit after the other.
#[inline(always)]
fn append_singly(mut value: u64, text: &[u8]) -> (u64, usize) {
    let mut count = 0;
    while let Some(byte @ b'0'..=b'9') = text.get(count) {
        value = value.wrapping_mul(10).wrapping_add(u64::from(byte - b'0'));
        count += 1;
    }
    (value, count)
}

/// Ten to the power of the index.
const TENS: [u64; 9] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];

/// The number that the first digits of eight bytes make, and how many they are: neighbours are joined to pairs, pairs
/// to fours, fours to all (Lemire, "Number Parsing at a Gigabyte per Second", 2021, section 8).
#[inline(always)]
fn leading_digits(text: u64) -> (u64, usize) {
    let ones = text ^ 0x3030_3030_3030_3030;
    // The high bit of each byte that is no digit; a carry goes only to bytes behind such a one.
    let others = (ones.wrapping_add(0x7676_7676_7676_7676) | ones) & 0x8080_8080_8080_8080;
    let count = (others.trailing_zeros() / 8) as usize;
    if count == 0 {
        return (0, 0);
    }
    // As many zeros in front as there are bytes left.
    let ones = ones << (64 - 8 * count);
    let pairs = ones * 10 + (ones >> 8);
    let low = (pairs & 0xff_0000_00ff).wrapping_mul(100 + (1_000_000 << 32));
    let high = ((pairs >> 16) & 0xff_0000_00ff).wrapping_mul(1 + (10_000 << 32));
    (low.wrapping_add(high) >> 32, count)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of all sizes and all bits, from a fixed seed.
    fn numbers() -> impl Iterator<Item = f64> {
        let mut state = 1_u64;
        let mut next = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            state ^ (state >> 29)
        };
        (0..60_000_u32).map(move |i| {
            let bits = next();
            // Every third of any size, the others from 2^−60 to 2^60, some with few bits, some just off a power of two.
            let exponent = 963 + next() % 121;
            let fraction = match i % 4 {
                0 => bits & ((1 << FRACTION) - 1),
                1 => bits & (0xff << (FRACTION - 8)),
                2 => bits % 3,
                _ => (1 << FRACTION) - 1 - bits % 3,
            };
            match i % 3 {
                0 => f64::from_bits(bits),
                _ => f64::from_bits((bits & (1 << 63)) | (exponent << FRACTION) | fraction),
            }
        })
    }

    /// What is known without [`str::parse`]: the decimal and its length, where it is the whole text.
    fn whole(text: &str) -> Option<Decimal> {
        let (decimal, length) = Decimal::scan(text.as_bytes())?;
        (length == text.len()).then_some(decimal)
    }

    #[test]
    fn rounding_is_that_of_the_standard_library() {
        let (mut known, mut all) = (0, 0);
        for value in numbers().filter(|value| value.is_finite()) {
            let around = [value, value.next_up(), value.next_down(), -value];
            let digits = [0, 3, 12, 15, 16, 17, 18].map(|digits| format!("{value:.digits$}"));
            let shortest = [format!("{value:?}"), format!("{value}"), format!("{value:e}")];
            for text in digits.iter().chain(&shortest) {
                let Some(decimal) = whole(text) else { continue };
                let parsed: f64 = text.parse().unwrap();
                for value in around.iter().filter(|value| decimal.rounds_to(**value)) {
                    assert_eq!(parsed.to_bits(), value.to_bits(), "{text} is not {value:?}");
                }
                if let Some(plain) = decimal.plain_value() {
                    assert_eq!(parsed.to_bits(), plain.to_bits(), "{text} is {plain:?}");
                }
            }
            if (1e-13..1e12).contains(&value.abs()) {
                all += 1;
                known +=
                    usize::from(whole(&shortest[0]).is_some_and(|found| found.rounds_to(value)));
            }
        }
        // What a scene is full of takes the fast way, but for whole numbers of many digits and a few small ones.
        assert!(all > 20_000 && known * 10 > all * 9, "{known} of {all}");
    }

    #[test]
    fn halves_and_edges_are_left_to_others() {
        let rounds =
            |text: &str, value: f64| whole(text).is_some_and(|found| found.rounds_to(value));
        // Half-way between 1 and the next number, and on either side of that.
        let next = 1.0_f64.next_up();
        assert!(!rounds("1.00000000000000011", next), "below the half");
        assert!(rounds("1.00000000000000005", 1.0), "below the half of the half");
        assert!(rounds("1.00000000000000012", next), "above the half");
        assert!(!rounds("1.00000000000000012", 1.0), "above the half");
        assert!(!rounds("4503599627370497.5", 4_503_599_627_370_497.0), "half-way to the even one");
        // Below a power of two numbers lie closer.
        assert!(rounds("0.99999999999999995", 1.0), "nearer to 1");
        assert!(!rounds("0.99999999999999994", 1.0), "nearer to the one below");
        assert!(rounds("0.99999999999999994", 1.0_f64.next_down()), "nearer to the one below");
        assert!(rounds("-2.5", -2.5) && !rounds("-2.5", 2.5) && !rounds("2.5", -2.5), "signs");
        for value in [0.0, -0.0, f64::INFINITY, f64::NAN, 5e-324] {
            assert!(!rounds(&format!("{value:?}"), value), "{value:?}");
        }
    }

    #[test]
    fn a_scan_takes_what_is_a_decimal() {
        let scan = |text: &str| Decimal::scan(text.as_bytes());
        let decimal = |negative, digits, places| Decimal { negative, digits, places };
        for (text, expected, length) in [
            ("12", decimal(false, 12, 0), 2),
            ("-0.50 1", decimal(true, 50, 2), 5),
            ("3.", decimal(false, 3, 0), 2),
            ("1.25e-7\n", decimal(false, 125, 9), 7),
            ("0.1234567890123456789", decimal(false, 1_234_567_890_123_456_789, 19), 21),
            ("9999999999999999999", decimal(false, 9_999_999_999_999_999_999, 0), 19),
            ("8.76543210x", decimal(false, 876_543_210, 8), 10),
        ] {
            assert_eq!(scan(text), Some((expected, length)), "{text}");
        }
        for text in [
            "",
            "-",
            ".5",
            "-.5",
            "x",
            "10000000000000000000",
            "1.2345678901234567890",
            "1.5e5",
            "1.5e-",
            "1.5e-100",
        ] {
            let found = scan(text).filter(|(_, length)| *length == text.len());
            assert_eq!(found, None, "{text}");
        }
    }

    #[test]
    fn eight_digits_at_once_are_those_one_by_one() {
        for text in
            ["00000000", "12345678", "1234567.", "99999999", "0/000000", "7:", "", "5\u{fa}0000"]
        {
            let mut eight = [0; 8];
            let length = text.len().min(8);
            eight[..length].copy_from_slice(&text.as_bytes()[..length]);
            let (digits, count) = append_singly(0, &eight);
            assert_eq!(leading_digits(u64::from_le_bytes(eight)), (digits, count), "{text:?}");
        }
    }
}
