//! Samples in rounds, until the picture is good enough or the time is over.
//!
//! Every pixel gets as many as all others until the error is near what is wanted; from then on those get more where a sample
//! takes most off it. What pixels need is told by samples of a third kind, the pilots, which are in neither half and not in
//! the picture: halves that decided for themselves, or for each other, would both stop where both happen to see nothing,
//! and their difference would not tell what they lack.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::allot::{Goal, Survey, allot};
use super::display::Display;
use super::estimate::shown;
use super::pattern::{pixel_seed, stochastic_side};
use super::sequence::{Draw, hash};
use crate::film::{Film, Half, Piece, Weighed, WideTile, weights};
use crate::options::Filter;
use crate::stats::RayStats;
use crate::tile::{Frame, Shot};
use crate::trace::tree::Tracer;
use crate::{Ending, Picture};

/// Samples in each half of a pixel before the error is estimated: the curve of displays is so bent in the dark that
/// few tell too little of it. As many are pilots.
const BASE: u32 = 8;
/// Pixels may differ in their samples when the error is at most so many times what is wanted.
const NEAR: f64 = 4.0;
/// Pilots do not pay where the error is less than so many times what is wanted.
const CLOSE: f64 = 1.5;
/// Which samples are pilots, after the halves, and what they are drawn by; the looks of an audit have 2 and 3.
const PILOTS: usize = 2;
const SEEDS: [u32; 3] = [0, 1, 4];
/// The most samples in a half of a pixel.
const MOST: u32 = 32_768;
/// Aimed at, as a share of the error that is wanted: not to need another round for a hair.
const AIM: f64 = 0.97;

/// One half of the samples of a pixel.
#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    count: u32,
    sum: Half,
    /// Of what is shown, in linear light: the mean and the sum of squares about it (Welford, "Note on a Method for
    /// Calculating Corrected Sums of Squares and Products", 1962).
    mean: [f32; 3],
    square: [f32; 3],
}

impl Cell {
    fn add(&mut self, light: &Half, background: [f32; 3]) {
        self.count += 1;
        self.sum.add(1.0, light);
        #[expect(clippy::cast_precision_loss, reason = "at most 2¹⁵")]
        let n = self.count as f32;
        let open = 1.0 - light.coverage;
        for (k, behind) in background.into_iter().enumerate() {
            let shown = (light.color[k] + open * behind).clamp(0.0, 1.0);
            let off = shown - self.mean[k];
            self.mean[k] += off / n;
            self.square[k] += off * (shown - self.mean[k]);
        }
    }

    #[expect(clippy::cast_precision_loss, reason = "at most 2¹⁵")]
    fn light(&self) -> Half {
        if self.count == 0 { Half::default() } else { self.sum.scaled(1.0 / self.count as f32) }
    }

    /// Variance of a sample in squared display steps.
    #[expect(clippy::cast_precision_loss, reason = "at most 2¹⁵")]
    fn variance(&self, display: &Display) -> f32 {
        if self.count < 2 {
            return 0.0;
        }
        let channel = |k: usize| {
            let slope = display.slope(self.mean[k]);
            self.square[k] / (self.count - 1) as f32 * slope * slope
        };
        (channel(0) + channel(1) + channel(2)) / 3.0
    }
}

/// The samples of a piece so far.
#[derive(Debug)]
struct Patch {
    piece: Piece,
    /// Both halves, and the pilots.
    cells: [Vec<Cell>; 3],
    /// Where the filter is wider than a pixel: sums of each pixel's samples by the pixel around it that they count in.
    spread: [Vec<Weighed>; 2],
    stats: RayStats,
}

impl Patch {
    fn new(piece: Piece, filter: Filter) -> Self {
        let beside = (2 * filter.reach() + 1) as usize;
        let spread = if filter == Filter::Box { 0 } else { piece.area() * beside * beside };
        Self {
            piece,
            cells: SEEDS.map(|_| vec![Cell::default(); piece.area()]),
            spread: [0, 1].map(|_| vec![Weighed::default(); spread]),
            stats: RayStats::default(),
        }
    }

