//! Tables of colours and dithers, tried on one picture.

use idf::{Image, ImageError, Kind, Plane, Samples};
use iencode::{Dither, dither};
use ilut::{Method, Metric, Pixels, quality};

use crate::clock::Stopwatch;
use crate::journal::Figures;

/// How the colours of a picture are found and drawn.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// How a table is made.
    pub method: Method,
    /// What is near.
    pub metric: Metric,
    /// How indices are chosen.
    pub dither: &'static Dither,
}

/// The least of so many runs counts.
const RUNS: usize = 3;

/// All methods without a dither, then all dithers with the best.
#[must_use]
pub fn ways() -> Vec<Way> {
    let metrics = [Metric::Rgb, Metric::Oklab];
    let plain = Method::ALL
        .into_iter()
        .flat_map(|method| metrics.map(|metric| Way { method, metric, dither: &dither::NONE }));
    let dithered = dither::TABLE
        .iter()
        .filter(|row| row.strength > 0.0)
        .flat_map(|dither| metrics.map(|metric| Way { method: Method::Best, metric, dither }));
    plain.chain(dithered).collect()
}

impl Way {
    /// The options of `iencode` that ask for it.
    #[must_use]
    pub fn words(&self) -> String {
        let (method, metric) = (self.method.word(), self.metric.word());
        format!("--method {method} --metric {metric} --dither {}", self.dither.name)
    }

    /// A name for files.
    #[must_use]
    pub fn file(&self) -> String {
        format!("{}-{}-{}", self.method.word(), self.metric.word(), self.dither.name)
    }

    /// Draws a picture in 256 colours: `seconds` of all cores together, `rms_rgb`, `rms_oklab`, `psnr`, and the picture.
    ///
    /// # Errors
    ///
    /// If the size is none of an image's.
    pub fn measured(
        &self,
        pixels: &Pixels,
    ) -> Result<(Figures, Image), Box<dyn std::error::Error>> {
        let options = iencode::Options {
            table: ilut::Options {
                method: self.method,
                metric: self.metric,
                ..ilut::Options::default()
            },
            dither: self.dither,
            strength: None,
        };
        let mut seconds = f64::INFINITY;
        let mut result = None;
        for _ in 0..RUNS {
            let begun = Stopwatch::start();
            result = Some(iencode::encoded(&[pixels], None, &options)?);
            seconds = seconds.min(begun.seconds());
        }
        let result = result.ok_or("a run")?;
        let indices = &result.indices[0];
        let found = quality(pixels, &result.table, indices);
        let figures = Figures::default()
            .with("seconds", seconds)
            .with("rms_rgb", found.rms_rgb)
            .with("rms_oklab", found.rms_oklab)
            .with("psnr", found.psnr_rgb);
        let colors = result.table.colors();
        Ok((figures, drawn(pixels, indices.iter().map(|&index| colors[usize::from(index)]))?))
    }
}

fn drawn(pixels: &Pixels, colors: impl Iterator<Item = [u8; 4]>) -> Result<Image, ImageError> {
    let colors: Vec<[u8; 4]> = colors.collect();
    let kinds = [Kind::Red, Kind::Grn, Kind::Blu].into_iter().enumerate();
    let planes = kinds.map(|(at, kind)| {
        let samples = Samples::U8(colors.iter().map(|color| color[at]).collect());
        Plane { kind, samples }
    });
    Image::new(pixels.columns(), pixels.rows(), planes.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_dither_and_method_is_tried() {
        let ways = ways();
        for method in Method::ALL {
            assert!(ways.iter().any(|way| way.method == method), "{}", method.word());
        }
        for row in dither::TABLE {
            assert!(ways.iter().any(|way| way.dither.name == row.name), "{}", row.name);
        }
    }

    #[test]
    fn a_picture_of_few_colours_is_unchanged() {
        let colors = (0..64_u8).map(|at| [at, 255 - at, 7 * (at % 8), 255]).collect();
        let pixels = Pixels::new(8, 8, colors).unwrap();
        let (figures, image) = ways()[4].measured(&pixels).unwrap();
        assert!(figures.number("rms_rgb") <= 0.0, "{figures:?}");
        let red = Samples::U8((0..64).collect());
        assert_eq!(image.plane(Kind::Red), Some(&red));
    }
}
