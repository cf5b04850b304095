//! Attributes, colours, numbers and arguments: what stays on one line unless it is longer than that.

use super::document::Flow;
use super::statement::{FOLD, Gap, STEP, Writer};
use crate::color_name::ColorWord;
use crate::token::{Keyword, SOFT_WORDS, Token, Word};
use crate::vocabulary;

impl Writer<'_> {
    /// `light`, which is next, is a lightness if a colour may stand here.
    fn light_is_lightness(&self) -> bool {
        matches!(
            self.item(1).token,
            Token::Word(Word::Color(
                ColorWord::Saturation(_)
                    | ColorWord::Splash(_)
                    | ColorWord::Base(_)
                    | ColorWord::Gray
            ))
        )
    }

    pub(super) fn at_color(&self) -> bool {
        match self.token() {
            Token::Word(Word::Color(_)) => true,
            Token::Word(Word::Key(Keyword::Light)) => self.light_is_lightness(),
            _ => false,
        }
    }

    /// A colour, to its last word.
    pub(super) fn color(&mut self) {
        loop {
            let token = self.token();
            self.word();
            match token {
                Token::Word(Word::Color(ColorWord::Hsv | ColorWord::Rgb)) => {
                    if self.is(0, "(") {
                        self.arguments(Gap::Blank);
                    }
                    return;
                }
                Token::Word(Word::Color(ColorWord::Base(_))) => {
                    let joined = self.token() == Token::Minus
                        && matches!(
                            self.item(1).token,
                            Token::Word(Word::Color(ColorWord::Base(_)))
                        );
                    if joined {
                        self.put(Gap::Nothing);
                        self.put(Gap::Nothing);
                    }
                    return;
                }
                Token::Word(Word::Color(ColorWord::Black | ColorWord::White | ColorWord::Gray)) => {
                    return;
                }
                _ => {}
            }
            let light = Token::Word(Word::Key(Keyword::Light));
            if !matches!(self.token(), Token::Word(Word::Color(_))) && self.token() != light {
                return;
            }
        }
    }

    pub(super) fn at_attribute(&self) -> bool {
        let attribute = matches!(
            self.key(),
            Some(
                Keyword::Shininess
                    | Keyword::Smoothness
                    | Keyword::Trans
                    | Keyword::Priority
                    | Keyword::Paint
            )
        );
        attribute || self.at_color() || matches!(self.token(), Token::Word(Word::Grade(_)))
    }

    pub(super) fn attribute(&mut self) {
        match self.key() {
            _ if self.at_color() => self.color(),
            Some(Keyword::Paint) => {
                self.word();
                if !self.at_statement() {
                    self.put(Gap::Blank);
                }
                if self.is(0, "(") {
                    self.arguments(Gap::Blank);
                }
                if self.at_color() {
                    self.gap(Gap::Blank);
                    self.color();
                }
            }
            Some(_) => {
                self.word();
                self.operand(Gap::Blank);
            }
            None => self.word(),
        }
    }

    /// A number, a name, a call, or what is in parentheses.
    pub(super) fn operand(&mut self, mut gap: Gap) {
        while matches!(self.token(), Token::Minus | Token::Plus) {
            self.put(gap);
            gap = Gap::Nothing;
        }
        match self.token() {
            Token::Open => self.arguments(gap),
            Token::Number(_) => self.put(gap),
            Token::Name(_) => {
                let function = is_function(self.item(0).text);
                self.put(gap);
                if function && self.is(0, "(") {
                    self.arguments(Gap::Nothing);
                }
            }
            _ => {}
        }
    }

    /// Operands and the operators between them, while there are any.
    pub(super) fn expression(&mut self) {
        self.operand(Gap::Blank);
        while self.is_one_of(&["+", "-", "*", "/", "^"]) {
            let power = self.is(0, "^");
            self.put(if power { Gap::Nothing } else { Gap::Fold(FOLD) });
            self.operand(if power { Gap::Nothing } else { Gap::Blank });
        }
    }

    /// What is in parentheses, with those in it. A statement ends it.
    pub(super) fn arguments(&mut self, gap: Gap) {
        self.put(gap);
        self.document.begin(Flow::Fill, STEP);
        let mut depth = 1;
        // What the last token leaves to be done: an operand stands before it.
        let (mut complete, mut tight) = (false, true);
        while depth > 0 {
            let named = self.is(1, "=") && !self.is(0, ",");
            if self.at_statement() && !named || self.token() == Token::End {
                break;
            }
            let sign = self.is_one_of(&["+", "-"]) && !complete;
            let plain = if tight { Gap::Nothing } else { Gap::Blank };
            if self.is(0, "(") {
                let call = self.at > 0 && matches!(self.items[self.at - 1].token, Token::Name(_));
                self.put(if call { Gap::Nothing } else { plain });
                self.document.begin(Flow::Fill, STEP);
                depth += 1;
                (complete, tight) = (false, true);
            } else if self.is(0, ")") {
                self.put(Gap::Nothing);
                self.document.end();
                depth -= 1;
                (complete, tight) = (true, false);
            } else if self.is(0, ",") {
                self.put(Gap::Nothing);
                self.gap(Gap::Fold(FOLD));
                (complete, tight) = (false, false);
            } else if self.is(0, "^") {
                self.put(Gap::Nothing);
                (complete, tight) = (false, true);
            } else if self.is_one_of(&["+", "-", "*", "/"]) && !sign {
                self.put(Gap::Fold(FOLD));
                (complete, tight) = (false, false);
            } else {
                self.put(plain);
                let operand = !sign && !self.items[self.at - 1].text.eq("=");
                (complete, tight) = (operand, sign);
            }
        }
        (0..depth).for_each(|_| self.document.end());
    }
}

/// A name that is called.
pub(super) fn is_function(name: &str) -> bool {
    let row = SOFT_WORDS.iter().find(|(word, _)| name.eq_ignore_ascii_case(word));
    row.is_some_and(|&(_, soft)| vocabulary::is_function(soft))
}
