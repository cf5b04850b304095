//! Half blocks: each character shows two pixels, one above the other.

use std::fmt::Write as _;

use ilut::{Metric, Pixels, Table};

use iencode::dither;

use crate::Drawing;

/// Colours that characters can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colors {
    /// Red, green and blue of a byte each.
    True,
    /// A cube of six levels, and greys.
    Indexed256,
    /// The eight colours of ECMA-48, dark and bright.
    Indexed16,
    /// None: characters of more and less ink, and no escape sequence.
    None,
}

/// Characters from dark to bright, on the dark.
const SHADES: [char; 5] = [' ', '░', '▒', '▓', '█'];

/// What a terminal shows for the 16 colours, unless its user chose others: those of xterm.
const COLORS_16: [[u8; 3]; 16] = [
    [0, 0, 0],
    [205, 0, 0],
    [0, 205, 0],
    [205, 205, 0],
    [0, 0, 238],
    [205, 0, 205],
    [0, 205, 205],
    [229, 229, 229],
    [127, 127, 127],
    [255, 0, 0],
    [0, 255, 0],
    [255, 255, 0],
    [92, 92, 255],
    [255, 0, 255],
    [0, 255, 255],
    [255, 255, 255],
];

/// Levels of the cube of 256 colours.
const LEVELS: [u8; 6] = [0, 95, 135, 175, 215, 255];

/// The first colour of the cube. Those before it are the 16 that users choose.
const CUBE: usize = 16;

/// Draws an opaque picture, a line of characters for two rows; in a table of colours, dithered to
/// the eye.
pub(crate) fn drawing(pixels: &Pixels, colors: Colors) -> Drawing {
    let (columns, places) = (pixels.columns() as usize, pixels.colors().len());
    if colors == Colors::None {
        let pieces = pixels.colors().chunks(2 * columns).map(|rows| shades(rows, columns));
        return Drawing { pieces: pieces.collect(), closing: "\n" };
    }
    let inks: Vec<Ink> = match colors {
        Colors::True => pixels.colors().iter().map(|&[r, g, b, _]| Ink::True([r, g, b])).collect(),
        Colors::Indexed256 => indices(pixels, cube_and_greys())
            .map(|index| Ink::Of256(CUBE + usize::from(index)))
            .collect(),
        Colors::Indexed16 => {
            indices(pixels, COLORS_16.to_vec()).map(|index| Ink::Of16(index.into())).collect()
        }
        Colors::None => Vec::new(),
    };
    let line = |top: usize| {
        let bottom = (top + columns < places).then(|| &inks[top + columns..][..columns]);
        line(&inks[top..][..columns], bottom)
    };
    let pieces = (0..places).step_by(2 * columns).map(line).collect();
    Drawing { pieces, closing: "\x1b[0m\n" }
}

/// A line of characters by the luma (Rec. 709) of one or two rows.
fn shades(rows: &[[u8; 4]], columns: usize) -> String {
    let luma = |[r, g, b, _]: [u8; 4]| {
        (2126 * u32::from(r) + 7152 * u32::from(g) + 722 * u32::from(b)) / 10_000
    };
    let shade = |column: usize| {
        let below = rows.get(columns + column).unwrap_or(&rows[column]);
        let mean = u32::midpoint(luma(rows[column]), luma(*below));
        SHADES[(mean as usize * SHADES.len()) >> 8]
    };
    let line = (0..columns).map(shade).collect::<String>();
    // What is black at the end of a line is not seen.
    format!("{}\n", line.trim_end())
}

/// The colours of 256 after the first 16.
fn cube_and_greys() -> Vec<[u8; 3]> {
    let cube = LEVELS.iter().flat_map(|&red| {
        LEVELS.iter().flat_map(move |&green| LEVELS.iter().map(move |&blue| [red, green, blue]))
    });
    cube.chain((0..24).map(|step| [8 + 10 * step; 3])).collect()
}

fn indices(pixels: &Pixels, colors: Vec<[u8; 3]>) -> impl Iterator<Item = u8> {
    let table = Table::new(colors.into_iter().map(|[r, g, b]| [r, g, b, u8::MAX]).collect());
    let table = table.expect("16 or 240 colours");
    let dither = &dither::FLOYD_STEINBERG;
    dither.indices(pixels, &table, Metric::Oklab, dither.strength).into_iter()
}

