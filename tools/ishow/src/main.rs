//! An image in the terminal.

use std::process::ExitCode;

fn main() -> ExitCode {
    idf::command::run_main(ishow::command::run)
}
