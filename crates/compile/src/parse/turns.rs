//! What is read several times: the bodies of repeats, and of unions and intersections over a variable.

use super::{Parsed, Parser};
use crate::ast::Spanned;
use crate::cursor::Mark;
use crate::diagnostic::Diagnostic;
use crate::index::Kind;
use crate::number_text as shown;
use crate::shared::Use;
use crate::source::Span;
use crate::token::{Soft, Symbol, Token};
use crate::value::Value;

/// How turns are counted.
const RANGE: &str = "turns are counted as in i from 1 to 12 step 0.5; the step may be left out";

/// `i from a to b step c`.
#[derive(Debug)]
pub(super) struct Range {
    variable: Spanned<Symbol>,
    from: f64,
    step: f64,
    /// How many turns; nothing if that is not known.
    count: Option<u64>,
}

/// A body that is being read.
#[derive(Debug)]
pub(super) struct Turns {
    range: Range,
    /// Where the body begins.
    mark: Mark,
    /// Turns that have begun.
    begun: u64,
    /// Errors before the first turn.
    errors: usize,
    /// What was made before the last turn.
    made: u64,
}

impl Range {
    /// Of a header that could not be read.
    pub(super) fn unknown(variable: Spanned<Symbol>) -> Self {
        Self { variable, from: f64::NAN, step: 1.0, count: None }
    }
}

impl Turns {
    /// How many turns have begun.
    pub(super) fn begun(&self) -> u64 {
        self.begun
    }

    /// True if the body is checked, but makes nothing.
    fn is_idle(&self) -> bool {
        self.range.count.is_none_or(|count| count == 0)
    }
}

impl Parser<'_> {
    /// The variable of a repeat, and its numbers.
    pub(super) fn range(&mut self) -> Parsed<Range> {
        let variable = self.number_name("a variable")?;
        self.expect_soft(Soft::From)?;
        let from = self.expression()?;
        self.expect_soft(Soft::To)?;
        let to = self.expression()?;
        let step = match self.take_soft(Soft::Step) {
            Some(_) => self.expression()?,
            None => Spanned { value: 1.0, span: to.span },
        };
        if step.value.abs() <= 0.0 {
            self.report(Diagnostic::error(step.span, "a step of 0 never arrives"));
            return Ok(Range::unknown(variable));
        }
        let turns = turns(from.value, to.value, step.value);
        let limit = self.shared.budget.limit();
        #[expect(clippy::cast_precision_loss, reason = "a limit, not a count")]
        if turns > limit as f64 {
            let message = format!("expected at most {limit} turns, found {}", shown(turns));
            self.report(
                Diagnostic::error(from.span.to(step.span), message)
                    .hint("--max-primitives raises the limit".to_owned()),
            );
            return Ok(Range::unknown(variable));
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number from 0 to the limit"
        )]
        let count = (!turns.is_nan()).then_some(turns as u64);
        Ok(Range { variable, from: from.value, step: step.value, count })
    }

    /// True if `repeat i from a to b` makes nothing, for certain.
    pub(super) fn is_empty(range: &Range) -> bool {
        range.count == Some(0)
    }

    /// The first turn of a body that begins at the next token. A body of no turns is read once, to be checked.
    pub(super) fn begin_turns(&mut self, range: Range) -> Turns {
        let (_, next) = self.peek();
        let mark = self.cursor.mark(next);
        let errors = self.shared.diagnostics.errors();
        let Range { variable, from, .. } = range;
        self.shared.define(Kind::Variable, variable, variable.span);
        let made = self.shared.budget.made();
        let turns = Turns { range, mark, begun: 1, errors, made };
        let number = if turns.is_idle() { f64::NAN } else { from };
        self.shared.checking += u32::from(turns.is_idle());
        self.shared.uses.push(Use::Turn { variable: variable.value, span: variable.span, number });
        self.bind_variable(&turns, number);
        turns
    }

    /// The body has been read to its end: goes back to its beginning for another turn, or says that there is none.
    pub(super) fn another_turn(&mut self, turns: &mut Turns) -> bool {
        self.shared.values.close_scope();
        let count = turns.range.count.unwrap_or(0);
        let failed = self.shared.diagnostics.errors() > turns.errors;
        let again = turns.begun < count && !failed && self.shared.checking == 0;
        if again && self.affordable(turns, count - turns.begun) && !self.shared.is_cut() {
            #[expect(clippy::cast_precision_loss, reason = "below the limit of turns")]
            let number = turns.range.from + turns.begun as f64 * turns.range.step;
            turns.begun += 1;
            self.cursor.go_back(&turns.mark);
            if let Some(Use::Turn { number: last, .. }) = self.shared.uses.last_mut() {
                *last = number;
            }
            self.bind_variable(turns, number);
            return true;
        }
        self.end_turns(turns);
        false
    }

    /// The body cannot be read to its end.
    pub(super) fn break_turns(&mut self, turns: &Turns) {
        self.shared.values.close_scope();
        self.end_turns(turns);
    }

    fn end_turns(&mut self, turns: &Turns) {
        self.cursor.release(turns.mark);
        self.shared.checking -= u32::from(turns.is_idle());
        self.shared.uses.pop();
    }

    fn bind_variable(&mut self, turns: &Turns, number: f64) {
        let Spanned { value: name, span } = turns.range.variable;
        self.shared.values.open_scope();
        self.shared.values.set(name, Value { number, span });
    }

    /// Asks once, before the second turn, for all that are left, and each time for one.
    fn affordable(&mut self, turns: &mut Turns, left: u64) -> bool {
        let bytes = self.cursor.since(&turns.mark);
        let made = std::mem::replace(&mut turns.made, self.shared.budget.made());
        if made == turns.made && !self.shared.budget.may_idle(bytes) {
            let error = self.shared.budget.idled(turns.range.variable.span);
            self.report(error);
            return false;
        }
        let asked = if turns.begun == 1 { bytes.saturating_mul(left) } else { bytes };
        let allowed = self.shared.budget.may_read(asked);
        if allowed {
            self.shared.budget.read(bytes);
        } else {
            self.too_much(turns.range.variable.span);
        }
        allowed
    }

    pub(super) fn too_much(&mut self, span: Span) {
        let error = self.shared.budget.exhausted(span);
        self.report(error);
    }

    fn expect_soft(&mut self, soft: Soft) -> Parsed<Span> {
        match self.take_soft(soft) {
            Some(span) => Ok(span),
            None => {
                let hint = self.meant(&[soft.text()]).unwrap_or_else(|| RANGE.to_owned());
                self.unexpected_because(&format!("`{}`", soft.text()), Some(hint))
            }
        }
    }

    /// Takes the next token if it is this word.
    pub(super) fn take_soft(&mut self, soft: Soft) -> Option<Span> {
        let (token, span) = self.peek();
        self.is_soft(token, soft).then(|| {
            self.advance();
            span
        })
    }

    pub(super) fn is_soft(&self, token: Token, soft: Soft) -> bool {
        matches!(token, Token::Name(name) if self.shared.symbols.soft(name) == Some(soft))
    }
}

