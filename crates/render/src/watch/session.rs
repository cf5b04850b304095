//! Pictures of a scene that changes: one at once, then better ones, until it changes again.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use idf::{Kind, Samples, Window};
use live::{Board, Look, Model, Pick, Place, Problem, Shot, Stage};
use scene::{Camera, Lens, Scene};

use crate::figures::Done;
use crate::{
    LoadError, LoadOptions, Options, Picture, PictureCache, Rate, RenderError, Sampling, World,
    measured_in, render_while_wanted,
};

/// What the text of a scene tells beside the scene.
pub(super) trait Source: Send + Sync {
    /// Where an object is written, counted from 0.
    fn place(&self, object: usize) -> Option<Place>;
    /// Why the scene cannot be loaded, with the line that is to blame.
    fn explain(&self, error: &LoadError) -> Problem;
    /// A camera as a statement.
    fn statement(&self, camera: &Camera, lens: Option<&Lens>) -> String;
}

/// How pictures are made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settings {
    /// But for the sampling.
    pub(super) options: Options,
    /// Of the picture that is asked for; none where the scene chooses.
    pub(super) sampling: Option<Sampling>,
    pub(super) load: LoadOptions,
    /// Rounding is spread in a fine pattern.
    pub(super) dither: bool,
    /// After the picture that is asked for the error is brought down to this, in display steps.
    pub(super) refine: Option<f64>,
}

/// A scene without errors.
#[derive(Clone)]
pub(super) struct Good {
    /// Texts without errors, this one included.
    pub(super) revision: u64,
    pub(super) scene: Arc<Scene>,
    pub(super) source: Arc<dyn Source>,
    /// Its pictures, read once and not for each place that they are seen from.
    pub(super) pictures: Arc<Mutex<PictureCache>>,
}

/// A scene from somewhere, ready to be rendered.
struct Stand {
    good: Good,
    camera: Camera,
    world: World,
    begun: Instant,
}

/// The pictures of one scene.
pub(super) struct Session {
    settings: Settings,
    board: Arc<Board>,
    /// Another number stops what is being made for the one before.
    turn: AtomicU64,
    state: Mutex<State>,
    work: Condvar,
    /// One picture at a time has all threads.
    easel: Mutex<()>,
    /// Nanoseconds of a pixel with one sample, as the last picture took them; 0 before the first.
    pace: AtomicU64,
}

/// A movement should be seen as one: where a picture with one sample in each pixel takes longer, it has fewer.
const MOVING: Duration = Duration::from_millis(90);
/// After a change, where a picture with one sample in each pixel takes longer, coarser ones come before it.
const WAITING: Duration = Duration::from_millis(200);
/// Sides of the squares, in pixels, that share a sample.
const COARSE: [u32; 4] = [16, 8, 4, 2];
/// Fewer samples show nothing, nor how long more of them take.
const LEAST_SAMPLES: u64 = 1024;
/// While the camera moves, rays that can add less than this to a channel are left out: a fifth of the work, and little
/// beside what one sample in each pixel leaves out anyway.
const MOVING_WEIGHT: f64 = 1.0 / 64.0;

#[derive(Default)]
struct State {
    good: Option<Good>,
    /// Where the person at the page looks from, if not where the text says.
    camera: Option<Camera>,
    /// What is to be made next.
    next: Option<Arc<Stand>>,
    /// Of the newest picture.
    newest: Option<Arc<Stand>>,
}

/// Standing for locks: whoever held one would have to panic for it to be lost.
const HELD: &str = "no one panics who holds it";

