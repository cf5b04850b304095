//! From the film to planes of an image.

use idf::{Image, ImageError, Kind, Matte, Plane, Properties, Samples, Transfer};
use rayon::prelude::*;
use scene::Rgb;

use crate::film::{Film, Pixel};

/// What the planes of a picture hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Form {
    /// 32-bit linear light, not clamped; else 8 bits of display values.
    pub float: bool,
    /// The background is painted in and there is no coverage.
    pub opaque: bool,
    /// Coverage is there even where every pixel is covered.
    pub coverage: bool,
    /// Colour is not multiplied by coverage, as in PNG. Of no effect in floating point, and without coverage.
    pub straight: bool,
    /// Light that falls between two of 8 bits becomes either, by its share, in a fine pattern that is always the same:
    /// gradients show no bands. Of no effect in floating point.
    pub dither: bool,
}

impl Form {
    /// How light is stored.
    #[must_use]
    pub fn transfer(self) -> Transfer {
        if self.float { Transfer::Linear } else { Transfer::Srgb }
    }
}

impl Film {
    /// The picture as an image: `red grn blu`, and `cvg` as `form` says or where a pixel is not fully covered.
    ///
    /// # Errors
    ///
    /// [`ImageError`] if the picture is larger than an image may be.
    pub fn image(&self, form: Form, background: Rgb) -> Result<Image, ImageError> {
        let (columns, rows) = self.size();
        let pixels = columns as usize * rows as usize;
        let open = !form.opaque && self.pixels().any(|pixel| pixel.coverage < 1.0);
        let covered = open || !form.opaque && form.coverage;
        let mut color: [Vec<f32>; 3] = std::array::from_fn(|_| Vec::with_capacity(pixels));
        let mut coverage = Vec::with_capacity(if covered { pixels } else { 0 });
        for pixel in self.pixels() {
            let pixel = match (form.opaque, form.float) {
                (true, _) => pixel.whole(background),
                (false, true) => pixel.without_negative(background),
                (false, false) if form.straight => pixel.straight_in_steps(background),
                (false, false) => pixel.in_steps(background),
            };
            for (plane, channel) in color.iter_mut().zip(pixel.color) {
                plane.push(channel);
            }
            if covered {
                coverage.push(pixel.coverage);
            }
        }
        let mut planes: Vec<Plane> = [Kind::Red, Kind::Grn, Kind::Blu]
            .into_iter()
            .zip(color)
            .map(|(kind, plane)| Plane {
                kind,
                samples: if form.dither && !form.float {
                    dithered(&plane, columns, self.origin())
                } else {
                    light(plane, form.float)
                },
            })
            .collect();
        if covered {
            planes.push(Plane { kind: Kind::Cvg, samples: share(coverage, form.float) });
        }
        let mut image = Image::new(columns, rows, planes)?;
        let background =
            open.then(|| background.to_array().map(|channel| Transfer::Srgb.encode(channel)));
        image.properties =
            Properties { transfer: Some(form.transfer()), background, ..Properties::default() };
        if covered && form.straight && !form.float {
            image.properties.matte = Matte::Straight;
        }
        Ok(image)
    }
}

impl Film {
    /// The picture over its background as screens take it: red, green, blue and 255 of each pixel, row by row from the top.
    /// They are the bytes of an image that is opaque and no floating point, dithered or not.
    #[must_use]
    pub fn rgba(&self, background: Rgb, dither: bool) -> Vec<u8> {
        let (columns, rows) = self.size();
        let [left, top] = self.origin().map(|side| side as usize);
        let mut bytes = vec![u8::MAX; columns as usize * rows as usize * 4];
        let lines = bytes.par_chunks_exact_mut(columns as usize * 4).zip(0..rows);
        lines.with_min_len(16).for_each(|(line, row)| {
            let pixels = line.chunks_exact_mut(4).zip(self.row(row));
            for (column, (out, pixel)) in pixels.enumerate() {
                let color = pixel.whole(background).color;
                for (out, linear) in out.iter_mut().zip(color) {
                    *out = if dither {
                        dithered_byte(linear, left + column, top + row as usize)
                    } else {
                        idf::srgb8(f64::from(linear))
                    };
                }
            }
        });
        bytes
    }
}

