//! Tables, plots and the page of growing scenes.

use super::case::CASES;
use super::measure::TRACING;
use crate::curve::power;
use crate::journal::Figures;
use crate::page;
use crate::plot::{Dot, Plot, Series};
use crate::table::{Cell, Table, significant};

/// One scene with so many solids; 0 where it does not grow.
#[derive(Clone, Debug)]
pub struct Row {
    /// Case or file.
    pub name: String,
    /// N.
    pub count: u32,
    /// What was found.
    pub figures: Figures,
}

/// All that was found.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// Columns and rows of the pictures.
    pub size: (u32, u32),
    /// [`super::measure::Task::Growth`].
    pub growth: Vec<Row>,
    /// [`super::measure::Task::Tracing`].
    pub tracing: Vec<Row>,
    /// [`super::measure::Task::Threads`].
    pub threads: Vec<Row>,
    /// What there was no time for, or what failed.
    pub missing: Vec<String>,
}

/// The slope is that of scenes with at least so many solids, where there are two: fixed costs do not count.
const LARGE: u32 = 1000;

/// The same for ways of tracing, some of which take too long for more.
const GROWN: u32 = 100;

impl Row {
    fn count(&self) -> Cell {
        if self.count == 0 { f64::NAN.into() } else { f64::from(self.count).into() }
    }
}

impl Found {
    /// The exponent of a figure in N, by case.
    fn exponent(&self, case: &str, of: &dyn Fn(&Figures) -> f64) -> Option<f64> {
        let rows = || self.growth.iter().filter(|row| row.name == case && row.count > 0);
        let pair = |row: &Row| (f64::from(row.count), of(&row.figures));
        let large = rows().filter(|row| row.count >= LARGE);
        power(large.map(pair)).or_else(|| power(rows().map(pair)))
    }

    /// All tables.
    #[must_use]
    pub fn tables(&self) -> Vec<Table> {
        vec![
            self.growing(),
            self.slopes(),
            self.claims(),
            self.trees(),
            self.ways(),
            self.scaling(),
            self.absent(),
        ]
    }

    fn growing(&self) -> Table {
        let columns = [
            "scene",
            "N",
            "primitives",
            "compile s",
            "build s",
            "trace s",
            "primary",
            "secondary",
            "shadow",
            "rays a second",
            "memory MB",
        ];
        let mut table = Table::new("speed", "Scenes as they grow, one thread", &columns);
        for row in &self.growth {
            let get = |name: &str| Cell::from(row.figures.get(name));
            let rays: f64 = ["primary", "secondary", "shadow"]
                .map(|kind| row.figures.number(kind))
                .iter()
                .sum();
            table.row([
                row.name.as_str().into(),
                row.count(),
                get("primitives"),
                get("compile"),
                get("build"),
                get("trace"),
                get("primary"),
                get("secondary"),
                get("shadow"),
                (rays / row.figures.number("trace")).into(),
                row.figures.get("memory").map(|bytes| bytes / 1_048_576.0).into(),
            ]);
        }
        table
    }

