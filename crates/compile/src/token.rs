//! Words and signs: the tables of keywords, interned words, and the tokens they are read as.

use std::collections::HashMap;
use std::sync::Arc;

use scene::Primitive;

use crate::color_name::{COLOR_WORDS, ColorWord};
use crate::word::{GRADES, Grade};

macro_rules! keywords {
    ($($name:ident $text:literal)+) => {
        /// A reserved word that is neither a solid, a graded word nor part of a colour.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum Keyword { $($name,)+ }

        /// Every keyword.
        pub(crate) const KEYWORDS: &[(&str, Keyword)] = &[$(($text, Keyword::$name),)+];
    };
}

keywords! {
    Include "include" Class "class" Object "object" Camera "camera" Target "target" Focal "focal"
    Light "light" Ambient "ambient" Background "background" Fog "fog"
    Is "is" At "at" Length "length" Toward "toward" Intensity "intensity"
    Point "point" Beam "beam" Spot "spot" No "no" Shadows "shadows"
    Scale "scale" Rotate "rotate"
    Shininess "shininess" Smoothness "smoothness" Trans "trans" Fake "fake" Priority "priority"
    Paint "paint"
}

impl Keyword {
    /// The words that begin a statement.
    pub(crate) const STATEMENTS: &[Self] = &[
        Self::Include,
        Self::Class,
        Self::Object,
        Self::Camera,
        Self::Target,
        Self::Focal,
        Self::Light,
        Self::Ambient,
        Self::Background,
        Self::Fog,
    ];

    /// The words that begin a transform.
    pub(crate) const TRANSFORMS: &[Self] = &[Self::At, Self::Scale, Self::Rotate];

    /// Lower case.
    pub(crate) fn text(self) -> &'static str {
        let row = KEYWORDS.iter().find(|(_, keyword)| *keyword == self);
        row.map_or("", |(text, _)| text)
    }
}

macro_rules! soft_words {
    ($($name:ident $text:literal)+) => {
        /// A word that means something in its place only; elsewhere it is a name like others.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum Soft { $($name,)+ }

        /// Every such word, in the order of the symbols.
        pub(crate) const SOFT_WORDS: &[(&str, Soft)] = &[$(($text, Soft::$name),)+];
    };
}

soft_words! {
    Let "let" Repeat "repeat" Union "union" Intersection "intersection"
    Of "of" From "from" To "to" Step "step" Parallel "parallel" Radius "radius" Aperture "aperture" Focus "focus" Frame "frame" Pi "pi"
    Sin "sin" Cos "cos" Tan "tan" Sqrt "sqrt" Abs "abs" Min "min" Max "max" Floor "floor" Mod "mod"
}

impl Soft {
    /// Lower case.
    pub(crate) fn text(self) -> &'static str {
        SOFT_WORDS[self as usize].0
    }
}

/// The solids whose names are reserved; a class may take the name of any other.
pub(crate) const RESERVED_SOLIDS: &[Primitive] =
    &[Primitive::Sphere, Primitive::Cylinder, Primitive::Cone, Primitive::Block];

/// What a reserved word means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Word {
    Key(Keyword),
    Solid(Primitive),
    Grade(Grade),
    Color(ColorWord),
}

/// A word in lower case, as a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Symbol(u32);

impl Symbol {
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// Every word met so far. Reserved words come first, so a word is looked up once, whatever it is.
#[derive(Debug)]
pub(crate) struct Symbols {
    indices: HashMap<Arc<str>, Symbol>,
    texts: Vec<Arc<str>>,
    reserved: Vec<Word>,
    lower: String,
}

impl Symbols {
    pub(crate) fn new() -> Self {
        let mut symbols = Self {
            indices: HashMap::new(),
            texts: Vec::new(),
            reserved: Vec::new(),
            lower: String::new(),
        };
        let keys = KEYWORDS.iter().map(|&(text, keyword)| (text, Word::Key(keyword)));
        let solids = RESERVED_SOLIDS.iter().flat_map(|&solid| {
            solid.keywords().iter().map(move |&text| (text, Word::Solid(solid)))
        });
        let grades = GRADES.iter().map(|&(text, grade)| (text, Word::Grade(grade)));
        let colors = COLOR_WORDS.iter().map(|&(text, color)| (text, Word::Color(color)));
        for (text, word) in keys.chain(solids).chain(grades).chain(colors) {
            symbols.intern(text);
            symbols.reserved.push(word);
        }
        for &(text, _) in SOFT_WORDS {
            symbols.intern(text);
        }
        symbols
    }

    /// The symbol of a word in any case.
    pub(crate) fn intern(&mut self, word: &str) -> Symbol {
        let mut lower = std::mem::take(&mut self.lower);
        let key = if word.bytes().any(|byte| byte.is_ascii_uppercase()) {
            lower.clear();
            lower.push_str(word);
            lower.make_ascii_lowercase();
            lower.as_str()
        } else {
            word
        };
        let symbol = self.indices.get(key).copied().unwrap_or_else(|| {
            let next = u32::try_from(self.texts.len()).expect("sources are shorter than 2³² bytes");
            let text: Arc<str> = key.into();
            self.texts.push(Arc::clone(&text));
            self.indices.insert(text, Symbol(next));
            Symbol(next)
        });
        self.lower = lower;
        symbol
    }

    /// What a word is where nothing is known of its place.
    pub(crate) fn token(&mut self, word: &str) -> Token {
        let symbol = self.intern(word);
        self.reserved.get(symbol.index()).map_or(Token::Name(symbol), |&word| Token::Word(word))
    }

    /// In lower case.
    pub(crate) fn text(&self, symbol: Symbol) -> &str {
        &self.texts[symbol.index()]
    }

    /// What the symbol may mean in its place.
    pub(crate) fn soft(&self, symbol: Symbol) -> Option<Soft> {
        let index = symbol.index().checked_sub(self.reserved.len())?;
        SOFT_WORDS.get(index).map(|&(_, soft)| soft)
    }

    /// All reserved words with their meaning.
    pub(crate) fn reserved(&self) -> impl Iterator<Item = (&str, Word)> {
        self.texts.iter().map(|text| &**text).zip(self.reserved.iter().copied())
    }
}

/// A token.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Token {
    Number(f64),
    Word(Word),
    Name(Symbol),
    /// In quotes; the text is the span without its ends.
    Text,
    Open,
    Close,
    Comma,
    Plus,
    Minus,
    Times,
    Over,
    Power,
    Equals,
    OpenBrace,
    CloseBrace,
    /// Something that an error has been reported for.
    Bad,
    End,
}

/// Text from a source, short enough for a message.
pub(crate) fn shortened(text: &str) -> String {
    const LONGEST: usize = 40;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reserved_words_are_distinct_and_lower_case() {
        let symbols = Symbols::new();
        let words = symbols.reserved.len() + SOFT_WORDS.len();
        assert_eq!(symbols.texts.len(), words, "no word twice");
        for (text, _) in symbols.reserved() {
            assert!(text.bytes().all(|byte| byte.is_ascii_lowercase()), "{text}");
        }
        for (i, &(text, soft)) in SOFT_WORDS.iter().enumerate() {
            assert_eq!(soft as usize, i, "{text}: in order");
            let symbol = symbols.indices[text];
            assert_eq!(symbols.soft(symbol), Some(soft), "{text}");
        }
    }
}
