//! What a sweep found, as tables, plots, and what they say.

use render::Options;

use crate::curve::{self, Point, error_after, fastest, frontier};
use crate::plot::{Dot, Plot, Series};
use crate::sweep::{DEEPEST, Found};
use crate::table::{Cell, Table, significant};
use crate::way::{Kind, Way};

/// Errors that are asked for in display steps: what the eye hardly sees, and what 8 bits do not show.
pub const GOALS: [f64; 2] = [1.0, 0.3];

/// Ways whose times are those of the table of equal times, by their samples.
const EQUAL: [&str; 3] = ["4", "16", "64"];

/// The most that a cut-off may change to be recommended, in display steps.
const HARMLESS: f64 = 0.3;

impl Found {
    /// The points of a kind with the box filter.
    fn of_kind(&self, kind: Kind) -> Vec<(&Way, Point)> {
        let is_box = |way: &Way| way.filter == render::Filter::Box;
        let of_kind = self.ways.iter().filter(|(way, _)| way.kind == kind && is_box(way));
        let point = |error: &crate::journal::Figures| Point {
            seconds: error.number("seconds"),
            error: error.number("error"),
        };
        let mut found: Vec<_> = of_kind.map(|(way, figures)| (way, point(figures))).collect();
        found.sort_by(|a, b| a.1.seconds.total_cmp(&b.1.seconds));
        found
    }

    /// All points with the box filter.
    fn points(&self) -> Vec<(&Way, Point)> {
        Kind::ALL.into_iter().flat_map(|kind| self.of_kind(kind)).collect()
    }

    /// Ways that no other beats in both time and error, by rising time.
    #[must_use]
    pub fn efficient(&self) -> Vec<&Way> {
        let all = self.points();
        let points: Vec<Point> = all.iter().map(|(_, point)| *point).collect();
        frontier(&points).into_iter().map(|place| all[place].0).collect()
    }

    /// The fastest way with an error of at most `goal`.
    #[must_use]
    pub fn recommended(&self, goal: f64) -> Option<(&Way, Point)> {
        let all = self.points();
        let points: Vec<Point> = all.iter().map(|(_, point)| *point).collect();
        fastest(&points, goal).map(|place| all[place])
    }

    /// The cheapest cut-off that changes less than [`HARMLESS`] steps.
    fn cut(&self) -> Option<(u32, f64, f64)> {
        // The deepest is what others are compared with.
        let others = self.cuts.iter().filter(|(depth, ..)| *depth < DEEPEST.0);
        let good = others.filter(|(.., figures)| figures.number("off") <= HARMLESS);
        let seconds = |cut: &&(u32, f64, crate::journal::Figures)| cut.2.number("seconds");
        let best = good.min_by(|a, b| seconds(a).total_cmp(&seconds(b)))?;
        Some((best.0, best.1, best.2.number("off")))
    }

