//! An independent way to the same picture: double-double arithmetic, whole lines, the expression as written. It reads
//! the scene's data and shares no code with what it checks.

pub(crate) mod author;
mod body;
pub(crate) mod compare;
mod dd;
mod finish;
mod form;
mod line;
mod paint;
mod place;
mod solid;
mod tests;
pub(crate) mod trace;
