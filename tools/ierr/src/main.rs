//! How far one image is from another.

use std::process::ExitCode;

fn main() -> ExitCode {
    idf::command::run_main(ierr::command::run)
}
