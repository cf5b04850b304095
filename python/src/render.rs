//! Rendering: what `portray` does, into arrays.

use std::time::Instant;

use compile::{Diagnostic, Severity};
use idf::{Image, Kind, Plane};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use render::{
    Certificates, Ending, Filter, Form, LoadOptions, Options, Picture, Rate, Sampling, Wish, World,
    measured, render_while_wanted,
};

use crate::argument::{Whole, detached, interruptible, threads, value, word};
use crate::sampling::{antialiasing, count, sampling};
use crate::scene::{Outcome, Source, checked};
use crate::{array, failure};

/// Channels of a render by their names, and the planes that each is.
const CHANNELS: [(&str, &[Kind]); 5] = [
    ("rgb", &[]),
    ("coverage", &[Kind::Cvg]),
    ("depth", &[Kind::Dep]),
    ("normal", &[Kind::Nrx, Kind::Nry, Kind::Nrz]),
    ("objects", &[Kind::Obj]),
];

const FILTERS: [(&str, Filter); 3] =
    [("box", Filter::Box), ("tent", Filter::Tent), ("mitchell", Filter::Mitchell)];

/// How a render is to be made, checked.
struct Plan {
    options: Options,
    load: LoadOptions,
    form: Form,
    kinds: Vec<Kind>,
}

/// A render and the world it is of.
struct Made {
    image: Image,
    picture: Picture,
    primitives: usize,
    seconds: f64,
}

/// A picture of a scene: a dictionary of arrays and figures.
#[pyfunction]
#[pyo3(name = "render", signature = (source, size, samples, aa, error, seconds, certify, filter, glossy, seed, depth,
    min_weight, channels, linear, dither_output, definitions, threads))]
pub(crate) fn render_scene<'py>(
    py: Python<'py>,
    source: Source,
    size: (Whole, Whole),
    samples: Option<Whole>,
    aa: Option<&str>,
    error: Option<f64>,
    seconds: Option<f64>,
    certify: bool,
    filter: &str,
    glossy: bool,
    seed: Whole,
    depth: Whole,
    min_weight: f64,
    channels: Vec<String>,
    linear: bool,
    dither_output: bool,
    definitions: Vec<(String, f64)>,
    threads: Option<Whole>,
) -> PyResult<Bound<'py, PyDict>> {
    let begun = Instant::now();
    if linear && dither_output {
        return Err(value("dither_output: floating point shows no bands; take dtype=numpy.uint8"));
    }
    if !(0.0..=1.0).contains(&min_weight) {
        return Err(value(format!(
            "min_weight: expected a number from 0 to 1, found {min_weight}"
        )));
    }
    let definitions = checked(definitions)?;
    let (columns, rows) = sides(size)?;
    let filter = word("filter", filter, FILTERS)?;
    let (samples, aa) = (count(samples)?, antialiasing(aa)?);
    let sampling = sampling(&Wish { samples, aa, error, seconds, certify, filter })?;
    let options = Options {
        columns,
        rows,
        certify,
        filter,
        seed: seed.within("seed", 0..=i64::from(u32::MAX))?,
        depth: depth.within("depth", 0..=i64::from(Options::DEPTH_LIMIT))?,
        min_weight,
        clamp: !linear,
        threads: self::threads(threads)?.unwrap_or(0),
        ..Options::default()
    };
    let mut kinds = Vec::new();
    for name in &channels {
        kinds.extend(word("channels", name, CHANNELS)?);
    }
    let coverage = kinds.contains(&Kind::Cvg);
    let form =
        Form { float: linear, opaque: !coverage, coverage, straight: true, dither: dither_output };
    let load = LoadOptions { picture: Some((columns, rows)), glossy, ..LoadOptions::default() };
    let mut plan = Plan { options, load, form, kinds };
    let mut outcome = detached(py, None, || Outcome::of(source, definitions))??;
    let Some(scene) = &outcome.scene else { return Err(outcome.error(py)) };
    if scene.objects.is_empty() {
        let message = "the scene has no objects; the picture shows the background";
        let mut warning = Diagnostic::nowhere(message);
        warning.severity = Severity::Warning;
        outcome.diagnostics.push(warning);
    }
    plan.options.sampling = sampling.unwrap_or_else(|| Sampling::fitting(scene, glossy));
    let loaded = detached(py, None, || World::load_with(scene, &plan.load))?;
    let world = match loaded {
        Ok(world) => world,
        Err(error) => {
            let diagnostics = vec![Diagnostic::nowhere(error.to_string())];
            return Err(Outcome { diagnostics, ..outcome }.error(py));
        }
    };
    if let Sampling::Stochastic(Rate::Time(time)) = &mut plan.options.sampling {
        *time = time.saturating_sub(begun.elapsed());
    }
    let made = interruptible(py, |stopped| make(&world, &plan, stopped))??;
    drop(world);
    let result = array::arrays(py, &made.image)?;
    if !channels.iter().any(|name| name == "rgb") {
        result.del_item("light")?;
    }
    result.set_item("statistics", statistics(py, &plan.options, &made)?)?;
    result.set_item("estimated_error", made.picture.error)?;
    result.set_item("diagnostics", outcome.objects(py)?)?;
    Ok(result)
}

