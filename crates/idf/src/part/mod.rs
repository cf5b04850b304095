//! Parts of one picture, made apart and put together again.
//!
//! A part is an image with one more line in its description, which says what it is a part of:
//!
//! ```text
//! part 3 of 8 tiles 32 canvas 640 480 picture 9f…e1 sum 02…7c
//! part window canvas 640 480 picture 9f…e1 sum 5a…90
//! ```
//!
//! The first holds every eighth tile of 32 × 32 pixels of a picture of 640 × 480, as [`Tiles`] says;
//! the image has the size of the whole picture, and is 0 where other parts are. The second holds the
//! window that the image has. `picture` is a number for all that the picture is made of, so that
//! parts of different pictures are not mixed, and `sum` a checksum over the rest of the line, what
//! the image says about its light, and its samples (both 128 bits of XXH3).
//!
//! [`Assembly`] puts parts together, and proves that they cover the picture, each pixel once.

mod assembly;
mod canvas;
mod error;

use std::fmt;
use std::path::Path;

use xxhash_rust::xxh3::Xxh3;

use crate::error::ReadError;
use crate::image::{Image, Window};
use crate::plane::Kind;
use crate::read::read_description;
use crate::samples::Samples;

pub use assembly::Assembly;
pub use canvas::Canvas;
pub use error::PartError;

/// The key of the line in a description.
const KEY: &str = "part";

/// What an image is a part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Which pixels of the picture it holds.
    pub share: Share,
    /// Columns and rows of the whole picture.
    pub canvas: [u32; 2],
    /// Stands for all that the picture is made of: other scenes and options have other numbers.
    pub picture: u128,
}

/// Which pixels of a picture a part holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Share {
    /// A rectangle.
    Window(Window),
    /// Tiles from all over the picture.
    Tiles(Tiles),
}

/// Every so-manieth tile of a picture: in each row of tiles one after `count - 1` of other parts, and
/// from row to row moved such that those of a part are spread evenly.
///
/// ```
/// use idf::part::Tiles;
///
/// let windows = Tiles { number: 1, count: 3, side: 8 }.windows([20, 16]);
/// // Tiles of parts 0 1 2 stand above those of 1 2 0.
/// let corners: Vec<_> = windows.map(|w| (w.column, w.row)).collect();
/// assert_eq!(corners, [(8, 0), (0, 8)]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tiles {
    /// Which part, from 0.
    pub number: u32,
    /// How many parts there are, from 1 to [`Tiles::MOST_PARTS`].
    pub count: u32,
    /// Side of a tile in pixels, from 1 to [`Tiles::MOST_SIDE`].
    pub side: u32,
}

impl Tiles {
    /// The largest number of parts.
    pub const MOST_PARTS: u32 = 1 << 20;
    /// The largest side of a tile.
    pub const MOST_SIDE: u32 = 1 << 16;

    /// Side of the tiles of parts where nothing else is asked for. Small tiles share the work out evenly: 16 pixels, or 8 where
    /// 16 would leave a part less than 16 tiles. Where tiles need so many pixels around them as `apron`, more than none, the
    /// largest of 256, 128, 64, 32, 16 and 8 that leaves each part 16.
    pub fn fitting_side(count: u32, [columns, rows]: [u32; 2], apron: u32) -> u32 {
        let tiles = |side: u32| u64::from(columns.div_ceil(side)) * u64::from(rows.div_ceil(side));
        let fits = |side: &u32| tiles(*side) >= 16 * u64::from(count);
        let sides: &[u32] = if apron == 0 { &[16, 8] } else { &[256, 128, 64, 32, 16, 8] };
        sides.iter().copied().find(fits).unwrap_or(8)
    }

    /// The tiles of this part in a picture of so many columns and rows, row by row; those at the right
    /// and lower rim may be smaller. None if there are more parts than tiles, or hardly fewer.
    ///
    /// # Panics
    ///
    /// While it goes on, if a row or column is beyond 2³¹: no image is so large.
    pub fn windows(&self, [columns, rows]: [u32; 2]) -> impl Iterator<Item = Window> + use<> {
        let Self { number, count, side } = *self;
        let (count, side) = (count.max(1), side.max(1));
        let step = u64::from(stride(count));
        let window = move |across: u32, down: u32| {
            let (column, row) = (across * side, down * side);
            let place = |corner: u32| i32::try_from(corner).expect("images are less than 2³¹ wide");
            Window {
                column: place(column),
                row: place(row),
                columns: side.min(columns - column),
                rows: side.min(rows - row),
            }
        };
        (0..rows.div_ceil(side)).flat_map(move |down| {
            // Number (across + step · down) mod count is this part's.
            let shift = step * u64::from(down) % u64::from(count);
            let first = (u64::from(number) + u64::from(count) - shift) % u64::from(count);
            let first = u32::try_from(first).expect("less than the count");
            (first..columns.div_ceil(side))
                .step_by(count as usize)
                .map(move |across| window(across, down))
        })
    }
}