impl Session {
    pub(super) fn new(settings: Settings, board: Arc<Board>) -> Self {
        let Options { columns, rows, .. } = settings.options;
        board.say(|shown| shown.size = [columns, rows]);
        Self {
            settings,
            board,
            turn: AtomicU64::new(0),
            state: Mutex::default(),
            work: Condvar::new(),
            easel: Mutex::new(()),
            pace: AtomicU64::new(0),
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().expect(HELD)
    }

    /// Stops what is being made: it is of yesterday.
    pub(super) fn halt(&self) {
        self.turn.fetch_add(1, Ordering::Relaxed);
    }

    /// Has pictures made of a scene, from where the last was seen if its text says the same of the camera. Fails if it
    /// cannot be loaded; then the last stays. `begun` is when the change was seen, and `changed` are the files that are other
    /// than those of the last.
    pub(super) fn take(
        &self,
        mut good: Good,
        begun: Instant,
        changed: &BTreeSet<PathBuf>,
    ) -> Result<(), Problem> {
        let kept = {
            let state = self.lock();
            let before = state.good.as_ref();
            good.revision = before.map_or(0, |before| before.revision) + 1;
            if let Some(before) = before {
                let mut pictures = before.pictures.lock().expect(HELD).clone();
                changed.iter().for_each(|path| pictures.forget(path));
                good.pictures = Arc::new(Mutex::new(pictures));
            }
            let before = before.map(|before| before.scene.camera);
            state.camera.filter(|_| before == Some(good.scene.camera))
        };
        let stand = self.stand(&good, kept, begun).map_err(|error| good.source.explain(&error))?;
        let mut state = self.lock();
        state.good = Some(good);
        state.camera = kept;
        self.begin(&mut state, stand);
        Ok(())
    }

    fn stand(
        &self,
        good: &Good,
        camera: Option<Camera>,
        begun: Instant,
    ) -> Result<Stand, LoadError> {
        let own = good.scene.camera;
        let mut pictures = good.pictures.lock().expect(HELD);
        let mut load =
            |scene: &Scene| World::load_keeping(scene, &self.settings.load, &mut pictures);
        let world = match camera {
            Some(camera) if own != Some(camera) => {
                load(&Scene { camera: Some(camera), ..(*good.scene).clone() })?
            }
            _ => load(&good.scene)?,
        };
        drop(pictures);
        let camera = camera.or(own).ok_or(LoadError::NoCamera)?;
        Ok(Stand { good: good.clone(), camera, world, begun })
    }

    fn begin(&self, state: &mut State, stand: Stand) {
        self.halt();
        state.next = Some(Arc::new(stand));
        self.work.notify_all();
    }

    /// Makes pictures as long as the program runs.
    pub(super) fn paint(&self) {
        loop {
            let idle = |state: &mut State| state.next.is_none();
            let mut state = self.work.wait_while(self.lock(), idle).expect(HELD);
            let turn = self.turn.load(Ordering::Relaxed);
            let next = state.next.take();
            drop(state);
            if let Some(stand) = next
                && let Err(problem) = self.make(turn, &stand)
            {
                self.board.say(|shown| shown.problems.push(problem));
            }
        }
    }

    /// A picture with one sample a pixel, or in each square of so many, unless it is stopped.
    fn quick(
        &self,
        world: &World,
        square: u32,
        options: &Options,
        stopped: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<Picture>, RenderError> {
        let (columns, rows) = (options.columns.div_ceil(square), options.rows.div_ceil(square));
        let options = Options { columns, rows, sampling: Sampling::Grid(1), ..*options };
        let easel = self.easel.lock().expect(HELD);
        let begun = Instant::now();
        let picture = render_while_wanted(world, &options, stopped, None)?;
        drop(easel);
        if picture.is_some() {
            let pixels = u128::from(columns) * u128::from(rows);
            let pace = u64::try_from(begun.elapsed().as_nanos() / pixels).unwrap_or(u64::MAX);
            self.pace.store(pace, Ordering::Relaxed);
        }
        Ok(picture)
    }

    /// Samples of a picture with one in each square of so many pixels.
    fn samples(&self, square: u32) -> u64 {
        let Options { columns, rows, .. } = self.settings.options;
        u64::from(columns.div_ceil(square)) * u64::from(rows.div_ceil(square))
    }

    /// How long they take, by what the last picture took.
    fn expected(&self, square: u32) -> Duration {
        let pace = self.pace.load(Ordering::Relaxed);
        Duration::from_nanos(pace.saturating_mul(self.samples(square)))
    }

    /// Squares for coarse pictures, the largest first.
    fn squares(&self) -> impl DoubleEndedIterator<Item = u32> {
        COARSE.into_iter().filter(|&square| self.samples(square) >= LEAST_SAMPLES)
    }

    /// Coarse pictures, if need be, one sample a pixel, then the picture that is asked for, then better ones, as long as
    /// they are wanted.
    fn make(&self, turn: u64, stand: &Arc<Stand>) -> Result<(), Problem> {
        let failed = |error: RenderError| nowhere(&error.to_string());
        let Settings { options, sampling, load, refine, .. } = self.settings;
        let stopped = || self.turn.load(Ordering::Relaxed) != turn;
        let mut first = None;
        if self.expected(1) <= WAITING {
            // What the last scene took is no measure of this one.
            let begun = Instant::now();
            let has_coarse = self.squares().next().is_some();
            let late = || stopped() || has_coarse && begun.elapsed() > WAITING;
            first = self.quick(&stand.world, 1, &options, &late).map_err(failed)?;
        }
        if first.is_none() {
            for square in self.squares() {
                if square > COARSE[1] && self.expected(COARSE[1]) <= MOVING {
                    continue;
                }
                let made = self.quick(&stand.world, square, &options, &stopped).map_err(failed)?;
                let Some(picture) = made.filter(|_| !stopped()) else { return Ok(()) };
                self.show(stand, &options, &picture, Stage::Coarse);
                if self.expected(1) <= WAITING {
                    break;
                }
            }
        }
        let once = Sampling::Grid(1);
        let better = refine.map(|error| Sampling::Stochastic(Rate::Error(error)));
        let fitting = || Sampling::fitting(&stand.good.scene, load.glossy);
        let mut stages: Vec<Sampling> = vec![once, sampling.unwrap_or_else(fitting)];
        stages.extend(better);
        stages.dedup();
        let last = stages.len() - 1;
        for (number, sampling) in stages.into_iter().enumerate() {
            let options = Options { sampling, ..options };
            let stage = match number {
                _ if number == last => Stage::Finished,
                0 => Stage::AtOnce,
                _ => Stage::Asked,
            };
            let mut show = |picture: Picture| {
                if !stopped() {
                    self.show(stand, &options, &picture, Stage::Asked);
                }
            };
            let made = if sampling == once {
                match first.take() {
                    Some(picture) => Ok(Some(picture)),
                    None => self.quick(&stand.world, 1, &options, &stopped),
                }
            } else {
                let easel = self.easel.lock().expect(HELD);
                let made = render_while_wanted(&stand.world, &options, &stopped, Some(&mut show));
                drop(easel);
                made
            };
            match made.map_err(failed)? {
                Some(picture) if !stopped() => self.show(stand, &options, &picture, stage),
                _ => return Ok(()),
            }
        }
        Ok(())
    }

    fn show(&self, stand: &Arc<Stand>, options: &Options, picture: &Picture, stage: Stage) {
        let shot = self.shot(picture, &stand.world);
        let seconds = stand.begun.elapsed().as_secs_f64();
        let Picture { stats, samples, error, cut, certificates, .. } = *picture;
        let done = Done { stats, samples, error, cut, certificates, seconds };
        let mut figures = done.figures(options, &stand.world);
        if stage == Stage::Coarse {
            // The others would be those of a smaller picture.
            figures.retain(|(name, _)| *name == "trace_seconds");
        }
        let named = |(name, value): (&str, String)| {
            // Here it is the time since the text changed, reading included.
            let name = if name == "trace_seconds" { "seconds" } else { name };
            (name.replace('_', " "), value)
        };
        let figures = figures.into_iter().map(named).collect();
        self.lock().newest = Some(Arc::clone(stand));
        let Stand { good, camera, world, .. } = &**stand;
        self.board.show(shot, |shown| {
            shown.camera = Some(*camera);
            shown.statement = good.source.statement(camera, good.scene.lens.as_ref());
            shown.stage = stage;
            shown.revision = good.revision;
            shown.figures = figures;
            shown.omissions = world
                .omissions()
                .iter()
                .map(|pass| {
                    let why = format!("{}: {}", pass.what, pass.reason);
                    (pass.name.to_owned(), why, [pass.before, pass.after])
                })
                .collect();
        });
    }

    fn shot(&self, picture: &Picture, world: &World) -> Shot {
        let (columns, rows) = picture.film.size();
        let rgba = picture.film.rgba(world.background, self.settings.dither);
        Shot { columns, rows, rgba }
    }
}

impl Model for Session {
    fn look(&self, camera: &Camera) -> Result<Look, String> {
        let good = self.lock().good.clone().ok_or("there is no scene without errors yet")?;
        self.halt();
        let stand =
            self.stand(&good, Some(*camera), Instant::now()).map_err(|error| error.to_string())?;
        let options = self.settings.options;
        let min_weight = f64::max(options.min_weight, MOVING_WEIGHT);
        let options = Options { min_weight, ..options };
        let mut squares = [1].into_iter().chain(self.squares().rev());
        let square = squares.find(|&square| self.expected(square) <= MOVING);
        let square = square.or_else(|| self.squares().next()).unwrap_or(1);
        let begun = Instant::now();
        let made = self.quick(&stand.world, square, &options, &|| false);
        let picture = made.map_err(|error| error.to_string())?.ok_or("it was given up")?;
        let shot = self.shot(&picture, &stand.world);
        let microseconds = u64::try_from(begun.elapsed().as_micros()).unwrap_or(u64::MAX);
        let statement = good.source.statement(camera, good.scene.lens.as_ref());
        self.lock().newest = Some(Arc::new(stand));
        Ok(Look { shot, statement, microseconds })
    }

    fn settle(&self, camera: Option<Camera>) {
        let begun = Instant::now();
        let Some(good) = self.lock().good.clone() else { return };
        // From where it cannot be seen there was no picture to settle at.
        let Ok(stand) = self.stand(&good, camera, begun) else { return };
        let mut state = self.lock();
        let is_newest = state.good.as_ref().is_some_and(|now| Arc::ptr_eq(&now.scene, &good.scene));
        if is_newest {
            state.camera = camera;
            self.begin(&mut state, stand);
        }
    }

    fn pick(&self, column: u32, row: u32) -> Option<Pick> {
        let stand = self.lock().newest.clone()?;
        let options = Options { threads: 1, ..self.settings.options };
        if column >= options.columns || row >= options.rows {
            return None;
        }
        let place = |side: u32| i32::try_from(side).ok();
        let window = Window { column: place(column)?, row: place(row)?, columns: 1, rows: 1 };
        let kinds = [Kind::Dep, Kind::Nrx, Kind::Nry, Kind::Nrz, Kind::Obj];
        let planes = measured_in(&stand.world, &options, &kinds, &[window]).ok()?;
        let value = |kind: Kind| {
            let plane = planes.iter().find(|plane| plane.kind == kind)?;
            match &plane.samples {
                Samples::U16(samples) => samples.first().copied().map(f64::from),
                Samples::F32(samples) => samples.first().copied().map(f64::from),
                Samples::U8(_) => None,
            }
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
        let object = value(Kind::Obj)? as usize;
        let index = object.checked_sub(1)?;
        let Good { scene, source, .. } = &stand.good;
        Some(Pick {
            object,
            name: scene.objects.get(index)?.name.clone(),
            place: source.place(index),
            depth: value(Kind::Dep)?,
            normal: [value(Kind::Nrx)?, value(Kind::Nry)?, value(Kind::Nrz)?],
        })
    }
}

/// A problem that no place in the text shows.
pub(super) fn nowhere(message: &str) -> Problem {
    Problem { is_error: true, file: None, line: 0, column: 0, text: format!("error: {message}") }
}
