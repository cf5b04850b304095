//! Images composited by the operators of Porter and Duff.

use std::process::ExitCode;

fn main() -> ExitCode {
    idf::command::run_main(icomp::command::run)
}