    fn add(
        &mut self,
        half: usize,
        pixel: usize,
        place: [f64; 2],
        light: &Half,
        frame: &Progress<'_>,
    ) {
        self.cells[half][pixel].add(light, frame.background);
        let filter = frame.frame.options.filter;
        if filter == Filter::Box || half == PILOTS {
            return;
        }
        let beside = (2 * filter.reach() + 1) as usize;
        let sums = &mut self.spread[half][pixel * beside * beside..][..beside * beside];
        let across = weights(filter, place[0]);
        for (row, down) in sums.chunks_exact_mut(beside).zip(weights(filter, place[1])) {
            for (sum, across) in row.iter_mut().zip(across.clone()) {
                sum.add(down * across, light);
            }
        }
    }

    /// Each pixel's samples weigh as much as any other's, however many there are.
    fn wide(&self, filter: Filter) -> WideTile {
        let mut tile = WideTile::new(self.piece, filter, [1, 1]);
        let beside = (2 * filter.reach() + 1) as usize;
        for half in 0..2 {
            let pixels = self.spread[half].chunks_exact(beside * beside);
            for (pixel, (sums, cell)) in pixels.zip(&self.cells[half]).enumerate() {
                tile.gather(half, pixel, cell.count, sums);
            }
        }
        tile
    }
}

/// What a round brings.
enum Round<'a> {
    /// So many samples in the halves of every pixel, and so many pilots.
    All([u32; 3]),
    /// By pixel, row by row over the whole picture, in either half.
    Each(&'a [u32]),
}

/// A picture on its way.
struct Progress<'f> {
    frame: &'f Frame<'f>,
    background: [f32; 3],
    patches: Vec<Mutex<Patch>>,
    samples: AtomicU64,
    start: Instant,
    /// When sampling stops, wherever it is.
    deadline: Option<Instant>,
    /// Samples a second in the last round.
    speed: f64,
}

/// Samples between two looks at the clock.
const STRIDE: u64 = 64;

impl<'f> Progress<'f> {
    fn new(frame: &'f Frame<'f>) -> Self {
        let filter = frame.options.filter;
        let background = frame.background();
        let patch = |number| Mutex::new(Patch::new(frame.piece(number), filter));
        let patches = (0..frame.tile_count()).map(patch).collect();
        let (samples, start) = (AtomicU64::new(0), Instant::now());
        Self { frame, background, patches, samples, start, deadline: None, speed: 0.0 }
    }

