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
mod color_name;
#[cfg(feature = "command")]
pub mod command;
pub mod diagnostic;
mod extent;
mod include;
pub mod paper;
mod parse;
mod resolve;
pub mod source;
mod suggestion;
mod token;
mod word;

use std::path::Path;

use scene::Scene;

pub use diagnostic::{Diagnostic, Severity};
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
}

/// Diagnostics printed in full; the others are counted.
const PRINTED: usize = 100;

/// Compiles the main file of `sources`; the files it includes are added to them.
///
/// There is a scene exactly if no diagnostic is an error.
pub fn compile(sources: &mut SourceMap) -> (Option<Scene>, Vec<Diagnostic>) {
    let mut shared = parse::Shared::new();
    let mut resolver = resolve::Resolver::default();
    if let Some(main) = sources.main() {
        include::read_all(sources, main, &mut resolver, &mut shared);
    }
    resolver.finish(&mut shared);
    let scene = (!shared.diagnostics.has_errors()).then_some(shared.scene);
    (scene, shared.diagnostics.finish())
}

/// Compiles the file at `path`. That it cannot be read is a diagnostic like others.
#[must_use]
pub fn compile_path(path: &Path) -> Compiled {
    Compiled::from(SourceMap::from_path(path))
}

/// Compiles a text. Files it includes are looked for in the working folder.
#[must_use]
pub fn compile_text(text: impl AsRef<[u8]>) -> Compiled {
    Compiled::from(SourceMap::from_reader(Path::new("<text>"), text.as_ref()))
}

impl From<Result<SourceMap, source::SourceError>> for Compiled {
    fn from(sources: Result<SourceMap, source::SourceError>) -> Self {
        match sources {
            Ok(mut sources) => {
                let (scene, diagnostics) = compile(&mut sources);
                Self { scene, diagnostics, sources }
            }
            Err(error) => Self {
                scene: None,
                diagnostics: vec![Diagnostic::nowhere(error.to_string())],
                sources: SourceMap::default(),
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
