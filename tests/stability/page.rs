//! The page that holds the table.

use std::fmt::Write;

use super::case::{Case, Found};

/// Text before the table.
const HEAD: &str = include_str!("head.md");

/// POV-Ray's figure for a case, if there is one.
fn povray<'f>(case: &Case, figures: &'f str) -> Option<&'f str> {
    let mut rows = figures.lines().filter_map(|line| line.split_once(';'));
    rows.find(|(name, _)| case.peer.is_some() && *name == case.name).map(|(_, figure)| figure)
}

/// The page, with what POV-Ray made of cases by their names.
pub(crate) fn page(rows: &[(Case, Found)], figures: &str) -> String {
    let mut text = HEAD.to_owned();
    let (mut section, mut beside) = ("", false);
    for (number, (case, found)) in rows.iter().enumerate() {
        if case.section != section {
            section = case.section;
            let same = |row: &&(Case, Found)| row.0.section == section;
            beside = rows[number..].iter().take_while(same).any(|row| row.0.peer.is_some());
            let (peer, line) = if beside { (" POV-Ray |", " --- |") } else { ("", "") };
            let _ = write!(
                text,
                "\n## {section}\n\n| case | promised | measured |{peer}\n| --- | --- | --- |{line}\n"
            );
        }
        let peer = povray(case, figures).unwrap_or("–");
        let peer = if beside { format!(" {peer} |") } else { String::new() };
        let _ = writeln!(text, "| {} | {} | {found} |{peer}", case.name, case.promise);
    }
    text
}
