//! What a misspelt word may have meant.

/// Names longer than this get no suggestion: the comparison takes their length squared.
const LONGEST: usize = 32;

/// The candidate nearest to `word`, if it is near enough to be meant; the first of several. `word` is lower case.
pub(crate) fn closest<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    if word.len() > LONGEST {
        return None;
    }
    let (mut least, mut best) = (usize::MAX, None);
    for candidate in candidates {
        // A third of the letters may be wrong, and one of few.
        let limit = (word.len().max(candidate.len()) / 3).max(1);
        if candidate.len().abs_diff(word.len()) > limit || candidate.len() > 2 * LONGEST {
            continue;
        }
        let distance = distance(word.as_bytes(), candidate.as_bytes());
        if distance <= limit && distance < least {
            least = distance;
            best = Some(candidate);
        }
    }
    // One letter changed in a word of two makes another word.
    best.filter(|_| least < word.len())
}

/// The question with which a hint begins.
pub(crate) fn did_you_mean(word: Option<&str>) -> Option<String> {
    word.map(|word| format!("did you mean `{word}`?"))
}

/// Insertions, deletions, changes and swaps of neighbours from `a` to `b` (optimal string alignment).
fn distance(a: &[u8], b: &[u8]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut above: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let change = above[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = change.min(above[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(before[j - 2] + 1);
            }
            row.push(least);
        }
        before = std::mem::replace(&mut above, row);
    }
    above[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_by_hand() {
        for (a, b, expected) in [
            ("glas", "glass", 1),
            ("sphree", "sphere", 1),
            ("", "abc", 3),
            ("kitten", "sitting", 3),
            ("block", "block", 0),
        ] {
            assert_eq!(distance(a.as_bytes(), b.as_bytes()), expected, "{a} {b}");
        }
    }

    #[test]
    fn only_near_words_are_suggested() {
        let words = ["sphere", "cylinder", "cone", "block", "at"];
        assert_eq!(closest("spere", words), Some("sphere"));
        assert_eq!(closest("cilinder", words), Some("cylinder"));
        assert_eq!(closest("wheel", words), None);
        assert_eq!(closest("def", ["let", "fog"]), None, "two letters of three");
        assert_eq!(closest("plane", ["planar", "place"]), Some("place"), "the nearest");
        assert_eq!(closest("x", words), None, "one letter says nothing");
        assert_eq!(closest(&"sphere".repeat(1000), words), None, "too long");
    }
}
