//! Numbers as expressions, read with a stack of their own.

use scene::transform::sin_cos_degrees;

use super::solid::NESTING_LIMIT;
use super::{Failed, Parsed, Parser};
use crate::ast::Spanned;
use crate::diagnostic::Diagnostic;
use crate::number_text as shown;
use crate::source::Span;
use crate::suggestion::{closest, did_you_mean};
use crate::token::{Soft, Symbol, Token, Word, shortened};

/// What waits for its right operand or its end.
#[derive(Clone, Copy, Debug)]
enum Pending {
    Negate(Span),
    Binary(Operator),
    Open,
    /// A call, where its name stands, and how many values precede its arguments.
    Call(&'static Function, Span, usize),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Operator {
    Plus,
    Minus,
    Times,
    Over,
    Power,
}

/// Binds tighter than `*`, less tight than `^`: `-2^2` is −4.
const SIGN: u8 = 3;

impl Operator {
    fn of(token: Token) -> Option<Self> {
        Some(match token {
            Token::Plus => Self::Plus,
            Token::Minus => Self::Minus,
            Token::Times => Self::Times,
            Token::Over => Self::Over,
            Token::Power => Self::Power,
            _ => return None,
        })
    }

    fn strength(self) -> u8 {
        match self {
            Self::Plus | Self::Minus => 1,
            Self::Times | Self::Over => 2,
            Self::Power => 4,
        }
    }

    fn sign(self) -> char {
        match self {
            Self::Plus => '+',
            Self::Minus => '-',
            Self::Times => '*',
            Self::Over => '/',
            Self::Power => '^',
        }
    }
}

/// A function of numbers.
#[derive(Debug)]
struct Function {
    word: Soft,
    /// Numbers it takes, at least and at most.
    least: usize,
    most: usize,
    /// Nothing where it has no value.
    value: fn(&[f64]) -> Option<f64>,
}

/// Every function. A new one is a new row, and a soft word.
const FUNCTIONS: &[Function] = &[
    Function { word: Soft::Sin, least: 1, most: 1, value: |x| Some(sin_cos_degrees(x[0]).0) },
    Function { word: Soft::Cos, least: 1, most: 1, value: |x| Some(sin_cos_degrees(x[0]).1) },
    Function { word: Soft::Tan, least: 1, most: 1, value: tangent },
    Function { word: Soft::Sqrt, least: 1, most: 1, value: |x| (x[0] >= 0.0).then(|| x[0].sqrt()) },
    Function { word: Soft::Abs, least: 1, most: 1, value: |x| Some(x[0].abs()) },
    Function { word: Soft::Floor, least: 1, most: 1, value: |x| Some(x[0].floor()) },
    Function { word: Soft::Min, least: 2, most: usize::MAX, value: |x| best(x, |a, b| a < b) },
    Function { word: Soft::Max, least: 2, most: usize::MAX, value: |x| best(x, |a, b| a > b) },
    Function { word: Soft::Mod, least: 2, most: 2, value: modulo },
];

fn tangent(x: &[f64]) -> Option<f64> {
    let (sine, cosine) = sin_cos_degrees(x[0]);
    (cosine.abs() > 0.0).then(|| sine / cosine)
}

fn best(x: &[f64], better: fn(f64, f64) -> bool) -> Option<f64> {
    x.iter().copied().reduce(|a, b| if better(b, a) { b } else { a })
}

/// The remainder that has the sign of the divisor.
fn modulo(x: &[f64]) -> Option<f64> {
    let rest = x[0] % x[1];
    let other_side = rest.abs() > 0.0 && (rest < 0.0) != (x[1] < 0.0);
    (x[1].abs() > 0.0).then(|| if other_side { rest + x[1] } else { rest })
}

/// An expression as far as it is read.
#[derive(Debug, Default)]
struct Stack {
    values: Vec<Spanned<f64>>,
    pending: Vec<Pending>,
    /// Parentheses that are open, those of calls included.
    open: usize,
}

impl Parser<'_> {
    /// A number where operators may stand: in parentheses, and after `=`, `from`, `to` and `step`. It is NaN where its
    /// value is not known.
    pub(super) fn expression(&mut self) -> Parsed<Spanned<f64>> {
        self.evaluate(true)
    }

    /// A number where operators belong to solids: one with its sign, a name, a call, or an expression in parentheses.
    pub(super) fn number(&mut self) -> Parsed<Spanned<f64>> {
        self.evaluate(false)
    }

