//! Attributes in front of a factor.

use std::collections::HashMap;

use scene::class::AttributesTable;
use scene::form::{FORMS, Row};
use scene::{Attributes, AttributesId, Index, Primitive, Scene, Transparency};

use super::{Clause, Parsed, Parser, Seen};
use crate::diagnostic::Diagnostic;
use crate::shared::Shared;
use crate::source::Span;
use crate::suggestion::{closest, did_you_mean};
use crate::token::{Keyword, Soft, Symbol, Token, Word};
use crate::word::Grade;

/// The keywords that begin an attribute.
const ATTRIBUTES: &[Keyword] =
    &[Keyword::Shininess, Keyword::Smoothness, Keyword::Trans, Keyword::Priority, Keyword::Paint];

/// How clear bodies are written.
const TRANS: &str = "it is written trans (half distance, index of refraction)";

/// Some that are used most.
const INDICES: &str = "the index of water is 1.33, that of glass 1.5";

impl Parser<'_> {
    /// The attributes of the factor that follows.
    pub(super) fn attributes(&mut self) -> Parsed<AttributesId> {
        let (mut attributes, mut seen) = (Attributes::default(), Seen::default());
        loop {
            let (token, span) = self.peek();
            match token {
                Token::Word(Word::Grade(grade)) => {
                    self.advance();
                    self.grade(&mut attributes, &mut seen, grade, span);
                }
                Token::Word(Word::Key(keyword)) if ATTRIBUTES.contains(&keyword) => {
                    self.advance();
                    self.attribute(&mut attributes, &mut seen, keyword, span)?;
                }
                _ if self.at_color(&seen) => {
                    self.once(&mut seen, Clause::Color, span);
                    attributes.color = Some(self.color()?);
                }
                Token::Name(name) if self.misspelt(name) => {
                    return self.unknown_attribute(name, span);
                }
                _ => break,
            }
        }
        if let (Some(Transparency { .. }), Some(shininess)) =
            (attributes.transparency, attributes.shininess)
            && shininess <= 0.0
        {
            let at = seen.0[Clause::Shininess as usize].unwrap_or_default();
            let trans = seen.0[Clause::Transparency as usize].unwrap_or_default();
            self.report(
                Diagnostic::warning(at, "the dullest surface lets no light through")
                    .note(trans, "this has no effect")
                    .hint("a body with `trans` is `shiniest` by default".to_owned()),
            );
        }
        if self.shared.checking > 0 {
            return Ok(AttributesId::NONE);
        }
        let Shared { attributes: cache, scene, .. } = &mut *self.shared;
        Ok(cache.intern(scene, attributes))
    }

    fn grade(&mut self, attributes: &mut Attributes, seen: &mut Seen, grade: Grade, span: Span) {
        match grade {
            Grade::Shininess(share) => {
                self.once(seen, Clause::Shininess, span);
                attributes.shininess = Some(share);
            }
            Grade::Smoothness(slope) => {
                self.once(seen, Clause::Smoothness, span);
                attributes.smoothness = Some(slope);
            }
            Grade::Pure(pure) => {
                self.once(seen, Clause::Purity, span);
                attributes.pure = Some(pure);
            }
        }
    }

    /// The attribute that begins with `keyword`, which has been taken.
    fn attribute(
        &mut self,
        attributes: &mut Attributes,
        seen: &mut Seen,
        keyword: Keyword,
        span: Span,
    ) -> Parsed<()> {
        match keyword {
            Keyword::Shininess => {
                self.once(seen, Clause::Shininess, span);
                attributes.shininess = Some(self.share("the shininess")?);
            }
            Keyword::Smoothness => {
                self.once(seen, Clause::Smoothness, span);
                attributes.smoothness = Some(self.share("the smoothness")?);
            }
            Keyword::Trans => {
                self.once(seen, Clause::Transparency, span);
                attributes.transparency = Some(self.transparency()?);
            }
            Keyword::Priority => {
                self.once(seen, Clause::Priority, span);
                attributes.priority = Some(self.priority()?);
            }
            _ => attributes.paint.push(self.paint()?),
        }
        Ok(())
    }

    fn transparency(&mut self) -> Parsed<Transparency> {
        if self.peek().0 != Token::Open {
            return self.unexpected_because("`(`", Some(TRANS.to_owned()));
        }
        self.advance();
        let half_distance =
            self.expression_in("the half distance of `trans`", "above 0", |x| x > 0.0)?.value;
        if self.take(Token::Comma).is_none() {
            return self.unexpected_because("`,`", Some(format!("{TRANS}; {INDICES}")));
        }
        let index = if self.take_key(Keyword::Fake).is_some() {
            Index::Fake
        } else if self.misspells_fake() {
            let (_, span) = self.peek();
            let word = self.cursor.text(span).to_ascii_lowercase();
            let hint = did_you_mean(closest(&word, ["fake"])).unwrap_or_else(|| INDICES.to_owned());
            return self.unexpected_because("an index of refraction or `fake`", Some(hint));
        } else {
            let index = self.expression_in("the index of refraction", "above 0", |x| x > 0.0)?;
            Index::Refractive(index.value)
        };
        self.expect(Token::Close, "`)`")?;
        Ok(Transparency { half_distance, index })
    }

    /// The next token is a name that nothing is called by, and all there is up to the `)`.
    fn misspells_fake(&mut self) -> bool {
        let Token::Name(name) = self.peek().0 else { return false };
        self.peek_at(1).0 == Token::Close
            && self.shared.values.get(name).is_none()
            && !matches!(self.shared.symbols.soft(name), Some(Soft::Pi | Soft::Frame))
    }

    fn priority(&mut self) -> Parsed<i32> {
        let (least, most) = (f64::from(i32::MIN), f64::from(i32::MAX));
        let range = format!("a whole number from {least} to {most}");
        let fits = |x: f64| x.fract().abs() <= 0.0 && x >= least && x <= most;
        let number = self.number_in("`priority`", &range, fits)?;
        if !fits(number.value) {
            return Ok(0);
        }
        #[expect(clippy::cast_possible_truncation, reason = "a whole number in range")]
        Ok(number.value as i32)
    }

    /// The next token is a name that is no class, and something follows that cannot follow a factor: it was meant as
    /// an attribute.
    fn misspelt(&mut self, name: Symbol) -> bool {
        let solid = is_solid(self.shared.symbols.text(name));
        if solid || self.shared.classes.contains(name) || self.at_group_of_turns() || self.at_end()
        {
            return false;
        }
        match self.peek_at(1).0 {
            Token::Name(_)
            | Token::Number(_)
            | Token::Open
            | Token::OpenBrace
            | Token::Word(Word::Solid(_) | Word::Grade(_) | Word::Color(_)) => true,
            Token::Word(Word::Key(keyword)) => ATTRIBUTES.contains(&keyword),
            _ => false,
        }
    }

    fn unknown_attribute<T>(&mut self, name: Symbol, span: Span) -> Parsed<T> {
        let symbols = &self.shared.symbols;
        if self.shared.classes.is_current(name) {
            let message = format!("class `{}` cannot be made of itself", symbols.text(name));
            return self.fail(Diagnostic::error(span, message));
        }
        if let Some(soft @ (Soft::Union | Soft::Intersection)) = symbols.soft(name) {
            let sign = if soft == Soft::Union { "+" } else { "*" };
            let turns = format!("it is written {} of i from 1 to 12 ( … )", soft.text());
            self.advance();
            let hint = match self.peek().0 {
                Token::Open | Token::OpenBrace => {
                    format!("{turns}; two solids are joined by `{sign}`, as in sphere {sign} block")
                }
                _ => self.meant(&[Soft::Of.text()]).unwrap_or(turns),
            };
            return self.unexpected_because("`of`", Some(hint));
        }
        let words = symbols.reserved().filter(|&(_, word)| match word {
            Word::Key(keyword) => ATTRIBUTES.contains(&keyword) || keyword == Keyword::Light,
            Word::Solid(_) | Word::Grade(_) | Word::Color(_) => true,
        });
        let words = words.map(|(text, _)| text).chain(self.shared.class_names());
        let words = words.chain(FORMS.iter().map(|row| row.keyword));
        let words = words.chain([Soft::Union.text(), Soft::Intersection.text()]);
        let hint = self.meant_by(name, words);
        let found = self.found(Token::Name(name), span);
        let message = format!("expected an attribute or a solid, found {found}");
        self.fail(Diagnostic::error(span, message).hint(hint))
    }
}

