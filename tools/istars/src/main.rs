//! A starry sky.

use std::process::ExitCode;

fn main() -> ExitCode {
    idf::command::run_main(istars::command::run)
}