    /// Error against seconds, with POV-Ray's where there is any.
    #[must_use]
    pub fn plot(&self) -> Plot {
        let all = self.points();
        let points: Vec<Point> = all.iter().map(|(_, point)| *point).collect();
        let efficient = frontier(&points).into_iter().map(|place| points[place]);
        let named = |name: &str, points: &[Point]| match curve::slope(points) {
            Some(slope) => format!("{name}, slope {slope:.2}"),
            None => name.to_owned(),
        };
        let about = |words: &str, point: &Point| {
            let [seconds, error] = [point.seconds, point.error].map(|x| significant(x, 3));
            format!("{words}: {error} steps after {seconds} s")
        };
        let mut series = Vec::new();
        for kind in Kind::ALL {
            let found = self.of_kind(kind);
            let points: Vec<Point> = found.iter().map(|(_, point)| *point).collect();
            let dot = |(way, point): &(&Way, Point)| Dot {
                at: [point.seconds, point.error],
                label: way.label(),
                about: about(&way.words(), point),
            };
            if !found.is_empty() {
                let dots = found.iter().map(dot).collect();
                series.push(Series { name: named(kind.name(), &points), dots });
            }
        }
        for kind in ["POV-Ray, none", "POV-Ray, method 1", "POV-Ray, method 2"] {
            let mut found: Vec<_> = self
                .peers
                .iter()
                .filter(|(way, figures)| way.kind == kind && figures.number("error") > 0.0)
                .map(|(way, figures)| {
                    let [seconds, error] = ["seconds", "error"].map(|name| figures.number(name));
                    (*way, Point { seconds, error })
                })
                .collect();
            found.sort_by(|a, b| a.1.seconds.total_cmp(&b.1.seconds));
            let points: Vec<Point> = found.iter().map(|(_, point)| *point).collect();
            let dot = |(way, point): &(&crate::peer::Way, Point)| Dot {
                at: [point.seconds, point.error],
                label: String::new(),
                about: about(&format!("{} {}", way.kind, way.options), point),
            };
            if !found.is_empty() {
                let dots = found.iter().map(dot).collect();
                series.push(Series { name: named(kind, &points), dots });
            }
        }
        Plot {
            title: format!("{}: error against seconds", self.name),
            axes: ["seconds of one core".into(), "true error, display steps".into()],
            series,
            frontier: efficient.map(|point| [point.seconds, point.error]).collect(),
            levels: GOALS.to_vec(),
        }
    }
}

/// The tables of all scenes.
#[must_use]
pub fn tables(all: &[Found]) -> Vec<Table> {
    vec![
        recommended(all),
        equal_time(all),
        verdict(all),
        sampling(all),
        promised(all),
        references(all),
        cuts(all),
        tracing(all),
        omitting(all),
        omissions(all),
        colors(all),
        peers(all),
        missing(all),
    ]
}

fn recommended(all: &[Found]) -> Table {
    let columns = ["scene", "for", "options", "seconds", "error"];
    let mut table = Table::new("recommended", "Recommended settings", &columns);
    for found in all {
        for goal in GOALS {
            let aim = format!("an error below {goal}");
            let name = || Cell::from(found.name.as_str());
            match found.recommended(goal) {
                Some((way, point)) => table.row([
                    name(),
                    aim.into(),
                    way.words().into(),
                    point.seconds.into(),
                    point.error.into(),
                ]),
                None if found.ways.is_empty() => {}
                None => table.row([
                    name(),
                    aim.into(),
                    format!("--error {goal} (nothing that was tried)").into(),
                    f64::NAN.into(),
                    f64::NAN.into(),
                ]),
            }
        }
        if let Some((depth, weight, off)) = found.cut() {
            let usual = Options::default();
            let is_usual = depth == usual.depth && (weight - usual.min_weight).abs() <= 0.0;
            let remark = if is_usual { " (as usual)" } else { "" };
            let words = format!("--depth {depth} --min-weight {weight}{remark}");
            let aim = format!("a change below {HARMLESS}");
            table.row([
                found.name.as_str().into(),
                aim.into(),
                words.into(),
                f64::NAN.into(),
                off.into(),
            ]);
        }
    }
    table
}

/// Errors of each kind after the time that a grid takes.
fn after_equal_time(found: &Found) -> Vec<(f64, [Option<f64>; 4])> {
    let grid = found.of_kind(Kind::Grid);
    let times = EQUAL.iter().filter_map(|label| {
        grid.iter().find(|(way, _)| way.label() == *label).map(|(_, point)| point.seconds)
    });
    times
        .map(|seconds| {
            let errors = Kind::ALL.map(|kind| {
                let points: Vec<Point> = found.of_kind(kind).iter().map(|(_, p)| *p).collect();
                error_after(&points, seconds)
            });
            (seconds, errors)
        })
        .collect()
}

fn winner(errors: &[Option<f64>; 4]) -> Option<Kind> {
    let known =
        Kind::ALL.into_iter().zip(errors).filter_map(|(kind, error)| Some((kind, (*error)?)));
    known.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(kind, _)| kind)
}