/// How far the tiles of a part move from one row of tiles to the next: the number next to 0.618 `count` that
/// has no divisor in common with it, so that tiles of one part are nowhere near each other.
fn stride(count: u32) -> u32 {
    let aim = u32::try_from(u64::from(count) * 618 / 1000).expect("less than the count");
    let fits = |step: &u32| *step >= 1 && *step <= count && divisor(*step, count) == 1;
    (0..=count).flat_map(|off| [aim.saturating_sub(off), aim + off]).find(fits).unwrap_or(1)
}

/// The greatest common divisor.
fn divisor(a: u32, b: u32) -> u32 {
    let (mut a, mut b) = (a, b);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

impl Share {
    /// The rectangles of the picture that it is made of.
    pub fn windows(&self, canvas: [u32; 2]) -> impl Iterator<Item = Window> + use<> {
        let (window, tiles) = match self {
            Self::Window(window) => (Some(*window), None),
            Self::Tiles(tiles) => (None, Some(*tiles)),
        };
        let tiles = tiles.into_iter().flat_map(move |tiles| tiles.windows(canvas));
        window.into_iter().chain(tiles)
    }

    /// Size and place of the image that holds it.
    pub fn frame(&self, [columns, rows]: [u32; 2]) -> Window {
        match self {
            Self::Window(window) => *window,
            Self::Tiles(_) => Window { column: 0, row: 0, columns, rows },
        }
    }
}

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Window(Window { column, row, columns, rows }) => {
                write!(f, "window {column},{row},{columns},{rows}")
            }
            Self::Tiles(Tiles { number, count, .. }) => write!(f, "part {number} of {count}"),
        }
    }
}

impl Part {
    /// Writes into `image` what it is a part of, with the checksum, in place of what it said before.
    pub fn mark(&self, image: &mut Image) {
        unmark(image);
        let line = format!("{} sum {:032x}", self.line(), self.sum(image));
        image.properties.unknown.push(line);
    }

    /// What `image` says that it is a part of, if anything; its checksum is found to be right.
    ///
    /// # Errors
    ///
    /// If the line is not as it should be, or the image is not what was written.
    pub fn of(image: &Image) -> Result<Option<Self>, PartError> {
        let Some(line) = image.properties.unknown.iter().find(|line| is_part(line)) else {
            return Ok(None);
        };
        let (part, sum) = parsed(line, image.window())?;
        if part.share.frame(part.canvas) != image.window() || part.sum(image) != sum {
            return Err(PartError::Sum);
        }
        Ok(Some(part))
    }

    /// What the image at `path` says that it is a part of, if anything, by its description alone.
    ///
    /// # Errors
    ///
    /// If the description cannot be read, or its line is not as it should be.
    pub fn at(path: &Path) -> Result<Option<Self>, ReadError> {
        let description = read_description(path)?;
        let Some(line) = description.unknown.iter().find(|line| is_part(line)) else {
            return Ok(None);
        };
        let ([column, row], [columns, rows]) = (description.origin, description.size);
        match parsed(line, Window { column, row, columns, rows }) {
            Ok((part, _)) => Ok(Some(part)),
            Err(error) => Err(ReadError::Part { path: path.into(), error }),
        }
    }

    /// The line without the checksum.
    fn line(&self) -> String {
        let share = match self.share {
            Share::Window(_) => "window".to_owned(),
            Share::Tiles(Tiles { number, count, side }) => {
                format!("{number} of {count} tiles {side}")
            }
        };
        let ([columns, rows], picture) = (self.canvas, self.picture);
        format!("{KEY} {share} canvas {columns} {rows} picture {picture:032x}")
    }

    fn sum(&self, image: &Image) -> u128 {
        let properties = &image.properties;
        let mut sum = Sum::default();
        sum.add(self.line().as_bytes());
        let Window { column, row, columns, rows } = image.window();
        sum.add(format!("{column} {row} {columns} {rows}").as_bytes());
        if let Some(transfer) = properties.transfer {
            sum.add(transfer.to_string().as_bytes());
        }
        if image.plane(Kind::Cvg).is_some() {
            sum.add(format!("{:?}", properties.matte).as_bytes());
        }
        for value in properties.background.into_iter().flatten() {
            sum.add(&value.to_le_bytes());
        }
        for plane in image.planes() {
            sum.add(plane.kind.word().as_bytes());
            sum.add_samples(&plane.samples);
        }
        sum.value()
    }
}

