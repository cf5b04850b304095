//! An independent way to the same picture: double-double arithmetic, whole lines, the expression as written. It reads
//! the scene's data and shares no code with what it checks.

pub(crate) mod author;
pub(crate) mod body;
pub(crate) mod compare;
pub(crate) mod dd;
pub(crate) mod finish;
mod form;
mod line;
mod paint;
pub(crate) mod place;
mod solid;
#[cfg(test)]
mod tests;
pub(crate) mod trace;