/// Columns and rows, if an image may be so large.
fn sides((columns, rows): (Whole, Whole)) -> PyResult<(u32, u32)> {
    let most = i64::from(Options::SIDE_LIMIT);
    let (columns, rows) = (columns.within("size", 1..=most)?, rows.within("size", 1..=most)?);
    idf::checked_size(columns, rows).map_err(|error| failure::image(&error))?;
    Ok((columns, rows))
}

/// Renders, and measures what is asked for besides.
fn make(world: &World, plan: &Plan, stopped: &(dyn Fn() -> bool + Sync)) -> PyResult<Made> {
    let start = Instant::now();
    let Plan { options, form, kinds, .. } = plan;
    let failed = |error: render::RenderError| match error {
        render::RenderError::Memory { .. } => {
            pyo3::exceptions::PyMemoryError::new_err(error.to_string())
        }
        error => value(error.to_string()),
    };
    let picture = render_while_wanted(world, options, stopped, None).map_err(failed)?;
    let picture = picture.ok_or_else(|| value("the picture was given up"))?;
    let seconds = start.elapsed().as_secs_f64();
    let image = picture.film.image(*form, world.background());
    let image = image.map_err(|error| failure::image(&error))?;
    let found = measured(world, options, kinds).map_err(failed)?;
    let planes: Vec<Plane> = image.planes().iter().cloned().chain(found).collect();
    let image = image.with_planes(image.columns(), image.rows(), planes);
    let image = image.map_err(|error| failure::image(&error))?;
    Ok(Made { image, picture, primitives: world.leaf_count(), seconds })
}

/// Figures by the names that they have in `portray --stats`.
fn statistics<'py>(
    py: Python<'py>,
    options: &Options,
    made: &Made,
) -> PyResult<Bound<'py, PyDict>> {
    let Picture { stats, samples, cut: [depth, weight], ending, .. } = &made.picture;
    let figures = PyDict::new(py);
    figures.set_item("columns", options.columns)?;
    figures.set_item("rows", options.rows)?;
    figures.set_item("samples", samples)?;
    figures.set_item("primitives", made.primitives)?;
    figures.set_item("rays", stats.rays())?;
    figures.set_item("primary", stats.primary)?;
    figures.set_item("secondary", stats.secondary)?;
    figures.set_item("shadow", stats.shadow)?;
    figures.set_item("cut_by_depth", stats.cut_by_depth)?;
    figures.set_item("cut_by_weight", stats.cut_by_weight)?;
    figures.set_item("depth_cut_bound", depth)?;
    figures.set_item("weight_cut_bound", weight)?;
    if let Some(Certificates { certain, undecided, bound, given_up, seconds }) =
        made.picture.certificates
    {
        figures.set_item("certain_share", certain)?;
        figures.set_item("undecided_share", undecided)?;
        figures.set_item("undecided_bound", bound)?;
        figures.set_item("tiles_given_up_share", given_up)?;
        figures.set_item("certify_seconds", seconds)?;
    }
    figures.set_item("trace_seconds", made.seconds)?;
    let ending = match ending {
        Ending::Done => "done",
        Ending::MostSamples => "most samples",
        Ending::OneSample => "one sample",
    };
    figures.set_item("ending", ending)?;
    Ok(figures)
}
