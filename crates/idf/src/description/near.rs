//! Keys that are not known, but nearly: perhaps misspelt.

use super::{Description, KEYS, Line};
use crate::plane::{Kind, Role, TABLE};

impl Description {
    /// Keys of kept lines that are perhaps misspelt, each with the key that may be meant: one letter
    /// more, less, or other, two in the wrong order, or capitals; two such slips in long words. Kinds
    /// of channels are sought where a line is as one of a channel, as their words are short.
    pub fn near_misses(&self) -> Vec<(String, &'static str)> {
        let mut found = Vec::new();
        for source in &self.unknown {
            let Ok(mut line) = Line::split(source, 0) else { continue };
            let Some(key) = line.take() else { continue };
            let rest: Vec<String> = std::iter::from_fn(|| line.take()).collect();
            let small = key.to_lowercase();
            let of_keys =
                KEYS.iter().map(|row| row.0).find(|known| slips(&small, known) <= most(known));
            let of_kinds = || {
                let is_meant = |kind: Kind| slips(&small, kind.word()) <= 1 && is_like(kind, &rest);
                TABLE.iter().find(|row| is_meant(row.kind)).map(|row| row.word)
            };
            found.extend(of_keys.or_else(of_kinds).map(|known| (key, known)));
        }
        found
    }
}

/// Slips in a word of this length.
fn most(known: &str) -> usize {
    if known.len() < 8 { 1 } else { 2 }
}

/// Whether a line goes on as one of `kind`.
fn is_like(kind: Kind, rest: &[String]) -> bool {
    let is_number = |word: &String| word.parse::<u32>().is_ok();
    match rest {
        [file] => kind.role() == Role::Text && file.ends_with(".log"),
        [_, columns, rows, _, _] => {
            kind.role() != Role::Text && is_number(columns) && is_number(rows)
        }
        _ => false,
    }
}

/// Letters to change, add, leave out or exchange with the next to make one word of the other
/// (Damerau 1964, each place at most once).
fn slips(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().take(32).collect(), b.chars().collect());
    let mut rows: Vec<Vec<usize>> = vec![(0..=b.len()).collect()];
    for (i, letter) in a.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, other) in b.iter().enumerate() {
            let changed = rows[i][j] + usize::from(letter != other);
            let mut least = changed.min(row[j] + 1).min(rows[i][j + 1] + 1);
            if i > 0 && j > 0 && a[i - 1] == *other && b[j - 1] == *letter {
                least = least.min(rows[i - 1][j - 1] + 1);
            }
            row.push(least);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::*;

    #[test]
    fn slips_are_counted() {
        for (a, b, expected) in [
            ("size", "size", 0),
            ("sizee", "size", 1),
            ("siz", "size", 1),
            ("rde", "red", 1),
            ("backgruond", "background", 1),
            ("bakgruond", "background", 2),
            ("", "red", 3),
            ("camera", "matte", 5),
        ] {
            assert_eq!((slips(a, b), slips(b, a)), (expected, expected), "{a} {b}");
        }
    }

    #[test]
    fn what_is_nearly_known_is_found_and_other_keys_are_not() {
        let text = "idf 1\nsize 4 2\nsizee 3 3\ntransfre linear\nSize 1 1\nrad a.red 4 2 8 raw\n\
                    lug a.log\nrad 12\nref a\ncamera 35 mm\nlens 4 2 8 raw\n# red comment\n\
                    note \"bakgruond\"\nbakgruond 0 0 0\n";
        let found = parse(text).unwrap().near_misses();
        let found: Vec<(&str, &str)> = found.iter().map(|(a, b)| (a.as_str(), *b)).collect();
        assert_eq!(
            found,
            [
                ("sizee", "size"),
                ("transfre", "transfer"),
                ("Size", "size"),
                ("rad", "red"),
                ("lug", "log"),
                ("bakgruond", "background"),
            ]
        );
    }

    #[test]
    fn a_mark_of_the_order_of_bytes_is_no_key() {
        let plain = "idf 1\nsize 4 2\n";
        assert_eq!(parse(&format!("\u{feff}{plain}")).unwrap(), parse(plain).unwrap());
    }
}