/// How many of `from`, `from + step`, … do not lie beyond `to`: 0 or more, or NaN.
///
/// Decimal fractions are not binary ones: `from 0 to 0.3 step 0.1` means four turns, although 3 · 0.1 > 0.3. Each of
/// the three numbers is off by half a unit of its own, so the quotient is less than 4 ε · max(|from|, |to|) / |step|
/// short of what was written.
fn turns(from: f64, to: f64, step: f64) -> f64 {
    let largest = if from.abs() > to.abs() { from.abs() } else { to.abs() };
    let slack = 4.0 * f64::EPSILON * largest / step.abs();
    let last = ((to - from) / step + slack).floor();
    if last < 0.0 { 0.0 } else { last + 1.0 }
}

#[cfg(test)]
mod tests {
    use super::turns;

    #[test]
    fn turns_are_counted_as_written() {
        for (from, to, step, expected) in [
            (1.0, 12.0, 1.0, 12.0),
            (1.0, 1.0, 1.0, 1.0),
            (1.0, 0.0, 1.0, 0.0_f64),
            (3.0, 0.0, -1.0, 4.0),
            (0.0, 0.3, 0.1, 4.0),
            (0.0, 1.0, 0.1, 11.0),
            (0.0, 0.29, 0.1, 3.0),
            (0.5, 2.4, 1.0, 2.0),
            (-1e6, 1e6, 0.1, 20_000_001.0),
            (0.0, 1e300, 1e-300, f64::INFINITY),
        ] {
            let found = turns(from, to, step);
            assert_eq!(found.to_bits(), expected.to_bits(), "{from} to {to} step {step}: {found}");
        }
        assert!(turns(f64::NAN, 1.0, 1.0).is_nan(), "not known");
    }
}
