//! What the modules share: a text to a scene, a scene to a picture, and the programs in this process.

#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

mod shown;

use std::error::Error;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use render::{Options, Sampling, World};
use scene::Scene;

pub(crate) use shown::Shown;

/// The paper's listing.
pub(crate) const LISTING: &str = include_str!("../../scenes/wine-glass/wine-glass.sdl");

/// The root of the repository.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// The scene that `text` describes.
pub(crate) fn scene(text: &str) -> Scene {
    let compiled = compile::compile_text(text);
    let report = compiled.report();
    compiled.scene.unwrap_or_else(|| panic!("{report}\nin\n{text}"))
}

/// Settings for a square picture with `grid` × `grid` samples a pixel.
pub(crate) fn square(side: u32, grid: u32) -> Options {
    Options { columns: side, rows: side, sampling: Sampling::Grid(grid), ..Options::default() }
}

/// The picture of `scene`.
pub(crate) fn shown(scene: &Scene, options: &Options) -> Shown {
    let world = World::load(scene).unwrap();
    let picture = render::render(&world, options, &|_| ()).unwrap();
    Shown::new(&picture.film, scene.background)
}

/// `portray` with these words on its command line; words that begin with `@` are names in `folder`.
pub(crate) fn portray(folder: &Path, words: &str) -> Result<(), Box<dyn Error>> {
    let arguments = render::command::Arguments::try_parse_from(arguments(folder, "portray", words));
    render::command::run(&arguments?)
}

/// `prcomp` in the same way.
pub(crate) fn prcomp(folder: &Path, words: &str) -> ExitCode {
    compile::command::run(arguments(folder, "prcomp", words))
}

fn arguments(folder: &Path, program: &str, words: &str) -> Vec<OsString> {
    let word = |word: &str| match word.strip_prefix('@') {
        Some(name) => folder.join(name).into_os_string(),
        None => word.into(),
    };
    std::iter::once(program.into()).chain(words.split_whitespace().map(word)).collect()
}

/// Every file below `folder` with what is in it, sorted by name.
pub(crate) fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let (mut folders, mut found) = (vec![folder.to_owned()], Vec::new());
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let bytes = fs::read(&path).unwrap();
                found.push((path.strip_prefix(folder).unwrap().to_owned(), bytes));
            }
        }
    }
    found.sort();
    found
}

/// sRGB to linear light (IEC 61966-2-1).
pub(crate) fn linear(byte: u8) -> f64 {
    let value = f64::from(byte) / 255.0;
    if value <= 0.040_45 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
}

/// Linear light to a display value of 0 to 255.
pub(crate) fn display(light: f64) -> f64 {
    let value = if light <= 0.003_130_8 {
        light * 12.92
    } else {
        1.055 * libm::pow(light, 1.0 / 2.4) - 0.055
    };
    value * 255.0
}
