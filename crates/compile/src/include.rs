//! Files that include files, read one inside the other without recursion.

use std::collections::HashSet;

use crate::ast::{Spanned, StatementKind};
use crate::cursor::Cursor;
use crate::diagnostic::Diagnostic;
use crate::parse::{Bodies, Parser};
use crate::resolve::Resolver;
use crate::shared::Shared;
use crate::source::{FileId, SourceMap, Span, shown};

/// A file that is being read.
#[derive(Debug)]
struct Open {
    id: FileId,
    cursor: Cursor,
    /// The repeats that the next statement is in.
    bodies: Bodies,
    /// The statement that includes it; nothing for the main file.
    included_at: Option<Span>,
}

/// Files of a chain named in a message.
const NAMED: usize = 8;

/// Takes every statement of the main file and of those it includes to `resolver`.
pub(crate) fn read_all(
    sources: &mut SourceMap,
    main: FileId,
    resolver: &mut Resolver,
    shared: &mut Shared,
) {
    let mut chain = vec![open(sources, main, None, shared)];
    let mut reading = HashSet::from([sources.first(main)]);
    while let Some(file) = chain.last_mut() {
        let included = file.included_at.is_some();
        let mut parser = Parser::new(&mut file.cursor, shared);
        let Some(statement) = parser.next_statement(&mut file.bodies) else {
            reading.remove(&sources.first(file.id));
            chain.pop();
            continue;
        };
        if let StatementKind::Include(name) = statement.kind {
            match include(sources, &name, &chain, &reading) {
                Ok(id) => {
                    reading.insert(sources.first(id));
                    chain.push(open(sources, id, Some(name.span), shared));
                }
                Err(error) => {
                    shared.diagnostics.push(error);
                    shared.incomplete = true;
                }
            }
        } else {
            resolver.statement(statement, included, shared);
        }
    }
}

fn open(sources: &SourceMap, id: FileId, included_at: Option<Span>, shared: &mut Shared) -> Open {
    let (text, base) = sources.text(id);
    let mut cursor = Cursor::new(text, base, &mut shared.diagnostics);
    if let Some(first) = cursor.compiled_scene() {
        let found = "expected a scene description, found a compiled scene";
        let hint = "portray renders it as it is; prcomp reads the .sdl file it was made from";
        shared.diagnostics.push(Diagnostic::error(first, found).hint(hint.to_owned()));
        shared.incomplete = true;
        cursor.end();
    }
    Open { id, cursor, bodies: Bodies::default(), included_at }
}

/// The file that `name` means in the last file of `chain`.
fn include(
    sources: &mut SourceMap,
    name: &Spanned<String>,
    chain: &[Open],
    reading: &HashSet<FileId>,
) -> Result<FileId, Diagnostic> {
    let failed = |message: String| {
        let places = chain.iter().rev().filter_map(|file| file.included_at);
        places.fold(Diagnostic::error(name.span, message), |error, place| {
            error.note(place, "included from here")
        })
    };
    let Some(last) = chain.last() else { return Err(failed("no file includes this".to_owned())) };
    let id = sources.include(&name.value, last.id).map_err(|error| failed(error.to_string()))?;
    if !reading.contains(&sources.first(id)) {
        return Ok(id);
    }
    let start = chain.iter().position(|file| sources.first(file.id) == sources.first(id));
    let circle = &chain[start.unwrap_or_default()..];
    let mut names: Vec<String> = circle
        .iter()
        .take(NAMED)
        .map(|file| format!("`{}`", shown(sources.path(file.id))))
        .collect();
    if circle.len() > NAMED {
        names.push("…".to_owned());
    }
    names.push(format!("`{}`", shown(sources.path(id))));
    Err(failed(format!("a file cannot include itself: {}", names.join(" includes "))))
}
