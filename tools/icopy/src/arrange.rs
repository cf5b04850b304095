//! Pixels in other places: crop, shift, flip, rotate, tile.

use idf::{Image, ImageError, Plane, checked_size};

use crate::CopyError;

/// A part of a picture, in its own pixels from the top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// Leftmost column.
    pub column: u32,
    /// Topmost row.
    pub row: u32,
    /// Width.
    pub columns: u32,
    /// Height.
    pub rows: u32,
}

/// Axis of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Across: left becomes right.
    X,
    /// Down: top becomes bottom.
    Y,
}

/// Clockwise turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// The left side becomes the top.
    Quarter,
    /// Upside down.
    Half,
    /// The right side becomes the top.
    ThreeQuarters,
}

impl Region {
    /// Refuses a part that is not in a picture of `size`.
    pub(crate) fn check(self, size: [u32; 2]) -> Result<(), CopyError> {
        let Self { column, row, columns, rows } = self;
        let ends = [column.checked_add(columns), row.checked_add(rows)];
        let inside = ends.iter().zip(size).all(|(end, most)| end.is_some_and(|end| end <= most));
        if inside && columns > 0 && rows > 0 {
            return Ok(());
        }
        Err(CopyError::Region { found: self, size })
    }
}

/// The part, at its place on the canvas.
pub(crate) fn cropped(image: &Image, region: Region) -> Result<Image, CopyError> {
    let Region { column, row, columns, rows } = region;
    region.check(image.size())?;
    if region == (Region { column: 0, row: 0, columns: image.columns(), rows: image.rows() }) {
        return Ok(image.clone());
    }
    let mut part = arranged(image, columns, rows, |x, y| [column + x, row + y])?;
    for (origin, offset) in part.properties.origin.iter_mut().zip([column, row]) {
        *origin = origin.saturating_add_unsigned(offset);
    }
    Ok(part)
}

/// The picture moved to the right and down; what leaves it comes in at the other side.
pub(crate) fn shifted(image: &Image, offset: [i32; 2]) -> Result<Image, CopyError> {
    let [columns, rows] = image.size();
    // A pixel comes from where the offset leads back to; sizes are at most 2^31.
    let start = |by: i32, length: u32| {
        let back = (-i64::from(by)).rem_euclid(i64::from(length));
        u32::try_from(back).expect("below a length of 32 bits")
    };
    let [x0, y0] = [start(offset[0], columns), start(offset[1], rows)];
    let around = |at: u32, by: u32, length: u32| {
        let left = length - by;
        if at < left { at + by } else { at - left }
    };
    arranged(image, columns, rows, |x, y| [around(x, x0, columns), around(y, y0, rows)])
}

/// The picture seen in a mirror.
pub(crate) fn flipped(image: &Image, axis: Axis) -> Result<Image, CopyError> {
    let [columns, rows] = image.size();
    match axis {
        Axis::X => arranged(image, columns, rows, |x, y| [columns - 1 - x, y]),
        Axis::Y => arranged(image, columns, rows, |x, y| [x, rows - 1 - y]),
    }
}

/// The picture turned clockwise; a canvas is not turned with it, so it lies at its top left.
pub(crate) fn rotated(image: &Image, turn: Turn) -> Result<Image, CopyError> {
    let [columns, rows] = image.size();
    let mut turned = match turn {
        Turn::Quarter => arranged(image, rows, columns, |x, y| [y, rows - 1 - x]),
        Turn::Half => arranged(image, columns, rows, |x, y| [columns - 1 - x, rows - 1 - y]),
        Turn::ThreeQuarters => arranged(image, rows, columns, |x, y| [columns - 1 - y, x]),
    }?;
    turned.properties.origin = [0, 0];
    Ok(turned)
}

/// The picture repeated across and down, at the top left of a canvas.
pub(crate) fn tiled(image: &Image, times: [u32; 2]) -> Result<Image, CopyError> {
    let [columns, rows] = image.size();
    let [across, down] = [columns.saturating_mul(times[0]), rows.saturating_mul(times[1])];
    let mut tiles = arranged(image, across, down, |x, y| [x % columns, y % rows])?;
    tiles.properties.origin = [0, 0];
    Ok(tiles)
}

/// An image of `columns` and `rows`, where each pixel is the one of `image` at `source`.
fn arranged(
    image: &Image,
    columns: u32,
    rows: u32,
    source: impl Fn(u32, u32) -> [u32; 2],
) -> Result<Image, CopyError> {
    checked_size(columns, rows)?;
    let width = image.columns() as usize;
    let planes = image.planes().iter().map(|plane| {
        let places = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
        let positions = places.map(|(x, y)| {
            let [column, row] = source(x, y);
            row as usize * width + column as usize
        });
        Plane { kind: plane.kind, samples: plane.samples.gathered(positions) }
    });
    let planes: Vec<Plane> = planes.collect();
    image.with_planes(columns, rows, planes).map_err(|error: ImageError| error.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use idf::{Kind, Samples};

    /// Rows of a picture as words, one digit for each pixel.
    fn picture(text: &str) -> Image {
        let rows: Vec<&str> = text.split(' ').collect();
        let samples = rows.concat().bytes().map(|digit| u16::from(digit - b'0')).collect();
        let plane = Plane { kind: Kind::Cvg, samples: Samples::U16(samples) };
        let [columns, rows] = [rows[0].len(), rows.len()].map(|n| u32::try_from(n).unwrap());
        Image::new(columns, rows, vec![plane]).unwrap()
    }

    #[test]
    fn flips_reverse_one_axis() {
        let original = picture("123 456");
        assert_eq!(flipped(&original, Axis::X), Ok(picture("321 654")));
        assert_eq!(flipped(&original, Axis::Y), Ok(picture("456 123")));
    }

    #[test]
    fn shifts_go_around() {
        let original = picture("123 456");
        assert_eq!(shifted(&original, [1, 0]), Ok(picture("312 645")));
        assert_eq!(shifted(&original, [-1, 1]), Ok(picture("564 231")));
        assert_eq!(shifted(&original, [i32::MIN, -2]), Ok(picture("312 645")));
    }

    #[test]
    fn turns_are_clockwise() {
        let original = picture("123 456");
        assert_eq!(rotated(&original, Turn::Quarter), Ok(picture("41 52 63")));
        assert_eq!(rotated(&original, Turn::Half), Ok(picture("654 321")));
        assert_eq!(rotated(&original, Turn::ThreeQuarters), Ok(picture("36 25 14")));
    }

    #[test]
    fn tiles_repeat() {
        assert_eq!(tiled(&picture("12 34"), [3, 2]), Ok(picture("121212 343434 121212 343434")));
        let error = tiled(&picture("12"), [1 << 31, 3]);
        let size = ImageError::Size { columns: u32::MAX, rows: 3 };
        assert_eq!(error, Err(CopyError::Image(size)));
    }

    #[test]
    fn a_part_stays_at_its_place() {
        let mut original = picture("123 456 789");
        original.properties.origin = [10, -5];
        let region = |column, row, columns, rows| Region { column, row, columns, rows };
        let mut expected = picture("56 89");
        expected.properties.origin = [11, -4];
        assert_eq!(cropped(&original, region(1, 1, 2, 2)), Ok(expected));
        for found in
            [region(1, 0, 3, 1), region(0, 3, 1, 1), region(u32::MAX, 0, 2, 1), region(0, 0, 0, 1)]
        {
            let error = CopyError::Region { found, size: [3, 3] };
            assert_eq!(cropped(&original, found), Err(error));
        }
    }
}
