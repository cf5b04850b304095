//! Sixel: pictures as text for terminals, six rows at a time (DEC, "VT330/VT340 Programmer
//! Reference Manual", volume 2, chapter 14).

use std::fmt::Write as _;

/// Rows of a band.
const BAND: usize = 6;
/// The character for six empty rows; bit 0 is the top one.
const EMPTY: u8 = b'?';
/// Runs up to this long are shorter as they are than counted.
const SHORT: usize = 3;

/// The text that draws a picture of `indices`, row by row from the top, in `colors` (sRGB bytes,
/// straight, with alpha). Pixels of an alpha below 128 are left as they are on the screen.
///
/// Colours are in percent, as the format has them, so each is off by up to 1.3 display steps.
///
/// # Panics
///
/// If `columns` is 0, or an index has no colour.
pub fn encode(columns: usize, indices: &[u8], colors: &[[u8; 4]]) -> String {
    let rows = indices.len() / columns;
    let used = |color: usize| indices.iter().any(|&index| usize::from(index) == color);
    let used: Vec<bool> = (0..colors.len()).map(used).collect();
    let is_clear = |color: usize| colors[color][3] < 128;
    let clear = (0..colors.len()).any(|color| used[color] && is_clear(color));
    // The second parameter says whether places without a colour keep what is there.
    let keep = u8::from(clear);
    let mut text = format!("\x1bP0;{keep};0q\"1;1;{columns};{rows}");
    for (register, &[red, green, blue, _]) in colors.iter().enumerate() {
        if used[register] && !is_clear(register) {
            let [r, g, b] = [red, green, blue].map(percent);
            write_text(&mut text, format_args!("#{register};2;{r};{g};{b}"));
        }
    }
    let mut bits = vec![[0_u8; 256]; columns];
    for (band, indices) in indices.chunks(BAND * columns).enumerate() {
        if band > 0 {
            text.push('-');
        }
        bits.fill([0; 256]);
        let mut present = [false; 256];
        for (row, indices) in indices.chunks(columns).enumerate() {
            for (bits, &index) in bits.iter_mut().zip(indices) {
                bits[usize::from(index)] |= 1 << row;
                present[usize::from(index)] = true;
            }
        }
        let drawn = (0..colors.len()).filter(|&color| present[color] && !is_clear(color));
        for (position, color) in drawn.enumerate() {
            text.push_str(if position > 0 { "$" } else { "" });
            write_text(&mut text, format_args!("#{color}"));
            write_runs(&mut text, bits.iter().map(|bits| EMPTY + bits[color]));
        }
    }
    text.push_str("\x1b\\");
    text
}

/// Writes one band of one colour, without the empty places at its end.
fn write_runs(text: &mut String, mut sixels: impl Iterator<Item = u8>) {
    let Some(mut sixel) = sixels.next() else { return };
    let mut length = 1;
    for next in sixels {
        if next != sixel {
            write_run(text, sixel, length);
            (sixel, length) = (next, 0);
        }
        length += 1;
    }
    if sixel != EMPTY {
        write_run(text, sixel, length);
    }
}

fn write_run(text: &mut String, sixel: u8, length: usize) {
    let sixel = char::from(sixel);
    if length > SHORT {
        write_text(text, format_args!("!{length}{sixel}"));
    } else {
        text.extend(std::iter::repeat_n(sixel, length));
    }
}

fn write_text(text: &mut String, piece: std::fmt::Arguments<'_>) {
    text.write_fmt(piece).expect("a string takes any text");
}

/// Nearest whole percent of a byte.
fn percent(byte: u8) -> u16 {
    (u16::from(byte) * 100 + 127) / 255
}

#[expect(clippy::cast_possible_truncation, reason = "small numbers of the tests")]
#[cfg(test)]
mod tests {
    use super::*;