fn equal_time(all: &[Found]) -> Table {
    let columns = ["scene", "after seconds", "none", "adaptive", "stochastic", "--error", "wins"];
    let title = "True error after equal time: what decides the default";
    let mut table = Table::new("equal-time", title, &columns);
    for found in all {
        for (seconds, errors) in after_equal_time(found) {
            let [a, b, c, d] = errors.map(Cell::from);
            let wins = winner(&errors).map_or("", Kind::name);
            table.row([found.name.as_str().into(), seconds.into(), a, b, c, d, wins.into()]);
        }
    }
    table
}

fn verdict(all: &[Found]) -> Table {
    let columns = ["sampling", "wins", "of", "error by the best, geometric mean"];
    let mut table = Table::new("verdict", "Which way wins at equal time", &columns);
    let rows: Vec<[Option<f64>; 4]> =
        all.iter().flat_map(after_equal_time).map(|(_, errors)| errors).collect();
    if rows.is_empty() {
        return table;
    }
    for (place, kind) in Kind::ALL.into_iter().enumerate() {
        let wins = rows.iter().filter(|errors| winner(errors) == Some(kind)).count();
        let best = |errors: &[Option<f64>; 4]| {
            errors.iter().flatten().fold(f64::INFINITY, |least, &error| least.min(error))
        };
        let ratios =
            rows.iter().filter_map(|errors| Some(libm::log(errors[place]? / best(errors))));
        let (sum, count) = ratios.fold((0.0, 0.0), |(sum, count), log| (sum + log, count + 1.0));
        #[expect(clippy::cast_precision_loss, reason = "a few rows")]
        let [wins, of] = [wins as f64, rows.len() as f64];
        let mean: f64 = if count > 0.0 { libm::exp(sum / count) } else { f64::NAN };
        table.row([kind.name().into(), wins.into(), of.into(), mean.into()]);
    }
    table
}

fn sampling(all: &[Found]) -> Table {
    let columns =
        ["scene", "options", "seconds", "samples", "error", "±", "seeds", "on the frontier"];
    let mut table = Table::new("sampling", "Ways of sampling", &columns);
    for found in all {
        let efficient = found.efficient();
        for (way, figures) in &found.ways {
            let is_efficient = efficient.contains(&way);
            table.row([
                found.name.as_str().into(),
                way.words().into(),
                figures.get("seconds").into(),
                figures.get("samples").into(),
                figures.get("error").into(),
                figures.get("deviation").into(),
                figures.get("seeds").into(),
                if is_efficient { "yes" } else { "" }.into(),
            ]);
        }
    }
    table
}

fn promised(all: &[Found]) -> Table {
    let columns = ["scene", "options", "error", "reported", "reported by true", "least", "most"];
    let mut table = Table::new("reported", "Reported and true error", &columns);
    for found in all {
        for (way, figures) in
            found.ways.iter().filter(|(_, figures)| figures.get("ratio").is_some())
        {
            table.row([
                found.name.as_str().into(),
                way.words().into(),
                figures.get("error").into(),
                figures.get("reported").into(),
                figures.get("ratio").into(),
                figures.get("ratio_least").into(),
                figures.get("ratio_most").into(),
            ]);
        }
    }
    table
}

fn references(all: &[Found]) -> Table {
    let columns =
        ["scene", "columns", "rows", "primitives", "filter", "samples of each", "own error"];
    let title = "References: the error of both together";
    let mut table = Table::new("references", title, &columns);
    for found in all {
        for (filter, figures) in &found.references {
            #[expect(clippy::cast_precision_loss, reason = "a count for a table")]
            let primitives = found.primitives as f64;
            table.row([
                found.name.as_str().into(),
                f64::from(found.size.0).into(),
                f64::from(found.size.1).into(),
                primitives.into(),
                (*filter).into(),
                figures.get("samples").into(),
                figures.get("own").into(),
            ]);
        }
    }
    table
}

