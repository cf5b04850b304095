//! Words and names that may stand at a place.

use std::collections::BTreeMap;

use compile::index;
use compile::vocabulary::{Kind, Piece, entries};
use lsp_types::{CompletionItem, CompletionItemKind};

use crate::meaning;
use crate::names::kind_word;
use crate::place::{self, Before};
use crate::scene_text::{Analysis, OpenText};

/// What may stand at a byte, the word under it left aside.
pub(crate) fn at(text: &OpenText, analysis: &Analysis, offset: usize) -> Vec<CompletionItem> {
    let pieces = text.pieces();
    let before: Vec<_> = pieces.iter().filter(|(bytes, _)| bytes.start < offset).collect();
    let mut before = before.as_slice();
    if let Some(((bytes, piece), rest)) = before.split_last() {
        let in_text = *piece == Piece::Text && offset < bytes.end;
        if in_text {
            return Vec::new();
        }
        if bytes.end >= offset && matches!(piece, Piece::Word(_) | Piece::Name) {
            before = rest;
        }
    }
    let gap = before.last().map_or(0, |(bytes, _)| bytes.end);
    let next = pieces.iter().map(|(bytes, _)| bytes.start).find(|start| *start >= offset);
    if in_comment(
        text.text.get(gap..next.unwrap_or(text.text.len())).unwrap_or_default(),
        offset - gap.min(offset),
    ) {
        return Vec::new();
    }
    let before: Vec<Before<'_>> = before
        .iter()
        .map(|(bytes, piece)| Before { text: text.slice(bytes), piece: *piece })
        .collect();
    let wanted = place::wanted(&before);
    let mut items: Vec<CompletionItem> = wanted
        .arguments
        .iter()
        .map(|argument| {
            let detail = format!("an argument; {} if nothing is said", argument.default);
            named(argument.name, &detail, None)
        })
        .collect();
    if let Some(class) = &wanted.class {
        items.extend(parameters(analysis, class));
    }
    let words = entries().into_iter();
    let words = words
        .filter(|entry| wanted.kinds.contains(&entry.kind) || wanted.words.contains(&entry.word));
    items.extend(
        words.map(|entry| item(entry.word, word_kind(entry.kind), meaning::of(entry.word), None)),
    );
    items.extend(names(analysis, &wanted.kinds));
    items
}

/// The name of an argument, with what follows it.
fn named(name: &str, detail: &str, doc: Option<String>) -> CompletionItem {
    let insert_text = Some(format!("{name} = "));
    CompletionItem { insert_text, ..item(name, CompletionItemKind::FIELD, detail, doc) }
}

/// The parameters of a class.
fn parameters(analysis: &Analysis, class: &str) -> Vec<CompletionItem> {
    let definitions = &analysis.index.definitions;
    let is_class = |d: &&index::Definition| d.kind == index::Kind::Class && d.name == class;
    let Some(whole) = definitions.iter().find(is_class).map(|class| class.whole) else {
        return Vec::new();
    };
    let inside = |d: &&index::Definition| {
        d.kind == index::Kind::Parameter && whole.start <= d.span.start && d.span.end <= whole.end
    };
    let own = definitions.iter().filter(inside);
    own.map(|d| named(&d.name, kind_word(d.kind), d.doc.clone())).collect()
}

/// A byte of what stands between two pieces is in a comment.
fn in_comment(gap: &str, at: usize) -> bool {
    let mut rest = 0;
    while let Some(start) = gap.get(rest..).and_then(|gap| gap.find('/')).map(|start| start + rest)
    {
        if start >= at {
            return false;
        }
        let block = gap[start..].starts_with("/*");
        let end = match block {
            true => gap[start + 2..].find("*/").map(|end| start + end + 4),
            false => gap[start..].find('\n').map(|end| start + end),
        };
        match end {
            // The end of its line is in a comment still, what is behind `*/` not.
            Some(end) if at > end || block && at == end => rest = end,
            _ => return true,
        }
    }
    false
}

fn names(analysis: &Analysis, kinds: &[Kind]) -> Vec<CompletionItem> {
    let mut found: BTreeMap<&str, CompletionItem> = BTreeMap::new();
    for definition in &analysis.index.definitions {
        let (wanted, kind) = match definition.kind {
            index::Kind::Class => (Kind::Solid, CompletionItemKind::CLASS),
            index::Kind::Let => (Kind::Number, CompletionItemKind::CONSTANT),
            index::Kind::Parameter | index::Kind::Variable => {
                (Kind::Number, CompletionItemKind::VARIABLE)
            }
            index::Kind::Object => continue,
        };
        if kinds.contains(&wanted) {
            let item =
                item(&definition.name, kind, kind_word(definition.kind), definition.doc.clone());
            found.insert(&definition.name, item);
        }
    }
    found.into_values().collect()
}

fn item(word: &str, kind: CompletionItemKind, detail: &str, doc: Option<String>) -> CompletionItem {
    CompletionItem {
        label: word.to_owned(),
        kind: Some(kind),
        detail: Some(detail.to_owned()),
        documentation: doc.map(lsp_types::Documentation::String),
        ..CompletionItem::default()
    }
}

fn word_kind(kind: Kind) -> CompletionItemKind {
    match kind {
        Kind::Statement | Kind::Clause | Kind::Transform => CompletionItemKind::KEYWORD,
        Kind::Attribute => CompletionItemKind::PROPERTY,
        Kind::Color => CompletionItemKind::COLOR,
        Kind::Solid => CompletionItemKind::CLASS,
        Kind::Texture | Kind::Function => CompletionItemKind::FUNCTION,
        Kind::Mapping => CompletionItemKind::ENUM_MEMBER,
        Kind::Number => CompletionItemKind::CONSTANT,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_are_told_from_what_is_between() {
        for (gap, at, expected) in [
            (" // a\n ", 1, false),
            (" // a\n ", 4, true),
            (" // a\n ", 5, true),
            (" // a\n ", 6, false),
            ("/* a */ ", 3, true),
            ("/* a */ ", 7, false),
            ("/* a */ // b", 11, true),
            ("/* open", 7, true),
            ("   ", 2, false),
        ] {
            assert_eq!(in_comment(gap, at), expected, "{gap:?} {at}");
        }
    }
}
