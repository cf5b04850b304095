//! What a word or a name means, and what a colour looks like.

use std::ops::Range;

use compile::vocabulary::{Kind, Piece};
use lsp_types::{Hover, HoverContents, MarkupContent, MarkupKind};
use scene::color::linear_from_display;

use crate::meaning;
use crate::names::kind_word;
use crate::position::{Encoding, Lines};
use crate::scene_text::{Analysis, OpenText};

/// Longest text of a definition that is shown, in characters.
const SHOWN: usize = 400;

/// What there is to say about a byte.
pub(crate) fn at(
    text: &OpenText,
    analysis: &Analysis,
    offset: usize,
    encoding: Encoding,
) -> Option<Hover> {
    let (bytes, said) = color(text, offset).or_else(|| about(text, analysis, offset))?;
    let contents = MarkupContent { kind: MarkupKind::Markdown, value: said };
    Some(Hover {
        contents: HoverContents::Markup(contents),
        range: Some(Lines::new(&text.text, encoding).range(bytes)),
    })
}

/// A name of the text, or a word of the language.
fn about(text: &OpenText, analysis: &Analysis, offset: usize) -> Option<(Range<usize>, String)> {
    if let Some((definition, span)) = analysis.name_at(offset) {
        let bytes = span.start as usize..span.end as usize;
        let source = analysis.sources.within(definition.whole);
        let source = source.map_or("", |(_, text, range)| text.get(range).unwrap_or_default());
        let mut shown: String = source.chars().take(SHOWN).collect();
        if shown.len() < source.len() {
            shown.push('…');
        }
        let doc = definition.doc.as_deref().map(|doc| format!("\n\n{doc}")).unwrap_or_default();
        let kind = kind_word(definition.kind);
        return Some((bytes, format!("{kind} `{}`\n\n```sdl\n{shown}\n```{doc}", definition.name)));
    }
    let (bytes, _) = text.word_at(offset)?;
    let said = meaning::of(text.slice(&bytes));
    (!said.is_empty()).then(|| (bytes, said.to_owned()))
}

/// The colour that a byte is in, with a swatch.
fn color(text: &OpenText, offset: usize) -> Option<(Range<usize>, String)> {
    let bytes = phrase(text, offset)?;
    let written = text.slice(&bytes);
    let scene = compile::compile_text(format!("background {written}")).scene?;
    let [r, g, b] = scene.background.to_array().map(display);
    let hex = format!("{r:02x}{g:02x}{b:02x}");
    let swatch = format!(
        "![#{hex}](data:image/svg+xml,%3Csvg%20xmlns='http://www.w3.org/2000/svg'%20width='64'%20height='16'\
         %3E%3Crect%20width='64'%20height='16'%20fill='%23{hex}'/%3E%3C/svg%3E)"
    );
    Some((bytes, format!("{swatch} `#{hex}`\n\n`{written}`: {r}, {g}, {b}")))
}

/// The display value of 8 bits that is nearest to a linear one.
fn display(linear: f64) -> u8 {
    let distance = |value: &u8| (linear_from_display(f64::from(*value) / 255.0) - linear).abs();
    let nearest = (0..=u8::MAX).min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.unwrap_or_default()
}

/// The bytes of the colour around `offset`: its words, and the numbers of `hsv` and `rgb`.
fn phrase(text: &OpenText, offset: usize) -> Option<Range<usize>> {
    let pieces = text.pieces();
    let word = |at: usize| pieces.get(at).map(|(bytes, _)| text.slice(bytes).to_ascii_lowercase());
    let is = |at: usize, wanted: &str| word(at).as_deref() == Some(wanted);
    let color = |at: usize| matches!(pieces.get(at), Some((_, Piece::Word(Kind::Color))));
    let mut at = 0;
    while at < pieces.len() {
        // `light` is a lightness where a hue follows; where it begins a statement one is never wrong by it.
        let begins = color(at)
            || is(at, "light") && color(at + 1) && !is(at + 1, "very") && !is(at + 1, "dark");
        if !begins {
            at += 1;
            continue;
        }
        let (start, mut end) = (at, at);
        loop {
            let last = word(end).unwrap_or_default();
            if matches!(last.as_str(), "hsv" | "rgb") {
                end = (end..pieces.len()).find(|&at| is(at, ")")).unwrap_or(end);
                break;
            }
            let hue = HUES.contains(&last.as_str());
            if hue
                && is(end + 1, "-")
                && word(end + 2).is_some_and(|word| HUES.contains(&word.as_str()))
            {
                end += 2;
                break;
            }
            let whole = hue || matches!(last.as_str(), "black" | "white" | "gray" | "grey");
            if whole || !(color(end + 1) || is(end + 1, "light")) {
                break;
            }
            end += 1;
        }
        let bytes = pieces[start].0.start..pieces[end].0.end;
        if bytes.contains(&offset) || bytes.end == offset {
            return Some(bytes);
        }
        at = end + 1;
    }
    None
}

/// The hues that are joined with `-`.
const HUES: [&str; 7] = ["red", "orange", "brown", "yellow", "green", "blue", "purple"];