/// Gives equal sets of attributes the same index.
///
/// Sets without paint are told apart by the bits of their numbers; that takes a tenth of the time of
/// [`AttributesTable`], which scenes of many small objects would otherwise spend most of their time in.
#[derive(Debug, Default)]
pub(crate) struct AttributesCache {
    plain: HashMap<[u64; 9], AttributesId>,
    painted: AttributesTable,
}

impl AttributesCache {
    fn intern(&mut self, scene: &mut Scene, attributes: Attributes) -> AttributesId {
        if !attributes.paint.is_empty() {
            return self.painted.intern(scene, attributes);
        }
        let key = bits(&attributes);
        if key == [UNSAID; 9] {
            return AttributesId::NONE;
        }
        *self.plain.entry(key).or_insert_with(|| {
            scene.attributes.push(attributes);
            let index = u32::try_from(scene.attributes.len() - 1);
            AttributesId(index.expect("sources are shorter than 2³² bytes"))
        })
    }
}

/// A solid whose word is not reserved, or is.
fn is_solid(word: &str) -> bool {
    Row::named(word).is_some() || Primitive::named(word).is_some()
}

/// The bits of no number that can be written.
const UNSAID: u64 = u64::MAX;

fn bits(attributes: &Attributes) -> [u64; 9] {
    let Attributes { color, shininess, smoothness, pure, transparency, priority, paint: _ } =
        attributes;
    let number = |x: &Option<f64>| x.map_or(UNSAID, f64::to_bits);
    let channels = color.map_or([UNSAID; 3], |color| color.to_array().map(f64::to_bits));
    let index = transparency.map_or(UNSAID, |transparency| match transparency.index {
        Index::Refractive(index) => index.to_bits(),
        Index::Fake => 0,
    });
    [
        channels[0],
        channels[1],
        channels[2],
        number(shininess),
        number(smoothness),
        pure.map_or(UNSAID, u64::from),
        transparency.map_or(UNSAID, |transparency| transparency.half_distance.to_bits()),
        index,
        priority.map_or(UNSAID, |priority| u64::from(priority.cast_unsigned())),
    ]
}
