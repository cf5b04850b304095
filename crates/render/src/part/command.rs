//! The part of the command line that asks for a part of a picture.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::Args;
use idf::Window;
use idf::command::{UsageError, check_output};
use idf::exchange::Format;
use idf::part::{Share, Tiles};

use crate::command::Arguments;
use crate::options::{Options, Rate, Sampling};

/// Which part of a picture to render.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct PartArguments {
    /// Render a window of the picture alone: its first column and row from the top left, columns and rows. icopy puts windows
    /// together
    #[arg(long, value_name = "X,Y,W,H", value_parser = window, allow_hyphen_values = true)]
    pub(crate) window: Option<Window>,
    /// Render part I of N, from 0: every N-th tile of the picture. It is an IDF image with a checksum; icopy puts
    /// all N together
    #[arg(long, value_name = "I/N", conflicts_with = "window")]
    pub(crate) part: Option<Numbered>,
    /// Side of the tiles of parts in pixels [default: 16 or less, and with --filter up to 256, such that
    /// each part has many]
    #[arg(long, value_name = "PIXELS",
          value_parser = clap::value_parser!(u32).range(4..=i64::from(Tiles::MOST_SIDE)))]
    pub(crate) tile: Option<u32>,
    /// The picture that parts will make, if it is no IDF image: decides what they hold
    #[arg(long, value_name = "FILE")]
    pub(crate) part_of: Option<PathBuf>,
}

/// A part by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Numbered {
    pub(crate) number: u32,
    pub(crate) count: u32,
}

impl FromStr for Numbered {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').map(|(i, n)| (i.parse::<u32>(), n.parse::<u32>()));
        let Some((Ok(number), Ok(count))) = numbers else {
            return Err("expected number and count of the parts, as 0/8".into());
        };
        let most = Tiles::MOST_PARTS;
        if !(1..=most).contains(&count) {
            return Err(format!("expected a count from 1 to {most}"));
        }
        if number >= count {
            return Err(format!("parts are numbered from 0 to {}", count - 1));
        }
        Ok(Self { number, count })
    }
}

fn window(text: &str) -> Result<Window, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|word| word.parse().ok()).collect();
    let places = numbers.and_then(|numbers| <[u32; 4]>::try_from(numbers).ok());
    let expected = || "expected column, row, columns and rows, as 0,128,512,64".to_owned();
    let [column, row, columns, rows] = places.ok_or_else(expected)?;
    let place = |side: u32| i32::try_from(side).map_err(|_| expected());
    if columns == 0 || rows == 0 {
        return Err("a window has at least one column and row".into());
    }
    Ok(Window { column: place(column)?, row: place(row)?, columns, rows })
}

/// Side of the tiles of parts where nothing else is asked for.
pub(crate) fn fitting_side(count: u32, options: &Options) -> u32 {
    let canvas = [options.columns, options.rows];
    Tiles::fitting_side(count, canvas, options.filter.reach())
}

impl PartArguments {
    /// The format of the whole picture, where a part is written to `output` in the format `written`.
    pub(crate) fn format(
        &self,
        output: &Path,
        written: Option<Format>,
    ) -> Result<Option<Format>, UsageError> {
        let is_idf = matches!(written, Some(Format::Idf) | None);
        if self.part.is_some() && !is_idf {
            return Err(UsageError(format!(
                "--part: a part is an IDF image, found `{0}`; give a name without ending, and --part-of {0}",
                output.display()
            )));
        }
        let Some(whole) = &self.part_of else { return Ok(written) };
        if self.part.is_none() && self.window.is_none() || !is_idf {
            let message = "--part-of is for --part and --window that are written as IDF";
            return Err(UsageError(message.into()));
        }
        check_output(whole, &[])?;
        Ok(Format::of(whole))
    }

    /// Refuses what would be of no effect.
    pub(crate) fn check(&self) -> Result<(), UsageError> {
        if self.tile.is_some() && self.part.is_none() {
            return Err(UsageError("--tile is for --part".into()));
        }
        Ok(())
    }

