//! Images composited by the operators of Porter and Duff.
//!
//! Work is in linear light, by each image's transfer, on premultiplied pixels; a sample of the
//! result is that of exact arithmetic, rounded once. The canvas is the union of the images' windows.
//! Where an image has no coverage it covers all of its window; outside of it there is nothing.
//! Coverage in floating point counts within 0 and 1, light as it is.
//!
//! ```
//! use icomp::{Operator, Options, composed};
//! use idf::{Image, Kind, Plane, Samples, Transfer};
//!
//! let pane = |light, coverage| {
//!     let plane = |kind, sample| Plane { kind, samples: Samples::U8(vec![sample]) };
//!     let mut image = Image::new(1, 1, vec![plane(Kind::Grg, light), plane(Kind::Cvg, coverage)])?;
//!     image.properties.transfer = Some(Transfer::Linear);
//!     Ok::<_, idf::ImageError>(image)
//! };
//! let over = Operator::from_name("over").expect("it is in the table");
//! let both = composed(over, &[&pane(100, 102)?, &pane(50, 200)?], &Options::default())?;
//! // Three fifths of what is behind are seen.
//! assert_eq!(both.plane(Kind::Grg), Some(&Samples::U8(vec![130])));
//! assert_eq!(both.plane(Kind::Cvg), Some(&Samples::U8(vec![222])));
//! # Ok::<(), idf::ImageError>(())
//! ```

mod canvas;
pub mod command;
mod kernel;
pub mod operator;
mod plan;
mod store;

use idf::{Image, ImageError, Matte};

pub use operator::{OPERATORS, Operator, Rule, Share};
pub use plan::{Plan, Source};

/// How to composite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// What operators of one image multiply by; 0 or more.
    pub factor: f64,
    /// Composite as programs without linear light do: colours are divided by coverage, stored by
    /// the result's transfer, multiplied by coverage again, and then combined.
    pub stored: bool,
    /// How light and coverage go together in the result. Without it, straight where all images with
    /// coverage are, else premultiplied. `opaque` is always premultiplied.
    pub matte: Option<Matte>,
}

impl Default for Options {
    fn default() -> Self {
        Self { factor: 1.0, stored: false, matte: None }
    }
}

/// The composite of `images`, folded from the left; of one, for an operator of one.
///
/// The result has the light of all, grey only where all are grey, and coverage unless it is 1 whatever
/// the images' coverage is; the depth of the deepest; and the transfer that all have, or else the usual one
/// of its depth. Its background is that of the last image that has one, among those of which
/// something can be left. Lines of history come in the order of the images.
///
/// # Errors
///
/// If an image has only a part of a colour or indices without their table, or the canvas would be
/// larger than an image may be.
pub fn composed(
    operator: &Operator,
    images: &[&Image],
    options: &Options,
) -> Result<Image, ImageError> {
    let images: Vec<Image> =
        images.iter().map(|image| image.resolved()).collect::<Result<_, _>>()?;
    let source = |image| Source { sample: image, window: image.window() };
    let sources: Vec<Source<'_>> = images.iter().map(source).collect();
    let plan = Plan::new(operator, &sources, options)?;
    let rows: Vec<Option<&Image>> = images.iter().map(Some).collect();
    let mut image = plan.band(&rows, 0..plan.size()[1])?;
    image.properties.history =
        images.iter().flat_map(|image| image.properties.history.clone()).collect();
    Ok(image)
}
