//! What names in expressions stand for: `let`, parameters of classes, variables of repeats.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};

use crate::source::Span;
use crate::token::Symbol;

/// What a name stands for. NaN stands for a number that is not known: in a body that is only checked, or after an error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Value {
    pub(crate) number: f64,
    /// Where it is named.
    pub(crate) span: Span,
}

/// Names local to a body, innermost last.
#[derive(Debug, Default)]
struct Local {
    /// Values with the number of scopes they stand in.
    values: HashMap<Symbol, Vec<(usize, Value)>>,
    /// Names in the order they were given, so that a scope can be left.
    trail: Vec<Symbol>,
    scopes: Vec<usize>,
}

/// All names that can be seen.
#[derive(Debug)]
pub(crate) struct Values {
    global: HashMap<Symbol, Value>,
    /// One for the statements, and one for each class that is being made; only the last is seen.
    locals: Vec<Local>,
    /// Parameters of classes, and what is named beside them.
    parameters: HashSet<Symbol>,
}

impl Default for Values {
    fn default() -> Self {
        Self { global: HashMap::new(), locals: vec![Local::default()], parameters: HashSet::new() }
    }
}

impl Values {
    pub(crate) fn get(&self, name: Symbol) -> Option<Value> {
        let local = self.locals.last().and_then(|local| local.values.get(&name)?.last());
        local.map(|(_, value)| value).or_else(|| self.global.get(&name)).copied()
    }

    /// Every name that can be seen.
    pub(crate) fn names(&self) -> Vec<Symbol> {
        let local = self.locals.last().into_iter().flat_map(|local| local.trail.iter());
        let mut names: Vec<Symbol> = local.chain(self.global.keys()).copied().collect();
        names.sort_unstable();
        names
    }

    /// Gives a name its value; says where the same scope has it already.
    pub(crate) fn set(&mut self, name: Symbol, value: Value) -> Option<Span> {
        if let Some(local) = self.locals.last_mut()
            && !local.scopes.is_empty()
        {
            let depth = local.scopes.len();
            let values = local.values.entry(name).or_default();
            if let Some((_, first)) = values.last().filter(|(at, _)| *at == depth) {
                return Some(first.span);
            }
            values.push((depth, value));
            local.trail.push(name);
            return None;
        }
        match self.global.entry(name) {
            Entry::Occupied(first) => Some(first.get().span),
            Entry::Vacant(place) => {
                place.insert(value);
                None
            }
        }
    }

    /// The names of a body come on top of those outside.
    pub(crate) fn open_scope(&mut self) {
        if let Some(local) = self.locals.last_mut() {
            local.scopes.push(local.trail.len());
        }
    }

    /// The names of a body are forgotten.
    pub(crate) fn close_scope(&mut self) {
        let Some(local) = self.locals.last_mut() else { return };
        let start = local.scopes.pop().unwrap_or_default();
        for name in local.trail.drain(start..) {
            if let Some(values) = local.values.get_mut(&name) {
                values.pop();
            }
        }
    }

    /// A class sees what stands outside of everything, and its own parameters.
    pub(crate) fn open_class(&mut self) {
        self.locals.push(Local::default());
        self.open_scope();
    }

    pub(crate) fn close_class(&mut self) {
        self.locals.pop();
    }

    /// The class has been read where it is named.
    pub(crate) fn close_definition(&mut self) {
        if let Some(local) = self.locals.pop() {
            self.parameters.extend(local.values.into_keys());
        }
    }

    /// In what a name that is not known was known before.
    pub(crate) fn known_inside(&self, name: Symbol) -> Option<&'static str> {
        // A body that is over leaves its names without values.
        if self.locals.last().is_some_and(|local| local.values.contains_key(&name)) {
            return Some("its repeat");
        }
        self.parameters.contains(&name).then_some("its class")
    }
}