fn cuts(all: &[Found]) -> Table {
    let columns = ["scene", "depth", "least weight", "seconds", "rays", "change", "bound, linear"];
    let title = "Depth and weight cut-offs, against the deepest with the same samples";
    let mut table = Table::new("cut-offs", title, &columns);
    for found in all {
        for (depth, weight, figures) in &found.cuts {
            table.row([
                found.name.as_str().into(),
                f64::from(*depth).into(),
                (*weight).into(),
                figures.get("seconds").into(),
                figures.get("rays").into(),
                figures.get("off").into(),
                figures.get("bound").into(),
            ]);
        }
    }
    table
}

fn tracing(all: &[Found]) -> Table {
    let columns = ["scene", "--accel", "seconds", "by bvh", "same bytes"];
    let mut table = Table::new("tracing", "Ways of tracing", &columns);
    for found in all {
        let usual = found.tracing.iter().find(|(word, _)| *word == "bvh");
        for (word, figures) in &found.tracing {
            let ratio = usual.map(|(_, usual)| figures.number("seconds") / usual.number("seconds"));
            let same = match usual {
                Some((_, usual)) if figures.get("seconds").is_some() => {
                    if figures.note == usual.note { "yes" } else { "no" }
                }
                _ => figures.note.as_str(),
            };
            table.row([
                found.name.as_str().into(),
                (*word).into(),
                figures.get("seconds").into(),
                ratio.into(),
                same.into(),
            ]);
        }
    }
    table
}

fn omitting(all: &[Found]) -> Table {
    let columns = [
        "scene",
        "load s",
        "load s, --keep-all",
        "trace s",
        "trace s, --keep-all",
        "by --keep-all",
        "same bytes",
    ];
    let mut table = Table::new("saved", "What leaving out saved", &columns);
    for found in all {
        let Some(figures) = &found.omitting else { continue };
        let same = if figures.number("same") > 0.0 { "yes" } else { "no" };
        table.row([
            found.name.as_str().into(),
            figures.get("load").into(),
            figures.get("load_all").into(),
            figures.get("trace").into(),
            figures.get("trace_all").into(),
            (figures.number("trace") / figures.number("trace_all")).into(),
            same.into(),
        ]);
    }
    table
}

fn omissions(all: &[Found]) -> Table {
    let columns = ["scene", "pass", "what", "before", "after", "because"];
    let mut table = Table::new("left-out", "What was left out", &columns);
    for found in all {
        for omission in found.omissions.iter().filter(|omission| omission.before > 0) {
            #[expect(clippy::cast_precision_loss, reason = "counts for a table")]
            let [before, after] = [omission.before, omission.after].map(|count| count as f64);
            table.row([
                found.name.as_str().into(),
                omission.name.into(),
                omission.what.into(),
                before.into(),
                after.into(),
                omission.reason.into(),
            ]);
        }
    }
    table
}

fn colors(all: &[Found]) -> Table {
    let columns = ["scene", "options of iencode", "seconds", "off, RGB", "off, Oklab", "PSNR, dB"];
    let mut table = Table::new("colours", "256 colours of the picture", &columns);
    for found in all {
        for (way, figures) in &found.colors {
            table.row([
                found.name.as_str().into(),
                way.words().into(),
                figures.get("seconds").into(),
                figures.get("rms_rgb").into(),
                figures.get("rms_oklab").into(),
                figures.get("psnr").into(),
            ]);
        }
    }
    table
}

fn peers(all: &[Found]) -> Table {
    let columns = ["scene", "program", "options", "CPU seconds", "error"];
    let title = "POV-Ray, against its own picture of many samples";
    let mut table = Table::new("povray", title, &columns);
    for found in all {
        for (way, figures) in &found.peers {
            table.row([
                found.name.as_str().into(),
                way.kind.into(),
                way.options.into(),
                figures.get("seconds").into(),
                figures.get("error").into(),
            ]);
        }
    }
    table
}

