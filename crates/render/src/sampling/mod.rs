//! Which points of a picture are looked at, what each counts for, and when there are enough of them.
//!
//! [`pattern`] says which points of a pixel, [`sequence`] makes those that are drawn by lot, [`filter`] is what a sample
//! counts for in the pixels around it. [`subdivision`] divides pixels whose corners differ. [`progressive`]
//! goes on until the error, which [`estimate`] tells, is small enough or the time is over; [`allot`] says which pixels
//! get more. [`audit`] looks at some of them again. [`wish`] is what is said about all that, [`choice`] which of these ways
//! suits a scene of which nothing is said.

pub(crate) mod allot;
pub(crate) mod audit;
pub(crate) mod choice;
#[cfg(feature = "command")]
pub(crate) mod command;
pub(crate) mod disc;
pub(crate) mod display;
pub(crate) mod estimate;
pub(crate) mod filter;
pub(crate) mod lens;
pub(crate) mod pattern;
pub(crate) mod place;
pub(crate) mod progressive;
pub(crate) mod sequence;
pub(crate) mod subdivision;
pub(crate) mod wish;
