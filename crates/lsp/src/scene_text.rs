//! A text that is open, and what the compiler makes of it.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use compile::vocabulary::{Piece, pieces};
use compile::{Diagnostic, Index, SourceMap, Span};
use lsp_types::{TextDocumentContentChangeEvent, Uri};

use crate::position::{Encoding, Lines};
use crate::uri;

/// A text that the client has open.
#[derive(Clone, Debug)]
pub(crate) struct OpenText {
    /// As the client names it.
    pub(crate) uri: Uri,
    pub(crate) path: PathBuf,
    pub(crate) version: i32,
    pub(crate) text: String,
}

/// What the compiler makes of a text.
#[derive(Debug)]
pub(crate) struct Analysis {
    pub(crate) sources: SourceMap,
    pub(crate) index: Index,
    pub(crate) diagnostics: Vec<Diagnostic>,
}

impl OpenText {
    /// Changes the text, in order. A range that is none is moved to one.
    pub(crate) fn change(
        &mut self,
        changes: Vec<TextDocumentContentChangeEvent>,
        encoding: Encoding,
    ) {
        for change in changes {
            match change.range {
                None => self.text = change.text,
                Some(range) => {
                    let lines = Lines::new(&self.text, encoding);
                    let start = lines.offset(range.start);
                    let end = lines.offset(range.end).max(start);
                    self.text.replace_range(start..end, &change.text);
                }
            }
        }
    }

    /// Compiles the text; the other texts that are open stand for the files that it includes. `None` if it is too long.
    pub(crate) fn analysis(&self, others: &BTreeMap<String, Self>) -> Option<Analysis> {
        let mut sources = self.sources()?;
        for other in others.values() {
            sources.set_unsaved(&other.path, other.text.as_str());
        }
        let (index, diagnostics) = compile::index(&mut sources);
        Some(Analysis { sources, index, diagnostics })
    }

    /// The text alone.
    pub(crate) fn sources(&self) -> Option<SourceMap> {
        SourceMap::from_reader(&self.path, self.text.as_bytes()).ok()
    }

    /// Words and signs, each with its bytes.
    pub(crate) fn pieces(&self) -> Vec<(Range<usize>, Piece)> {
        let Some(sources) = self.sources() else { return Vec::new() };
        let bytes = |span: Span| span.start as usize..span.end as usize;
        pieces(&sources).into_iter().map(|(span, piece)| (bytes(span), piece)).collect()
    }

    pub(crate) fn slice(&self, bytes: &Range<usize>) -> &str {
        self.text.get(bytes.clone()).unwrap_or_default()
    }

    /// The word at a byte or just before it.
    pub(crate) fn word_at(&self, offset: usize) -> Option<(Range<usize>, Piece)> {
        let word = |piece: Piece| matches!(piece, Piece::Word(_) | Piece::Name | Piece::Text);
        let pieces = self.pieces().into_iter();
        let mut touching = pieces
            .filter(|(bytes, piece)| word(*piece) && (bytes.start..=bytes.end).contains(&offset));
        let first = touching.next()?;
        // Of two that touch the later one begins here.
        Some(touching.next().unwrap_or(first))
    }
}

/// The URI of a file, as the client names it if it is open.
pub(crate) fn uri_of(path: &Path, open: &BTreeMap<String, OpenText>) -> Option<Uri> {
    let identity = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let wanted = identity(path);
    let known = open.values().find(|text| text.path == path || identity(&text.path) == wanted);
    known.map(|text| text.uri.clone()).or_else(|| uri::from_path(&wanted))
}
