//! The compiler: a scene description to a compiled scene.

fn main() -> std::process::ExitCode {
    compile::command::run(std::env::args_os())
}
