//! Any image format to any other.

use std::process::ExitCode;

fn main() -> ExitCode {
    idf::command::run_main(icopy::command::run)
}
