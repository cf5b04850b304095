//! The programs of the suite in one: it is the one whose name it is called by.
//!
//! Programs of other packages are not there when the tests of this one run; links to this are.

use std::path::Path;
use std::process::ExitCode;

use idf::command::run_main;

fn main() -> ExitCode {
    let called = std::env::args_os().next().unwrap_or_default();
    match Path::new(&called).file_name().and_then(|name| name.to_str()) {
        Some("icomp") => run_main(icomp::command::run),
        Some("icopy") => run_main(icopy::command::run),
        Some("iencode") => run_main(iencode::command::run),
        Some("ieq") => run_main(ieq::command::run),
        Some("ierr") => run_main(ierr::command::run),
        Some("ilut") => run_main(ilut::command::run),
        Some("ishow") => run_main(ishow::command::run),
        Some("istars") => run_main(istars::command::run),
        Some("portray") => run_main(render::command::run),
        Some("prfarm") => run_main(farm::command::run),
        Some("prlsp") => lsp::command::run(std::env::args_os()),
        Some("prcomp") => compile::command::run(std::env::args_os()),
        // No program of the suite ends so.
        _ => ExitCode::from(100),
    }
}
