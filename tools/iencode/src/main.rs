//! An image in the colours of a table.

use std::process::ExitCode;

fn main() -> ExitCode {
    idf::command::run_main(iencode::command::run)
}
