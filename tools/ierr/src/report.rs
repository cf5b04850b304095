//! What was found, as text and as JSON.

use std::fmt::{self, Write};

use crate::metric::{Measured, Row, Unit};
use crate::pair::{ONE, Pair, Scale};

/// One metric and what it found; nothing where the images are too small for it.
#[derive(Clone, Debug)]
pub struct Figure {
    /// The row of the metric.
    pub row: &'static Row,
    /// What it found.
    pub measured: Option<Measured>,
}

/// All figures of two images.
#[derive(Clone, Debug)]
pub struct Report {
    /// Names of the two images.
    pub names: [String; 2],
    /// Columns and rows.
    pub size: [usize; 2],
    /// What values are.
    pub scale: Scale,
    /// Samples that could not be compared; in no figure.
    pub incomparable: usize,
    /// The figures, in the order that was asked for.
    pub figures: Vec<Figure>,
}

impl Report {
    /// A report of `pair` without figures.
    pub fn new(names: [String; 2], pair: &Pair) -> Self {
        Self {
            names,
            size: [pair.columns, pair.rows],
            scale: pair.scale,
            incomparable: pair.incomparable(),
            figures: Vec::new(),
        }
    }

    /// One object on one line. Keys stay as they are in later versions, and new ones may come:
    /// `reference`, `test`, `columns`, `rows`, `scale` (`display` or `linear`), `incomparable`,
    /// and `metrics`, which has an object for each metric by its word. A metric has `value`, for
    /// differences of display values `steps` (255 times as much), where there are any `channels` by
    /// their words, and `worst` with `column`, `row` and `channel`. A number that is not finite is `null`, and
    /// so is a metric that the images are too small for.
    pub fn to_json(&self) -> String {
        let [reference, test] = self.names.each_ref().map(|name| quoted(name));
        let [columns, rows] = self.size;
        let metrics: Vec<String> =
            self.figures.iter().map(|figure| figure.to_json(self.scale)).collect();
        format!(
            "{{\"reference\":{reference},\"test\":{test},\"columns\":{columns},\"rows\":{rows},\
             \"scale\":\"{}\",\"incomparable\":{},\"metrics\":{{{}}}}}",
            self.scale.word(),
            self.incomparable,
            metrics.join(",")
        )
    }
}

impl Scale {
    /// The word in a report.
    pub fn word(self) -> &'static str {
        match self {
            Self::Display => "display",
            Self::Linear => "linear",
        }
    }
}

impl Figure {
    fn to_json(&self, scale: Scale) -> String {
        let word = self.row.word;
        let Some(Measured { value, channels, worst, .. }) = &self.measured else {
            return format!("\"{word}\":null");
        };
        let mut fields = vec![format!("\"value\":{}", number(*value))];
        if self.row.unit == Unit::Value && scale == Scale::Display {
            fields.push(format!("\"steps\":{}", number(value * f64::from(ONE))));
        }
        if !channels.is_empty() {
            let channels = channels.iter().map(|(kind, v)| format!("\"{kind}\":{}", number(*v)));
            fields.push(format!("\"channels\":{{{}}}", channels.collect::<Vec<_>>().join(",")));
        }
        if let Some(place) = worst {
            let channel = place.kind.map(|kind| format!(",\"channel\":\"{kind}\""));
            fields.push(format!(
                "\"worst\":{{\"column\":{},\"row\":{}{}}}",
                place.column,
                place.row,
                channel.unwrap_or_default()
            ));
        }
        format!("\"{word}\":{{{}}}", fields.join(","))
    }

    fn write(&self, f: &mut fmt::Formatter<'_>, scale: Scale) -> fmt::Result {
        write!(f, "{:5}", self.row.word)?;
        let Some(Measured { value, channels, worst, .. }) = &self.measured else {
            return writeln!(f, "  the images are too small");
        };
        match self.row.unit {
            Unit::Value if scale == Scale::Display => {
                write!(f, "  {value:.6}  {:.4} steps of 255", value * f64::from(ONE))?;
            }
            Unit::Value | Unit::Score => write!(f, "  {value:.6}")?,
            Unit::Decibels => write!(f, "  {value:.4} dB")?,
        }
        if channels.len() > 1 {
            for (kind, value) in channels {
                match self.row.unit {
                    Unit::Decibels => write!(f, "  {kind} {value:.4}")?,
                    Unit::Value | Unit::Score => write!(f, "  {kind} {value:.6}")?,
                }
            }
        }
        if let Some(place) = worst {
            write!(f, "  worst at {},{}", place.column, place.row)?;
            if let Some(kind) = place.kind {
                write!(f, " in {kind}")?;
            }
        }
        writeln!(f)
    }
}

/// One line for each metric; values from 0 to 1, and in display steps.
impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.figures.iter().try_for_each(|figure| figure.write(f, self.scale))
    }
}

/// A number of JSON, which has none that is not finite.
fn number(value: f64) -> String {
    if value.is_finite() { value.to_string() } else { "null".into() }
}

fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => {
                write!(quoted, "\\u{:04x}", u32::from(c)).expect("a string takes all");
            }
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::Place;
    use idf::Kind;

    fn report() -> Report {
        let figure = |word, measured| Figure { row: Row::from_word(word).unwrap(), measured };
        let max = Measured {
            value: 0.2,
            channels: vec![(Kind::Red, 0.2), (Kind::Cvg, 0.0)],
            worst: Some(Place { column: 3, row: 1, kind: Some(Kind::Red) }),
            map: None,
        };
        let psnr = Measured { value: f64::INFINITY, channels: Vec::new(), worst: None, map: None };
        Report {
            names: ["a \"b\".png".into(), "c\\d\n".into()],
            size: [4, 2],
            scale: Scale::Display,
            incomparable: 5,
            figures: vec![
                figure("max", Some(max)),
                figure("psnr", Some(psnr)),
                figure("ssim", None),
            ],
        }
    }

    #[test]
    fn json_has_stable_keys() {
        let expected = "{\"reference\":\"a \\\"b\\\".png\",\"test\":\"c\\\\d\\u000a\",\"columns\":4,\
                        \"rows\":2,\"scale\":\"display\",\"incomparable\":5,\"metrics\":{\
                        \"max\":{\"value\":0.2,\"steps\":51,\"channels\":{\"red\":0.2,\"cvg\":0},\
                        \"worst\":{\"column\":3,\"row\":1,\"channel\":\"red\"}},\
                        \"psnr\":{\"value\":null},\"ssim\":null}}";
        assert_eq!(report().to_json(), expected);
        let linear = Report { scale: Scale::Linear, ..report() };
        assert!(!linear.to_json().contains("steps"), "light has no display steps");
    }

    #[test]
    fn text_has_a_line_for_each_metric() {
        let expected = "max    0.200000  51.0000 steps of 255  red 0.200000  cvg 0.000000  \
                        worst at 3,1 in red\n\
                        psnr   inf dB\n\
                        ssim   the images are too small\n";
        assert_eq!(report().to_string(), expected);
    }
}
