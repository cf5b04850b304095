//! What holds of light in every picture.

mod coverage;
mod finite;
mod measured;
mod normals;
mod words;
