//! Names: where they are given, where they are used, and the outline of a text.

use std::collections::BTreeMap;

use compile::Span;
use compile::index::{Definition, Kind};
use lsp_types::{DocumentSymbol, Location, SymbolKind};

use crate::position::{Encoding, Lines};
use crate::scene_text::{Analysis, OpenText, uri_of};

impl Analysis {
    /// A place in a file, as the protocol has it.
    pub(crate) fn location(
        &self,
        span: Span,
        open: &BTreeMap<String, OpenText>,
        encoding: Encoding,
    ) -> Option<Location> {
        let (path, text, bytes) = self.sources.within(span)?;
        Some(Location::new(uri_of(path, open)?, Lines::new(text, encoding).range(bytes)))
    }

    /// The name at a byte of the main file: what it names, and its own place.
    pub(crate) fn name_at(&self, offset: usize) -> Option<(&Definition, Span)> {
        let offset = u32::try_from(offset).ok()?;
        let holds = |span: Span| span.start <= offset && offset <= span.end;
        let used = self.index.references.iter().find(|reference| holds(reference.span));
        if let Some(reference) = used {
            return Some((self.index.definitions.get(reference.definition)?, reference.span));
        }
        let given = self.index.definitions.iter().find(|definition| holds(definition.span))?;
        Some((given, given.span))
    }

    /// Every place of the name at a byte; with `declaration` that where it is given, too.
    pub(crate) fn places(&self, offset: usize, declaration: bool) -> Vec<Span> {
        let Some((definition, _)) = self.name_at(offset) else { return Vec::new() };
        let index = self.index.definitions.iter().position(|other| other == definition);
        let used = self.index.references.iter().filter(|r| Some(r.definition) == index);
        let given = declaration.then_some(definition.span);
        given.into_iter().chain(used.map(|reference| reference.span)).collect()
    }

    /// Classes, objects and numbers of the main file.
    pub(crate) fn outline(&self, text: &OpenText, encoding: Encoding) -> Vec<DocumentSymbol> {
        let lines = Lines::new(&text.text, encoding);
        let own = self.index.definitions.iter().filter(|definition| {
            (definition.whole.end as usize) <= text.text.len()
                && !matches!(definition.kind, Kind::Parameter | Kind::Variable)
        });
        let bytes = |span: Span| span.start as usize..span.end as usize;
        own.map(|definition| {
            #[expect(deprecated, reason = "the field has to be there")]
            DocumentSymbol {
                name: text.slice(&bytes(definition.span)).to_owned(),
                detail: definition.doc.clone(),
                kind: symbol_kind(definition.kind),
                tags: None,
                deprecated: None,
                range: lines.range(bytes(definition.whole.to(definition.span))),
                selection_range: lines.range(bytes(definition.span)),
                children: None,
            }
        })
        .collect()
    }
}

fn symbol_kind(kind: Kind) -> SymbolKind {
    match kind {
        Kind::Class => SymbolKind::CLASS,
        Kind::Object => SymbolKind::OBJECT,
        Kind::Let => SymbolKind::CONSTANT,
        Kind::Parameter | Kind::Variable => SymbolKind::VARIABLE,
    }
}

/// The word for a kind of name.
pub(crate) fn kind_word(kind: Kind) -> &'static str {
    match kind {
        Kind::Class => "class",
        Kind::Object => "object",
        Kind::Let => "number",
        Kind::Parameter => "parameter",
        Kind::Variable => "variable of a repeat",
    }
}
