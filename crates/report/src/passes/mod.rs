//! What leaving out saves, pass by pass: each scene with all passes, with none, and with all but one, in turn.

pub mod command;
pub mod measure;
pub mod sheet;
