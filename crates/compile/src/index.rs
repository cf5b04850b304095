//! Where names are given and where they are used, for editors.
//!
//! ```
//! use std::path::Path;
//! let text = "// Round.\nclass ball (r) is sphere scale r\nobject is ball (2)";
//! let mut sources = compile::SourceMap::from_reader(Path::new("a.sdl"), text.as_bytes())?;
//! let (index, diagnostics) = compile::index(&mut sources);
//! assert!(diagnostics.is_empty());
//! let ball = &index.definitions[0];
//! assert_eq!((ball.name.as_str(), ball.kind), ("ball", compile::index::Kind::Class));
//! assert_eq!(ball.doc.as_deref(), Some("Round."));
//! assert_eq!(index.references.iter().filter(|r| r.definition == 0).count(), 1);
//! # Ok::<(), compile::source::SourceError>(())
//! ```

use std::collections::{BTreeMap, BTreeSet};

use crate::source::{SourceMap, Span};

/// What a name is the name of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A class.
    Class,
    /// An object.
    Object,
    /// A number: `let`.
    Let,
    /// A parameter of a class.
    Parameter,
    /// The variable of a repeat.
    Variable,
}

/// A place where a name is given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Definition {
    /// In lower case.
    pub name: String,
    /// What it names.
    pub kind: Kind,
    /// The name. [`SourceMap::locate`] tells file, line and column.
    pub span: Span,
    /// The statement, from its keyword to its last token; of a parameter and of a variable the name.
    pub whole: Span,
    /// The comment that ends on the line above the statement, or stands behind it on its line, without its marks.
    pub doc: Option<String>,
}

/// A place where a name is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reference {
    /// The name.
    pub span: Span,
    /// Index of what it names in [`Index::definitions`].
    pub definition: usize,
}

/// The names of a scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Index {
    /// In source order. A file that is included several times has its names as often.
    pub definitions: Vec<Definition>,
    /// In source order. Only names that are known are here.
    pub references: Vec<Reference>,
}

/// Names as they are met.
#[derive(Debug, Default)]
pub(crate) struct Record(Option<Names>);

#[derive(Debug, Default)]
struct Names {
    /// By the place of the name; a body that is read several times names its own each time.
    definitions: BTreeMap<Span, (Kind, String, Span)>,
    /// Where a name is used, and the place it is given.
    references: BTreeSet<(Span, Span)>,
}

impl Record {
    /// A record that keeps what it is told.
    pub(crate) fn wanted() -> Self {
        Self(Some(Names::default()))
    }

    pub(crate) fn is_wanted(&self) -> bool {
        self.0.is_some()
    }

    pub(crate) fn define(&mut self, kind: Kind, name: &str, span: Span, whole: Span) {
        if let Some(names) = &mut self.0 {
            names.definitions.entry(span).or_insert_with(|| (kind, name.to_owned(), whole));
        }
    }

    /// The statement that names something goes on to the end of `whole`.
    pub(crate) fn extend(&mut self, span: Span, whole: Span) {
        if let Some(names) = &mut self.0
            && let Some((_, _, known)) = names.definitions.get_mut(&span)
        {
            *known = known.to(whole);
        }
    }

    /// The name at `span` is the one given at `definition`.
    pub(crate) fn refer(&mut self, span: Span, definition: Span) {
        if let Some(names) = &mut self.0 {
            names.references.insert((span, definition));
        }
    }

    pub(crate) fn finish(self, sources: &SourceMap) -> Index {
        let names = self.0.unwrap_or_default();
        let places: Vec<Span> = names.definitions.keys().copied().collect();
        let definitions = names.definitions.into_iter().map(|(span, (kind, name, whole))| {
            let doc = doc(sources, whole);
            Definition { name, kind, span, whole, doc }
        });
        let references = names.references.into_iter().filter_map(|(span, definition)| {
            let definition = places.binary_search(&definition).ok()?;
            Some(Reference { span, definition })
        });
        Index { definitions: definitions.collect(), references: references.collect() }
    }
}

/// The comment about a statement: the lines above it, or else the end of its last line.
fn doc(sources: &SourceMap, whole: Span) -> Option<String> {
    let (bytes, line_start, range) = sources.surroundings(whole)?;
    let mut lines = Vec::new();
    let mut above = bytes.get(..line_start)?;
    // Comments of a line each, bottom up; or one block.
    while let Some(line) = last_line(above) {
        let text = std::str::from_utf8(line).ok()?.trim();
        let Some(comment) = text.strip_prefix("//") else {
            let block = text.strip_suffix("*/").filter(|_| lines.is_empty());
            if let Some(block) = block.and_then(|text| Some(text.split_once("/*")?.1)) {
                lines.push(block.trim().to_owned());
            }
            break;
        };
        lines.push(comment.trim().to_owned());
        above = &above[..above.len() - line.len() - 1];
    }
    if lines.is_empty() {
        let rest = bytes.get(range.end..)?.split(|&byte| byte == b'\n').next()?;
        let rest = std::str::from_utf8(rest).ok()?.trim();
        let comment = rest.strip_prefix("//")?;
        lines.push(comment.trim().to_owned());
    }
    lines.reverse();
    Some(lines.join("\n"))
}

/// The last whole line of a text that ends with a line end.
fn last_line(text: &[u8]) -> Option<&[u8]> {
    let text = text.strip_suffix(b"\n")?;
    text.rsplit(|&byte| byte == b'\n').next()
}
