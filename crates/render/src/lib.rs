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

#[cfg(feature = "command")]
pub mod command;
mod film;
mod options;
mod picture;
mod sample;
mod shade;
mod stats;
mod tile;
mod trace;
mod world;

pub use film::{Film, Half, Pixel};
pub use options::{Accel, Options};
pub use picture::Form;
pub use stats::RayStats;
pub use world::{LoadError, World};

/// A finished render.
#[derive(Debug)]
pub struct Picture {
    /// Samples.
    pub film: Film,
    /// Counts.
    pub stats: RayStats,
}

/// Why a render could not start: the threads could not be made.
#[derive(Debug)]
pub struct ThreadError(rayon::ThreadPoolBuildError);

impl std::fmt::Display for ThreadError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "cannot start threads: {}; try fewer with `--threads`", self.0)
    }
}

impl std::error::Error for ThreadError {}

/// Stack for one level of the expression or of the ray tree, from above; unoptimised builds included.
const STACK_PER_LEVEL: usize = 4 << 10;
const STACK_LEAST: usize = 8 << 20;

/// Renders `world`. `progress` hears how many pixels have been finished since it was last called.
///
/// # Errors
///
/// [`ThreadError`] when the threads cannot be made.
pub fn render(
    world: &World,
    options: &Options,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Picture, ThreadError> {
    let view = world.view_from.view(options.columns, options.rows);
    let levels = world.depth() as usize + options.depth as usize;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads)
        .stack_size(STACK_LEAST + levels * STACK_PER_LEVEL)
        .build()
        .map_err(ThreadError)?;
    let (film, stats) = pool.install(|| tile::render(world, view, options, progress));
    Ok(Picture { film, stats })
}