/// A colour of a character.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ink {
    True([u8; 3]),
    Of256(usize),
    Of16(usize),
}

impl Ink {
    /// Parameters of the sequence that selects it (ECMA-48, 8.3.117, and ISO 8613-6).
    fn parameters(self, is_behind: bool) -> String {
        let shift = if is_behind { 10 } else { 0 };
        match self {
            Self::True([r, g, b]) => format!("{};2;{r};{g};{b}", 38 + shift),
            Self::Of256(index) => format!("{};5;{index}", 38 + shift),
            Self::Of16(index) if index < 8 => (30 + shift + index).to_string(),
            Self::Of16(index) => (90 + shift + index - 8).to_string(),
        }
    }
}

/// A line of characters; where there is no row below, the lower halves stay as they are.
fn line(top: &[Ink], bottom: Option<&[Ink]>) -> String {
    let mut text = String::new();
    let (mut front, mut behind) = (None, None);
    for (column, &upper) in top.iter().enumerate() {
        let lower = bottom.map(|row| row[column]);
        let mut parameters = Vec::new();
        // Where both halves agree the background alone will do.
        let is_one = lower == Some(upper);
        if !is_one && front != Some(upper) {
            front = Some(upper);
            parameters.push(upper.parameters(false));
        }
        if let Some(lower) = lower.filter(|_| behind != lower) {
            behind = Some(lower);
            parameters.push(lower.parameters(true));
        }
        if !parameters.is_empty() {
            write!(text, "\x1b[{}m", parameters.join(";")).expect("a string takes any text");
        }
        text.push(if is_one { ' ' } else { '▀' });
    }
    text.push_str("\x1b[0m\n");
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: [u8; 4] = [255, 0, 0, 255];
    const BLUE: [u8; 4] = [0, 0, 255, 255];

    fn text(columns: u32, colors: &[[u8; 4]], of: Colors) -> String {
        let rows = u32::try_from(colors.len()).unwrap() / columns;
        drawing(&Pixels::new(columns, rows, colors.to_vec()).unwrap(), of).pieces.concat()
    }

    #[test]
    fn a_character_is_two_pixels() {
        let four = [RED, RED, BLUE, RED];
        let expected = "\x1b[38;2;255;0;0;48;2;0;0;255m▀\x1b[48;2;255;0;0m \x1b[0m\n";
        assert_eq!(text(2, &four, Colors::True), expected);
    }

    #[test]
    fn the_last_row_may_be_alone() {
        let expected = "\x1b[48;2;255;0;0m \x1b[0m\n\x1b[38;2;0;0;255m▀\x1b[0m\n";
        assert_eq!(text(1, &[RED, RED, BLUE], Colors::True), expected);
    }

    #[test]
    fn colors_of_a_table_are_its_own() {
        // 196 is 16 + 36 · 5; the bright red of the 16 is number 9, and black number 0.
        let black = [0, 0, 0, 255];
        assert_eq!(text(1, &[RED, black], Colors::Indexed256), "\x1b[38;5;196;48;5;16m▀\x1b[0m\n");
        assert_eq!(text(1, &[RED, black], Colors::Indexed16), "\x1b[91;40m▀\x1b[0m\n");
        assert_eq!(text(1, &[black, RED], Colors::Indexed16), "\x1b[30;101m▀\x1b[0m\n");
    }

    #[test]
    fn without_colors_there_are_shades_and_no_escapes() {
        let [black, grey, white] = [0, 127, 255].map(|value| [value, value, value, 255]);
        let rows = [black, black, white, grey, black, white, white, grey, white, black];
        assert_eq!(text(5, &rows, Colors::None), "▒▒▓▓\n");
        assert_eq!(text(2, &[white, black, white, black, grey, black], Colors::None), "█\n▒\n");
    }

    #[test]
    fn greys_follow_the_cube() {
        let colors = cube_and_greys();
        assert_eq!(colors.len(), 240);
        assert_eq!(colors[231 - CUBE], [255; 3]);
        assert_eq!(colors[232 - CUBE], [8; 3]);
        assert_eq!(colors[255 - CUBE], [238; 3]);
    }
}