/// A checksum or an identity of several things: 128 bits of XXH3, the same on every machine.
#[derive(Clone, Default)]
pub struct Sum(Xxh3);

impl Sum {
    /// Adds some bytes, and where they end.
    pub fn add(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
        self.0.update(&(bytes.len() as u64).to_le_bytes());
    }

    /// Adds samples, and how deep they are.
    pub fn add_samples(&mut self, samples: &Samples) {
        // In pieces: samples of 16 and 32 bits are copied to become bytes.
        const PIECE: usize = 1 << 20;
        self.add(samples.depth().word().as_bytes());
        for start in (0..samples.len()).step_by(PIECE) {
            self.0.update(&samples.raw_bytes(start..samples.len().min(start + PIECE)));
        }
        self.add(&[]);
    }

    /// The sum of all that was added.
    pub fn value(&self) -> u128 {
        self.0.digest128()
    }
}

impl fmt::Debug for Sum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Sum({:032x})", self.value())
    }
}

/// Takes out of `image` what it says that it is a part of.
pub fn unmark(image: &mut Image) {
    image.properties.unknown.retain(|line| !is_part(line));
}

/// Takes it out if it is no longer so, as the image was changed.
pub fn settle(image: &mut Image) {
    if Part::of(image).is_err() {
        unmark(image);
    }
}

/// Whether a line of a description says what its image is a part of.
pub fn is_part(line: &str) -> bool {
    line.split_whitespace().next() == Some(KEY)
}

/// The part of a line, and its checksum; the image lies at `window`.
fn parsed(line: &str, window: Window) -> Result<(Part, u128), PartError> {
    let wrong = || PartError::Line { found: line.to_owned() };
    let line = line.split('#').next().unwrap_or_default();
    let words: Vec<&str> = line.split_whitespace().skip(1).collect();
    let number = |word: &str| word.parse::<u32>().ok();
    let identity = |word: &str| u128::from_str_radix(word, 16).ok().filter(|_| word.len() == 32);
    let (share, rest) = match words.as_slice() {
        ["window", rest @ ..] => (Some(Share::Window(window)), rest),
        [part, "of", count, "tiles", side, rest @ ..] => {
            let tiles = number(part).zip(number(count)).zip(number(side));
            let tiles = tiles.map(|((number, count), side)| Tiles { number, count, side });
            (tiles.filter(is_possible).map(Share::Tiles), rest)
        }
        _ => return Err(wrong()),
    };
    let ["canvas", columns, rows, "picture", picture, "sum", sum] = rest else {
        return Err(wrong());
    };
    let found = (|| {
        let canvas = [number(columns)?, number(rows)?];
        crate::image::checked_size(canvas[0], canvas[1]).ok()?;
        let share = share.filter(|share| is_within(share, canvas))?;
        Some((Part { share, canvas, picture: identity(picture)? }, identity(sum)?))
    })();
    found.ok_or_else(wrong)
}

fn is_possible(tiles: &Tiles) -> bool {
    (1..=Tiles::MOST_PARTS).contains(&tiles.count)
        && tiles.number < tiles.count
        && (1..=Tiles::MOST_SIDE).contains(&tiles.side)
}

