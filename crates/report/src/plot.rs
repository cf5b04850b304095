//! Plots of two logarithmic axes as SVG.
//!
//! They hold no script and no address, follow the colours that the reader has chosen, and come in two widths, so that
//! letters stay readable on a small screen. Crates that draw plots were tried: `plotters` puts minor lines of
//! logarithmic axes at equal steps, leaves decades without numbers, and knows no dark background.

use std::fmt::Write;

use crate::table::{escaped, significant};

/// A point of a plot.
#[derive(Clone, Debug)]
pub struct Dot {
    /// Where, above 0.
    pub at: [f64; 2],
    /// What stands beside it.
    pub label: String,
    /// What is shown when it is pointed at.
    pub about: String,
}

/// Points that belong together.
#[derive(Clone, Debug)]
pub struct Series {
    /// What the legend says.
    pub name: String,
    /// By rising x.
    pub dots: Vec<Dot>,
}

/// A plot of two logarithmic axes.
#[derive(Clone, Debug, Default)]
pub struct Plot {
    /// Title.
    pub title: String,
    /// Names of the axes, with units.
    pub axes: [String; 2],
    /// At most [`Plot::MOST_SERIES`] have a look of their own.
    pub series: Vec<Series>,
    /// A line that nothing beats, under all points.
    pub frontier: Vec<[f64; 2]>,
    /// Heights that matter.
    pub levels: Vec<f64>,
}

/// How wide a plot is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// For screens of a desk.
    Wide,
    /// For a hand.
    Narrow,
}

/// Colours, named in the style; the words of markers go with them.
const LOOKS: [&str; Plot::MOST_SERIES] = ["a", "b", "c", "d", "e", "f", "g", "h"];

/// Colours that differ in lightness as well (Okabe and Ito 2002), on white and on black.
const STYLE: &str = "\
.plot{--paper:#fbfaf7;--ink:#23262b;--soft:#62676f;--line:#dcd9d1;--a:#0072b2;--b:#c8500a;--c:#00805c;--d:#a8498a;--e:#8a6d00;--f:#3f8fc4;\
--g:#5b5b5b;--h:#b03030;font-family:system-ui,sans-serif}\
@media (prefers-color-scheme:dark){.plot{--paper:#14171c;--ink:#d8dbe0;--soft:#969ca6;--line:#2c323b;--a:#56b4e9;--b:#f0883e;--c:#2fc49a;--d:#e08cc4;\
--e:#e6c84a;--f:#9fd0f0;--g:#b0b0b0;--h:#ff8080}}\
.plot text{fill:var(--ink)}.plot .soft{fill:var(--soft)}.plot .grid{stroke:var(--line);stroke-width:1;fill:none}\
.plot .minor{stroke-opacity:.45}.plot .frontier{stroke:var(--ink);stroke-opacity:.16;stroke-width:9;fill:none;\
stroke-linejoin:round;stroke-linecap:round}.plot .level{stroke:var(--soft);stroke-dasharray:5 4;fill:none}\
.plot .halo{paint-order:stroke;stroke:var(--paper);stroke-width:3px;stroke-linejoin:round}";

/// Where things are in a form.
struct Layout {
    size: [f64; 2],
    /// Left, top, right, bottom of the field.
    field: [f64; 4],
    letter: f64,
    /// Width of a letter, about.
    wide: f64,
    columns: usize,
}

impl Layout {
    /// For a legend of so many entries, the longest of so many letters.
    fn new(form: Form, entries: usize, longest: usize) -> Self {
        let (width, height, letter, columns) = match form {
            Form::Wide => (760.0, 420.0, 13.0, if longest > 26 { 2 } else { 3 }),
            Form::Narrow => (368.0, 380.0, 12.5, 1),
        };
        #[expect(clippy::cast_precision_loss, reason = "a few rows")]
        let legend = entries.div_ceil(columns) as f64 * letter * 1.6;
        let top = 2.9 * letter + legend;
        let field = [4.2 * letter, top, width - 1.2 * letter, top + height - 3.6 * letter];
        let size = [width, field[3] + 3.6 * letter];
        Self { size, field, letter, wide: 0.58 * letter, columns }
    }
}

/// A logarithmic axis from one number to another, over pixels.
struct Axis {
    range: [f64; 2],
    pixels: [f64; 2],
}