    fn evaluate(&mut self, operators: bool) -> Parsed<Spanned<f64>> {
        let mut stack = Stack::default();
        loop {
            if !self.operand(&mut stack, operators)? {
                continue;
            }
            loop {
                let (token, span) = self.peek();
                if let Some(operator) = Operator::of(token).filter(|_| operators || stack.open > 0)
                {
                    self.advance();
                    // Only `^` joins from the right.
                    let strength = operator.strength() + u8::from(operator == Operator::Power);
                    self.reduce(&mut stack, strength);
                    stack.pending.push(Pending::Binary(operator));
                    break;
                }
                if stack.open == 0 {
                    self.reduce(&mut stack, 0);
                    return stack.values.pop().ok_or(Failed);
                }
                self.reduce(&mut stack, 0);
                match (token, stack.pending.last().copied()) {
                    (Token::Close, Some(Pending::Open)) => {}
                    (Token::Close, Some(Pending::Call(function, start, base))) => {
                        let arguments: Vec<Spanned<f64>> = stack.values.drain(base..).collect();
                        let value = self.call(function, &arguments, start.to(span));
                        stack.values.push(value);
                    }
                    (Token::Comma, Some(Pending::Call(..))) => {
                        self.advance();
                        break;
                    }
                    (_, Some(Pending::Call(..))) => {
                        return self.unexpected("an operator, `,` or `)`", &[]);
                    }
                    _ => return self.unexpected("an operator or `)`", &[]),
                }
                self.advance();
                stack.pending.pop();
                stack.open -= 1;
            }
        }
    }

    /// One step toward an operand; true if it is complete.
    fn operand(&mut self, stack: &mut Stack, operators: bool) -> Parsed<bool> {
        let (token, span) = self.peek();
        if stack.pending.len() >= NESTING_LIMIT {
            let message = format!("signs and parentheses nest deeper than {NESTING_LIMIT}");
            return self.fail(Diagnostic::error(span, message));
        }
        match token {
            Token::Minus | Token::Plus
                if operators || stack.open > 0 || stack.pending.is_empty() =>
            {
                self.advance();
                // A `+` waits too, so that a bare number has one sign.
                if token == Token::Minus {
                    stack.pending.push(Pending::Negate(span));
                } else if !operators
                    && stack.open == 0
                    && matches!(self.peek().0, Token::Minus | Token::Plus)
                {
                    return self.unexpected("a number", &[]);
                }
                return Ok(false);
            }
            Token::Number(value) => {
                self.advance();
                stack.values.push(Spanned { value, span });
            }
            Token::Open => {
                self.advance();
                stack.pending.push(Pending::Open);
                stack.open += 1;
                return Ok(false);
            }
            Token::Name(name) => {
                self.advance();
                let soft = self.shared.symbols.soft(name);
                if let Some(function) = FUNCTIONS.iter().find(|f| Some(f.word) == soft) {
                    if self.take(Token::Open).is_none() {
                        let shape = if function.least == 1 { "(x)" } else { "(x, y)" };
                        let hint = format!("it is written {} {shape}", function.word.text());
                        return self.unexpected_because("`(`", Some(hint));
                    }
                    stack.pending.push(Pending::Call(function, span, stack.values.len()));
                    stack.open += 1;
                    return Ok(false);
                }
                let value = self.named_number(name, span, operators || stack.open > 0);
                stack.values.push(Spanned { value, span });
            }
            _ => return self.unexpected("a number", &[]),
        }
        Ok(true)
    }

    /// Works out what binds at least as tight as `strength`, back to what is open.
    fn reduce(&mut self, stack: &mut Stack, strength: u8) {
        while let Some(&pending) = stack.pending.last() {
            let own = match pending {
                Pending::Negate(_) => SIGN,
                Pending::Binary(operator) => operator.strength(),
                Pending::Open | Pending::Call(..) => return,
            };
            if own < strength {
                return;
            }
            stack.pending.pop();
            let Some(b) = stack.values.pop() else { return };
            let value = match (pending, stack.values.last().copied()) {
                (Pending::Binary(operator), Some(a)) => {
                    stack.values.pop();
                    self.binary(operator, a, b)
                }
                (Pending::Negate(sign), _) => Spanned { value: -b.value, span: sign.to(b.span) },
                _ => b,
            };
            stack.values.push(value);
        }
    }

    fn binary(&mut self, operator: Operator, a: Spanned<f64>, b: Spanned<f64>) -> Spanned<f64> {
        let span = a.span.to(b.span);
        let (x, y) = (a.value, b.value);
        if operator == Operator::Over && y.abs() <= 0.0 {
            let error = Diagnostic::error(b.span, "division by 0");
            self.report(error.hint("the number below the line has to differ from 0".to_owned()));
            return Spanned { value: f64::NAN, span };
        }
        let value = match operator {
            Operator::Plus => x + y,
            Operator::Minus => x - y,
            Operator::Times => x * y,
            Operator::Over => x / y,
            // NaN to the power of 0 would be known.
            Operator::Power if x.is_nan() || y.is_nan() => f64::NAN,
            Operator::Power => libm::pow(x, y),
        };
        if !value.is_finite() && !x.is_nan() && !y.is_nan() {
            let sign = operator.sign();
            let x = if x < 0.0 { format!("({})", shown(x)) } else { shown(x) };
            let y = shown(y);
            let what = if value.is_nan() { "is no number" } else { "is too large for a number" };
            self.report(Diagnostic::error(span, format!("{x} {sign} {y} {what}")));
            return Spanned { value: f64::NAN, span };
        }
        Spanned { value, span }
    }