    /// Takes samples until all pixels have as many as the round says, or until the deadline.
    fn round(&mut self, round: &Round<'_>) {
        let (before, start) = (*self.samples.get_mut(), Instant::now());
        let this = &*self;
        this.frame.over_tiles(|tracer, number| {
            if this.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                return;
            }
            let mut patch = this.patches[number as usize].lock().expect("no thread panics");
            this.patch_round(tracer, &mut patch, round);
        });
        #[expect(clippy::cast_precision_loss, reason = "counts below 2⁵³")]
        let taken = (*self.samples.get_mut() - before) as f64;
        if taken > 0.0 {
            self.speed = taken / start.elapsed().as_secs_f64();
        }
    }

    fn patch_round(&self, tracer: &mut Tracer<'f>, patch: &mut Patch, round: &Round<'_>) {
        let (piece, seed) = (patch.piece, self.frame.options.seed);
        // Column and row of the first sampled pixel of the picture are minus the reach of the filter.
        let reach = i32::try_from(self.frame.options.filter.reach()).expect("small");
        let columns = self.frame.sampled().0 as usize;
        let wanted = |half: usize, number: usize| match round {
            Round::All(counts) => counts[half],
            Round::Each(counts) => {
                let [column, row] = piece
                    .pixel(number)
                    .map(|at| usize::try_from(at + reach).expect("samples are where they count"));
                if half == PILOTS { 0 } else { counts[row * columns + column] }
            }
        };
        let todo: Vec<(usize, usize, u32, u32)> = (0..piece.area())
            .flat_map(|number| [0, 1, PILOTS].map(|half| (number, half)))
            .map(|(number, half)| {
                (number, half, patch.cells[half][number].count, wanted(half, number))
            })
            .filter(|&(.., from, to)| to > from)
            .collect();
        if todo.is_empty() {
            return;
        }
        let region = self.frame.region(&piece);
        let mut taken = 0_u64;
        let in_time = |taken: &mut u64| {
            *taken += 1;
            !((*taken).is_multiple_of(STRIDE)
                && (self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
                    || self.frame.is_stopped()))
        };
        let shots = todo.into_iter().flat_map(|(number, half, from, to)| {
            let pixel = piece.pixel(number);
            let seed = pixel_seed(pixel.map(i32::cast_unsigned), SEEDS[half], seed);
            let side = stochastic_side(2 * to);
            (from..to).map(move |sample| {
                let draw = Draw::new(sample, seed);
                let [x, y, ..] = draw.start();
                let place = (f64::from(pixel[0]) + x, f64::from(pixel[1]) + y);
                ((half, number, [x, y]), Shot { place, side, draw })
            })
        });
        tracer.stats = RayStats::default();
        let mut count = 0;
        let shots = shots.take_while(|_| in_time(&mut taken));
        self.frame.follow(tracer, region.as_ref(), shots, |(half, number, place), light| {
            patch.add(half, number, place, &light, self);
            count += 1;
        });
        patch.stats.add(&tracer.stats);
        self.samples.fetch_add(count, Ordering::Relaxed);
    }

    fn patches(&mut self) -> impl Iterator<Item = &Patch> {
        self.patches.iter_mut().map(|patch| &*patch.get_mut().expect("no thread panics"))
    }

    /// The picture so far. Its halves are means, and weigh the same.
    fn film(&mut self) -> Film {
        let options = self.frame.options;
        let (size, filter) = ((options.columns, options.rows), options.filter);
        if filter != Filter::Box {
            let tiles = self.patches().map(|patch| patch.wide(filter)).collect();
            return Film::of_wide(size, [0; 2], [1, 1], tiles);
        }
        let mut halves = [0, 1].map(|_| vec![Half::default(); (size.0 * size.1) as usize]);
        self.scatter(|half, at, cell| {
            if half != PILOTS {
                halves[half][at] = cell.light();
            }
        });
        Film::whole(size, [1, 1], halves)
    }

    /// Tells each half and the pilots of each sampled pixel by its place in the picture, row by row.
    fn scatter(&mut self, mut put: impl FnMut(usize, usize, &Cell)) {
        let columns = self.frame.sampled().0 as usize;
        let reach = i32::try_from(self.frame.options.filter.reach()).expect("small");
        for patch in self.patches() {
            for half in 0..=PILOTS {
                for (number, cell) in patch.cells[half].iter().enumerate() {
                    let [column, row] = patch.piece.pixel(number).map(|at| {
                        usize::try_from(at + reach).expect("samples are where they count")
                    });
                    put(half, row * columns + column, cell);
                }
            }
        }
    }

    /// Samples taken so far, pilots included.
    fn samples(&mut self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "counts below 2⁵³")]
        let samples = *self.samples.get_mut() as f64;
        samples
    }

    fn estimate(&self, film: &Film) -> Option<f64> {
        film.error(self.background)
    }

    fn pixels(&self) -> usize {
        let (columns, rows) = self.frame.sampled();
        columns as usize * rows as usize
    }

    /// Gives more samples to the pixels that need them most.
    fn refine(&mut self, goal: Goal) -> bool {
        let (columns, pixels) = (self.frame.sampled().0 as usize, self.pixels());
        let display = Display::get();
        let background = self.background;
        let mut survey = Survey { shown: vec![[0.0; 3]; pixels], within: vec![0.0; pixels] };
        let mut counts = vec![0; pixels];
        self.scatter(|half, at, cell| match half {
            PILOTS => {
                survey.shown[at] = shown(&cell.light(), background, display);
                survey.within[at] = cell.variance(display);
            }
            0 => counts[at] = cell.count,
            // The other half has as many, unless time was over.
            _ => counts[at] = if cell.count < counts[at] { cell.count } else { counts[at] },
        });
        let wanted = allot(&counts, &survey.variances(columns), &self.costs(), goal, MOST);
        let more = wanted != counts;
        if more {
            self.round(&Round::Each(&wanted));
        }
        more
    }

    /// Rays of a sample in each pixel, as a mean over its tile: counted, not timed, so that they are always the same.
    fn costs(&mut self) -> Vec<f32> {
        let (columns, pixels) = (self.frame.sampled().0 as usize, self.pixels());
        let reach = i32::try_from(self.frame.options.filter.reach()).expect("small");
        let mut costs = vec![1.0; pixels];
        for patch in self.patches() {
            #[expect(clippy::cast_precision_loss, reason = "a mean")]
            let cost = patch.stats.rays() as f32 / patch.stats.primary.max(1) as f32;
            for number in 0..patch.piece.area() {
                let [column, row] = patch
                    .piece
                    .pixel(number)
                    .map(|at| usize::try_from(at + reach).expect("samples are where they count"));
                costs[row * columns + column] = cost;
            }
        }
        costs
    }

    fn stats(&mut self) -> RayStats {
        let mut stats = RayStats::default();
        for patch in self.patches() {
            stats.add(&patch.stats);
        }
        stats
    }

    /// The picture, with what was cut in the rounds in which all pixels had as many samples.
    fn picture(&mut self, film: Film, even: &RayStats, ending: Ending) -> Picture {
        let stats = self.stats();
        #[expect(clippy::cast_precision_loss, reason = "counts below 2⁵³")]
        let samples = stats.primary as f64 / self.pixels() as f64;
        let error = self.estimate(&film);
        let cut = even.cut();
        Picture { film, stats, samples, error, cut, ending, certificates: None }
    }
}