fn missing(all: &[Found]) -> Table {
    let mut table = Table::new("missing", "What was not measured", &["scene", "what"]);
    for found in all {
        for what in &found.missing {
            table.row([found.name.as_str().into(), what.as_str().into()]);
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::journal::Figures;
    use crate::way::ways;

    /// A scene on which a grid errs by 4/√s and division by 1/√s, both after s seconds.
    fn found() -> Found {
        let figures = |seconds: f64, error: f64| {
            Figures::default().with("seconds", seconds).with("error", error)
        };
        let mut found = Found { name: "x".into(), ..Found::default() };
        for way in ways(false) {
            let seconds = way.cost().unwrap_or(1e9);
            let error = match way.kind {
                Kind::Grid => 4.0 / seconds.sqrt(),
                Kind::Adaptive => 1.0 / seconds.sqrt(),
                Kind::Stochastic => 9.0,
                Kind::Promised => 20.0,
            };
            found.ways.push((way, figures(seconds, error)));
        }
        found
    }

    #[test]
    fn what_wins_is_recommended() {
        let found = found();
        assert!(found.efficient().iter().all(|way| way.kind != Kind::Stochastic));
        // 1 and a half samples at most: an error of 1/√1.5.
        let (way, point) = found.recommended(1.0).unwrap();
        assert_eq!(way.words(), "--aa adaptive --samples 1");
        assert!((point.error - 1.0 / 1.5_f64.sqrt()).abs() < 1e-12);
        let all = [found];
        let equal = equal_time(&all);
        assert_eq!(equal.rows.len(), 3);
        for row in &equal.rows {
            assert_eq!(row.last(), Some(&Cell::from("adaptive")), "{row:?}");
        }
        // After 16 seconds: 4/√16 on the grid, and 1/√16 on the line between its points.
        let Cell::Number(grid) = equal.rows[1][2] else { panic!("a number") };
        let Cell::Number(adaptive) = equal.rows[1][3] else { panic!("a number") };
        assert!((grid - 1.0).abs() < 1e-12 && (adaptive - 0.25).abs() < 1e-12, "{equal:?}");
        let verdict = verdict(&all);
        assert_eq!(verdict.rows[1][1], Cell::from(3.0));
        let Cell::Number(worse) = verdict.rows[0][3] else { panic!("a number") };
        assert!((worse - 4.0).abs() < 1e-9, "{verdict:?}");
    }

    #[test]
    fn slopes_stand_in_the_legend_and_the_frontier_is_drawn() {
        let plot = found().plot();
        let names: Vec<&str> = plot.series.iter().map(|series| series.name.as_str()).collect();
        assert_eq!(names[..2], ["none, slope -0.50", "adaptive, slope -0.50"]);
        assert!(plot.frontier.len() > 3);
        let falls = plot.frontier.windows(2).all(|pair| pair[0][1] > pair[1][1]);
        assert!(falls, "{:?}", plot.frontier);
    }

    #[test]
    fn the_cheapest_harmless_cut_is_recommended() {
        let figures =
            |seconds: f64, off: f64| Figures::default().with("seconds", seconds).with("off", off);
        let cuts = vec![
            (1, 0.1, figures(1.0, 3.0)),
            (5, 0.01, figures(3.0, 0.25)),
            (9, 0.01, figures(4.0, 0.01)),
            (DEEPEST.0, 0.01, figures(0.5, 0.0)),
        ];
        let found = Found { name: "x".into(), cuts, ..Found::default() };
        let table = recommended(&[found]);
        assert_eq!(table.rows.len(), 1);
        assert_eq!(table.rows[0][2], Cell::from("--depth 5 --min-weight 0.01"));
    }

    #[test]
    fn tables_have_names_of_their_own() {
        let mut names: Vec<&str> = tables(&[]).iter().map(|table| table.name).collect();
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
