//! Scene to image: ray tracing of constructive solid geometry.
//!
//! A [`scene::Scene`] is loaded into a [`World`]: a flat expression with the eye at the origin, boxes in hierarchies,
//! and one part for each medium an object can have. Tiles of the picture are traced in parallel; what they see goes to a
//! [`Film`], which keeps two halves of the samples apart.
//!
//! ```
//! use render::{Options, World, render};
//! use scene::{Camera, Placement, Primitive, Scene, Solid};
//!
//! let mut scene = Scene { ambient: scene::Rgb::ONE, ..Scene::default() };
//! scene.add_object(None, Solid::primitive(Primitive::Sphere, Placement::default()));
//! scene.camera = Some(Camera {
//!     parallel: false,
//!     position: glam::DVec3::new(0.0, 0.0, 9.0),
//!     target: glam::DVec3::ZERO,
//!     focal_length_mm: 50.0,
//! });
//! let world = World::load(&scene)?;
//! let options = Options { columns: 32, rows: 32, ..Options::default() };
//! let picture = render(&world, &options, &|_| ())?;
//! let middle = picture.film.pixels().nth(16 * 32 + 16).unwrap();
//! assert_eq!(middle.color, [1.0; 3]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod certify;
#[cfg(feature = "command")]
pub mod command;
#[cfg(feature = "command")]
mod figures;
mod film;
mod first;
pub mod identity;
mod options;
pub mod part;
mod picture;
#[cfg(feature = "command")]
mod progress;
mod radiance;
#[cfg(feature = "command")]
mod reading;
mod sampling;
mod schedule;
pub mod sequence;
mod shade;
mod stats;
mod tile;
mod trace;
#[cfg(feature = "command")]
mod watch;
mod world;

pub use certify::picture::Certificates;
use certify::picture::obstacle;
pub use film::{Film, Half, Pixel};
pub use first::{measured, measured_in, measured_kinds};
pub use options::{Accel, Filter, Options, Rate, Sampling};
pub use picture::Form;
pub use radiance::{Radiance, radiance};
pub use sampling::audit::{Audit, audit};
pub use sampling::choice::noise;
pub use sampling::wish::{Antialiasing, Wish, WishError};
pub use schedule::{scheduled, tile_seconds};
pub use shade::texture_file::{ImageFailure, PictureCache};
pub use stats::RayStats;
pub use world::{LoadError, LoadOptions, Omission, World};

/// A finished render.
#[derive(Debug)]
pub struct Picture {
    /// Samples.
    pub film: Film,
    /// Counts.
    pub stats: RayStats,
    /// Samples of a pixel, or their mean.
    pub samples: f64,
    /// The root of the mean square error of the picture over its background, in display steps of 1/255, before rounding,
    /// as the two halves of the samples tell; none where they are not drawn by lot, or where there is but one.
    pub error: Option<f64>,
    /// What was cut at the depth limit and what was too faint, as a mean over the picture in channel units: a bound on
    /// what no number of samples brings.
    pub cut: [f64; 2],
    /// Whether it is as it was asked for.
    pub ending: Ending,
    /// What was proved of it, if that was asked for.
    pub certificates: Option<Certificates>,
}

/// Why a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// It is what was asked for.
    Done,
    /// The error is above the one asked for, but pixels have the most samples that there are.
    MostSamples,
    /// There was time for one sample only, and it may have taken longer.
    OneSample,
}

/// Why a render could not start.
#[derive(Debug)]
#[non_exhaustive]
pub enum RenderError {
    /// The threads could not be made.
    Threads(rayon::ThreadPoolBuildError),
    /// Lists of all boundaries along a ray would be too long.
    Lists {
        /// Primitives that the scene stands for.
        primitives: u64,
    },
    /// Nothing can be proved of such a picture.
    Certify {
        /// Why not.
        reason: &'static str,
    },
    /// There is no memory for the picture.
    Memory {
        /// Columns and rows asked for.
        size: (u32, u32),
        /// Bytes it takes.
        bytes: u64,
    },
}

