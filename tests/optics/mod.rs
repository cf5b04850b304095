//! What holds of light in every picture.

mod coverage;
mod finite;
mod measured;