    fn call(
        &mut self,
        function: &Function,
        arguments: &[Spanned<f64>],
        span: Span,
    ) -> Spanned<f64> {
        let unknown = Spanned { value: f64::NAN, span };
        let name = function.word.text();
        let found = arguments.len();
        if found < function.least || found > function.most {
            let expected = match (function.least, function.most) {
                (1, 1) => "one number",
                (2, 2) => "two numbers",
                _ => "two numbers or more",
            };
            self.report(Diagnostic::error(
                span,
                format!("`{name}` takes {expected}, found {found}"),
            ));
            return unknown;
        }
        let numbers: Vec<f64> = arguments.iter().map(|argument| argument.value).collect();
        if numbers.iter().any(|number| number.is_nan()) {
            return unknown;
        }
        match (function.value)(&numbers) {
            Some(value) if value.is_finite() => Spanned { value, span },
            _ => {
                let numbers: Vec<String> = numbers.into_iter().map(shown).collect();
                let message = format!("{name} ({}) has no value", numbers.join(", "));
                self.report(Diagnostic::error(span, message));
                unknown
            }
        }
    }

    /// The number that a name stands for. `call` says that a `(` behind it can only be that of a call.
    fn named_number(&mut self, name: Symbol, span: Span, call: bool) -> f64 {
        match self.shared.symbols.soft(name) {
            Some(Soft::Pi) => return std::f64::consts::PI,
            Some(Soft::Frame) => return self.shared.frame,
            _ => {}
        }
        if let Some(value) = self.shared.values.get(name) {
            self.shared.record.refer(span, value.span);
            return value.number;
        }
        let called = call && self.peek().0 == Token::Open;
        if called {
            self.skip_parentheses();
        }
        // What a missing file should have named is not unknown.
        if !self.shared.incomplete {
            let unknown = self.unknown_number(name, span, called);
            self.report(unknown);
        }
        f64::NAN
    }

    fn unknown_number(&self, name: Symbol, span: Span, called: bool) -> Diagnostic {
        let text = self.shared.symbols.text(name);
        let functions = FUNCTIONS.iter().map(|function| function.word.text());
        if called {
            let hint = did_you_mean(closest(text, functions.clone())).unwrap_or_else(|| {
                format!("the functions are {}", functions.collect::<Vec<_>>().join(", "))
            });
            let message = format!("unknown function `{}`", shortened(text));
            return Diagnostic::error(span, message).hint(hint);
        }
        let error = Diagnostic::error(span, format!("unknown number `{}`", shortened(text)));
        if self.shared.classes.contains(name) {
            return error.hint("this is the name of a class, a solid".to_owned());
        }
        if !self.shared.diagnostics.open() {
            return error;
        }
        let names = self.shared.values.names();
        let names = names.iter().map(|&name| self.shared.symbols.text(name));
        let others = [Soft::Pi.text(), Soft::Frame.text()].into_iter().chain(functions);
        let hint = did_you_mean(closest(text, names.chain(others)));
        let text = shortened(text);
        error.hint(hint.unwrap_or_else(|| match self.shared.values.known_inside(name) {
            Some(body) => format!("`{text}` is known inside {body} only"),
            None => format!("`let {text} = …` names a number from there on"),
        }))
    }

    /// Leaves a `(` behind, and everything up to its `)`.
    pub(super) fn skip_parentheses(&mut self) {
        let mut open = 0_usize;
        loop {
            match self.peek().0 {
                Token::Open => open += 1,
                Token::Close => open -= 1,
                Token::End => return,
                _ if self.at_statement().is_some() => return,
                _ => {}
            }
            self.advance();
            if open == 0 {
                return;
            }
        }
    }

    /// A name for a number; `what` it is to be.
    pub(super) fn number_name(&mut self, what: &str) -> Parsed<Spanned<Symbol>> {
        let (token, span) = self.peek();
        match token {
            Token::Name(name) => {
                let soft = self.shared.symbols.soft(name);
                let text = self.shared.symbols.text(name);
                let function = FUNCTIONS.iter().any(|function| Some(function.word) == soft);
                let kind = match soft {
                    _ if function => "a function",
                    Some(Soft::Pi) => "a number already",
                    Some(Soft::Frame) => "the number of the picture in a sequence",
                    _ => {
                        self.advance();
                        return Ok(Spanned { value: name, span });
                    }
                };
                let message = format!("`{text}` is {kind} and cannot name {what}");
                self.fail(Diagnostic::error(span, message).hint("choose another name".to_owned()))
            }
            Token::Word(Word::Key(_) | Word::Solid(_) | Word::Grade(_) | Word::Color(_)) => {
                self.reserved(what)
            }
            _ => self.unexpected(&format!("the name of {what}"), &[]),
        }
    }
}
