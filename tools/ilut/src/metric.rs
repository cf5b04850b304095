//! `Metric`: how far two colours are apart.

use crate::oklab;

/// A space in which the distance of colours is the Euclidean one, in display steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Metric {
    /// sRGB bytes.
    #[default]
    Rgb,
    /// Oklab, scaled by 255: how far apart two colours look.
    Oklab,
}

impl Metric {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Rgb, Self::Oklab];

    /// The word on a command line.
    pub fn word(self) -> &'static str {
        match self {
            Self::Rgb => "rgb",
            Self::Oklab => "oklab",
        }
    }

    /// Place of an opaque colour.
    #[inline]
    pub(crate) fn place(self, color: [u8; 3]) -> [f32; 3] {
        match self {
            Self::Rgb => color.map(f32::from),
            Self::Oklab => oklab::from_srgb(color),
        }
    }

    /// Place of a colour with alpha. The square of a distance is the mean of that over black and
    /// that over white: with `A = 255 α` the channels are `α c - A / 2`, and alpha takes what is
    /// left of the two squares. All colours of alpha 0 are in one place.
    #[inline]
    pub(crate) fn place_with_alpha(self, [red, green, blue, alpha]: [u8; 4]) -> [f32; 4] {
        let [x, y, z] = self.place([red, green, blue]);
        let share = f32::from(alpha) / 255.0;
        let half = 0.5 * f32::from(alpha);
        match self {
            Self::Rgb => {
                [share * x - half, share * y - half, share * z - half, RGB_ALPHA * 255.0 * share]
            }
            Self::Oklab => [share * x - half, share * y, share * z, half],
        }
    }

    /// The opaque colour of bytes nearest to a place.
    pub(crate) fn color(self, place: [f32; 3]) -> [u8; 3] {
        match self {
            Self::Rgb => place.map(byte),
            Self::Oklab => oklab::to_srgb(place),
        }
    }

    /// The colour of bytes nearest to a place with alpha.
    pub(crate) fn color_with_alpha(self, [x, y, z, w]: [f32; 4]) -> [u8; 4] {
        let alpha = match self {
            Self::Rgb => w / RGB_ALPHA,
            Self::Oklab => 2.0 * w,
        };
        let (share, half) = (alpha / 255.0, 0.5 * alpha);
        let alpha = byte(alpha);
        if alpha == 0 {
            return [0; 4];
        }
        let [red, green, blue] = match self {
            Self::Rgb => self.color([x + half, y + half, z + half].map(|v| v / share)),
            Self::Oklab => self.color([x + half, y, z].map(|v| v / share)),
        };
        [red, green, blue, alpha]
    }
}

/// √3 / 2: three channels leave `3 (1/2 - 1/4) A²` of the mean of the two squares.
const RGB_ALPHA: f32 = 0.866_025_4;

/// Nearest byte, halves up.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the value is between 0 and 255.5"
)]
fn byte(value: f32) -> u8 {
    (value.clamp(0.0, 255.0) + 0.5) as u8
}
