//! Compiling, and what the compiler has to say.

use std::path::{Path, PathBuf};

use compile::{Compiled, Diagnostic, SourceMap, Span};
use pyo3::prelude::*;
use scene::Scene;

use crate::argument::{detached, value};
use crate::failure;

/// Where a scene comes from.
#[derive(FromPyObject)]
pub(crate) enum Source {
    /// Its text.
    #[pyo3(transparent, annotation = "str")]
    Text(String),
    /// Its file.
    #[pyo3(transparent, annotation = "os.PathLike")]
    File(PathBuf),
}

/// A scene, if there is one, and what was said about it.
pub(crate) struct Outcome {
    pub(crate) scene: Option<Scene>,
    pub(crate) diagnostics: Vec<Diagnostic>,
    pub(crate) sources: SourceMap,
}

/// How every compiled scene begins, whatever its version.
const COMPILED: &str = "portray scene ";

/// Whether a renderer could show the picture of a file.
fn look(path: &Path) -> Result<(), String> {
    idf::exchange::read_picture(path).map(drop).map_err(|error| error.to_string())
}

impl Outcome {
    /// Compiles a description, or reads what is compiled already.
    pub(crate) fn of(source: Source, definitions: Vec<(String, f64)>) -> PyResult<Self> {
        let refuse_definitions = || match definitions.first() {
            Some((name, _)) => Err(value(format!(
                "definitions: {name}: numbers are given when a scene is compiled, and this one is already"
            ))),
            None => Ok(()),
        };
        let compiled = match &source {
            Source::Text(text) if text.starts_with(COMPILED) => {
                refuse_definitions()?;
                return Self::read("<text>", text.as_bytes(), None);
            }
            Source::File(path)
                if path.extension().is_some_and(|end| end.eq_ignore_ascii_case("prc")) =>
            {
                refuse_definitions()?;
                let bytes = std::fs::read(path).map_err(|error| unreadable(path, &error))?;
                return Self::read(&path.display().to_string(), &bytes, path.parent());
            }
            Source::Text(text) => compile::compile_text_with(text, &options(definitions)),
            Source::File(path) => {
                std::fs::File::open(path).map_err(|error| unreadable(path, &error))?;
                compile::compile_path_with(path, &options(definitions))
            }
        };
        let Compiled { scene, diagnostics, sources, .. } = compiled;
        Ok(Self { scene, diagnostics, sources })
    }

    /// A scene that was compiled before. Its pictures are named from its folder.
    fn read(name: &str, bytes: &[u8], folder: Option<&Path>) -> PyResult<Self> {
        let mut scene =
            scene::format::read(bytes).map_err(|error| value(format!("{name}: {error}")))?;
        for image in &mut scene.images {
            name.clone_into(&mut image.source);
            let joined = folder.map(|folder| folder.join(&image.path));
            if let Some(path) = joined.as_deref().and_then(Path::to_str) {
                image.path = path.to_owned();
            }
        }
        let sources = SourceMap::default();
        Ok(Self { scene: Some(scene), diagnostics: Vec::new(), sources })
    }

    /// What was said, as objects of Python.
    pub(crate) fn objects<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        self.diagnostics.iter().map(|diagnostic| object(py, diagnostic, &self.sources)).collect()
    }

    /// That there is no scene, as the exception of it.
    pub(crate) fn error(&self, py: Python<'_>) -> PyErr {
        let report = || {
            let human = |diagnostic: &Diagnostic| diagnostic.human(&self.sources);
            self.diagnostics.iter().map(human).collect::<String>()
        };
        let raised = || {
            let class = py.import("portray._scene")?.getattr("SceneError")?;
            class.call1((report().trim_end(), self.objects(py)?))
        };
        raised().map_or_else(|error| error, PyErr::from_value)
    }
}

fn options(definitions: Vec<(String, f64)>) -> compile::Options {
    compile::Options { definitions, look: Some(look), ..compile::Options::default() }
}

fn unreadable(path: &Path, error: &std::io::Error) -> PyErr {
    failure::system(error, format!("cannot read `{}`: {error}", path.display()))
}

/// A diagnostic as an object of Python.
fn object<'py>(
    py: Python<'py>,
    diagnostic: &Diagnostic,
    sources: &SourceMap,
) -> PyResult<Bound<'py, PyAny>> {
    let module = py.import("portray._scene")?;
    let note = module.getattr("Note")?;
    let notes = diagnostic.notes.iter().map(|found| {
        let (file, line, column, ..) = place(sources, found.span);
        note.call1((&found.message, file, line, column))
    });
    let notes = notes.collect::<PyResult<Vec<_>>>()?;
    let (file, line, column, end_line, end_column) =
        diagnostic.span.map_or_else(Place::default, |span| place(sources, span));
    module.getattr("Diagnostic")?.call1((
        diagnostic.severity.to_string(),
        &diagnostic.message,
        file,
        line,
        column,
        end_line,
        end_column,
        diagnostic.hint.as_deref(),
        pyo3::types::PyTuple::new(py, notes)?,
    ))
}

/// File, line and column of the first character, and line and column behind the last.
type Place = (Option<String>, Option<u32>, Option<u32>, Option<u32>, Option<u32>);

fn place(sources: &SourceMap, span: Span) -> Place {
    let (start, end) = (sources.locate(span), sources.locate_end(span));
    let file = start.as_ref().map(|at| at.path.display().to_string());
    let line = |at: &compile::source::Location<'_>| at.line;
    let column = |at: &compile::source::Location<'_>| at.column;
    (
        file,
        start.as_ref().map(line),
        start.as_ref().map(column),
        end.as_ref().map(line),
        end.as_ref().map(column),
    )
}

/// Definitions that compile as those of a command line.
pub(crate) fn checked(definitions: Vec<(String, f64)>) -> PyResult<Vec<(String, f64)>> {
    for (name, number) in &definitions {
        compile::definition(&format!("{name}={number}"))
            .map_err(|error| value(format!("definitions: {name:?}: {error}")))?;
    }
    Ok(definitions)
}

/// The compiled scene as text, if there is one, and what the compiler has to say.
#[pyfunction]
#[pyo3(name = "compile", signature = (source, definitions))]
pub(crate) fn compile_scene<'py>(
    py: Python<'py>,
    source: Source,
    definitions: Vec<(String, f64)>,
) -> PyResult<(Option<String>, Vec<Bound<'py, PyAny>>)> {
    let definitions = checked(definitions)?;
    let work = || {
        let mut outcome = Outcome::of(source, definitions)?;
        let text = outcome.scene.as_mut().map(|scene| {
            compile::image::rebase(scene, Path::new("."));
            compile::omit::leave_out(scene);
            let mut text = Vec::new();
            scene::format::write(scene, &mut text)?;
            Ok::<_, std::io::Error>(String::from_utf8_lossy(&text).into_owned())
        });
        Ok::<_, PyErr>((text.transpose()?, outcome))
    };
    let (text, outcome) = detached(py, None, work)??;
    Ok((text, outcome.objects(py)?))
}
