//! What holds of the suite as a whole.

mod classes;
mod determinism;
mod fuzz_bodies;
mod gallery;
mod grammar;
mod language;
mod listing;
mod malformed;
mod media;
mod optics;
mod oracle;
mod radiance;
mod random_csg;
mod readme;
mod shell;
mod stability;
mod support;
mod tidy;
mod toolkit;
