//! Stiff and extreme cases: one table of what is promised of each and how it is measured.
//!
//! A test measures all and fails where a promise is broken. The program `stability` (`main.rs`) writes the page
//! `docs/stability.md` of the same table.

mod algebra;
pub(crate) mod case;
mod extreme;
mod kernel;
mod long;
pub(crate) mod page;
mod place;
pub(crate) mod povray;
mod refusal;
mod right;
mod scale;
mod toolkit;

use case::Case;

/// The table.
pub(crate) fn table() -> Vec<Case> {
    [
        scale::cases(),
        right::cases(),
        algebra::cases(),
        long::cases(),
        kernel::cases(),
        toolkit::cases(),
        refusal::cases(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

#[cfg(test)]
mod tests {
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
    fn survey() {
        let mut section = "";
        for case in table() {
            if std::env::var("ONLY")
                .is_ok_and(|only| !format!("{}{}", case.section, case.name).contains(&only))
            {
                continue;
            }
            if case.section != section {
                section = case.section;
                eprintln!("## {section}");
            }
            let start = std::time::Instant::now();
            let found = (case.measure)();
            eprintln!(
                "{} {} | {} | {found} | {:.2} s",
                if case.holds(&found) { "ok " } else { "BAD" },
                case.name,
                case.promise,
                start.elapsed().as_secs_f64()
            );
        }
    }

    #[test]
    fn promises_are_kept() {
        kept(0);
    }

    #[test]
    fn other_promises_are_kept() {
        kept(1);
    }

    #[test]
    fn the_page_has_the_rows_of_the_table() {
        let text = std::fs::read_to_string(root().join("docs/stability.md")).expect("the page");
        let rows: Vec<&str> = text.lines().filter(|line| line.starts_with("| ")).collect();
        let cases = table();
        for case in &cases {
            let found = rows.iter().filter(|row| row.starts_with(&page::begin(case))).count();
            assert!(found > 0, "{}: {} is not in docs/stability.md", case.section, case.name);
        }
        let heads = text.lines().filter(|line| line.starts_with("| --- ")).count();
        assert_eq!(rows.len(), cases.len() + 2 * heads, "rows of docs/stability.md");
    }

    #[test]
    fn a_broken_promise_is_seen() {
        use super::case::{Case, Found, Promise};
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
            (Promise::Said("too small"), Found::Said(String::new()), false),
        ] {
            let case = Case::new("", "", promise, || Found::NONE);
            assert_eq!(case.holds(&found), holds, "{promise} {found:?}");
        }
    }
}
