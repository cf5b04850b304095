//! Stiff and extreme cases: one table of what is promised of each and how it is measured.
//!
//! A test measures all and fails where a promise is broken. The program `stability` (`main.rs`) writes the page
//! `docs/stability.md` of the same table.

mod algebra;
pub(crate) mod case;
mod extreme;
mod fresh;
mod kernel;
mod long;
pub(crate) mod page;
pub(crate) mod place;
mod refusal;
mod right;
mod scale;
mod toolkit;

pub(crate) use algebra::stud;
use case::Case;
pub(crate) use long::{compared_with, run as run_long};
pub(crate) use right::unpainted;

/// The table, each section in one piece.
pub(crate) fn table() -> Vec<Case> {
    let all = [
        scale::cases(),
        right::cases(),
        algebra::cases(),
        long::cases(),
        kernel::cases(),
        toolkit::cases(),
        refusal::cases(),
    ];
    let mut cases: Vec<Case> = all.into_iter().flatten().collect();
    let mut sections: Vec<&str> = Vec::new();
    for case in &cases {
        if !sections.contains(&case.section) {
            sections.push(case.section);
        }
    }
    cases.sort_by_key(|case| sections.iter().position(|section| *section == case.section));
    cases
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::case::{Case, Found, Peer, Promise};
    use super::{page, table};
    use crate::support::root;

    /// Measures the cases whose section's place in the table leaves this rest.
    fn kept(rest: usize) {
        let cases = table();
        let broken =
            cases.iter().enumerate().filter(|(k, _)| k % 2 == rest).filter_map(|(_, case)| {
                let found = (case.measure)();
                let said = || {
                    format!(
                        "{}: {}: promised {}, found {found:?}",
                        case.section, case.name, case.promise
                    )
                };
                (!case.holds(&found)).then(said)
            });
        let broken: Vec<String> = broken.collect();
        assert!(broken.is_empty(), "{} promises are broken:\n{}", broken.len(), broken.join("\n"));
    }

    #[test]
    fn promises_are_kept() {
        kept(0);
    }

    #[test]
    fn other_promises_are_kept() {
        kept(1);
    }

    /// A row without what was measured.
    fn promised(line: &str) -> String {
        let cells: Vec<&str> = line.split('|').collect();
        match cells.as_slice() {
            [before, name, promise, _, after @ ..] => {
                [&[*before, *name, *promise], after].concat().join("|")
            }
            _ => line.to_owned(),
        }
    }

    #[test]
    fn the_page_is_that_of_the_table() {
        let read = |name: &str| fs::read_to_string(root().join(name)).expect("it is there");
        let rows: Vec<(Case, Found)> =
            table().into_iter().map(|case| (case, Found::NONE)).collect();
        let expected = page::page(&rows, &read("tests/stability/povray.csv"));
        let found = read("docs/stability.md");
        for (expected, found) in expected.lines().zip(found.lines()) {
            assert_eq!(promised(expected), promised(found), "see tests/stability/main.rs");
        }
        assert_eq!(expected.lines().count(), found.lines().count(), "lines");
    }

    #[test]
    fn what_peers_draw_compiles_without_a_word() {
        for case in table() {
            if let Some(Peer::Itself(written) | Peer::Ours(written) | Peer::Own(written, _)) =
                &case.peer
            {
                assert_eq!(written.compiled().error_report(), "", "{}", case.name);
            }
        }
    }

    #[test]
    fn a_broken_promise_is_seen() {
        for (promise, found, holds) in [
            (Promise::Right, Found::differing(0, 9), true),
            (Promise::Right, Found::differing(1, 9), false),
            (Promise::Right, Found::NONE, false),
            (Promise::Alike, Found::differing(1, 10_000), true),
            (Promise::Alike, Found::differing(1, 9_999), false),
            (Promise::Within(2.0), Found::Error(2.0), true),
            (Promise::Within(2.0), Found::Error(2.1), false),
            (Promise::Within(2.0), Found::Error(f64::NAN), false),
            (Promise::Said("too small"), Found::Said("it is too small".to_owned()), true),
            (Promise::Within(2.0), Found::Decades(vec![1.0, 2.0]), true),
            (Promise::Within(2.0), Found::Decades(vec![2.1, 2.0]), false),
            (Promise::Said("too small"), Found::Said(String::new()), false),
        ] {
            let case = Case::new("", "", promise, || Found::NONE);
            assert_eq!(case.holds(&found), holds, "{promise} {found:?}");
        }
    }
}