    /// What a terminal shows: columns, and for each pixel the percents of its colour, if any.
    /// Reads the format by its manual, apart from how the text above is written.
    fn shown(text: &str) -> (usize, Vec<Option<[u16; 3]>>) {
        let body = text.strip_prefix("\x1bP").unwrap().strip_suffix("\x1b\\").unwrap();
        let (parameters, mut rest) = body.split_once('q').unwrap();
        let keeps = parameters.split(';').nth(1) == Some("1");
        let mut registers = vec![[0; 3]; 256];
        let (mut size, mut at, mut color) = ([0, 0], [0, 0], 0);
        let mut pixels = Vec::new();
        while let Some(character) = rest.chars().next() {
            rest = &rest[1..];
            let end = rest.find(|c: char| !c.is_ascii_digit() && c != ';').unwrap_or(rest.len());
            let numbers: Vec<u16> = match character {
                '"' | '#' | '!' => rest[..end].split(';').map(|n| n.parse().unwrap()).collect(),
                _ => Vec::new(),
            };
            if !numbers.is_empty() {
                rest = &rest[end..];
            }
            let mut count = 1;
            let mut sixel = character;
            match (character, &numbers[..]) {
                ('"', &[1, 1, columns, rows]) => {
                    size = [usize::from(columns), usize::from(rows)];
                    let behind = if keeps { None } else { Some([0; 3]) };
                    pixels = vec![behind; size[0] * size[1]];
                    continue;
                }
                ('#', &[register, 2, r, g, b]) => {
                    assert!(r <= 100 && g <= 100 && b <= 100, "{numbers:?}");
                    registers[usize::from(register)] = [r, g, b];
                    continue;
                }
                ('#', &[register]) => {
                    color = usize::from(register);
                    continue;
                }
                ('$', []) => {
                    at[0] = 0;
                    continue;
                }
                ('-', []) => {
                    at = [0, at[1] + 6];
                    continue;
                }
                ('!', &[length]) => {
                    count = usize::from(length);
                    sixel = rest.chars().next().unwrap();
                    rest = &rest[1..];
                }
                ('?'..='~', []) => {}
                other => panic!("{other:?}"),
            }
            let bits = sixel as u8 - b'?';
            for column in at[0]..at[0] + count {
                for row in (0..6).filter(|row| bits >> row & 1 == 1) {
                    assert!(column < size[0] && at[1] + row < size[1], "inside the picture");
                    pixels[(at[1] + row) * size[0] + column] = Some(registers[color]);
                }
            }
            at[0] += count;
        }
        (size[0], pixels)
    }

    #[test]
    fn a_small_picture_is_these_characters() {
        // Two columns, two rows: red and blue, then blue twice.
        let colors = [[255, 0, 0, 255], [0, 0, 128, 255]];
        let text = encode(2, &[0, 1, 1, 1], &colors);
        // Red: the left pixel of the top row, bit 0, `?` + 1; blue: the left one of row 1,
        // bit 1, `?` + 2, and both right ones, `?` + 3.
        let expected = "\x1bP0;0;0q\"1;1;2;2#0;2;100;0;0#1;2;0;0;50#0@$#1AB\x1b\\";
        assert_eq!(text, expected);
    }

    #[test]
    fn long_runs_are_counted() {
        let text = encode(9, &[0, 0, 0, 1, 1, 1, 1, 1, 0], &[[255; 4], [0, 0, 0, 255]]);
        assert!(text.ends_with("#0@@@!5?@$#1???!5@\x1b\\"), "{text:?}");
    }

    #[test]
    fn pictures_come_back() {
        let colors: Vec<[u8; 4]> =
            (0..=255_u8).map(|i| [i, i.wrapping_mul(7), 255 - i, 255]).collect();
        let mut state = 1_u32;
        for (columns, rows) in [(1, 1), (1, 13), (40, 6), (33, 25)] {
            let random = |_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                // Runs of some length, and all colours.
                if state >> 30 == 0 { (state >> 16) as u8 } else { (state >> 26) as u8 / 32 }
            };
            let indices: Vec<u8> = (0..columns * rows).map(random).collect();
            let (found, pixels) = shown(&encode(columns, &indices, &colors));
            assert_eq!(found, columns);
            assert_eq!(pixels.len(), indices.len());
            for (pixel, &index) in pixels.iter().zip(&indices) {
                let [r, g, b, _] = colors[usize::from(index)];
                let percents = pixel.unwrap();
                for (percent, byte) in percents.into_iter().zip([r, g, b]) {
                    let off = f64::from(percent) * 2.55 - f64::from(byte);
                    assert!(off.abs() <= 1.276, "{percent} % for {byte}");
                }
            }
        }
    }

    #[test]
    fn clear_pixels_are_left_alone() {
        let colors = [[1, 2, 3, 0], [255, 255, 255, 128], [9, 9, 9, 127]];
        let text = encode(3, &[0, 1, 2], &colors);
        assert_eq!(shown(&text).1, [None, Some([100; 3]), None]);
        assert!(!text.contains("#0") && !text.contains("#2"), "{text:?}");
    }
}
