//! The command line of `prlsp`.

use std::ffi::OsString;
use std::io::{self, Write};
use std::process::ExitCode;

use crate::transport;
use clap::Parser;
use clap::error::ErrorKind;

/// Speaks the language server protocol over standard input and output.
#[derive(Debug, Parser)]
#[command(
    name = "prlsp",
    version,
    about = "The scene description language in editors: speaks the language server protocol over standard input and output",
    after_help = "It is started by an editor; editors/README.md says how"
)]
struct Arguments {}

/// Serves until the client says that it exits; exit status 1 where the client breaks off, 2 where the command line is
/// wrong.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    if let Err(error) = Arguments::try_parse_from(arguments) {
        let help = matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion);
        if help && write!(io::stdout(), "{}", error.render()).is_ok() {
            return ExitCode::SUCCESS;
        }
        writeln!(io::stderr(), "prlsp: {}", error.render().to_string().trim_end()).ok();
        return ExitCode::from(if help { 1 } else { 2 });
    }
    match transport::serve() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            writeln!(io::stderr(), "prlsp: error: {error}").ok();
            ExitCode::FAILURE
        }
    }
}
