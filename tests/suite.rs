//! What holds of the suite as a whole.

mod classes;
mod determinism;
mod editors;
mod fuzz_bodies;
mod gallery;
mod grammar;
mod language;
mod leaving_out;
mod listing;
mod malformed;
mod media;
mod optics;
mod oracle;
mod page;
mod peers;
mod python;
mod radiance;
mod random_csg;
mod readme;
mod shell;
mod stability;
mod station;
mod support;
mod tasks;
mod tidy;
mod toolkit;
