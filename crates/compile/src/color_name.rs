//! Colour names, hsv and rgb to linear RGB.
//!
//! The names are those of the Color Naming System (Berk, Brownston and Kaufman, "A New Color-Naming System for
//! Graphics Languages", 1982): 31 hues in 5 lightnesses and 4 saturations, and 7 without a hue. The system comes
//! without numbers. Here a name is a colour of the HSL double cone with its lightness and saturation in even steps;
//! the result is a display value.

use palette::{FromColor, Hsl, Hsv, Srgb};
use scene::{Rgb, color};

/// A word that colours are made of. `light` is one, too, but begins a statement elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ColorWord {
    Black,
    White,
    Gray,
    Very,
    Dark,
    Medium,
    /// Share of full saturation.
    Saturation(f64),
    /// A quarter of the way toward this hue.
    Splash(Base),
    Base(Base),
    Hsv,
    Rgb,
}

/// The hues that others are mixed from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Base {
    Red,
    Orange,
    Brown,
    Yellow,
    Green,
    Blue,
    Purple,
}

/// Every colour word but `light`. A new one is a new row.
pub(crate) const COLOR_WORDS: &[(&str, ColorWord)] = &[
    ("black", ColorWord::Black),
    ("white", ColorWord::White),
    ("gray", ColorWord::Gray),
    ("grey", ColorWord::Gray),
    ("very", ColorWord::Very),
    ("dark", ColorWord::Dark),
    ("medium", ColorWord::Medium),
    ("grayish", ColorWord::Saturation(0.25)),
    ("greyish", ColorWord::Saturation(0.25)),
    ("moderate", ColorWord::Saturation(0.5)),
    ("strong", ColorWord::Saturation(0.75)),
    ("vivid", ColorWord::Saturation(1.0)),
    ("reddish", ColorWord::Splash(Base::Red)),
    ("orangish", ColorWord::Splash(Base::Orange)),
    ("brownish", ColorWord::Splash(Base::Brown)),
    ("yellowish", ColorWord::Splash(Base::Yellow)),
    ("greenish", ColorWord::Splash(Base::Green)),
    ("bluish", ColorWord::Splash(Base::Blue)),
    ("purplish", ColorWord::Splash(Base::Purple)),
    ("red", ColorWord::Base(Base::Red)),
    ("orange", ColorWord::Base(Base::Orange)),
    ("brown", ColorWord::Base(Base::Brown)),
    ("yellow", ColorWord::Base(Base::Yellow)),
    ("green", ColorWord::Base(Base::Green)),
    ("blue", ColorWord::Base(Base::Blue)),
    ("purple", ColorWord::Base(Base::Purple)),
    ("hsv", ColorWord::Hsv),
    ("rgb", ColorWord::Rgb),
];

/// The ring of hues in degrees, closed: its last is its first.
const RING: [(Base, f64); 7] = [
    (Base::Red, 0.0),
    (Base::Orange, 30.0),
    (Base::Yellow, 60.0),
    (Base::Green, 120.0),
    (Base::Blue, 240.0),
    (Base::Purple, 300.0),
    (Base::Red, 360.0),
];

/// Brown is a dark orange. With 0.5 in place of 0.45, 16 of the 627 names share their 8-bit colour with another.
const BROWN: Hue = Hue { degrees: 30.0, lightness: 0.45 };

/// A hue, and the share of the lightness that it leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hue {
    degrees: f64,
    lightness: f64,
}

/// Lightness in steps of a sixth, from `very dark` to `very light`; black is 0 and white 6.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Lightness(u8);

impl Lightness {
    pub(crate) const BLACK: Self = Self(0);
    pub(crate) const VERY_DARK: Self = Self(1);
    pub(crate) const DARK: Self = Self(2);
    pub(crate) const MEDIUM: Self = Self(3);
    pub(crate) const LIGHT: Self = Self(4);
    pub(crate) const VERY_LIGHT: Self = Self(5);
    pub(crate) const WHITE: Self = Self(6);

    fn share(self) -> f64 {
        f64::from(self.0) / 6.0
    }
}

