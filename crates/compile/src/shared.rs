//! What all files of a run share, and how much may be made of what is read several times.

use std::collections::HashMap;

use scene::Scene;

use crate::ast::Spanned;
use crate::diagnostic::{Diagnostic, Diagnostics, Note};
use crate::image::ImageNames;
use crate::index::{Kind, Record};
use crate::parse::AttributesCache;
use crate::resolve::Classes;
use crate::source::Span;
use crate::token::{Symbol, Symbols};
use crate::value::Values;
use crate::{Look, Options, number_text};

/// What all files of a run share.
#[derive(Debug)]
pub(crate) struct Shared {
    pub(crate) symbols: Symbols,
    pub(crate) diagnostics: Diagnostics,
    pub(crate) attributes: AttributesCache,
    pub(crate) images: ImageNames,
    pub(crate) look: Option<Look>,
    pub(crate) classes: Classes,
    pub(crate) values: Values,
    pub(crate) scene: Scene,
    /// Where each object is written.
    pub(crate) object_spans: Vec<Span>,
    /// Where each light is written.
    pub(crate) light_spans: Vec<Span>,
    /// A file is missing, and with it any number of names.
    pub(crate) incomplete: bool,
    /// Not 0 while a body is read of which nothing is made.
    pub(crate) checking: u32,
    /// The turns and the classes that what is read is part of, outermost first.
    pub(crate) uses: Vec<Use>,
    pub(crate) budget: Budget,
    pub(crate) record: Record,
    /// Bodies were not read as often as is written.
    pub(crate) cut: bool,
    /// The number of the picture in a sequence.
    pub(crate) frame: f64,
    /// Numbers that replace those of `let`, and whether they did.
    pub(crate) given: HashMap<Symbol, (f64, bool)>,
}

/// Why a place is read again.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Use {
    /// A turn of a repeat.
    Turn { variable: Symbol, span: Span, number: f64 },
    /// A class with parameters.
    Class { name: Symbol, span: Span },
}

impl Use {
    pub(crate) fn note(self, symbols: &Symbols) -> Note {
        let (span, message) = match self {
            Self::Turn { variable, span, number } => {
                let name = symbols.text(variable);
                (span, format!("in the turn with {name} = {}", number_text(number)))
            }
            Self::Class { name, span } => {
                (span, format!("in this use of `{}`", symbols.text(name)))
            }
        };
        Note { span, message }
    }
}

/// Places named in an error, innermost first.
const USES_NAMED: usize = 8;

impl Shared {
    pub(crate) fn new(options: &Options) -> Self {
        let mut symbols = Symbols::new();
        let mut given = HashMap::new();
        let mut frame = 0.0;
        for (name, number) in &options.definitions {
            if name.eq_ignore_ascii_case("frame") {
                frame = *number;
            } else {
                given.insert(symbols.intern(name), (*number, false));
            }
        }
        Self {
            symbols,
            diagnostics: Diagnostics::default(),
            attributes: AttributesCache::default(),
            images: ImageNames::default(),
            look: options.look,
            classes: Classes::default(),
            values: Values::default(),
            scene: Scene::default(),
            object_spans: Vec::new(),
            light_spans: Vec::new(),
            incomplete: false,
            checking: 0,
            uses: Vec::new(),
            budget: Budget::new(options.max_primitives),
            record: Record::default(),
            cut: false,
            frame,
            given,
        }
    }

    /// Reports a diagnostic, with the turn and the class it came up in.
    pub(crate) fn report(&mut self, mut diagnostic: Diagnostic) {
        if self.checking == 0 {
            diagnostic.notes.extend(self.use_notes());
        }
        self.diagnostics.push(diagnostic);
    }

    /// The turns and the classes that what is read is part of, innermost first.
    pub(crate) fn use_notes(&self) -> Vec<Note> {
        let uses = self.uses.iter().rev().take(USES_NAMED);
        uses.map(|place| place.note(&self.symbols)).collect()
    }