impl Axis {
    /// An axis that holds all of `values`, with some room.
    fn over(values: impl Iterator<Item = f64>, pixels: [f64; 2]) -> Self {
        let plain = values.filter(|x| *x > 0.0 && x.is_finite()).map(libm::log10);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for x in plain {
            low = if x < low { x } else { low };
            high = if x > high { x } else { high };
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        let room = 0.06 * (high - low) + 0.08;
        Self { range: [low - room, high + room], pixels }
    }

    fn place(&self, value: f64) -> f64 {
        let share = (libm::log10(value) - self.range[0]) / (self.range[1] - self.range[0]);
        self.pixels[0] + share * (self.pixels[1] - self.pixels[0])
    }

    /// Numbers with a line, and whether the number is written. At least `room` pixels lie between those that are.
    fn ticks(&self, room: f64) -> Vec<(f64, bool)> {
        #[expect(clippy::cast_possible_truncation, reason = "decades of positive numbers")]
        let [first, last] = [self.range[0].floor() as i32, self.range[1].ceil() as i32];
        let decade = (self.pixels[1] - self.pixels[0]).abs() / (self.range[1] - self.range[0]);
        let written: &[u32] = match decade {
            // 1 to 2 and 5 to 10 are 0.3 of a decade.
            d if 0.3 * d > room => &[1, 2, 5],
            d if 0.47 * d > room => &[1, 3],
            _ => &[1],
        };
        let mut ticks = Vec::new();
        for power in first..=last {
            for digit in 1..=9_u32 {
                let value = f64::from(digit) * libm::pow(10.0, f64::from(power));
                let log = libm::log10(value);
                let decade_shown = decade > room || power.rem_euclid(2) == 0;
                if log >= self.range[0] && log <= self.range[1] {
                    ticks.push((value, decade_shown && written.contains(&digit)));
                }
            }
        }
        ticks
    }
}

/// Left, top, right, bottom.
type Area = [f64; 4];

fn overlap(a: &Area, b: &Area) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

impl Plot {
    /// Series beyond so many look like earlier ones.
    pub const MOST_SERIES: usize = 8;

    /// A picture, to be put into a page or a file of its own.
    #[must_use]
    pub fn svg(&self, form: Form) -> String {
        let entries = self.series.len() + usize::from(!self.frontier.is_empty());
        let letters = self.series.iter().map(|series| series.name.chars().count());
        let layout = Layout::new(form, entries, letters.max().unwrap_or(0));
        let Layout { size: [width, height], field: [left, top, right, bottom], letter, .. } =
            layout;
        let dots = || self.series.iter().flat_map(|series| &series.dots);
        let x = Axis::over(dots().map(|dot| dot.at[0]), [left, right]);
        let y = Axis::over(dots().map(|dot| dot.at[1]), [bottom, top]);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" viewBox=\"0 0 {width} {height:.0}\" width=\"{width}\" \
             height=\"{height:.0}\" role=\"img\" font-size=\"{letter}\"><style>{STYLE}</style><title>{}</title>\
             <rect width=\"{width}\" height=\"{height:.0}\" fill=\"var(--paper)\"/>\n",
            escaped(&self.title)
        );
        writeln!(
            svg,
            "<text x=\"{left}\" y=\"{:.1}\" font-weight=\"600\">{}</text>",
            1.3 * letter,
            escaped(&self.title)
        )
        .expect("a string");
        self.legend(&mut svg, &layout);
        self.grid(&mut svg, &layout, &x, &y);
        let line = |points: &mut dyn Iterator<Item = [f64; 2]>| {
            let places = points.map(|at| format!("{:.1},{:.1}", x.place(at[0]), y.place(at[1])));
            places.collect::<Vec<_>>().join(" ")
        };
        if !self.frontier.is_empty() {
            let points = line(&mut self.frontier.iter().copied());
            writeln!(svg, "<polyline class=\"frontier\" points=\"{points}\"/>").expect("a string");
        }
        let mut taken: Vec<Area> = dots()
            .map(|dot| {
                let (x, y) = (x.place(dot.at[0]), y.place(dot.at[1]));
                [x - 4.0, y - 4.0, x + 4.0, y + 4.0]
            })
            .collect();
        let mut labels = String::new();
        for (number, series) in self.series.iter().enumerate() {
            let look = LOOKS[number % LOOKS.len()];
            let points = line(&mut series.dots.iter().map(|dot| dot.at));
            writeln!(
                svg,
                "<polyline points=\"{points}\" fill=\"none\" stroke=\"var(--{look})\" stroke-width=\"1.6\"/>"
            )
            .expect("a string");
            for dot in &series.dots {
                let (x, y) = (x.place(dot.at[0]), y.place(dot.at[1]));
                let about = escaped(&dot.about);
                writeln!(svg, "<g><title>{about}</title>{}</g>", marker(number, x, y))
                    .expect("a string");
                label(&mut labels, &layout, look, &dot.label, (x, y), &mut taken);
            }
        }
        svg + &labels + "</svg>\n"
    }