impl Base {
    /// The word for it.
    pub(crate) fn word(self) -> &'static str {
        let row = COLOR_WORDS.iter().find(|(_, word)| *word == ColorWord::Base(self));
        row.map_or("", |(word, _)| word)
    }

    /// The hue itself.
    pub(crate) fn hue(self) -> Hue {
        let at = RING.iter().find(|(base, _)| *base == self);
        at.map_or(BROWN, |&(_, degrees)| Hue { degrees, lightness: 1.0 })
    }

    /// The hue `share` of the way toward a neighbour; `None` if `other` is none.
    pub(crate) fn toward(self, other: Self, share: f64) -> Option<Hue> {
        let (from, to) = if self == Self::Brown || other == Self::Brown {
            let partner = if self == Self::Brown { other } else { self };
            if !matches!(partner, Self::Red | Self::Yellow) {
                return None;
            }
            (self.hue(), other.hue())
        } else {
            let gap = RING.windows(2).find(|gap| {
                (gap[0].0, gap[1].0) == (self, other) || (gap[1].0, gap[0].0) == (self, other)
            })?;
            let ends = if gap[0].0 == self { (gap[0].1, gap[1].1) } else { (gap[1].1, gap[0].1) };
            let hue = |degrees| Hue { degrees, lightness: 1.0 };
            (hue(ends.0), hue(ends.1))
        };
        let mix = |a: f64, b: f64| (1.0 - share) * a + share * b;
        Some(Hue {
            degrees: mix(from.degrees, to.degrees),
            lightness: mix(from.lightness, to.lightness),
        })
    }

    /// The one hue that lies between two that are not neighbours.
    pub(crate) fn between(self, other: Self) -> Option<Self> {
        let place = |base| RING[..6].iter().position(|row| row.0 == base);
        let (a, b) = (place(self)?, place(other)?);
        let (low, high) = (a.min(b), a.max(b));
        match high - low {
            2 => Some(RING[low + 1].0),
            4 => Some(RING[(high + 1) % 6].0),
            _ => None,
        }
    }
}

/// Linear RGB of a name with a hue; `saturation` in 0…1.
pub(crate) fn named(lightness: Lightness, saturation: f64, hue: Hue) -> Rgb {
    color::linear(display(lightness, saturation, hue))
}

/// Linear RGB of a name without one.
pub(crate) fn gray(lightness: Lightness) -> Rgb {
    color::linear([lightness.share(); 3])
}

/// Linear RGB of a hue in degrees and a saturation and value in 0…1.
pub(crate) fn from_hsv(hue_degrees: f64, saturation: f64, value: f64) -> Rgb {
    color::linear(channels(Srgb::from_color(Hsv::new_srgb(hue_degrees, saturation, value))))
}

fn display(lightness: Lightness, saturation: f64, hue: Hue) -> [f64; 3] {
    let lightness = lightness.share() * hue.lightness;
    channels(Srgb::from_color(Hsl::new_srgb(hue.degrees, saturation, lightness)))
}