    fn slopes(&self) -> Table {
        let columns = ["scene", "compile", "build", "trace", "memory"];
        let title = "Exponents: N to this power, from 1000 solids on";
        let mut table = Table::new("exponents", title, &columns);
        for case in CASES {
            let exponent = |name: &'static str| {
                Cell::from(self.exponent(case.name, &|figures: &Figures| figures.number(name)))
            };
            if self.growth.iter().any(|row| row.name == case.name) {
                table.row([
                    case.name.into(),
                    exponent("compile"),
                    exponent("build"),
                    exponent("trace"),
                    exponent("memory"),
                ]);
            }
        }
        table
    }

    /// What the paper claims, as ratios of seconds.
    fn claims(&self) -> Table {
        let columns = [
            "scene",
            "N",
            "coherence by boxes",
            "without rectangles",
            "tighter volumes",
            "trees by flat unions",
            "bvh by boxes",
        ];
        let title = "The paper's ways: seconds of one by those of the other";
        let mut table = Table::new("claims", title, &columns);
        for row in &self.tracing {
            let ratio =
                |a: &str, b: &str| Cell::from(row.figures.number(a) / row.figures.number(b));
            table.row([
                row.name.as_str().into(),
                row.count(),
                ratio("coherence", "boxes"),
                ratio("remembered", "boxes"),
                ratio("slanted", "boxes"),
                ratio("boxes", "flat"),
                ratio("bvh", "boxes"),
            ]);
        }
        table
    }

    /// What becomes of a ray's cost as scenes grow, by each way.
    fn trees(&self) -> Table {
        let columns = ["scene", "bvh", "coherence", "boxes", "flat unions", "none"];
        let title =
            "Exponents of the paper's ways: seconds are as N to this power, from 100 solids on";
        let mut table = Table::new("trees", title, &columns);
        for case in CASES {
            let exponent = |way: &str| {
                let rows = self.tracing.iter().filter(|row| row.name == case.name);
                let rows = rows.filter(|row| row.count >= GROWN);
                power(rows.map(|row| (f64::from(row.count), row.figures.number(way))))
            };
            if exponent("boxes").is_some() {
                let [bvh, coherence, boxes, flat, none] =
                    ["bvh", "coherence", "boxes", "flat", "none"].map(|way| exponent(way).into());
                table.row([case.name.into(), bvh, coherence, boxes, flat, none]);
            }
        }
        table
    }

    fn ways(&self) -> Table {
        let columns = [
            "scene",
            "N",
            "bvh s",
            "coherence s",
            "… without rectangles s",
            "boxes s",
            "… with corners cut s",
            "… without trees s",
            "none s",
            "same bytes",
        ];
        let mut table =
            Table::new("tracing", "Ways of tracing, least of up to five runs in turn", &columns);
        for row in &self.tracing {
            let [a, b, c, d, e, f, g] = TRACING.map(|(word, _)| Cell::from(row.figures.get(word)));
            let same = if row.figures.number("same") > 0.0 { "yes" } else { "no" };
            table.row([row.name.as_str().into(), row.count(), a, b, c, d, e, f, g, same.into()]);
        }
        table
    }

    fn scaling(&self) -> Table {
        let columns = [
            "scene",
            "N",
            "one thread s",
            "two threads s",
            "times faster",
            "tiles",
            "2, simulated",
            "4, simulated",
            "16, simulated",
            "64, simulated",
        ];
        let title =
            "Threads: medians of nine runs in turn, and the schedule of the tiles' own seconds";
        let mut table = Table::new("threads", title, &columns);
        for row in &self.threads {
            let get = |name: &str| Cell::from(row.figures.get(name));
            table.row([
                row.name.as_str().into(),
                row.count(),
                get("one"),
                get("two"),
                (row.figures.number("one") / row.figures.number("two")).into(),
                get("tiles"),
                get("times_2"),
                get("times_4"),
                get("times_16"),
                get("times_64"),
            ]);
        }
        table
    }

    fn absent(&self) -> Table {
        let mut table = Table::new("missing", "What was not measured", &["what"]);
        for what in &self.missing {
            table.row([what.as_str().into()]);
        }
        table
    }

    /// Plots with their names.
    #[must_use]
    pub fn plots(&self) -> Vec<(&'static str, Plot)> {
        let trace = |figures: &Figures| figures.number("trace");
        let make = |figures: &Figures| figures.number("compile") + figures.number("build");
        let memory = |figures: &Figures| figures.number("memory") / 1_048_576.0;
        vec![
            ("trace", self.plot("Seconds to trace", "seconds of one core", "s", &trace)),
            ("build", self.plot("Seconds to compile and build", "seconds of one core", "s", &make)),
            ("memory", self.plot("Memory", "MB at most", "MB", &memory)),
        ]
    }

    fn plot(&self, title: &str, axis: &str, unit: &str, of: &dyn Fn(&Figures) -> f64) -> Plot {
        let mut series = Vec::new();
        for case in CASES {
            let rows =
                self.growth.iter().filter(|row| row.name == case.name && of(&row.figures) > 0.0);
            let dots: Vec<Dot> = rows
                .map(|row| {
                    let value = of(&row.figures);
                    let about =
                        format!("{} {}: {} {unit}", case.name, row.count, significant(value, 3));
                    Dot { at: [f64::from(row.count), value], label: String::new(), about }
                })
                .collect();
            if dots.is_empty() {
                continue;
            }
            let name = match self.exponent(case.name, of) {
                Some(exponent) => format!("{}, N^{exponent:.2}", case.name),
                None => case.name.to_owned(),
            };
            series.push(Series { name, dots });
        }
        let axes = ["solids".to_owned(), axis.to_owned()];
        Plot { title: title.into(), axes, series, frontier: Vec::new(), levels: Vec::new() }
    }

    /// The page.
    #[must_use]
    pub fn page(&self) -> String {
        let (columns, rows) = self.size;
        let mut body = format!(
            "<p>Generated scenes, {columns} × {rows} pixels with one sample each, on one thread; each is measured in a \
             process of its own. Exponents stand in the legends.</p>\n<p class=\"soft\">"
        );
        let about = CASES.iter().map(|case| format!("<code>{}</code>: {}", case.name, case.about));
        body += &about.collect::<Vec<_>>().join(" · ");
        body += ".</p>\n";
        for (_, plot) in self.plots() {
            if !plot.series.is_empty() {
                body += &page::plotted(&plot);
            }
        }
        for table in self.tables() {
            body += &page::open(&table);
        }
        page::page("Speed", &body)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A heap that takes 2 · N^0.25 seconds from 1000 on, and 7 before.
    fn found() -> Found {
        let row = |count: u32| {
            let trace = if count < LARGE { 7.0 } else { 2.0 * libm::pow(f64::from(count), 0.25) };
            let figures = Figures::default().with("trace", trace).with("compile", 1.0);
            Row { name: "heap".into(), count, figures }
        };
        Found { growth: [10, 100, 1000, 10_000, 100_000].map(row).into(), ..Found::default() }
    }

    #[test]
    fn exponents_are_those_of_large_scenes() {
        let slopes = found().slopes();
        assert_eq!(slopes.rows.len(), 1, "{slopes:?}");
        let Cell::Number(trace) = slopes.rows[0][3] else { panic!("a number") };
        assert!((trace - 0.25).abs() < 1e-12, "{trace}");
        let plots = found().plots();
        assert_eq!(plots[0].1.series[0].name, "heap, N^0.25");
        assert!(plots[2].1.series.is_empty(), "nothing is known of memory");
    }

    #[test]
    fn ratios_are_those_of_the_figures() {
        let words = ["bvh", "coherence", "remembered", "boxes", "slanted", "flat", "none"];
        let times = [1.0, 3.0, 3.5, 4.0, 5.0, 8.0, 9.0];
        let figures = words.iter().zip(times).fold(Figures::default(), |f, (w, t)| f.with(w, t));
        let row = Row { name: "drilled".into(), count: 100, figures };
        let found = Found { tracing: vec![row], ..Found::default() };
        let claims = found.claims();
        let expected = [0.75, 0.875, 1.25, 0.5, 0.25].map(Cell::from);
        assert_eq!(claims.rows[0][2..], expected);
    }

    #[test]
    fn trees_grow_as_their_figures_do() {
        let row = |count: u32| {
            let n = f64::from(count);
            let figures =
                ["bvh", "coherence", "boxes", "flat", "none"].iter().zip([0.1, 0.2, 0.3, 1.0, 1.1]);
            let figures = figures.fold(Figures::default(), |figures, (way, power)| {
                // What ten solids take says nothing.
                figures.with(way, if count == 10 { 5.0 } else { libm::pow(n, power) })
            });
            Row { name: "heap".into(), count, figures }
        };
        let found = Found { tracing: [10, 100, 1000].map(row).into(), ..Found::default() };
        let trees = found.trees();
        assert_eq!(trees.rows.len(), 1, "{trees:?}");
        for (cell, expected) in trees.rows[0][1..].iter().zip([0.1, 0.2, 0.3, 1.0, 1.1]) {
            let Cell::Number(found) = cell else { panic!("a number") };
            assert!((found - expected).abs() < 1e-9, "{found} for {expected}");
        }
    }

    #[test]
    fn the_page_is_well_formed() {
        let html = found().page();
        let parsed = roxmltree::Document::parse(html.strip_prefix("<!DOCTYPE html>\n").unwrap());
        assert!(parsed.is_ok(), "{parsed:?}");
    }
}
