//! The renderer: a scene to an image.

fn main() -> std::process::ExitCode {
    idf::command::run_main(render::command::run)
}