/// Tells how much of the work is done, in pixels.
struct Told<'p> {
    progress: &'p (dyn Fn(u64) + Sync),
    pixels: f64,
    told: u64,
}

impl Told<'_> {
    fn tell(&mut self, share: f64) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "pixels")]
        let done = (self.pixels * share.clamp(0.0, 1.0)) as u64;
        if done > self.told {
            (self.progress)(done - self.told);
            self.told = done;
        }
    }
}

/// Samples until the estimated error is at most `wanted` display steps; nothing if the picture is given up before. `show`
/// is given what there is after each round but the last.
pub(crate) fn until_error(
    frame: &Frame<'_>,
    wanted: f64,
    progress: &(dyn Fn(u64) + Sync),
    mut show: Option<&mut (dyn FnMut(Picture) + Send)>,
) -> Option<Picture> {
    let mut made = Progress::new(frame);
    let mut told = Told { progress, pixels: made.pixels() as f64, told: 0 };
    let (mut count, mut even) = (BASE, None);
    // Error and samples before a round in which pixels differed; then whether such rounds have been given up.
    let (mut before, mut given_up) = (None, false);
    made.round(&Round::All([count, count, 0]));
    loop {
        if frame.is_stopped() {
            return None;
        }
        let film = made.film();
        let error = made.estimate(&film).unwrap_or(0.0);
        // Time goes with the error to the power of −4/3.
        told.tell(libm::pow(wanted / error.max(wanted), 4.0 / 3.0));
        if error <= wanted {
            let even = even.unwrap_or_else(|| made.stats());
            return Some(made.picture(film, &even, Ending::Done));
        }
        if let Some(show) = &mut show {
            let (film, even) = (made.film(), even.unwrap_or_else(|| made.stats()));
            show(made.picture(film, &even, Ending::Done));
        }
        let samples = made.samples();
        if let Some((error_before, samples_before)) = before.take() {
            // As many samples everywhere would have taken this much off. Where they would do better, what is missing
            // is where the pilots saw nothing.
            given_up |= error > error_before * libm::pow(samples_before / samples, 0.75);
        }
        let near = even.is_some() || (CLOSE * wanted..NEAR * wanted).contains(&error);
        let more = if given_up || !near {
            // Not more than will do: the error goes with the samples to the power of −3/4.
            let enough = f64::from(count) * libm::pow(error / (AIM * wanted), 4.0 / 3.0);
            let next = libm::ceil(enough).clamp(f64::from(count + 1), f64::from(2 * count));
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
            let next = (next as u32).min(MOST);
            let more = next > count;
            count = next;
            made.round(&Round::All([count, count, 0]));
            more
        } else {
            if even.is_none() {
                even = Some(made.stats());
                made.round(&Round::All([count, count, BASE]));
            }
            before = Some((error, samples));
            let left = AIM * wanted / error;
            made.refine(Goal::Left(left * left))
        };
        if !more {
            // Pilots that were given up do not tell that more are of no use.
            if frame.is_stopped() {
                return None;
            }
            let even = even.unwrap_or_else(|| made.stats());
            return Some(made.picture(film, &even, Ending::MostSamples));
        }
    }
}

