//! Tables: as CSV, as HTML, and as Markdown.

use std::fmt::Write;

/// What stands in a place of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A figure. What is not a number is shown as nothing.
    Number(f64),
}

/// Rows of cells under named columns.
#[derive(Clone, Debug)]
pub struct Table {
    /// The name of its file without ending.
    pub name: &'static str,
    /// What it is about.
    pub title: &'static str,
    /// Names of the columns, units included.
    pub columns: Vec<&'static str>,
    /// As long as there are columns.
    pub rows: Vec<Vec<Cell>>,
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<Option<f64>> for Cell {
    fn from(number: Option<f64>) -> Self {
        Self::Number(number.unwrap_or(f64::NAN))
    }
}

/// A number in so many significant digits, without zeros at its end; nothing if it is not a number.
#[must_use]
pub fn significant(number: f64, digits: usize) -> String {
    if number.is_nan() {
        return String::new();
    }
    if number.is_infinite() || number.abs() <= 0.0 {
        return if number.is_infinite() { "∞".into() } else { "0".into() };
    }
    let scientific = format!("{number:.*e}", digits.max(1) - 1);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let trimmed = |text: &str| -> String {
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').into()
        } else {
            text.into()
        }
    };
    if !(-4..9).contains(&exponent) {
        return format!("{}e{exponent}", trimmed(mantissa));
    }
    let decimals = usize::try_from(i32::try_from(digits).unwrap_or(6) - 1 - exponent).unwrap_or(0);
    // Rounded once, to the digits that count.
    let rounded: f64 = scientific.parse().unwrap_or(number);
    trimmed(&format!("{rounded:.decimals$}"))
}

/// A text with what HTML means by its signs written out.
#[must_use]
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A field of CSV (RFC 4180).
fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

impl Cell {
    fn shown(&self, digits: usize) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Number(number) => significant(*number, digits),
        }
    }
}

impl Table {
    /// A table without rows.
    #[must_use]
    pub fn new(name: &'static str, title: &'static str, columns: &[&'static str]) -> Self {
        Self { name, title, columns: columns.into(), rows: Vec::new() }
    }

    /// Adds a row.
    ///
    /// # Panics
    ///
    /// If it is not as long as there are columns.
    pub fn row<const N: usize>(&mut self, cells: [Cell; N]) {
        assert_eq!(N, self.columns.len(), "{}: a cell for each column", self.name);
        self.rows.push(cells.into());
    }

    /// Comma-separated values (RFC 4180) with a line of names; numbers in six digits, infinite ones as `inf`.
    #[must_use]
    pub fn csv(&self) -> String {
        let line = |fields: Vec<String>| fields.join(",") + "\n";
        let mut text = line(self.columns.iter().map(|name| field(name)).collect());
        for row in &self.rows {
            let cell = |cell: &Cell| match cell {
                Cell::Number(number) if number.is_infinite() => "inf".into(),
                cell => field(&cell.shown(6)),
            };
            text += &line(row.iter().map(cell).collect());
        }
        text
    }

    /// Markdown, numbers in three digits.
    #[must_use]
    pub fn markdown(&self) -> String {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let mut text = line(self.columns.iter().map(|&name| name.to_owned()).collect());
        text += &line(self.columns.iter().map(|_| "---".to_owned()).collect());
        for row in &self.rows {
            text += &line(row.iter().map(|cell| cell.shown(3).replace('|', "\\|")).collect());
        }
        text
    }

    /// An HTML table that can be moved aside where it is wider than the page; numbers in three digits.
    #[must_use]
    pub fn html(&self) -> String {
        let mut text = String::from("<div class=\"scroll\"><table><thead><tr>");
        for (at, name) in self.columns.iter().enumerate() {
            let numbers = self.rows.iter().any(|row| matches!(row.get(at), Some(Cell::Number(_))));
            let class = if numbers { " class=\"number\"" } else { "" };
            write!(text, "<th{class}>{}</th>", escaped(name)).expect("a string");
        }
        text += "</tr></thead><tbody>\n";
        for row in &self.rows {
            text += "<tr>";
            for cell in row {
                let class = if matches!(cell, Cell::Number(_)) { " class=\"number\"" } else { "" };
                write!(text, "<td{class}>{}</td>", escaped(&cell.shown(3))).expect("a string");
            }
            text += "</tr>\n";
        }
        text + "</tbody></table></div>\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_count() {
        for (number, digits, expected) in [
            (0.0, 3, "0"),
            (-0.0, 3, "0"),
            (2.371_9, 3, "2.37"),
            (0.089_96, 3, "0.09"),
            (0.000_123_4, 3, "0.000123"),
            (0.000_012_34, 3, "1.23e-5"),
            (999.6, 3, "1000"),
            (123_456.0, 3, "123000"),
            (1.5e12, 3, "1.5e12"),
            (-7.25, 2, "-7.2"),
            (f64::NAN, 3, ""),
            (f64::INFINITY, 3, "∞"),
        ] {
            assert_eq!(significant(number, digits), expected, "{number}");
        }
    }

    #[test]
    fn the_three_forms_hold_the_same() {
        let mut table = Table::new("t", "a table", &["way", "error, steps"]);
        table.row(["--aa none, \"1\"".into(), 0.25.into()]);
        table.row(["a<b|c".into(), f64::NAN.into()]);
        assert_eq!(table.csv(), "way,\"error, steps\"\n\"--aa none, \"\"1\"\"\",0.25\na<b|c,\n");
        let markdown =
            "| way | error, steps |\n| --- | --- |\n| --aa none, \"1\" | 0.25 |\n| a<b\\|c |  |\n";
        assert_eq!(table.markdown(), markdown);
        let html = table.html();
        assert!(html.contains("<td>a&lt;b|c</td><td class=\"number\"></td>"), "{html}");
        assert!(html.contains("<td class=\"number\">0.25</td>"), "{html}");
    }
}