/// Steps of 8 bits.
const STEPS: f64 = 255.0;

impl Pixel {
    /// With the background behind it.
    fn whole(&self, background: Rgb) -> Self {
        let open = 1.0 - f64::from(self.coverage);
        self.with(|color, background| color + open * background, background, 1.0)
    }

    /// The largest share of the background that may be left open, so that no colour is below 0: what is tinted may be
    /// darker in a channel than the background seen through the mean of its tint. 0…1: wide filters have negative lobes,
    /// which take sums out of range.
    fn most_open(&self, background: Rgb) -> f64 {
        let exact = (1.0 - f64::from(self.coverage)).clamp(0.0, 1.0);
        let whole = self.whole(background);
        whole.color.iter().zip(background.to_array()).fold(exact, |most, (&all, behind)| {
            let all = if all > 0.0 { f64::from(all) } else { 0.0 };
            // A rounding of f32 more or less does not show.
            if most * behind <= all * (1.0 + f64::from(f32::EPSILON)) { most } else { all / behind }
        })
    }

    /// With no colour below 0, by a greater coverage where it must be; over `background` the pixel is what it was.
    fn without_negative(&self, background: Rgb) -> Self {
        let share = 0.0..=1.0;
        if self.color.iter().all(|&channel| channel >= 0.0) && share.contains(&self.coverage) {
            return *self;
        }
        let open = self.most_open(background);
        let lit = self.whole(background).with(|c, b| c - open * b, background, 1.0 - open);
        // What is left of one is rounding.
        Self { color: lit.color.map(|channel| if channel > 0.0 { channel } else { 0.0 }), ..lit }
    }

    /// With a coverage that 8 bits hold: the colour makes up for it, so that over `background` the pixel is what it was.
    fn in_steps(&self, background: Rgb) -> Self {
        let most = self.most_open(background);
        let nearest = libm::floor((1.0 - f64::from(self.coverage)) * STEPS + 0.5);
        let steps = if nearest <= most * STEPS { nearest } else { libm::floor(most * STEPS) };
        // Sums of samples are off by their rounding.
        let open = if steps > 0.0 { steps / STEPS } else { 0.0 };
        let whole = self.whole(background);
        whole.with(|color, background| color - open * background, background, 1.0 - open)
    }

    /// The same with the colour divided by the coverage. Where that would be brighter than white, as highlights behind
    /// fog are, less is left open.
    fn straight_in_steps(&self, background: Rgb) -> Self {
        // A hundredth of a step does not show.
        const SLACK: f64 = 0.01;
        let whole = self.whole(background);
        let room = 1.0 - self.most_open(background);
        let least = whole.color.iter().zip(background.to_array()).fold(room, |least, (&all, b)| {
            let beyond = (f64::from(all) - b) / (1.0 - b);
            if beyond > least { beyond } else { least }
        });
        let nearest = libm::floor(f64::from(self.coverage) * STEPS + 0.5);
        let above = libm::ceil(least * STEPS - SLACK);
        let steps = if nearest >= above { nearest } else { above };
        let covered = if steps < STEPS { steps / STEPS } else { 1.0 };
        if covered <= 0.0 {
            return Self { color: [0.0; 3], coverage: 0.0 };
        }
        let straight = |color, background| (color - (1.0 - covered) * background) / covered;
        whole.with(straight, background, covered)
    }

    fn with(&self, light: impl Fn(f64, f64) -> f64, background: Rgb, coverage: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "planes in memory are f32")]
        let small = |x: f64| x as f32;
        let color = std::array::from_fn(|k| small(light(f64::from(self.color[k]), background[k])));
        Self { color, coverage: small(coverage) }
    }
}

fn light(plane: Vec<f32>, float: bool) -> Samples {
    if float {
        Samples::F32(plane)
    } else {
        Samples::U8(plane.into_iter().map(|linear| idf::srgb8(f64::from(linear))).collect())
    }
}