fn is_within(share: &Share, canvas: [u32; 2]) -> bool {
    let Share::Window(Window { column, row, columns, rows }) = *share else { return true };
    let ends = |from: i32, length: u32, all: u32| {
        from >= 0 && i64::from(from) + i64::from(length) <= i64::from(all)
    };
    ends(column, columns, canvas[0]) && ends(row, rows, canvas[1])
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::image::Plane;

    fn image(columns: u32, rows: u32) -> Image {
        let samples = Samples::U8((0..columns * rows).map(|i| i.to_le_bytes()[0]).collect());
        Image::new(columns, rows, vec![Plane { kind: Kind::Grg, samples }]).unwrap()
    }

    #[test]
    fn every_pixel_is_in_one_part() {
        for (canvas, side) in [([64, 48], 16), ([65, 47], 16), ([7, 300], 4), ([1, 1], 32)] {
            for count in [1, 2, 3, 5, 8, 16, 97] {
                let mut times = vec![0; (canvas[0] * canvas[1]) as usize];
                for number in 0..count {
                    for window in (Tiles { number, count, side }).windows(canvas) {
                        for row in 0..window.rows {
                            for column in 0..window.columns {
                                let (x, y) =
                                    (window.column.unsigned_abs(), window.row.unsigned_abs());
                                times[((y + row) * canvas[0] + x + column) as usize] += 1;
                            }
                        }
                    }
                }
                assert!(times.iter().all(|&t| t == 1), "{canvas:?} in {count} parts of {side}");
            }
        }
    }

    #[test]
    fn parts_have_tiles_in_every_row_and_column_of_tiles() {
        for count in 2..=24 {
            for number in 0..count {
                let windows: Vec<Window> =
                    Tiles { number, count, side: 1 }.windows([count, count]).collect();
                let seen = |place: fn(&Window) -> i32| {
                    let places: BTreeSet<i32> = windows.iter().map(place).collect();
                    places.len()
                };
                let expected = count as usize;
                let all = (seen(|w| w.column), seen(|w| w.row), windows.len());
                assert_eq!(all, (expected, expected, expected), "part {number} of {count}");
            }
        }
    }

    #[test]
    fn tiles_fit_the_picture_and_its_parts() {
        for (count, canvas, apron, expected) in [
            (8, [512, 512], 0, 16),
            (8, [128, 128], 0, 8),
            (999, [8, 8], 0, 8),
            (8, [1024, 1024], 2, 64),
            (1, [1920, 1080], 1, 256),
            (8, [512, 512], 2, 32),
        ] {
            let side = Tiles::fitting_side(count, canvas, apron);
            assert_eq!(side, expected, "{count} parts of {canvas:?}");
        }
    }

    #[test]
    fn what_was_written_is_read_and_what_was_changed_is_refused() {
        let window = Window { column: 3, row: 1, columns: 5, rows: 4 };
        let tiles = Tiles { number: 1, count: 3, side: 2 };
        for (share, size) in [(Share::Window(window), [5, 4]), (Share::Tiles(tiles), [9, 8])] {
            let part = Part { share, canvas: [9, 8], picture: 77 << 99 };
            let mut image = image(size[0], size[1]);
            let frame = share.frame(part.canvas);
            image.properties.origin = [frame.column, frame.row];
            assert_eq!(Part::of(&image), Ok(None));
            part.mark(&mut image);
            assert_eq!(Part::of(&image), Ok(Some(part)));
            let mut moved = image.clone();
            moved.properties.origin[0] -= 1;
            let mut lit = image.clone();
            lit.properties.background = Some([0.5; 3]);
            let mut planes = image.planes().to_vec();
            let Samples::U8(samples) = &mut planes[0].samples else { panic!() };
            samples[7] ^= 1;
            let changed = image.with_planes(size[0], size[1], planes).unwrap();
            for other in [&moved, &lit, &changed] {
                assert_eq!(Part::of(other), Err(PartError::Sum));
            }
            let mut settled = moved.clone();
            settle(&mut settled);
            assert_eq!(Part::of(&settled), Ok(None), "it is no part any more");
            settled = image.clone();
            settle(&mut settled);
            assert_eq!(settled, image, "it still is one");
            part.mark(&mut image);
            assert_eq!(image.properties.unknown.len(), 1, "one line: {:?}", image.properties);
            unmark(&mut image);
            assert_eq!(Part::of(&image), Ok(None));
        }
    }

    #[test]
    fn lines_that_make_no_sense_are_refused() {
        let mut image = image(4, 4);
        let id = "0123456789abcdef0123456789abcdef";
        let good = format!("part 0 of 2 tiles 2 canvas 4 4 picture {id} sum {id}");
        for line in [
            "part".to_owned(),
            good.replace("0 of 2", "2 of 2"),
            good.replace("0 of 2", "0 of 0"),
            good.replace("tiles 2", "tiles 0"),
            good.replace("canvas 4 4", "canvas 4 4 4"),
            good.replace("canvas 4 4", "canvas 0 4"),
            good.replace("canvas 4 4", "canvas 999999999 999999999"),
            good.replace(id, "xyz"),
            good.replace("0 of 2 tiles 2 canvas 4 4", "window canvas 3 4"),
        ] {
            image.properties.unknown = vec![line.clone()];
            assert!(matches!(Part::of(&image), Err(PartError::Line { .. })), "{line}");
        }
        image.properties.unknown = vec![good];
        assert_eq!(Part::of(&image), Err(PartError::Sum), "the line is as it should be");
    }
}
