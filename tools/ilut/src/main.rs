//! The colours that an image gets by with.

use std::process::ExitCode;

fn main() -> ExitCode {
    idf::command::run_main(ilut::command::run)
}