impl std::fmt::Display for RenderError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Threads(error) => {
                write!(f, "cannot start threads: {error}; try fewer with `--threads`")
            }
            Self::Lists { primitives } => write!(
                f,
                "without boxes every ray lists the boundaries of all {primitives} primitives that the scene stands for, \
                 and more than {LISTED_LIMIT} take too long; try `--accel boxes` or `--accel bvh`"
            ),
            Self::Certify { reason } => write!(f, "nothing can be certified: {reason}"),
            Self::Memory { size: (columns, rows), bytes } => write!(
                f,
                "no memory for a picture of {columns}x{rows} pixels, which takes {} MB; make it smaller",
                bytes >> 20
            ),
        }
    }
}

impl std::error::Error for RenderError {}

/// Bytes a pixel takes at most while a picture is made.
fn pixel_bytes(options: &Options) -> u64 {
    // Two halves on the film, then planes.
    let plain = 96;
    let beside = u64::from(2 * options.filter.reach() + 1);
    // Two halves of sums with their weights, in tiles that overlap and in the picture.
    let wide = if beside > 1 { 120 } else { 0 };
    match options.sampling {
        // Samples in rounds keep what each half of a pixel knows, and what it gives to each pixel around it.
        Sampling::Stochastic(Rate::Error(_) | Rate::Time(_)) => {
            let spread = if beside > 1 { 2 * 20 * beside * beside } else { 0 };
            plain + 200 + wide + spread
        }
        _ => plain + wide,
    }
}

/// Primitives whose boundaries are listed for every ray where nothing says which of them it can meet.
const LISTED_LIMIT: u64 = 1 << 24;

/// Asks for all the memory of the picture at once and gives it back: if there is none, now is the time to say so.
fn check_memory(options: &Options) -> Result<(), RenderError> {
    let (columns, rows) = (options.columns, options.rows);
    let bytes = u64::from(columns) * u64::from(rows) * pixel_bytes(options);
    let room = usize::try_from(bytes).ok().map(|bytes| Vec::<u8>::new().try_reserve_exact(bytes));
    match room {
        Some(Ok(())) => Ok(()),
        _ => Err(RenderError::Memory { size: (columns, rows), bytes }),
    }
}

/// Whether there can be such a picture.
fn check(world: &World, options: &Options) -> Result<(), RenderError> {
    check_memory(options)?;
    match obstacle(world, options).filter(|_| options.certify) {
        Some(reason) => Err(RenderError::Certify { reason }),
        None => Ok(()),
    }
}

/// Stack for one level of the expression or of the ray tree, from above; unoptimised builds included.
const STACK_PER_LEVEL: usize = 4 << 10;
const STACK_LEAST: usize = 8 << 20;

/// Renders `world`. `progress` hears how many pixels have been finished since it was last called.
///
/// # Errors
///
/// [`RenderError`] when there are no threads or no memory to be had.
pub fn render(
    world: &World,
    options: &Options,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Picture, RenderError> {
    check(world, options)?;
    let view = world.view_from.view(options.columns, options.rows);
    let pool = pool(world, options, options.threads)?;
    Ok(pool.install(|| tile::render(world, view, options, progress)))
}

/// [`render`] until `stopped` says that the picture is not wanted any more, which it may not take back: then there is
/// none. With [`Rate::Error`] `show` is given what there is after each round but the last.
///
/// # Errors
///
/// As [`render`].
pub fn render_while_wanted(
    world: &World,
    options: &Options,
    stopped: &(dyn Fn() -> bool + Sync),
    show: Option<&mut (dyn FnMut(Picture) + Send)>,
) -> Result<Option<Picture>, RenderError> {
    check(world, options)?;
    let view = world.view_from.view(options.columns, options.rows);
    let pool = pool(world, options, options.threads)?;
    Ok(pool.install(|| tile::render_while_wanted(world, view, options, stopped, show)))
}

/// Threads with stack enough for `world`; 0 for as many as there are processors.
fn pool(
    world: &World,
    options: &Options,
    threads: usize,
) -> Result<rayon::ThreadPool, RenderError> {
    let primitives = world.stands_for();
    let lists_all = matches!(options.accel, Accel::None | Accel::Flat);
    if lists_all && primitives > LISTED_LIMIT {
        return Err(RenderError::Lists { primitives });
    }
    let levels = world.depth() as usize + options.depth as usize;
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .stack_size(STACK_LEAST + levels * STACK_PER_LEVEL)
        .build()
        .map_err(RenderError::Threads)
}
