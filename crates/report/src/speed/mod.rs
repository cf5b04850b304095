//! Seconds, rays and memory of scenes as they grow, and what the paper claims of its ways of tracing.
//!
//! Each scene is compiled, built and traced in a process of its own, so that its memory is its own too.

pub mod case;
pub mod command;
pub mod measure;
pub mod sheet;