/// Rounding in the conversion may step past the ends of the range.
fn channels(rgb: Srgb<f64>) -> [f64; 3] {
    [rgb.red, rgb.green, rgb.blue].map(|channel| channel.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    const BASES: [Base; 7] =
        [Base::Red, Base::Orange, Base::Brown, Base::Yellow, Base::Green, Base::Blue, Base::Purple];

    /// The 31 hues.
    fn hues() -> Vec<Hue> {
        let mut hues: Vec<Hue> = BASES.iter().map(|base| base.hue()).collect();
        for (i, &a) in BASES.iter().enumerate() {
            for &b in &BASES[i + 1..] {
                hues.extend(a.toward(b, 0.25));
                hues.extend(a.toward(b, 0.5));
                hues.extend(b.toward(a, 0.25));
            }
        }
        hues
    }

    fn close(a: [f64; 3], b: [f64; 3]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5)
    }

    #[test]
    fn the_627_names_are_distinct_in_eight_bits() {
        assert_eq!(hues().len(), 31, "hues");
        let mut seen = HashSet::new();
        let mut add = |display: [f64; 3]| {
            seen.insert(display.map(|channel| format!("{:.0}", channel * 255.0)));
        };
        for hue in hues() {
            for lightness in 1..=5 {
                for saturation in [0.25, 0.5, 0.75, 1.0] {
                    add(display(Lightness(lightness), saturation, hue));
                }
            }
        }
        for lightness in 0..=6 {
            add([Lightness(lightness).share(); 3]);
        }
        assert_eq!(seen.len(), 627, "31 hues, 5 lightnesses, 4 saturations, and 7 grays");
    }

    #[test]
    fn names_by_hand() {
        let red = Base::Red.hue();
        let green = Base::Green.hue();
        for (lightness, saturation, hue, expected) in [
            (Lightness::MEDIUM, 1.0, red, [1.0, 0.0, 0.0]),
            (Lightness::DARK, 0.5, red, [0.5, 0.166_667, 0.166_667]),
            (Lightness::LIGHT, 0.25, green, [0.583_333, 0.75, 0.583_333]),
            (Lightness::VERY_LIGHT, 1.0, red, [1.0, 0.666_667, 0.666_667]),
            (Lightness::VERY_DARK, 0.25, red, [0.208_333, 0.125, 0.125]),
            (Lightness::MEDIUM, 1.0, Base::Brown.hue(), [0.45, 0.225, 0.0]),
            (Lightness::MEDIUM, 0.5, Base::Brown.hue(), [0.3375, 0.225, 0.1125]),
            (
                Lightness::MEDIUM,
                1.0,
                Base::Yellow.toward(Base::Brown, 0.25).unwrap(),
                [0.8625, 0.754_688, 0.0],
            ),
        ] {
            let found = display(lightness, saturation, hue);
            assert!(close(found, expected), "{lightness:?} {saturation} {hue:?}: {found:?}");
        }
    }

    #[test]
    fn hsv_by_hand() {
        let display = |h, s, v| channels(Srgb::from_color(Hsv::new_srgb(h, s, v)));
        for (h, s, v, expected) in [
            (0.0, 1.0, 1.0, [1.0, 0.0, 0.0]),
            (30.0, 1.0, 1.0, [1.0, 0.5, 0.0]),
            (210.0, 0.5, 0.8, [0.4, 0.6, 0.8]),
            (330.0, 0.25, 0.9, [0.9, 0.675, 0.7875]),
            (-30.0, 1.0, 1.0, [1.0, 0.0, 0.5]),
            (360.0, 1.0, 1.0, [1.0, 0.0, 0.0]),
            (45.0, 0.0, 0.4, [0.4, 0.4, 0.4]),
            (359.999, 1.0, 1.0, [1.0, 0.0, 1.666_67e-5]),
        ] {
            let found: [f64; 3] = display(h, s, v);
            assert!(close(found, expected), "hsv ({h}, {s}, {v}): {found:?}");
        }
    }

    #[test]
    fn joined_hues_have_no_order_and_the_ring_rises() {
        for a in BASES {
            for b in BASES {
                assert_eq!(a.toward(b, 0.5), b.toward(a, 0.5), "{a:?} {b:?}");
            }
        }
        let mut last = -1.0;
        for gap in RING.windows(2) {
            let (a, b) = (gap[0].0, gap[1].0);
            let inside = [a.toward(b, 0.25), a.toward(b, 0.5), b.toward(a, 0.25)];
            let degrees = inside.map(|hue| hue.unwrap().degrees);
            for degrees in [gap[0].1, degrees[0], degrees[1], degrees[2]] {
                assert!(degrees > last, "{degrees} follows {last}");
                last = degrees;
            }
        }
    }

    #[test]
    fn lighter_names_are_lighter() {
        for hue in hues() {
            for saturation in [0.25, 0.5, 0.75, 1.0] {
                let luma = |lightness| {
                    let [r, g, b] = display(Lightness(lightness), saturation, hue);
                    0.2126 * r + 0.7152 * g + 0.0722 * b
                };
                assert!((1..5).all(|i| luma(i) < luma(i + 1)), "{hue:?} {saturation}");
            }
        }
    }

    #[test]
    fn what_lies_between() {
        assert_eq!(Base::Red.between(Base::Yellow), Some(Base::Orange));
        assert_eq!(Base::Red.between(Base::Blue), Some(Base::Purple), "across the end of the ring");
        assert_eq!(Base::Orange.between(Base::Purple), Some(Base::Red), "across the end");
        assert_eq!(Base::Red.between(Base::Green), None, "two lie between");
        assert_eq!(Base::Brown.between(Base::Orange), None, "brown is not on the ring");
    }
}
