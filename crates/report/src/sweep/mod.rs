//! The sweep over one scene: each measurement is looked up, or made and kept.

mod bench;
mod beside;
mod cutting;
mod sampling;
mod tracing;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use render::{LoadOptions, Omission, Picture, World};
use scene::Scene;

use crate::journal::{Digest, Figures, Journal};
use crate::way::Way;
use crate::{colors, peer};
use bench::Bench;
pub use cutting::{DEEPEST, cuts};

/// What is asked of a sweep.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Columns and rows of all pictures.
    pub size: (u32, u32),
    /// Seeds of which the mean is taken, for what is drawn by lot.
    pub seeds: u32,
    /// Samples a pixel of each reference; else as many as there is time for, from 32 to 256.
    pub reference: Option<u32>,
    /// When to stop measuring.
    pub deadline: Option<Instant>,
    /// Threads for what is not timed; 0 for as many as there are processors.
    pub threads: usize,
    /// Fewer ways, and no other filters.
    pub quick: bool,
    /// Render what POV-Ray has to show beside, from this file.
    pub peer: Option<PathBuf>,
}

/// A scene to be swept.
#[derive(Debug)]
pub struct Subject {
    /// A name for files, unlike those of the others.
    pub name: String,
    /// Where it is from, as it was named.
    pub path: PathBuf,
    /// The scene.
    pub scene: Scene,
}

/// What was found of one scene.
#[derive(Debug, Default)]
pub struct Found {
    /// Its name.
    pub name: String,
    /// Where it is from.
    pub path: PathBuf,
    /// Columns and rows.
    pub size: (u32, u32),
    /// Primitives that it stands for.
    pub primitives: u64,
    /// Of the references by the word of their filter: `samples`, `own`.
    pub references: Vec<(&'static str, Figures)>,
    /// Ways of sampling with the geometric means over seeds of `seconds`, `samples`, `error`, `reported`, with `ratio`,
    /// `ratio_least` and `ratio_most` of reported by true error where there is one, and `deviation`.
    pub ways: Vec<(Way, Figures)>,
    /// Depth and least weight, `seconds`, `rays`, `off`, `bound`.
    pub cuts: Vec<(u32, f64, Figures)>,
    /// Ways of tracing: `seconds`; the note is a digest of the picture, or why there is none.
    pub tracing: Vec<(&'static str, Figures)>,
    /// What each pass left out.
    pub omissions: Vec<Omission>,
    /// `load`, `load_all`, `trace`, `trace_all` in seconds, `same` is 1 if the bytes are.
    pub omitting: Option<Figures>,
    /// Colour tables and dithers: `seconds`, `rms_rgb`, `rms_oklab`.
    pub colors: Vec<(colors::Way, Figures)>,
    /// POV-Ray's settings: `seconds`, `error`.
    pub peers: Vec<(&'static peer::Way, Figures)>,
    /// What there was no time for, or what failed.
    pub missing: Vec<String>,
}

/// How much brighter differences are shown.
pub const GAIN: f64 = 16.0;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// A digest of all that a picture of the scene depends on.
pub(crate) fn scene_digest(scene: &Scene) -> Result<Digest> {
    let mut text = Vec::new();
    scene::format::write(scene, &mut text)?;
    let mut digest = Digest::default().and(&text);
    for image in &scene.images {
        for path in files_of(Path::new(&image.path)) {
            digest = digest.and(&fs::read(path)?);
        }
    }
    Ok(digest)
}

/// The files of a picture: with IDF, all of its name but logs, whose lines hold times.
fn files_of(path: &Path) -> Vec<PathBuf> {
    let folder = path.parent().filter(|folder| *folder != Path::new(""));
    let entries = fs::read_dir(folder.unwrap_or(Path::new("."))).into_iter().flatten().flatten();
    let is_of = |file: &PathBuf| {
        let is_log = file.extension().is_some_and(|ending| ending == "log");
        file.is_file() && !is_log && file.file_stem() == path.file_stem()
    };
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(is_of).collect();
    files.sort();
    files
}

/// Measures one scene; what `journal` knows already is taken from there. `said` hears what is done.
///
/// # Errors
///
/// If the scene cannot be rendered, or a file not be written.
pub fn sweep(
    subject: &Subject,
    settings: &Settings,
    journal: &mut Journal,
    folder: &Path,
    said: &dyn Fn(&str),
) -> Result<Found> {
    let (columns, rows) = settings.size;
    let named = |error: &dyn Error| format!("{}: {error}", subject.path.display());
    let picture = Some(settings.size);
    let load = |keep_all| LoadOptions { keep_all, picture, ..LoadOptions::default() };
    let world = World::load_with(&subject.scene, &load(false)).map_err(|error| named(&error))?;
    let version = env!("CARGO_PKG_VERSION");
    let key = format!("{version} {} {columns}x{rows}", scene_digest(&subject.scene)?);
    for part in ["pictures", "references"] {
        let part = folder.join(part).join(&subject.name);
        fs::create_dir_all(&part).map_err(|error| format!("{}: {error}", part.display()))?;
    }
    let mut bench = Bench {
        settings,
        journal,
        folder,
        name: &subject.name,
        world,
        key,
        said,
        missing: Vec::new(),
        sample_seconds: 0.0,
    };
    let mut found = Found {
        name: subject.name.clone(),
        path: subject.path.clone(),
        size: settings.size,
        primitives: bench.world.stands_for(),
        omissions: bench.world.omissions().to_vec(),
        ..Found::default()
    };
    bench.pilot()?;
    found.omitting = bench.omitting(&subject.scene, &load)?;
    bench.sampling(&mut found)?;
    bench.tracing(&mut found)?;
    bench.cutting(&mut found)?;
    bench.coloring(&mut found)?;
    bench.peers(&mut found)?;
    if !settings.quick {
        bench.filtering(&mut found)?;
    }
    found.missing = bench.missing;
    Ok(found)
}

/// A digest of all samples of a picture.
pub(crate) fn film_digest(picture: &Picture) -> String {
    let pixels = picture.film.pixels().fold(Digest::default(), |digest, pixel| {
        let [r, g, b] = pixel.color.map(f32::to_le_bytes);
        digest.and(&r).and(&g).and(&b).and(&pixel.coverage.to_le_bytes())
    });
    pixels.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_that_differ_have_other_digests() {
        let digest = |text: &str| {
            scene_digest(&compile::compile_text(text).scene.unwrap()).unwrap().to_string()
        };
        let first = digest("camera at (0, 0, 5) object is sphere");
        assert_eq!(first, digest("camera at (0, 0, 5)\n  object is sphere // a ball"));
        assert_ne!(first, digest("camera at (0, 0, 5) object is sphere at (1e-9, 0, 0)"));
    }
}