    fn legend(&self, svg: &mut String, layout: &Layout) {
        let Layout { field: [left, _, right, _], letter, columns, .. } = *layout;
        #[expect(clippy::cast_precision_loss, reason = "a few entries")]
        let place = |number: usize| {
            let column = (number % columns) as f64 * (right - left) / columns as f64;
            (left + column, (2.9 + 1.6 * (number / columns) as f64) * letter)
        };
        for (number, series) in self.series.iter().enumerate() {
            let (x, y) = place(number);
            let mark = marker(number, x + 6.0, y - 0.35 * letter);
            let name = escaped(&series.name);
            writeln!(svg, "{mark}<text x=\"{:.1}\" y=\"{y:.1}\">{name}</text>", x + 17.0)
                .expect("a string");
        }
        if !self.frontier.is_empty() {
            let (x, y) = place(self.series.len());
            let middle = y - 0.35 * letter;
            writeln!(
                svg,
                "<line class=\"frontier\" x1=\"{:.1}\" y1=\"{middle:.1}\" x2=\"{:.1}\" y2=\"{middle:.1}\"/>\
                 <text x=\"{:.1}\" y=\"{y:.1}\">efficient frontier</text>",
                x + 3.0, x + 12.0, x + 22.0
            )
            .expect("a string");
        }
    }

    fn grid(&self, svg: &mut String, layout: &Layout, x: &Axis, y: &Axis) {
        let Layout { size: [width, height], field: [left, top, right, bottom], letter, .. } =
            *layout;
        let mut lines = |path: String, class: &str| {
            writeln!(svg, "<path class=\"{class}\" d=\"{path}\"/>").expect("a string");
        };
        let (across, down) = (x.ticks(3.6 * letter), y.ticks(1.7 * letter));
        for written in [false, true] {
            let mut path = String::new();
            for (value, _) in across.iter().filter(|tick| tick.1 == written) {
                write!(path, "M{:.1} {top:.1}V{bottom:.1}", x.place(*value)).expect("a string");
            }
            for (value, _) in down.iter().filter(|tick| tick.1 == written) {
                write!(path, "M{left:.1} {:.1}H{right:.1}", y.place(*value)).expect("a string");
            }
            lines(path, if written { "grid" } else { "grid minor" });
        }
        for level in &self.levels {
            let at = y.place(*level);
            if at > top && at < bottom {
                lines(format!("M{left:.1} {at:.1}H{right:.1}"), "level");
            }
        }
        let mut text = |x: f64, y: f64, anchor: &str, words: &str| {
            writeln!(
                svg,
                "<text class=\"soft\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>",
                escaped(words)
            )
            .expect("a string");
        };
        for (value, _) in across.iter().filter(|tick| tick.1) {
            let (at, words) = (x.place(*value), tick(*value));
            if at + 1.2 * letter < width {
                text(at, bottom + 1.3 * letter, "middle", &words);
            }
        }
        for (value, _) in down.iter().filter(|tick| tick.1) {
            text(left - 0.5 * letter, y.place(*value) + 0.35 * letter, "end", &tick(*value));
        }
        text(0.5 * (left + right), height - 0.5 * letter, "middle", &self.axes[0]);
        let (x, y) = (0.95 * letter, 0.5 * (top + bottom));
        writeln!(
            svg,
            "<text class=\"soft\" transform=\"translate({x:.1} {y:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            escaped(&self.axes[1])
        )
        .expect("a string");
    }
}

/// A number of one digit at an axis, short.
fn tick(value: f64) -> String {
    // A bound on what rounding makes of powers of ten.
    let least = |bound: f64| value >= bound * (1.0 - 1e-9);
    match value {
        _ if least(1e9) => format!("{value:.0e}"),
        _ if least(1e6) => significant(value / 1e6, 1) + "M",
        _ if least(1e4) => significant(value / 1e3, 1) + "k",
        _ if least(1e-3) => significant(value, 1),
        _ => format!("{value:.0e}"),
    }
}

/// The sign of a series.
fn marker(number: usize, x: f64, y: f64) -> String {
    let look = LOOKS[number % LOOKS.len()];
    let fill = format!("fill=\"var(--{look})\"");
    match number % 4 {
        0 => format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" {fill}/>"),
        1 => format!(
            "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"7\" height=\"7\" {fill}/>",
            x - 3.5,
            y - 3.5
        ),
        2 => format!("<path d=\"M{x:.1} {:.1}l4.6 8h-9.2z\" {fill}/>", y - 5.0),
        _ => format!("<path d=\"M{x:.1} {:.1}l5 5l-5 5l-5 -5z\" {fill}/>", y - 5.0),
    }
}

