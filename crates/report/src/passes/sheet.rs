//! Tables and the page of what leaving out saves.

use super::measure::{Seen, name_of};
use crate::journal::Figures;
use crate::page;
use crate::table::{Cell, Table};

/// A scene with what was found.
#[derive(Clone, Debug)]
pub struct Row {
    /// Its name.
    pub name: String,
    /// What the passes did.
    pub seen: Seen,
    /// [`super::measure::measured`].
    pub figures: Figures,
}

#[expect(clippy::cast_precision_loss, reason = "counts for a table")]
fn count(number: u64) -> Cell {
    (number as f64).into()
}

impl Row {
    /// Seconds of a figure with all passes by those without one, or without all.
    fn ratio(&self, figure: &str, without: &str) -> f64 {
        self.figures.number(figure) / self.figures.number(&name_of(figure, without))
    }
}

/// All tables.
#[must_use]
pub fn tables(rows: &[Row]) -> Vec<Table> {
    vec![saved(rows), by_pass(rows)]
}

fn saved(rows: &[Row]) -> Table {
    let columns = [
        "scene",
        "primitives",
        "left",
        "load s",
        "load s, --keep-all",
        "trace s",
        "trace s, --keep-all",
        "trace, with by without",
        "same bytes",
    ];
    let mut table = Table::new("saved", "Scenes with and without all passes", &columns);
    for row in rows {
        let get = |name: &str| Cell::from(row.figures.get(name));
        let same = if row.figures.number("same") > 0.0 { "yes" } else { "no" };
        table.row([
            row.name.as_str().into(),
            count(row.seen.primitives),
            count(row.seen.left),
            get("load"),
            get("load_all"),
            get("trace"),
            get("trace_all"),
            row.ratio("trace", "all").into(),
            same.into(),
        ]);
    }
    if rows.len() > 1 {
        let (sum, number) = rows.iter().fold((0.0, 0.0), |(sum, number), row| {
            (sum + libm::log(row.ratio("trace", "all")), number + 1.0)
        });
        let mean: f64 = libm::exp(sum / number);
        let [primitives, left, load, load_all, trace, trace_all] = [f64::NAN; 6].map(Cell::from);
        table.row([
            "geometric mean".into(),
            primitives,
            left,
            load,
            load_all,
            trace,
            trace_all,
            mean.into(),
            "".into(),
        ]);
    }
    table
}

fn by_pass(rows: &[Row]) -> Table {
    let columns = [
        "scene",
        "pass",
        "what",
        "before",
        "after",
        "trace s",
        "trace s, without the pass",
        "with by without",
    ];
    let title = "Each pass: what it looks at, what is left of that, and the time without it alone";
    let mut table = Table::new("passes", title, &columns);
    for row in rows {
        for omission in row.seen.omissions.iter().filter(|omission| omission.before > 0) {
            let without = row.figures.get(&name_of("trace", omission.name));
            table.row([
                row.name.as_str().into(),
                omission.name.into(),
                omission.what.into(),
                count(omission.before),
                count(omission.after),
                row.figures.get("trace").filter(|_| without.is_some()).into(),
                without.into(),
                row.ratio("trace", omission.name).into(),
            ]);
        }
    }
    table
}

/// The page.
#[must_use]
pub fn page(rows: &[Row], (columns, height): (u32, u32)) -> String {
    let mut body = format!(
        "<p>{columns} × {height} pixels with one sample each, on one thread: each scene with all that leaves out what it \
         does not need, without any of it, and without each pass by itself, in turn; the least seconds count. A ratio \
         below 1 is time that was saved.</p>\n"
    );
    for table in tables(rows) {
        body += &page::open(&table);
    }
    page::page("What leaving out saves", &body)
}

#[cfg(test)]
mod tests {
    use super::*;
    use render::Omission;

    fn row() -> Row {
        let pass = |name, before, after| Omission { name, what: "x", reason: "y", before, after };
        let omissions = vec![pass("empty", 0, 0), pass("hidden paint", 5, 3), pass("fog", 1, 1)];
        let seen = Seen { primitives: 9, left: 4, omissions };
        let figures = Figures::default()
            .with("trace", 1.0)
            .with("trace_all", 4.0)
            .with("trace_hidden_paint", 2.0)
            .with("same", 1.0);
        Row { name: "a<b".into(), seen, figures }
    }

    #[test]
    fn ratios_are_with_by_without() {
        let other = Row { figures: row().figures.with("trace_all", 1.0), ..row() };
        let saved = saved(&[row(), other]);
        let ratios: Vec<&Cell> = saved.rows.iter().map(|row| &row[7]).collect();
        assert_eq!(ratios, [&Cell::from(0.25), &Cell::from(1.0), &Cell::from(0.5)]);
        let passes = by_pass(&[row()]);
        assert_eq!(passes.rows.len(), 2, "what looks at nothing is not told");
        assert_eq!(passes.rows[0][3..], [5.0, 3.0, 1.0, 2.0, 0.5].map(Cell::from));
        let html = page(&[row()], (8, 8));
        let parsed = roxmltree::Document::parse(html.strip_prefix("<!DOCTYPE html>\n").unwrap());
        assert!(parsed.is_ok(), "{parsed:?}");
    }
}