    /// Remembers where something is named, for those who ask for an index.
    pub(crate) fn define(&mut self, kind: Kind, name: Spanned<Symbol>, whole: Span) {
        if self.record.is_wanted() {
            self.record.define(kind, self.symbols.text(name.value), name.span, whole);
        }
    }

    /// True if what is read is for an editor, and bodies have been read often enough for what it asks.
    pub(crate) fn is_cut(&mut self) -> bool {
        self.cut |= self.record.is_wanted() && self.budget.read > EDITED;
        self.cut
    }

    /// Asks for one more solid, object or light; false if it comes from a body that has made too many.
    pub(crate) fn may_make(&mut self) -> bool {
        self.uses.is_empty() || self.checking > 0 || self.budget.may_make()
    }
}

/// How much bodies that are read several times may make, and how much of them may be read.
#[derive(Debug)]
pub(crate) struct Budget {
    limit: u64,
    made: u64,
    read: u64,
    /// Turns that made nothing, and what they cost.
    idle: Idle,
}

/// Turns that made nothing.
#[derive(Clone, Copy, Debug, Default)]
struct Idle {
    turns: u64,
    cost: u64,
}

/// Bytes that may be read again for each solid that may be made: work is bounded, too, not only what comes of it.
const BYTES_FOR_EACH: u64 = 256;

/// Bytes of turns that make nothing, for each solid that may be made.
const IDLE: u64 = 10;

/// The same for each solid that others have made: where few of many numbers fit, most turns do so.
const IDLE_FOR_EACH: u64 = 1 << 14;

/// Bytes that are read again for an editor, some hundredths of a second: names and mistakes are in the first turns.
const EDITED: u64 = 1 << 18;

/// What a turn costs beside its text, in the time of as many bytes.
const TURN: u64 = 16;

impl Budget {
    fn new(limit: u64) -> Self {
        Self { limit, made: 0, read: 0, idle: Idle::default() }
    }

    pub(crate) fn limit(&self) -> u64 {
        self.limit
    }

    fn may_make(&mut self) -> bool {
        self.made = self.made.saturating_add(1);
        self.made <= self.limit
    }

    pub(crate) fn may_read(&self, bytes: u64) -> bool {
        self.read.saturating_add(bytes) <= self.limit.saturating_mul(BYTES_FOR_EACH)
    }

    pub(crate) fn read(&mut self, bytes: u64) {
        self.read = self.read.saturating_add(bytes);
    }

    /// How much has been made.
    pub(crate) fn made(&self) -> u64 {
        self.made
    }

    /// A turn of so many bytes has made nothing; false if there are too many of them. [`IDLE`] bytes for each solid that
    /// may be made take half a second where that is 10⁷; turns that ask in vain beside others that make something may be
    /// some hundred times as many as these.
    pub(crate) fn may_idle(&mut self, bytes: u64) -> bool {
        self.idle.turns += 1;
        self.idle.cost = self.idle.cost.saturating_add(TURN + bytes);
        let base = self.limit.saturating_mul(IDLE);
        let allowed = base.saturating_add(self.made.saturating_mul(IDLE_FOR_EACH));
        self.idle.cost <= allowed
    }

    /// What is said of a repeat, at `span`, that makes nothing for too long.
    pub(crate) fn idled(&self, span: Span) -> Diagnostic {
        let Self { idle, made, .. } = self;
        let message = format!(
            "expected turns that make something, found {} that make nothing beside {made} that do",
            idle.turns
        );
        Diagnostic::error(span, message).hint("--max-primitives raises the limit".to_owned())
    }

    pub(crate) fn exhausted(&self, span: Span) -> Diagnostic {
        let message =
            format!("expected at most {} solids from repeats and classes, found more", self.limit);
        Diagnostic::error(span, message).hint("--max-primitives raises the limit".to_owned())
    }
}