/// Light to 8 bits by a threshold that differs from pixel to pixel of the whole picture.
fn dithered(plane: &[f32], columns: u32, [left, top]: [u32; 2]) -> Samples {
    let byte = |(at, &linear): (usize, &f32)| {
        let column = at % columns as usize + left as usize;
        dithered_byte(linear, column, at / columns as usize + top as usize)
    };
    Samples::U8(plane.iter().enumerate().map(byte).collect())
}

fn dithered_byte(linear: f32, column: usize, row: usize) -> u8 {
    let value = Transfer::Srgb.encode(f64::from(linear)) * STEPS + threshold(column, row);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
    let byte = value as u8;
    byte
}

/// Interleaved gradient noise (Jimenez, "Next Generation Post Processing in Call of Duty: Advanced Warfare", 2014): any
/// nine neighbours have thresholds spread over 0…1. A little off either end, so that what 8 bits hold stays what it is.
fn threshold(column: usize, row: usize) -> f64 {
    let fraction = |x: f64| x - libm::floor(x);
    let along = 0.067_110_56 * column as f64 + 0.005_837_15 * row as f64;
    0.001 + 0.998 * fraction(52.982_918_9 * fraction(along))
}

fn share(plane: Vec<f32>, float: bool) -> Samples {
    if float {
        Samples::F32(plane)
    } else {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0…1")]
        Samples::U8(plane.into_iter().map(|share| (share * 255.0 + 0.5) as u8).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What an 8-bit reader sees of a pixel over a background.
    fn over(pixel: Pixel, background: Rgb) -> [u8; 3] {
        let open = 1.0 - f64::from(share(vec![pixel.coverage], false).byte()) / STEPS;
        let stored = pixel.color.map(|c| light(vec![c], false).byte());
        let decode = |byte: u8| Transfer::Srgb.decode(f64::from(byte) / STEPS);
        std::array::from_fn(|k| idf::srgb8(decode(stored[k]) + open * background[k]))
    }

    #[test]
    fn screens_get_the_bytes_of_the_opaque_image() {
        // 37 × 3 pixels in one piece: colours beyond either end, and open ones.
        let (columns, rows) = (37_u16, 3_u16);
        let half = |number: u16| {
            let share = f32::from(number) / 110.0;
            let color = [share * 1.2 - 0.1, share * share, 0.5 * share];
            crate::Half { color, coverage: share }
        };
        let halves = [(0..columns * rows).map(half).collect(), Vec::new()];
        let size = (u32::from(columns), u32::from(rows));
        let film = Film::whole(size, [1, 0], halves).at([5, 7]);
        let background = Rgb::new(0.25, 0.5, 1.0);
        for dither in [false, true] {
            let form =
                Form { float: false, opaque: true, coverage: false, straight: false, dither };
            let image = film.image(form, background).unwrap();
            let bytes = |at: usize| match &image.planes()[at].samples {
                Samples::U8(bytes) => bytes.clone(),
                other => panic!("8 bits: {other:?}"),
            };
            let planes = [bytes(0), bytes(1), bytes(2), vec![255; 37 * 3]];
            let expected: Vec<u8> =
                (0..37 * 3).flat_map(|at| [0, 1, 2, 3].map(|k: usize| planes[k][at])).collect();
            assert_eq!(film.rgba(background, dither), expected, "dither {dither}");
        }
    }

    trait Byte {
        fn byte(&self) -> u8;
    }

    impl Byte for Samples {
        fn byte(&self) -> u8 {
            match self {
                Self::U8(bytes) => bytes[0],
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn eight_bits_over_the_background_are_the_whole() {
        let levels = [0.0, 0.001, 0.01, 0.1, 0.4, 0.77, 1.0];
        for background in levels {
            for filter in levels {
                for own in levels {
                    // A pane that tints: each channel of the background passes by its own share.
                    let shares = [filter, 0.3, 0.9];
                    let mean = (shares[0] + shares[1] + shares[2]) / 3.0;
                    let color =
                        shares.map(|share| own * (1.0 - mean) + (share - mean) * background);
                    #[expect(clippy::cast_possible_truncation, reason = "as on film")]
                    let pixel =
                        Pixel { color: color.map(|c| c as f32), coverage: (1.0 - mean) as f32 };
                    let background = Rgb::splat(background);
                    let expected = pixel.whole(background).color.map(|c| idf::srgb8(f64::from(c)));
                    let stored = pixel.in_steps(background);
                    let found = over(stored, background);
                    for k in 0..3 {
                        let near = found[k].abs_diff(expected[k]) <= 1;
                        assert!(near, "{pixel:?} over {background}: {found:?}, not {expected:?}");
                        assert!(stored.color[k] > -1e-6, "{stored:?} holds no light below 0");
                    }
                }
            }
        }
    }

    #[test]
    fn dithered_light_has_the_mean_of_what_it_stands_for() {
        let side = 64;
        for value in [0.0, 0.3, 10.5, 99.25, 127.9, 254.5, 255.0, 300.0] {
            #[expect(clippy::cast_possible_truncation, reason = "as on film")]
            let linear = Transfer::Srgb.decode(value / STEPS) as f32;
            let Samples::U8(bytes) = dithered(&vec![linear; side * side], 64, [0; 2]) else {
                panic!("not 8 bits");
            };
            let sum: f64 = bytes.iter().map(|&byte| f64::from(byte)).sum();
            let mean = sum / f64::from(64 * 64);
            let expected = f64::min(value, STEPS);
            assert!((mean - expected).abs() < 0.01, "{value}: {mean}");
            let near = bytes.iter().all(|&byte| (f64::from(byte) - expected).abs() < 1.0);
            assert!(near, "{value}: no further than the next step");
            // In any 4 × 4 pixels, too, within a step and a half of sixteen.
            for corner in (0..side * (side - 4)).filter(|at| at % side <= side - 4) {
                let cells = (0..16).map(|k| bytes[corner + k / 4 * side + k % 4]);
                let mean = cells.map(f64::from).sum::<f64>() / 16.0;
                assert!((mean - expected).abs() < 0.16, "{value} at {corner}: {mean}");
            }
        }
    }

    #[test]
    fn what_covers_all_or_nothing_is_kept() {
        for (coverage, color) in [(1.0, [0.2, 0.5, 0.7]), (0.0, [0.0; 3])] {
            let pixel = Pixel { color, coverage };
            let stored = pixel.in_steps(Rgb::new(0.8, 0.1, 1.0));
            assert!((stored.coverage - coverage).abs() < 1e-7, "{stored:?}");
            let near = stored.color.iter().zip(color).all(|(a, b)| (a - b).abs() < 1e-6);
            assert!(near, "{stored:?}");
        }
    }

    #[test]
    fn lobes_of_filters_leave_no_number_out_of_range() {
        // Blue that is black but for its rounding: nothing may be divided by it.
        let background = Rgb::new(0.2, 0.0, 2e-18);
        for coverage in [-0.04, 0.0, 0.5, 1.0, 1.07] {
            for channel in [-0.03, 0.0, 0.2, 1.04] {
                for pixel in [[channel; 3], [0.1, -0.01, channel], [channel, 0.1, -0.02]] {
                    let pixel = Pixel { color: pixel, coverage };
                    for kept in [
                        pixel.without_negative(background),
                        pixel.in_steps(background),
                        pixel.straight_in_steps(background),
                    ] {
                        assert!((0.0..=1.0).contains(&kept.coverage), "{pixel:?}: {kept:?}");
                        let bright = kept.color.iter().all(|c| c.is_finite() && c.abs() < 3.0);
                        assert!(bright, "{pixel:?}: {kept:?}");
                    }
                    let least = pixel.without_negative(background).color;
                    assert!(least.iter().all(|&channel| channel >= 0.0), "{pixel:?}: {least:?}");
                }
            }
        }
    }
}