    /// Which pixels are asked for, if not all.
    pub(crate) fn share(
        &self,
        options: &Options,
        sampling: Option<Sampling>,
        audit: bool,
    ) -> Result<Option<Share>, UsageError> {
        let canvas = [options.columns, options.rows];
        let (share, option) = match (self.window, self.part) {
            (Some(window), _) => {
                let inside = |from: i32, length: u32, all: u32| {
                    u64::from(from.unsigned_abs()) + u64::from(length) <= u64::from(all)
                };
                if !(inside(window.column, window.columns, canvas[0])
                    && inside(window.row, window.rows, canvas[1]))
                {
                    return Err(UsageError(format!(
                        "--window {}: expected a window in a picture of {}x{}",
                        [
                            window.column.unsigned_abs(),
                            window.row.unsigned_abs(),
                            window.columns,
                            window.rows
                        ]
                        .map(|n| n.to_string())
                        .join(","),
                        canvas[0],
                        canvas[1]
                    )));
                }
                (Share::Window(window), "--window")
            }
            (None, Some(Numbered { number, count })) => {
                let side = self.tile.unwrap_or_else(|| fitting_side(count, options));
                (Share::Tiles(Tiles { number, count, side }), "--part")
            }
            (None, None) => return Ok(None),
        };
        let refused = match sampling {
            Some(Sampling::Stochastic(Rate::Error(_))) => Some("--error"),
            Some(Sampling::Stochastic(Rate::Time(_))) => Some("--seconds"),
            _ if audit => Some("--audit"),
            _ if options.certify => Some("--certify"),
            _ => None,
        };
        match refused {
            Some(refused) => Err(UsageError(format!(
                "{option} and {refused}: it looks at the whole picture; leave it out"
            ))),
            None => Ok(Some(share)),
        }
    }
}

impl Arguments {
    /// The arguments of one part of the picture that is asked for: of a scene that is compiled already, written as
    /// `output`.
    #[must_use]
    pub fn of_part(&self, scene: &Path, tiles: Tiles, output: &Path) -> Self {
        let mut arguments = self.clone();
        let whole = self.output.clone();
        arguments.part = PartArguments {
            window: None,
            part: Some(Numbered { number: tiles.number, count: tiles.count }),
            tile: Some(tiles.side),
            // A name without ending is IDF, as the part is.
            part_of: whole.filter(|name| Format::of(name) != Some(Format::Idf)),
        };
        arguments.scene = scene.to_owned();
        arguments.output = Some(output.to_owned());
        arguments.definitions.clear();
        arguments.frames = None;
        arguments.threads = idf::command::Threads::of(self.worker_threads());
        arguments
    }

    /// Threads of each process that renders parts: one where nothing else is asked for.
    #[must_use]
    pub fn worker_threads(&self) -> usize {
        self.threads.count().map_or(1, std::num::NonZeroUsize::get)
    }

    /// Side of tiles in pixels, if it was asked for.
    #[must_use]
    pub fn tile(&self) -> Option<u32> {
        self.part.tile
    }

    /// Refuses what cannot be done in parts.
    ///
    /// # Errors
    ///
    /// For options that ask for a part, and for those that need the whole picture at once.
    pub fn check_in_parts(&self) -> Result<(), UsageError> {
        let PartArguments { window, part, part_of, .. } = &self.part;
        for (is_asked, option) in [
            (window.is_some(), "--window"),
            (part.is_some(), "--part"),
            (part_of.is_some(), "--part-of"),
            (self.stats.is_some(), "--stats"),
            (self.watch.is_wanted(), "--watch"),
            (self.sampling.audit, "--audit"),
            (self.sampling.certify, "--certify"),
        ] {
            if is_asked {
                return Err(UsageError(format!(
                    "{option}: a farm renders whole pictures, and each worker knows a part alone; leave it out"
                )));
            }
        }
        let progressive = match self.sampling.sampling()? {
            Some(Sampling::Stochastic(Rate::Error(_))) => Some("--error"),
            Some(Sampling::Stochastic(Rate::Time(_))) => Some("--seconds"),
            _ => None,
        };
        match progressive {
            Some(option) => Err(UsageError(format!(
                "{option}: samples are given to pixels by what is seen in the whole picture; give --samples"
            ))),
            None => Ok(()),
        }
    }
}
