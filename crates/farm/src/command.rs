//! The command line of `prfarm`.

use std::error::Error;
use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use idf::part::Tiles;

use crate::driver;
use crate::worker;

/// Renders a picture or a sequence in parts, by many processes
#[derive(Parser, Debug)]
#[command(
    name = "prfarm",
    version,
    after_help = "Examples:\n  prfarm render scenes/wine-glass/wine-glass.sdl --engine local --parts 8 -o wine-glass.png\n  \
                  prfarm render orbit.sdl --frames 0..47 --engine slurm --sbatch --partition=render -o orbit.png\n\n\
                  The same command again goes on where a render was stopped."
)]
pub struct Arguments {
    #[command(subcommand)]
    pub(crate) task: Task,
}

/// What to do.
#[derive(Subcommand, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one of it")]
pub(crate) enum Task {
    /// Render a scene in parts, and put them together
    Render(RenderArguments),
    /// Render one part: what the workers of `render` do
    Part(PartArguments),
}

/// How to render, and by whom.
#[derive(Args, Clone, Debug)]
pub(crate) struct RenderArguments {
    #[command(flatten)]
    pub(crate) picture: render::command::Arguments,
    /// Who does the work
    #[arg(long, value_enum)]
    pub(crate) engine: EngineWord,
    /// How many parts each picture is made of [default: 16, and 1 in a sequence]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_PARTS)))]
    pub(crate) parts: Option<u32>,
    /// Processes at a time, with `--engine local` [default: as many as there are cores]
    #[arg(long, value_name = "N")]
    pub(crate) jobs: Option<NonZeroUsize>,
    /// How often a part is tried again whose worker was killed
    #[arg(long, value_name = "N", default_value_t = 30)]
    pub(crate) retries: u32,
    /// An option for sbatch, with `--engine slurm`; may come more than once
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    pub(crate) sbatch: Vec<String>,
    /// Keep the parts when the picture is finished
    #[arg(long)]
    pub(crate) keep_parts: bool,
}

/// Most parts of a picture: more do not make it faster, and each is a few files.
const MOST_PARTS: u32 = if Tiles::MOST_PARTS < 10_000 { Tiles::MOST_PARTS } else { 10_000 };

/// Who does the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum EngineWord {
    /// Processes on this machine
    Local,
    /// Job arrays of a Slurm cluster, which shares this folder
    Slurm,
}

/// Which part to render.
#[derive(Args, Clone, Debug)]
pub(crate) struct PartArguments {
    /// The folder that `render` made, named after its output
    pub(crate) folder: PathBuf,
    /// The number of the part, from 0, counted over all pictures of a sequence
    pub(crate) number: usize,
    /// End when the process of this number has ended
    #[arg(long, value_name = "PID", hide = true)]
    pub(crate) parent: Option<u32>,
}

/// Does what the command line says.
///
/// # Errors
///
/// [`idf::command::UsageError`] for arguments that make no sense together; else what kept the picture from being made.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    match &arguments.task {
        Task::Render(arguments) => driver::run(arguments),
        Task::Part(arguments) => worker::run(arguments),
    }
}

/// The arguments of `render` in the words of a command line, without the name of the program.
pub(crate) fn parsed(words: &[String]) -> Result<RenderArguments, Box<dyn Error>> {
    let words = ["prfarm"].into_iter().chain(words.iter().map(String::as_str));
    match Arguments::try_parse_from(words)?.task {
        Task::Render(arguments) => Ok(arguments),
        Task::Part(_) => Err("the job is a part of another".into()),
    }
}
