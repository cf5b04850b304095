//! Scene description language to compiled scene.
//!
//! Text becomes tokens, tokens become one statement at a time, and each statement is taken into the scene before the
//! next is read, so that a scene is held once and not twice. After an error reading goes on at the next statement:
//! one run reports everything. Nothing here recurses, so input cannot exhaust the stack.
//!
//! ```
//! let compiled = compile::compile_text("camera at (0, 0, 5)  object is red sphere - block at (1, 1, 1)");
//! let scene = compiled.scene.expect("no errors");
//! assert_eq!(scene.objects.len(), 1);
//!
//! let compiled = compile::compile_text("object is glas  class glass is cone");
//! assert!(compiled.scene.is_none());
//! assert!(compiled.report().starts_with("<text>:1:11: error: unknown class `glas`"));
//! ```

mod ast;
pub mod camera;
mod color_name;
#[cfg(feature = "command")]
pub mod command;
mod cursor;
pub mod diagnostic;
mod extent;
mod habit;
pub mod image;
mod include;
pub mod index;
pub mod layout;
pub mod omit;
pub mod paper;
mod parse;
mod precision;
mod resolve;
mod shared;
pub mod source;
mod suggestion;
mod survey;
mod token;
mod value;
pub mod vocabulary;
mod word;

use std::path::Path;

use scene::Scene;

pub use diagnostic::{Diagnostic, Severity};
pub use index::Index;
use shared::Shared;
pub use source::{SourceMap, Span};

/// What comes of a run.
#[derive(Debug)]
pub struct Compiled {
    /// The scene; nothing if there are errors.
    pub scene: Option<Scene>,
    /// Errors and warnings in source order.
    pub diagnostics: Vec<Diagnostic>,
    /// The files read.
    pub sources: SourceMap,
    /// Where each object of the scene is written, in its order; several are at one place where a repeat makes them.
    pub objects: Vec<Span>,
}

/// Diagnostics printed in full; the others are counted.
const PRINTED: usize = 100;

/// Looks into the file of a picture: what is wrong with it, with its path.
pub type Look = fn(&Path) -> Result<(), String>;

/// What may be said about a run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Numbers that replace those of `let` statements outside of every body, by name in any case; `frame` is the
    /// number of the picture in a sequence. A name that no `let` has is an error.
    pub definitions: Vec<(String, f64)>,
    /// How many turns a repeat may take, and how many solids all repeats and all classes with parameters may make.
    pub max_primitives: u64,
    /// Looks into every picture that is named. Without it pictures have to be there, and may hold anything: this library
    /// knows no formats.
    pub look: Option<Look>,
}

impl Default for Options {
    fn default() -> Self {
        Self { definitions: Vec::new(), max_primitives: paper::LIMIT, look: None }
    }
}

/// A definition as command lines have it, `NAME=VALUE`.
///
/// # Errors
///
/// What was expected, when it is not a name and a number.
pub fn definition(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE")?;
    let (name, value) = (name.trim(), value.trim());
    let mut bytes = name.bytes();
    let begins = bytes.next().is_some_and(|byte| byte.is_ascii_alphabetic() || byte == b'_');
    if !begins || !bytes.all(|byte| byte.is_ascii_alphanumeric() || byte == b'_') {
        return Err(format!("expected a name before `=`, found `{name}`"));
    }
    match value.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok((name.to_owned(), number)),
        _ => Err(format!("expected a number after `=`, found `{value}`")),
    }
}

/// Compiles the main file of `sources`; the files it includes are added to them.
///
/// There is a scene exactly if no diagnostic is an error.
pub fn compile(sources: &mut SourceMap, options: &Options) -> (Option<Scene>, Vec<Diagnostic>) {
    let (scene, diagnostics, _) = compile_with_places(sources, options);
    (scene, diagnostics)
}

/// [`compile`], and where each object is written.
fn compile_with_places(
    sources: &mut SourceMap,
    options: &Options,
) -> (Option<Scene>, Vec<Diagnostic>, Vec<Span>) {
    let mut shared = Shared::new(options);
    run(sources, &mut shared);
    let scene = (!shared.diagnostics.has_errors()).then_some(shared.scene);
    (scene, shared.diagnostics.finish(), shared.object_spans)
}

/// Where the names of the main file of `sources`, and of the files it includes, are given and used, and what a
/// compilation has to say. Bodies of repeats are read a few thousand times, not as often as is written.
pub fn index(sources: &mut SourceMap) -> (Index, Vec<Diagnostic>) {
    let mut shared = Shared::new(&Options::default());
    shared.record = index::Record::wanted();
    run(sources, &mut shared);
    (shared.record.finish(sources), shared.diagnostics.finish())
}

fn run(sources: &mut SourceMap, shared: &mut Shared) {
    let mut resolver = resolve::Resolver::default();
    if let Some(main) = sources.main() {
        include::read_all(sources, main, &mut resolver, shared);
        image::resolve(sources, shared);
    }
    resolver.finish(shared);
}

/// A number as a message shows it.
fn number_text(number: f64) -> String {
    let size = number.abs();
    if size > 0.0 && !(1e-5..1e16).contains(&size) {
        format!("{number:e}")
    } else {
        format!("{number}")
    }
}

/// Compiles the file at `path`. That it cannot be read is a diagnostic like others.
#[must_use]
pub fn compile_path(path: &Path) -> Compiled {
    compile_path_with(path, &Options::default())
}

/// Compiles the file at `path` with options.
#[must_use]
pub fn compile_path_with(path: &Path, options: &Options) -> Compiled {
    Compiled::of(SourceMap::from_path(path), options)
}

/// Compiles a text with options. Files it includes are looked for in the working folder.
#[must_use]
pub fn compile_text_with(text: impl AsRef<[u8]>, options: &Options) -> Compiled {
    Compiled::of(SourceMap::from_reader(Path::new("<text>"), text.as_ref()), options)
}

/// Compiles a text. Files it includes are looked for in the working folder.
#[must_use]
pub fn compile_text(text: impl AsRef<[u8]>) -> Compiled {
    compile_text_with(text, &Options::default())
}

impl Compiled {
    /// Compiles sources, if they could be had.
    pub(crate) fn of(sources: Result<SourceMap, source::SourceError>, options: &Options) -> Self {
        match sources {
            Ok(mut sources) => {
                let (scene, diagnostics, objects) = compile_with_places(&mut sources, options);
                Self { scene, diagnostics, sources, objects }
            }
            Err(error) => Self {
                scene: None,
                diagnostics: vec![Diagnostic::nowhere(error.to_string())],
                sources: SourceMap::default(),
                objects: Vec::new(),
            },
        }
    }
}

impl Compiled {
    /// All diagnostics as text, each with its source line; empty if there are none.
    #[must_use]
    pub fn report(&self) -> String {
        self.printed(|_| true)
    }

    /// The errors as text.
    #[must_use]
    pub fn error_report(&self) -> String {
        self.printed(|severity| severity == Severity::Error)
    }

    fn printed(&self, wanted: impl Fn(Severity) -> bool) -> String {
        let wanted: Vec<&Diagnostic> =
            self.diagnostics.iter().filter(|diagnostic| wanted(diagnostic.severity)).collect();
        let mut text = String::new();
        for diagnostic in wanted.iter().take(PRINTED) {
            text.push_str(&diagnostic.human(&self.sources));
        }
        if wanted.len() > PRINTED {
            text.push_str(&format!("and {} more\n", wanted.len() - PRINTED));
        }
        text
    }
}
