//! Error against run time, speed, and what was left out.

use std::process::ExitCode;

fn main() -> ExitCode {
    idf::command::run_main(report::command::run)
}
