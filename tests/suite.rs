//! What holds of the suite as a whole.

mod fuzz_bodies;
mod media;
mod oracle;
mod random_csg;
mod readme;
