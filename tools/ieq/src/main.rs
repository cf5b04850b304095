//! The tones of an image.

use std::process::ExitCode;

fn main() -> ExitCode {
    idf::command::run_main(ieq::command::run)
}
