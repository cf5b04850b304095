//! Pixels of which it is proved what is seen in them.
//!
//! A tile is divided into squares ([`quadtree`]). For each the [`expression`] of what its rays can meet is cut down
//! by the [`outline`]s of solids in the picture, and [`verdict`] tells from the depths at which all rays enter solids and
//! leave them ([`band`]) whether they all see one surface first. What is not proved is divided, down to a 64th of a
//! pixel. [`points`] says where the pixels are looked at: each surface of a pixel by samples of its own, whose weight is
//! the area that was proved. Proofs hold for the square of a pixel, and for rays from one point or parallel ones.
//!
//! Nothing is proved of solids with arguments and of shared classes: they are undecided wherever their boxes are seen.

mod band;
mod expression;
mod outline;
pub(crate) mod picture;
pub(crate) mod points;
mod quadratic;
pub(crate) mod quadtree;
pub(crate) mod sheet;
#[cfg(test)]
mod tests;
mod verdict;