/// The best picture in some time; nothing if it is given up before.
pub(crate) fn until_time(
    frame: &Frame<'_>,
    time: Duration,
    progress: &(dyn Fn(u64) + Sync),
) -> Option<Picture> {
    let mut made = Progress::new(frame);
    let pixels = made.pixels() as f64;
    let mut told = Told { progress, pixels, told: 0 };
    made.round(&Round::All([1, 0, 0]));
    if frame.is_stopped() {
        return None;
    }
    if made.start.elapsed() * 2 > time {
        let film = made.film().of_first_half();
        let even = made.stats();
        return Some(made.picture(film, &even, Ending::OneSample));
    }
    made.round(&Round::All([1, 1, 0]));
    // At the end the picture is put together, and its error is estimated.
    let film = Instant::now();
    made.film().error(made.background);
    let time = time.saturating_sub(film.elapsed());
    made.deadline = Some(made.start + time);
    // Shorter rounds are not worth their planning.
    let rest = time.mul_f64(REST);
    let (mut count, mut even) = (1, None);
    loop {
        if frame.is_stopped() {
            return None;
        }
        let spent = made.start.elapsed();
        told.tell(spent.as_secs_f64() / time.as_secs_f64());
        let left = time.saturating_sub(spent);
        if left <= rest {
            break;
        }
        // Samples that fit.
        let room = left.as_secs_f64() * made.speed;
        let whole = libm::floor(room / (2.0 * pixels));
        if even.is_none() && count < BASE && whole >= 1.0 {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
            let more = whole.min(f64::from(count)) as u32;
            count += more;
            made.round(&Round::All([count, count, 0]));
        } else if count < BASE {
            even.get_or_insert_with(|| made.stats());
            made.sprinkle(room / (2.0 * pixels));
        } else {
            if even.is_none() {
                even = Some(made.stats());
                made.round(&Round::All([count, count, BASE]));
                continue;
            }
            // Half of what is left, so that the next round knows more; at last all of it.
            let last = left.as_secs_f64() < LAST * time.as_secs_f64();
            if !made.refine(Goal::Samples(if last { room } else { 0.5 * room })) {
                // Nothing differs anywhere, or all have the most.
                break;
            }
        }
    }
    let film = made.film();
    let even = even.unwrap_or_else(|| made.stats());
    Some(made.picture(film, &even, Ending::Done))
}

/// The share of the time that is too short for another round.
const REST: f64 = 0.01;
/// The share of the time that is spent in one round.
const LAST: f64 = 0.2;

impl Progress<'_> {
    /// One sample more in both halves of a share of the pixels, wherever it falls.
    fn sprinkle(&mut self, share: f64) {
        let mut counts = vec![0; self.pixels()];
        let columns = self.frame.sampled().0 as usize;
        let seed = self.frame.options.seed;
        self.scatter(|half, at, cell| {
            let place = u32::try_from(at % columns).unwrap_or(0);
            let chance = hash(hash(place, u32::try_from(at / columns).unwrap_or(0)), seed);
            let more = f64::from(chance) < share * f64::from(u32::MAX);
            if half == 0 {
                counts[at] = cell.count + u32::from(more);
            }
        });
        self.round(&Round::Each(&counts));
    }
}
