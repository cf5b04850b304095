//! Arguments of `ishow`, and the order of reading, asking and drawing.

use std::error::Error;
use std::fmt;
use std::io::{self, Write};
use std::path::PathBuf;

use clap::{Parser, ValueEnum};
use idf::command::{Color, Talk, Threads, open};
use idf::{Ask, ReadOptions};

use crate::answers::Answers;
use crate::signals::Signals;
use crate::terminal::Terminal;
use crate::{Colors, Drawing, Protocol, Screen, drawing};

/// Shows an image in the terminal
///
/// The terminal is asked what it has: kitty graphics, else sixel, else half blocks in as many
/// colours as COLORTERM and TERM promise. It is not asked where keys were typed ahead, which would be
/// lost. The picture is fitted to the window, never enlarged
/// unless --size is given, over --matte, or the image's background, or the terminal's.
///
/// Standard output has to be a terminal, unless both a protocol and --size say what to write.
#[derive(Parser, Debug)]
#[command(
    name = "ishow",
    version,
    after_help = "Example:\n  ishow wine.idf --matte '#ffffff'\n  ishow photo.png --sixel --size 80x24 > photo.six"
)]
pub struct Arguments {
    /// Image to show; `-` is standard input
    #[arg(value_name = "IMAGE")]
    image: PathBuf,
    /// Use the kitty graphics protocol
    #[arg(long, group = "protocol")]
    kitty: bool,
    /// Use sixel
    #[arg(long, group = "protocol")]
    sixel: bool,
    /// Use half blocks
    #[arg(long, group = "protocol")]
    blocks: bool,
    /// Colours of half blocks; none is text without escape sequences [default: by COLORTERM and TERM]
    #[arg(long, value_name = "COLOURS")]
    colors: Option<ColorsWord>,
    /// Fill as many columns and rows of characters [default: fit the window]
    #[arg(long, value_name = "COLUMNSxROWS", value_parser = cells, allow_hyphen_values = true)]
    size: Option<[u32; 2]>,
    /// Put a colour behind: #rrggbb, #rgb or R,G,B
    #[arg(long, value_name = "COLOUR")]
    matte: Option<Color>,
    /// Follow file names that lead out of the folder of the image
    #[arg(long)]
    outside: bool,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    talk: Talk,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ColorsWord {
    True,
    #[value(name = "256")]
    Indexed256,
    #[value(name = "16")]
    Indexed16,
    None,
}

/// Standard output is no terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct NotATerminal;

/// Does what `ishow` was asked for.
///
/// # Errors
///
/// If standard output is no terminal, or the image cannot be read or drawn.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    arguments.threads.run(|| work(arguments))?.map_err(|error| error as Box<dyn Error>)
}

fn work(arguments: &Arguments) -> Result<(), Box<dyn Error + Send + Sync>> {
    let Arguments { image: name, size, talk, .. } = arguments;
    let wanted = protocol(arguments);
    let terminal = Terminal::of_output()?;
    if terminal.is_none() && (wanted.is_none() || size.is_none()) {
        return Err(NotATerminal.into());
    }
    let read_options =
        ReadOptions { ask: Ask::Picture, outside: arguments.outside, ..ReadOptions::default() };
    let image = open(name, &read_options)?;
    let signals = Signals::held()?;
    let answers = match &terminal {
        Some(terminal) if !is_dumb() => terminal.ask(&signals)?,
        _ => Answers::default(),
    };
    signals.pass_on()?;
    if answers.were_keys_typed && wanted.is_none() {
        talk.warn(
            "keys were typed before the terminal could be asked what it shows, and are kept; \
             --kitty or --sixel says it",
        );
    }
    let found = if answers.kitty {
        Protocol::Kitty
    } else if answers.sixel {
        Protocol::Sixel
    } else {
        Protocol::Blocks
    };
    let protocol = wanted.unwrap_or(found);
    let screen = screen(arguments, terminal.as_ref(), &answers);
    let ([columns, rows], [width, height]) = (screen.cells, screen.cell);
    talk.note(format_args!(
        "{protocol}, {columns} x {rows} characters of {width} x {height} pixels"
    ));
    let matte = arguments.matte.map(|Color(color)| color);
    let behind = matte.or(image.properties.background).or(answers.background).unwrap_or_default();
    write(&drawing(&image, behind, &screen, protocol)?, &signals)?;
    Ok(signals.pass_on()?)
}

fn protocol(arguments: &Arguments) -> Option<Protocol> {
    let flags = [
        (arguments.kitty, Protocol::Kitty),
        (arguments.sixel, Protocol::Sixel),
        (arguments.blocks, Protocol::Blocks),
    ];
    flags.into_iter().find(|(is_given, _)| *is_given).map(|(_, protocol)| protocol)
}

/// The terminals that show questions instead of answering them.
fn is_dumb() -> bool {
    std::env::var_os("TERM").is_none_or(|term| term.is_empty() || term == "dumb" || term == "linux")
}

fn screen(arguments: &Arguments, terminal: Option<&Terminal>, answers: &Answers) -> Screen {
    let (window, pixels) = terminal.map_or(([80, 24], None), Terminal::size);
    // The last row is for the prompt.
    let cells = arguments.size.unwrap_or([window[0], (window[1] - 1).max(1)]);
    let of_text = answers.text.or(pixels);
    let of_text = of_text.map(|text| [text[0] / window[0], text[1] / window[1]]);
    let cell = answers.cell.or(of_text).filter(|cell| cell.iter().all(|&length| length > 0));
    Screen {
        cells,
        cell: cell.unwrap_or(Screen::USUAL_CELL),
        fill: arguments.size.is_some(),
        colors: arguments.colors.map_or_else(promised_colors, |word| match word {
            ColorsWord::True => Colors::True,
            ColorsWord::Indexed256 => Colors::Indexed256,
            ColorsWord::Indexed16 => Colors::Indexed16,
            ColorsWord::None => Colors::None,
        }),
        registers: answers.registers.unwrap_or(Screen::USUAL_REGISTERS),
    }
}

/// Colours by the environment.
fn promised_colors() -> Colors {
    let variable = |name| std::env::var(name).unwrap_or_default();
    let (color, term) = (variable("COLORTERM"), variable("TERM"));
    if term != "dumb" && (color == "truecolor" || color == "24bit" || term.ends_with("-direct")) {
        Colors::True
    } else if term == "dumb" {
        Colors::None
    } else if term.contains("256color") {
        Colors::Indexed256
    } else {
        Colors::Indexed16
    }
}

/// Draws, and stops between two pieces where a signal came.
fn write(drawing: &Drawing, signals: &Signals) -> io::Result<()> {
    let mut output = io::stdout().lock();
    for piece in &drawing.pieces {
        if signals.came() {
            output.write_all(drawing.closing.as_bytes())?;
            break;
        }
        output.write_all(piece.as_bytes())?;
    }
    output.flush()
}

fn cells(text: &str) -> Result<[u32; 2], String> {
    let numbers = text.split_once('x').map(|(a, b)| [a.parse::<u16>(), b.parse::<u16>()]);
    match numbers {
        Some([Ok(columns), Ok(rows)]) if columns > 0 && rows > 0 => {
            Ok([columns, rows].map(u32::from))
        }
        _ => Err("expected two whole numbers from 1 to 65535, as 80x24".into()),
    }
}

impl fmt::Display for NotATerminal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "standard output is not a terminal; to write what one would get, say a protocol \
             and --size, as --sixel --size 80x24",
        )
    }
}

impl Error for NotATerminal {}
