//! From the film to planes of an image.

use idf::{Image, ImageError, Kind, Plane, Properties, Samples, Transfer};
use scene::Rgb;

use crate::film::Film;

/// What the planes of a picture hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Form {
    /// 32-bit linear light, not clamped; else 8 bits of display values.
    pub float: bool,
    /// The background is painted in and there is no coverage.
    pub opaque: bool,
    /// Coverage is there even where every pixel is covered.
    pub coverage: bool,
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
        let mut color: [Vec<f32>; 3] = std::array::from_fn(|_| Vec::with_capacity(pixels));
        let mut coverage = Vec::with_capacity(pixels);
        for pixel in self.pixels() {
            for (k, plane) in color.iter_mut().enumerate() {
                let open = if form.opaque { 1.0 - f64::from(pixel.coverage) } else { 0.0 };
                #[expect(clippy::cast_possible_truncation, reason = "planes in memory are f32")]
                plane.push((f64::from(pixel.color[k]) + open * background[k]) as f32);
            }
            coverage.push(pixel.coverage);
        }
        let mut planes: Vec<Plane> = [Kind::Red, Kind::Grn, Kind::Blu]
            .into_iter()
            .zip(color)
            .map(|(kind, plane)| Plane { kind, samples: light(plane, form.float) })
            .collect();
        let open = coverage.iter().any(|&c| c < 1.0);
        if !form.opaque && (form.coverage || open) {
            planes.push(Plane { kind: Kind::Cvg, samples: share(coverage, form.float) });
        }
        let mut image = Image::new(columns, rows, planes)?;
        let transfer = if form.float { Transfer::Linear } else { Transfer::Srgb };
        let background = (!form.opaque && open)
            .then(|| background.to_array().map(|channel| Transfer::Srgb.encode(channel)));
        image.properties =
            Properties { transfer: Some(transfer), background, ..Properties::default() };
        Ok(image)
    }
}

fn light(plane: Vec<f32>, float: bool) -> Samples {
    if float {
        Samples::F32(plane)
    } else {
        Samples::U8(plane.into_iter().map(|linear| idf::srgb8(f64::from(linear))).collect())
    }
}

fn share(plane: Vec<f32>, float: bool) -> Samples {
    if float {
        Samples::F32(plane)
    } else {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0…1")]
        Samples::U8(plane.into_iter().map(|share| (share * 255.0 + 0.5) as u8).collect())
    }
}
