//! A starry sky: as many stars of each magnitude as there are, with a band, in the colours of hot bodies.
//!
//! A picture is planes of linear light, row by row. Stars come from a seed and their number alone
//! ([`Catalogue`]), and are spread over pixels by a telescope's profile ([`Profile`]).
//!
//! ```
//! use istars::{Options, light};
//!
//! let options = Options { columns: 64, rows: 48, faintest: 8.0, ..Options::default() };
//! let [red, green, blue] = light(&options)?;
//! assert_eq!(red.len(), 64 * 48);
//! assert!(red.iter().chain(&green).chain(&blue).all(|&light| light >= 0.0));
//! # Ok::<(), istars::TooManyStars>(())
//! ```

mod band;
mod catalogue;
mod color;
pub mod command;
mod profile;
mod random;
mod sky;

pub use band::Band;
pub use catalogue::{
    BRIGHTEST, Catalogue, MOST_STARS, SLOPE, Star, TooManyStars, brighter_than, flux,
};
pub use color::{CLASSES, Class, black_body};
pub use profile::Profile;
pub use sky::{Options, light};
