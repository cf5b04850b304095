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
#[expect(dead_code, unused_imports, reason = "the program that writes the page uses the rest")]
mod stability;
mod station;
mod support;
mod tasks;
mod tidy;
mod toolkit;
