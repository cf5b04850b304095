//! Parts of a picture: windows and sets of tiles, each pixel as it is in the whole picture.
//!
//! A pixel under the box filter depends on its place alone. Under a wider one samples of the pixels around count in it,
//! too, and sums of floating point depend on their order: they are taken over the same tiles as in the whole picture,
//! cut to what the part needs.

#[cfg(feature = "command")]
pub(crate) mod command;

use idf::part::{Canvas, PartError, Share};
use idf::{Depth, Image, Kind, Matte, Plane, Samples, Window};
use scene::Rgb;

use crate::film::{Film, FilmTile, Piece, Sums, WideTile};
use crate::options::{Filter, Options, Rate, Sampling};
use crate::picture::Form;
use crate::sampling::pattern::Pattern;
use crate::stats::RayStats;
use crate::tile::{Frame, SIDE};
use crate::world::World;
use crate::{RenderError, check_memory, measured_in, pool};

/// A finished part of a picture.
#[derive(Debug)]
pub struct PartPicture {
    share: Share,
    canvas: [u32; 2],
    windows: Vec<Window>,
    /// One for each window.
    films: Vec<Film>,
    /// Counts.
    pub stats: RayStats,
    /// Samples of a pixel, or their mean; those of pixels around the part, which count in it, are among them.
    pub samples: f64,
    /// As that of a whole picture, over this part.
    pub error: Option<f64>,
}

/// A piece whose samples are taken together, and the window it is for.
#[derive(Clone, Copy)]
struct Task {
    window: usize,
    piece: Piece,
}

