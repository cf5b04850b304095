//! What `portray` is given: a compiled scene, or a description, which is compiled.

use std::error::Error;
use std::io::Read;
use std::path::Path;

use compile::SourceMap;
use idf::command::{UsageError, is_stream};
use scene::Scene;

use crate::LoadError;
use crate::command::Arguments;

/// How every compiled scene begins, whatever its version.
const COMPILED: &[u8] = b"portray scene ";

/// What is said of a scene whose errors have been shown.
pub(crate) fn has_errors(scene: &Path) -> String {
    format!("{}: the scene has errors", scene.display())
}

/// The statement that names a picture which cannot be shown, if the scene was compiled from `sources`.
pub(crate) fn pointed_at(error: &LoadError, sources: &SourceMap) -> Option<String> {
    let LoadError::Image(failure) = error else { return None };
    compile::image::report(sources, &failure.file, &failure.reason)
}

/// Reads a compiled scene, or compiles a description in this process; with the description's sources. Warnings are
/// shown if `warns`, and errors always.
///
/// # Errors
///
/// If it cannot be read, or is no scene; errors of a description have been shown.
pub fn read_scene(
    arguments: &Arguments,
    warns: bool,
) -> Result<(Scene, SourceMap), Box<dyn Error>> {
    let Arguments { scene: path, talk, .. } = arguments;
    let bytes = if is_stream(path) {
        let mut bytes = Vec::new();
        std::io::stdin().lock().take(compile::source::SOURCE_LIMIT + 1).read_to_end(&mut bytes)?;
        Some(bytes)
    } else if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("prc")) {
        Some(std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?)
    } else {
        None
    };
    let options = compile_options(arguments);
    let compiled = match bytes {
        Some(bytes) if !is_stream(path) || bytes.starts_with(COMPILED) => {
            if let Some((name, _)) = options.definitions.first() {
                let message = "numbers are given when a scene is compiled, and this one is already";
                return Err(UsageError(format!("-D {name}: {message}")).into());
            }
            let mut scene = scene::format::read(&bytes)
                .map_err(|error| format!("{}: {error}", path.display()))?;
            name_from_working_folder(&mut scene, path);
            return Ok((scene, SourceMap::default()));
        }
        Some(bytes) => compile::compile_text_with(bytes, &options),
        None => compile::compile_path_with(path, &options),
    };
    if compiled.sources.paths().next().is_none() {
        // There is no text to point into.
        let said: Vec<&str> = compiled.diagnostics.iter().map(|d| d.message.as_str()).collect();
        return Err(said.join("; ").into());
    }
    let report =
        if talk.is_quiet() || !warns { compiled.error_report() } else { compiled.report() };
    idf::command::print(&report);
    let scene = compiled.scene.ok_or_else(|| has_errors(path))?;
    Ok((scene, compiled.sources))
}

/// How descriptions are compiled.
pub(crate) fn compile_options(arguments: &Arguments) -> compile::Options {
    compile::Options {
        definitions: arguments.definitions.clone(),
        max_primitives: arguments.max_primitives,
        // Pictures are read once, when the scene is loaded.
        look: None,
    }
}

/// Paths in a compiled scene begin at its own folder, and it names them itself.
fn name_from_working_folder(scene: &mut Scene, path: &Path) {
    let folder = if is_stream(path) { None } else { path.parent() };
    for image in &mut scene.images {
        image.source = path.display().to_string();
        // A folder that is no text is left to the system: its pictures are not found.
        if let Some(joined) =
            folder.and_then(|folder| folder.join(&image.path).to_str().map(str::to_owned))
        {
            image.path = joined;
        }
    }
}
