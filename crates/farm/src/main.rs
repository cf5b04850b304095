//! Pictures and sequences over many processes or nodes.

use std::process::ExitCode;

fn main() -> ExitCode {
    idf::command::run_main(farm::command::run)
}