/// Renders one part of a picture of `world`; `options` are those of the whole. `progress` hears how many pixels have
/// been sampled since it was last called, of [`sampled_pixels`].
///
/// # Errors
///
/// [`RenderError`] when there are no threads or no memory to be had.
///
/// # Panics
///
/// If samples go on until an error is reached or a time is over: what a pixel gets is found out over the whole picture.
pub fn render_part(
    world: &World,
    options: &Options,
    share: Share,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<PartPicture, RenderError> {
    let is_fixed =
        !matches!(options.sampling, Sampling::Stochastic(Rate::Error(_) | Rate::Time(_)));
    assert!(is_fixed, "a part has its samples beforehand");
    let canvas = [options.columns, options.rows];
    let windows: Vec<Window> = share.windows(canvas).collect();
    let area: u64 = windows.iter().map(|w| u64::from(w.columns) * u64::from(w.rows)).sum();
    let rows = area.div_ceil(u64::from(options.columns));
    check_memory(&Options { rows: u32::try_from(rows).unwrap_or(options.rows), ..*options })?;
    let view = world.view_from.view(options.columns, options.rows);
    let pool = pool(world, options, options.threads)?;
    let (films, stats, pixels, error) = pool.install(|| {
        let frame = Frame::new(world, view, options);
        let tasks = tasks(&windows, options);
        let (films, stats) = if options.filter == Filter::Box {
            of_box(&frame, &windows, &tasks, progress)
        } else {
            of_wide(&frame, &windows, &tasks, progress)
        };
        let pixels: usize = tasks.iter().map(|task| task.piece.area()).sum();
        let error = error(&films, &frame);
        (films, stats, pixels, error)
    });
    #[expect(clippy::cast_precision_loss, reason = "counts below 2⁵³")]
    let samples = stats.primary as f64 / pixels.max(1) as f64;
    Ok(PartPicture { share, canvas, windows, films, stats, samples, error })
}

/// How many pixels are sampled for a part: where the filter reaches beyond a pixel, more than it has.
#[must_use]
pub fn sampled_pixels(share: Share, options: &Options) -> u64 {
    let windows: Vec<Window> = share.windows([options.columns, options.rows]).collect();
    tasks(&windows, options).iter().map(|task| task.piece.area() as u64).sum()
}

/// The pieces to be sampled, in the order of the windows, and in each in that of the tiles of the whole picture.
fn tasks(windows: &[Window], options: &Options) -> Vec<Task> {
    let reach = options.filter.reach();
    let mut tasks = Vec::new();
    for (number, window) in windows.iter().enumerate() {
        let inner = Piece {
            column: window.column,
            row: window.row,
            width: window.columns,
            height: window.rows,
        };
        let outer = inner.grown(reach);
        // Tiles of the box filter begin at the window, so that they make a film; else at the corner of the picture.
        let corner = |side: i32| {
            let reach = i32::try_from(reach).expect("a filter is a few pixels wide");
            if reach == 0 { side } else { -reach }
        };
        let spans = |from: i32, length: u32, corner: i32| {
            let side = i32::try_from(SIDE).expect("small");
            let end =
                from + i32::try_from(length).expect("a picture has less than 2¹⁶ columns and rows");
            let first = corner + (from - corner).div_euclid(side) * side;
            (first..end).step_by(SIDE as usize).map(move |tile| {
                let (low, high) = (tile.max(from), (tile + side).min(end));
                (low, high.abs_diff(low))
            })
        };
        for (row, height) in spans(outer.row, outer.height, corner(inner.row)) {
            for (column, width) in spans(outer.column, outer.width, corner(inner.column)) {
                tasks.push(Task { window: number, piece: Piece { column, row, width, height } });
            }
        }
    }
    tasks
}

fn of_box(
    frame: &Frame<'_>,
    windows: &[Window],
    tasks: &[Task],
    progress: &(dyn Fn(u64) + Sync),
) -> (Vec<Film>, RayStats) {
    let counts = counts(frame.options);
    let start = |piece: Piece| FilmTile::new(piece.width, piece.height, counts);
    let (tiles, stats) = filled(frame, windows.len(), tasks, progress, start);
    let films = windows.iter().zip(tiles).map(|(window, tiles)| {
        Film::new((window.columns, window.rows), SIDE, counts, tiles).at(origin(window))
    });
    (films.collect(), stats)
}

fn of_wide(
    frame: &Frame<'_>,
    windows: &[Window],
    tasks: &[Task],
    progress: &(dyn Fn(u64) + Sync),
) -> (Vec<Film>, RayStats) {
    let counts = counts(frame.options);
    let start = |piece: Piece| WideTile::new(piece, frame.options.filter, counts);
    let (tiles, stats) = filled(frame, windows.len(), tasks, progress, start);
    let films = windows.iter().zip(tiles).map(|(window, tiles)| {
        Film::of_wide((window.columns, window.rows), origin(window), counts, tiles)
    });
    (films.collect(), stats)
}

/// Fills what `start` makes for each task; for each window what its tasks made.
fn filled<S: Sums + Send>(
    frame: &Frame<'_>,
    windows: usize,
    tasks: &[Task],
    progress: &(dyn Fn(u64) + Sync),
    start: impl Fn(Piece) -> S + Sync,
) -> (Vec<Vec<S>>, RayStats) {
    let pattern = Pattern::new(frame.options.sampling, frame.options.seed);
    let order: Vec<u32> = (0..).take(tasks.len()).collect();
    let made = frame.over(
        &order,
        || (),
        |tracer, (), number| {
            let piece = tasks[number as usize].piece;
            let mut sums = start(piece);
            let stats = frame.fill(tracer, piece, pattern.as_ref(), &mut sums);
            progress(piece.area() as u64);
            (sums, stats)
        },
    );
    let mut stats = RayStats::default();
    let mut tiles: Vec<Vec<S>> = (0..windows).map(|_| Vec::new()).collect();
    for (task, (sums, counted)) in tasks.iter().zip(made) {
        stats.add(&counted);
        tiles[task.window].push(sums);
    }
    (tiles, stats)
}

/// Samples of the halves of each pixel.
fn counts(options: &Options) -> [u32; 2] {
    Pattern::new(options.sampling, options.seed).map_or([1, 0], |pattern| pattern.counts())
}

fn origin(window: &Window) -> [u32; 2] {
    [window.column, window.row].map(i32::unsigned_abs)
}

/// The root of the mean square error of films together, where the halves of the samples tell.
fn error(films: &[Film], frame: &Frame<'_>) -> Option<f64> {
    if !matches!(frame.options.sampling, Sampling::Stochastic(_)) {
        return None;
    }
    let (mut sum, mut pixels) = (0.0, 0.0);
    for film in films {
        let (columns, rows) = film.size();
        let area = f64::from(columns) * f64::from(rows);
        let error = film.error(frame.background())?;
        sum += area * error * error;
        pixels += area;
    }
    (pixels > 0.0).then(|| (sum / pixels).sqrt())
}

impl PartPicture {
    /// What was cut at the depth limit and what was too faint, as of a whole picture.
    #[must_use]
    pub fn cut(&self) -> [f64; 2] {
        self.stats.cut()
    }

    /// The part as an image: a window is as large as it is, tiles lie on a canvas of the size of the whole picture that
    /// is 0 elsewhere. Those of `kinds` are there, or light, and coverage where `form` says or a pixel is not fully covered.
    /// The planes of `kinds` that are measured are sought now.
    ///
    /// # Errors
    ///
    /// [`PartError`] if there is no memory for it; [`RenderError`] if there are no threads.
    pub fn image(
        &self,
        world: &World,
        options: &Options,
        form: Form,
        kinds: Option<&[Kind]>,
    ) -> Result<Image, Box<dyn std::error::Error>> {
        let frame = self.share.frame(self.canvas);
        let image = self.light(frame, form, world.background)?;
        let Some(kinds) = kinds else { return Ok(image) };
        let light = image.planes().iter().filter(|plane| kinds.contains(&plane.kind)).cloned();
        let mut planes: Vec<Plane> = light.collect();
        planes.extend(self.measured(frame, world, options, kinds)?);
        Ok(image.with_planes(image.columns(), image.rows(), planes)?)
    }

    fn light(&self, frame: Window, form: Form, background: Rgb) -> Result<Image, PartError> {
        let mut canvas = Canvas::new(frame)?;
        let depth = if form.float { Depth::F32 } else { Depth::U8 };
        let light = [Kind::Red, Kind::Grn, Kind::Blu];
        for kind in light {
            canvas.make(kind, depth)?;
        }
        let images: Vec<Image> =
            self.films.iter().map(|film| film.image(form, background)).collect::<Result<_, _>>()?;
        let is_covered = images.iter().any(|image| image.plane(Kind::Cvg).is_some());
        for (image, &window) in images.iter().zip(&self.windows) {
            for Plane { kind, samples } in image.planes() {
                canvas.put(*kind, samples, window, window)?;
            }
            if is_covered && image.plane(Kind::Cvg).is_none() {
                canvas.cover(depth, window)?;
            }
        }
        let mut image = canvas.into_image(&light)?;
        let properties = &mut image.properties;
        properties.transfer = Some(form.transfer());
        properties.background = images.iter().find_map(|image| image.properties.background);
        if is_covered && images.iter().any(|image| image.properties.matte == Matte::Straight) {
            properties.matte = Matte::Straight;
        }
        Ok(image)
    }

    fn measured(
        &self,
        frame: Window,
        world: &World,
        options: &Options,
        kinds: &[Kind],
    ) -> Result<Vec<Plane>, Box<dyn std::error::Error>> {
        let planes = measured_in(world, options, kinds, &self.windows)?;
        let order: Vec<Kind> = planes.iter().map(|plane| plane.kind).collect();
        let mut canvas = Canvas::new(frame)?;
        for Plane { kind, samples } in &planes {
            canvas.make(*kind, samples.depth())?;
            let mut from = 0;
            for &window in &self.windows {
                let length = window.columns as usize * window.rows as usize;
                let own: Samples = samples.gathered(from..from + length);
                canvas.put(*kind, &own, window, window)?;
                from += length;
            }
        }
        if planes.is_empty() {
            return Ok(planes);
        }
        Ok(canvas.into_image(&order)?.into_planes())
    }
}
