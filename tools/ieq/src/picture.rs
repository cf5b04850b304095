//! The picture of a histogram.

use idf::plane::COLOR;
use idf::{Image, Plane, Samples};

use crate::histogram::{Channel, Histogram};

/// Columns and rows of the picture.
const SIZE: [u16; 2] = [512, 256];

/// Byte of a bar over its own channel, and of the ground.
const BAR: u8 = 230;
const GROUND: u8 = 24;

/// What luma adds to what is below its line.
const LUMA: u8 = 25;

/// Bars over the range of the histogram, as high as the fullest bin is full: red, green and blue
/// add up where they overlap, and all below luma's is lighter; grey alone is white.
pub(crate) fn drawn(histogram: &Histogram) -> Image {
    let [columns, rows] = SIZE;
    let heights: Vec<(&Channel, Vec<u16>)> = {
        let fullest = histogram.channels.iter().flat_map(|channel| &channel.counts);
        let fullest = fullest.fold(0.0_f64, |most, &count| if count > most { count } else { most });
        let bars = histogram.channels.iter();
        bars.map(|channel| (channel, heights(channel, fullest))).collect()
    };
    let plane = |kind: idf::Kind| {
        let pixel = |at: usize| {
            let (column, row) = (at % usize::from(columns), at / usize::from(columns));
            let above = usize::from(rows) - row;
            heights.iter().fold(GROUND, |value, (channel, heights)| {
                let below = usize::from(heights[column]) >= above;
                match channel.name {
                    _ if !below => value,
                    "luma" => value.saturating_add(LUMA),
                    name if name == kind.word() || name == "grg" => BAR,
                    _ => value,
                }
            })
        };
        let samples = (0..usize::from(columns) * usize::from(rows)).map(pixel).collect();
        Plane { kind, samples: Samples::U8(samples) }
    };
    Image::new(columns.into(), rows.into(), COLOR.map(plane).into())
        .expect("three planes of one size")
}

/// The height of the bar in each column: that of the fullest bin that the column shows.
fn heights(channel: &Channel, fullest: f64) -> Vec<u16> {
    let bins = channel.counts.len();
    let [columns, rows] = SIZE;
    let height = |column: usize| {
        let first = column * bins / usize::from(columns);
        let end = ((column + 1) * bins).div_ceil(usize::from(columns)).max(first + 1);
        let shown = channel.counts[first..end].iter();
        let count = shown.fold(0.0_f64, |most, &count| if count > most { count } else { most });
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a share of the rows"
        )]
        let height = (count / fullest * f64::from(rows)).ceil() as u16;
        height
    };
    (0..usize::from(columns)).map(height).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(name: &'static str, counts: &[f64]) -> Channel {
        let pixels = counts.iter().sum();
        Channel {
            name,
            counts: counts.into(),
            pixels,
            not_finite: 0.0,
            mean: 0.0,
            least: 0.0,
            greatest: 0.0,
            percentiles: [0.0; 7],
        }
    }

    fn at(image: &Image, column: usize, row: usize) -> [u8; 3] {
        COLOR.map(|kind| match image.plane(kind) {
            Some(Samples::U8(samples)) => samples[row * 512 + column],
            other => panic!("{other:?}"),
        })
    }

    #[test]
    fn bars_are_as_high_as_bins_are_full() {
        let channels = vec![channel("red", &[4.0, 0.0]), channel("grn", &[2.0, 1.0])];
        let image = drawn(&Histogram { range: [0.0, 1.0], channels });
        // The left half is the first bin: red to the top, green to the middle.
        assert_eq!(at(&image, 0, 0), [BAR, GROUND, GROUND]);
        assert_eq!(at(&image, 255, 127), [BAR, GROUND, GROUND]);
        assert_eq!(at(&image, 255, 128), [BAR, BAR, GROUND]);
        assert_eq!(at(&image, 256, 191), [GROUND; 3]);
        assert_eq!(at(&image, 511, 192), [GROUND, BAR, GROUND]);
    }

    #[test]
    fn nothing_counted_is_an_empty_picture() {
        let image = drawn(&Histogram { range: [0.0, 1.0], channels: vec![channel("grg", &[0.0])] });
        assert_eq!(at(&image, 100, 255), [GROUND; 3]);
    }

    #[test]
    fn a_column_of_many_bins_shows_the_fullest() {
        let mut counts = vec![0.0; 5120];
        counts[5119] = 1.0;
        let image =
            drawn(&Histogram { range: [0.0, 1.0], channels: vec![channel("grg", &counts)] });
        assert_eq!(at(&image, 511, 0), [BAR; 3]);
        assert_eq!(at(&image, 510, 255), [GROUND; 3]);
    }
}
