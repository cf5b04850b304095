//! `Pixels`: display values of a picture.

use idf::{
    Depth, Form, Image, ImageError, Kind, Matte, Samples, Transfer, check_memory, checked_size,
};

/// Display values (sRGB bytes, straight) of a picture, row by row from the top:
/// `[red, green, blue, alpha]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    columns: u32,
    rows: u32,
    colors: Vec<[u8; 4]>,
    is_opaque: bool,
}

impl Pixels {
    /// A picture of `colors`, row by row from the top.
    ///
    /// # Errors
    ///
    /// If the size is none of an image's, or there is another number of colours than pixels.
    pub fn new(columns: u32, rows: u32, colors: Vec<[u8; 4]>) -> Result<Self, ImageError> {
        let expected = checked_size(columns, rows)?;
        if colors.len() as u64 != expected {
            return Err(ImageError::Length { kind: Kind::Red, found: colors.len(), expected });
        }
        let is_opaque = colors.iter().all(|color| color[3] == u8::MAX);
        Ok(Self { columns, rows, colors, is_opaque })
    }

    /// What a display shows of `image`: over `matte` (display values, 0 to 1) where one is given,
    /// and then opaque; else with its coverage as alpha.
    ///
    /// # Errors
    ///
    /// If the image has no light, or a sample is not a number.
    pub fn of(image: &Image, matte: Option<[f64; 3]>) -> Result<Self, ImageError> {
        let image = match matte {
            Some(matte) => image.flattened(Some(matte))?,
            None => image.resolved()?,
        };
        let form = Form { depth: Depth::U8, transfer: Transfer::Srgb, matte: Matte::Straight };
        let image = image.converted(form)?;
        let kinds = image.light_kinds()?;
        let pixels = image.columns() as usize * image.rows() as usize;
        // The colours, and a number for each as they are counted.
        check_memory((pixels as u64).saturating_mul(8))?;
        let mut colors = vec![[u8::MAX; 4]; pixels];
        match kinds[..] {
            [] => return Err(ImageError::Missing { kind: Kind::Grg, present: image.kinds() }),
            [grey] => (0..3).try_for_each(|channel| fill(&mut colors, channel, &image, grey))?,
            _ => (0..).zip(kinds).try_for_each(|(at, kind)| fill(&mut colors, at, &image, kind))?,
        }
        if image.plane(Kind::Cvg).is_some() {
            fill(&mut colors, 3, &image, Kind::Cvg)?;
        }
        Self::new(image.columns(), image.rows(), colors)
    }

    /// Width.
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// Height.
    pub fn rows(&self) -> u32 {
        self.rows
    }

    /// The colours, row by row from the top.
    pub fn colors(&self) -> &[[u8; 4]] {
        &self.colors
    }

    /// Whether all alpha is 255.
    pub fn is_opaque(&self) -> bool {
        self.is_opaque
    }
}

/// Puts the bytes of a plane into one channel.
fn fill(
    colors: &mut [[u8; 4]],
    channel: usize,
    image: &Image,
    kind: Kind,
) -> Result<(), ImageError> {
    if let Samples::U8(samples) = image.needed(kind)? {
        for (color, &sample) in colors.iter_mut().zip(samples) {
            color[channel] = sample;
        }
    }
    Ok(())
}
