//! What may stand at a place, told from the words before it.

use compile::vocabulary::{Argument, Kind, Piece, arguments, entries, takes_texture};

/// What may stand at a place.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Wanted {
    /// Words of these kinds.
    pub(crate) kinds: Vec<Kind>,
    /// These words, too.
    pub(crate) words: Vec<&'static str>,
    /// Names of arguments of what is before the parenthesis.
    pub(crate) arguments: Vec<Argument>,
    /// The class that is before the parenthesis; its parameters may stand here.
    pub(crate) class: Option<String>,
}

/// A word or a sign.
pub(crate) struct Before<'t> {
    pub(crate) text: &'t str,
    pub(crate) piece: Piece,
}

/// What numbers are made of.
const NUMBERS: &[Kind] = &[Kind::Function, Kind::Number];

/// What a factor begins with.
const FACTOR: &[Kind] = &[Kind::Color, Kind::Attribute, Kind::Solid];

/// Groups that are read once for each number of a range.
const TURNS: &[&str] = &["union", "intersection"];

/// Words that solids are described with where a colour is open.
const SHADES: &[&str] = &["light"];

impl Wanted {
    fn of(kinds: &[Kind], words: &[&'static str]) -> Self {
        Self { kinds: kinds.to_vec(), words: words.to_vec(), ..Self::default() }
    }
}

/// What may follow `before`.
pub(crate) fn wanted(before: &[Before<'_>]) -> Wanted {
    let last = lower(before.last());
    match open_parenthesis(before) {
        Some(open) => inside(before, open, &last),
        None => outside(before, &last),
    }
}

fn lower(piece: Option<&Before<'_>>) -> String {
    piece.map(|piece| piece.text.to_ascii_lowercase()).unwrap_or_default()
}

/// The last `(` that is not closed; none beyond a statement.
fn open_parenthesis(before: &[Before<'_>]) -> Option<usize> {
    let mut closed = 0_usize;
    for (i, piece) in before.iter().enumerate().rev() {
        match piece.text {
            ")" => closed += 1,
            "(" if closed == 0 => return Some(i),
            "(" => closed -= 1,
            "{" | "}" => return None,
            text if begins_statement(piece, text) && closed == 0 && !is_shade(before, i) => {
                return None;
            }
            _ => {}
        }
    }
    None
}

fn begins_statement(piece: &Before<'_>, text: &str) -> bool {
    let soft = || text.eq_ignore_ascii_case("let") || text.eq_ignore_ascii_case("repeat");
    piece.piece == Piece::Word(Kind::Statement) || piece.piece == Piece::Name && soft()
}

/// `light` where no statement can begin, or before another part of a colour.
fn is_shade(before: &[Before<'_>], i: usize) -> bool {
    if !before[i].text.eq_ignore_ascii_case("light") {
        return false;
    }
    let next = before.get(i + 1).map(|next| next.piece);
    let previous = i.checked_sub(1).map(|i| &before[i]);
    let open = |piece: &Before<'_>| {
        let text = piece.text.to_ascii_lowercase();
        matches!(text.as_str(), "is" | "+" | "-" | "*" | "(" | "background" | "very")
            || piece.piece == Piece::Word(Kind::Attribute)
    };
    next == Some(Piece::Word(Kind::Color)) || previous.is_some_and(open)
}

/// What may stand in the parenthesis at `open`.
fn inside(before: &[Before<'_>], open: usize, last: &str) -> Wanted {
    let owner = lower(open.checked_sub(1).and_then(|i| before.get(i)));
    let owner_piece = open.checked_sub(1).map(|i| before[i].piece);
    let texture = is_texture_call(before, open);
    let list = arguments(&owner);
    if texture && takes_texture(&owner) && open + 1 == before.len() {
        return Wanted::of(&[Kind::Texture], &[]);
    }
    let solid = !texture && owner_piece == Some(Piece::Name) && !list.is_empty();
    if texture || solid {
        return argument(before, open, list, last);
    }
    match owner.as_str() {
        "hsv" | "rgb" | "spot" | "at" | "toward" | "rotate" | "prism" => Wanted::of(NUMBERS, &[]),
        "scale" => Wanted::of(NUMBERS, &[]),
        "trans" => Wanted::of(NUMBERS, &["fake"]),
        _ if is_function(&owner) => Wanted::of(NUMBERS, &[]),
        _ if owner_piece == Some(Piece::Name) && !TURNS.contains(&owner.as_str()) => {
            // Of a class, or a group behind a name: both may be meant.
            let class = matches!(last, "(" | ",").then_some(owner);
            Wanted { class, ..Wanted::of(&[FACTOR, NUMBERS].concat(), TURNS) }
        }
        _ if is_sum(before, open) => Wanted::of(NUMBERS, &[]),
        _ => factor(before, last),
    }
}

/// The parenthesis stands where a number does: behind `=`, `,`, an operator of numbers, or a range.
fn is_sum(before: &[Before<'_>], open: usize) -> bool {
    let owner = lower(open.checked_sub(1).and_then(|i| before.get(i)));
    matches!(owner.as_str(), "=" | "," | "/" | "^" | "from" | "to" | "step")
}

fn is_function(word: &str) -> bool {
    entries().iter().any(|entry| entry.kind == Kind::Function && entry.word == word)
}

/// `paint FUNCTION (`, or the function in the parenthesis of one that takes a function.
fn is_texture_call(before: &[Before<'_>], open: usize) -> bool {
    let back = |n: usize| lower(open.checked_sub(n).and_then(|i| before.get(i)));
    back(2) == "paint" || back(2) == "(" && takes_texture(&back(3)) && back(4) == "paint"
}

/// The name or the value of an argument.
fn argument(before: &[Before<'_>], open: usize, list: Vec<Argument>, last: &str) -> Wanted {
    if last == "=" {
        let name = lower(before.len().checked_sub(2).and_then(|i| before.get(i)));
        let words = list.iter().find(|argument| argument.name == name).map_or(&[][..], |a| a.words);
        return if words.is_empty() { Wanted::of(NUMBERS, &[]) } else { Wanted::of(&[], words) };
    }
    if !matches!(last, "(" | ",") {
        return Wanted::of(NUMBERS, &[]);
    }
    let given: Vec<String> = before[open..]
        .windows(2)
        .filter(|pair| pair[1].text == "=")
        .map(|pair| pair[0].text.to_ascii_lowercase())
        .collect();
    let words: Vec<&'static str> = match list.iter().find(|argument| !argument.words.is_empty()) {
        Some(argument) if given.is_empty() => argument.words.to_vec(),
        _ => Vec::new(),
    };
    let open_names = list.into_iter().filter(|argument| !given.contains(&argument.name.to_owned()));
    let numbers = if given.is_empty() { NUMBERS } else { &[] };
    Wanted { arguments: open_names.collect(), words, ..Wanted::of(numbers, &[]) }
}

/// What may stand outside of parentheses.
fn outside(before: &[Before<'_>], last: &str) -> Wanted {
    let begin = before
        .iter()
        .enumerate()
        .rposition(|(i, piece)| begins_statement(piece, piece.text) && !is_shade(before, i));
    let statement = lower(begin.and_then(|begin| before.get(begin)));
    let fresh = begin.is_some_and(|begin| begin + 1 == before.len());
    let color = [Kind::Color];
    match (statement.as_str(), fresh) {
        ("light", true) => Wanted::of(
            &color,
            &["point", "beam", "spot", "at", "toward", "intensity", "no", "radius", "light"],
        ),
        ("camera", true) => Wanted::of(&[], &["at", "parallel"]),
        ("target", true) => Wanted::of(&[], &["at"]),
        ("focal", true) => Wanted::of(&[], &["length"]),
        ("ambient", true) => Wanted::of(&color, &["intensity", "light"]),
        ("background", true) => Wanted::of(&color, SHADES),
        ("fog", true) => Wanted::of(NUMBERS, &[]),
        ("object", true) => Wanted::of(&[], &["is"]),
        ("class" | "let" | "repeat" | "include", true) => Wanted::default(),
        _ => in_statement(before, &statement, last),
    }
}

/// What may follow `last` in a statement that has begun.
fn in_statement(before: &[Before<'_>], statement: &str, last: &str) -> Wanted {
    match last {
        "camera" | "parallel" => return Wanted::of(&[], &["at"]),
        "no" => return Wanted::of(&[], &["shadows"]),
        "at" | "toward" | "rotate" | "spot" | "trans" | "hsv" | "rgb" => return Wanted::default(),
        "scale" | "shininess" | "smoothness" | "priority" | "intensity" | "length" | "radius"
        | "aperture" => {
            return Wanted::of(NUMBERS, &[]);
        }
        "paint" => return Wanted::of(&[Kind::Texture], &[]),
        "is" | "+" | "*" => return factor(before, last),
        _ => {}
    }
    if let Some(color) = in_color(before, last) {
        return color;
    }
    match statement {
        "light" => {
            let clauses = &["at", "toward", "intensity", "no", "radius"];
            Wanted::of(&[Kind::Color, Kind::Statement], clauses)
        }
        "ambient" => Wanted::of(&[Kind::Color, Kind::Statement], &["intensity"]),
        "camera" => Wanted::of(&[Kind::Statement], &["aperture", "focus", "let", "repeat"]),
        "target" | "focal" | "background" | "fog" | "include" => {
            Wanted::of(&[Kind::Statement], &["let", "repeat"])
        }
        "let" => Wanted::of(&[NUMBERS, &[Kind::Statement]].concat(), &[]),
        "repeat" => range(before, last),
        "object" | "class" => factor(before, last),
        _ => Wanted::of(&[Kind::Statement], &[]),
    }
}

/// The rest of a colour that has begun.
fn in_color(before: &[Before<'_>], last: &str) -> Option<Wanted> {
    const HUES: &[&str] = &["red", "orange", "brown", "yellow", "green", "blue", "purple"];
    const SPLASHES: &[&str] =
        &["reddish", "orangish", "brownish", "yellowish", "greenish", "bluish", "purplish"];
    const SATURATIONS: &[&str] = &["grayish", "moderate", "strong", "vivid"];
    let words = match last {
        "very" => vec!["dark", "light"],
        "dark" | "medium" => [HUES, SPLASHES, SATURATIONS, &["gray"]].concat(),
        "light" if before.len() > 1 => [HUES, SPLASHES, SATURATIONS, &["gray"]].concat(),
        _ if SATURATIONS.contains(&last) || last == "greyish" => [HUES, SPLASHES].concat(),
        _ if SPLASHES.contains(&last) => HUES.to_vec(),
        "-" => {
            let hue = lower(before.len().checked_sub(2).and_then(|i| before.get(i)));
            if !HUES.contains(&hue.as_str()) {
                return Some(factor(before, last));
            }
            return Some(Wanted::of(FACTOR, HUES));
        }
        _ => return None,
    };
    Some(Wanted::of(&[], &words))
}

/// What may stand in `repeat i from a to b step c {`.
fn range(before: &[Before<'_>], last: &str) -> Wanted {
    let said = |word: &str| {
        let begin = before.iter().rposition(|piece| piece.text.eq_ignore_ascii_case("repeat"));
        begin.is_some_and(|begin| {
            before[begin..].iter().any(|piece| piece.text.eq_ignore_ascii_case(word))
        })
    };
    match last {
        "from" | "to" | "step" => Wanted::of(NUMBERS, &[]),
        "{" | "}" => Wanted::of(&[Kind::Statement], &["let", "repeat"]),
        _ if said("step") => Wanted::of(NUMBERS, &[]),
        _ if said("to") => Wanted::of(NUMBERS, &["step"]),
        _ if said("from") => Wanted::of(NUMBERS, &["to"]),
        _ => Wanted::of(&[], &["from"]),
    }
}

/// A part of a solid: what begins one behind an operator or an attribute, what follows it behind one.
fn factor(before: &[Before<'_>], last: &str) -> Wanted {
    let begins = matches!(last, "is" | "+" | "-" | "*" | "(");
    let piece = before.last().map(|last| last.piece);
    match piece {
        _ if begins => Wanted::of(FACTOR, &[TURNS, SHADES, &["very"]].concat()),
        Some(Piece::Word(Kind::Attribute | Kind::Color)) => {
            Wanted::of(FACTOR, &[TURNS, SHADES].concat())
        }
        Some(Piece::Name) if TURNS.contains(&last) => Wanted::of(&[], &["of"]),
        Some(Piece::Word(Kind::Clause)) => Wanted::default(),
        // A number or a vector may end an attribute or a transform.
        Some(Piece::Number) => {
            let kinds = [FACTOR, &[Kind::Transform, Kind::Statement]].concat();
            Wanted::of(&kinds, &["to", "step"])
        }
        _ if last == ")" => {
            Wanted::of(&[FACTOR, &[Kind::Transform, Kind::Statement]].concat(), &[])
        }
        _ => Wanted::of(&[Kind::Transform, Kind::Statement], &["is", "let", "repeat", "from"]),
    }
}