/// Puts a label beside a point where nothing is yet; where there is no such place, it is left out.
fn label(
    svg: &mut String,
    layout: &Layout,
    look: &str,
    words: &str,
    (x, y): (f64, f64),
    taken: &mut Vec<Area>,
) {
    let Layout { field: [left, top, right, bottom], letter, wide, .. } = *layout;
    #[expect(clippy::cast_precision_loss, reason = "a few letters")]
    let width = words.chars().count() as f64 * wide;
    if words.is_empty() {
        return;
    }
    let places = [
        (x + 7.0, y - 4.0),
        (x + 7.0, y + 1.0 + 0.8 * letter),
        (x - 7.0 - width, y + 1.0 + 0.8 * letter),
        (x - 7.0 - width, y - 4.0),
        (x - 0.5 * width, y - 8.0),
        (x - 0.5 * width, y + 7.0 + 0.8 * letter),
    ];
    let area = |&(x, y): &(f64, f64)| [x, y - 0.8 * letter, x + width, y + 0.1 * letter];
    let is_free = |place: &&(f64, f64)| {
        let [a, b, c, d] = area(place);
        let within = a >= left && b >= top && c <= right && d <= bottom;
        within && !taken.iter().any(|other| overlap(&[a, b, c, d], other))
    };
    let Some(place) = places.iter().find(is_free) else { return };
    taken.push(area(place));
    writeln!(
        svg,
        "<text class=\"halo\" x=\"{:.1}\" y=\"{:.1}\" font-size=\"{:.1}\" style=\"fill:var(--{look})\">{}</text>",
        place.0, place.1, 0.88 * letter, escaped(words)
    )
    .expect("a string");
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot() -> Plot {
        let dot = |at: [f64; 2]| Dot { at, label: "1 & <2>".into(), about: "\"all\" of it".into() };
        let series = |k: f64| Series {
            name: format!("s{k} < t"),
            dots: (0..6)
                .map(|i| dot([k * libm::pow(2.0, f64::from(i)), libm::pow(0.5, f64::from(i))]))
                .collect(),
        };
        Plot {
            title: "Error & time".into(),
            axes: ["seconds".into(), "error".into()],
            series: (1..=5).map(|k| series(f64::from(k))).collect(),
            frontier: vec![[1.0, 1.0], [2.0, 0.5]],
            levels: vec![0.3, 99.0],
        }
    }

    #[test]
    fn plots_are_well_formed_and_ask_for_nothing() {
        for plot in [plot(), Plot::default()] {
            for form in [Form::Wide, Form::Narrow] {
                let svg = plot.svg(form);
                let parsed = roxmltree::Document::parse(&svg);
                assert!(parsed.is_ok(), "{parsed:?}: {svg}");
                let without_name = svg.replace("http://www.w3.org/2000/svg", "");
                assert!(!without_name.contains("http") && !svg.contains("NaN"), "{svg}");
                assert_eq!(
                    svg.matches("class=\"level\"").count(),
                    usize::from(!plot.levels.is_empty())
                );
            }
        }
    }

    #[test]
    fn a_place_on_an_axis_is_a_logarithm() {
        let axis = Axis { range: [-1.0, 3.0], pixels: [100.0, 500.0] };
        for (value, expected) in
            [(0.1, 100.0), (1.0, 200.0), (1000.0, 500.0), (31.622_776_6, 350.0)]
        {
            assert!((axis.place(value) - expected).abs() < 1e-6, "{value}");
        }
        let written: Vec<f64> = axis.ticks(40.0).iter().filter(|t| t.1).map(|t| t.0).collect();
        let expected = [0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0];
        let near = written.iter().zip(expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-9);
        assert!(near && written.len() == expected.len(), "{written:?}");
        assert_eq!(axis.ticks(40.0).len(), 37, "nine lines a decade");
    }

    #[test]
    fn numbers_at_axes_are_short() {
        for (value, expected) in [
            (2e-4, "2e-4"),
            (0.001, "0.001"),
            (0.5, "0.5"),
            (5000.0, "5000"),
            (1e4, "10k"),
            (200_000.0, "200k"),
            (1e6, "1M"),
            (5e9, "5e9"),
        ] {
            assert_eq!(tick(value), expected);
        }
    }

    #[test]
    fn labels_stand_clear_of_each_other() {
        let layout = Layout::new(Form::Wide, 1, 9);
        let (mut svg, mut taken) = (String::new(), Vec::new());
        for _ in 0..20 {
            label(&mut svg, &layout, "a", "16", (300.0, 200.0), &mut taken);
        }
        assert!(taken.len() >= 4 && taken.len() < 20, "{}", taken.len());
        for (number, one) in taken.iter().enumerate() {
            assert!(!taken[..number].iter().any(|other| overlap(one, other)), "{taken:?}");
        }
    }
}
