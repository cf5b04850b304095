//! Which points of a picture are looked at, what each counts for, and when there are enough of them.
//!
//! [`pattern`] says which points of a pixel, [`sequence`] makes those that are drawn by lot, [`filter`] is what a sample
//! counts for in the pixels around it. [`subdivision`] divides pixels whose corners differ.

#[cfg(feature = "command")]
pub(crate) mod command;
pub(crate) mod display;
pub(crate) mod filter;
pub(crate) mod pattern;
pub(crate) mod place;
pub(crate) mod sequence;
pub(crate) mod subdivision;
