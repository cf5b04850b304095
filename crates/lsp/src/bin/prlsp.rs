//! The program `prlsp`.

fn main() -> std::process::ExitCode {
    lsp::command::run(std::env::args_os())
}
