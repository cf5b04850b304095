//! A border about a picture.

use idf::plane::{COLOR, Role};
use idf::{Depth, Image, ImageError, Kind, Plane, Samples, Transfer, Window, checked_size};

use crate::CopyError;
use crate::join::covered;

/// Where the canvas ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// Pixels more on the left, top, right and bottom.
    By([u32; 4]),
    /// A window of the canvas on which the picture lies; what is beyond it is cut off.
    To(Window),
}

/// What is beyond the edges of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Border {
    /// Nothing: black of coverage 0.
    #[default]
    Clear,
    /// A colour of display values, covered; measured values and indices are 0, or that of the
    /// nearest colour in the table.
    Color([f64; 3]),
    /// The pixel at the edge.
    Edge,
    /// The picture again.
    Wrap,
}

/// The picture with a border.
pub(crate) fn extended(image: &Image, extent: Extent, border: Border) -> Result<Image, CopyError> {
    let own = image.window();
    let window = match extent {
        Extent::To(window) => window,
        Extent::By([left, top, right, bottom]) => Window {
            column: own.column.saturating_sub_unsigned(left),
            row: own.row.saturating_sub_unsigned(top),
            columns: own.columns.saturating_add(left).saturating_add(right),
            rows: own.rows.saturating_add(top).saturating_add(bottom),
        },
    };
    checked_size(window.columns, window.rows)?;
    let offset = |from: i32, to: i32| i64::from(to) - i64::from(from);
    let start = [offset(own.column, window.column), offset(own.row, window.row)];
    let columns = places(start[0], window.columns, own.columns, border);
    let rows = places(start[1], window.rows, own.rows, border);
    let beyond = columns.contains(&None) || rows.contains(&None);
    let mut planes = image.planes().to_vec();
    if beyond && border == Border::Clear && image.plane(Kind::Cvg).is_none() {
        planes.push(covered(image));
    }
    let width = image.columns() as usize;
    let placed = |Plane { kind, samples }: Plane| {
        let outside = outside(image, kind, samples.depth(), border)?;
        let samples = match (&samples, &outside) {
            (Samples::U8(s), Samples::U8(o)) => {
                Samples::U8(spread(s, width, &columns, &rows, o[0]))
            }
            (Samples::U16(s), Samples::U16(o)) => {
                Samples::U16(spread(s, width, &columns, &rows, o[0]))
            }
            (Samples::F32(s), Samples::F32(o)) => {
                Samples::F32(spread(s, width, &columns, &rows, o[0]))
            }
            _ => samples,
        };
        Ok::<_, CopyError>(Plane { kind, samples })
    };
    let planes = planes.into_iter().map(placed).collect::<Result<Vec<_>, _>>()?;
    let mut copy = image.with_planes(window.columns, window.rows, planes)?;
    copy.properties.origin = [window.column, window.row];
    Ok(copy)
}

/// Where each of `count` places from `start` on is in a picture of `length`; none beyond it.
fn places(start: i64, count: u32, length: u32, border: Border) -> Vec<Option<usize>> {
    let length = i64::from(length);
    let place = |at: i64| match border {
        Border::Edge => at.clamp(0, length - 1),
        Border::Wrap => at.rem_euclid(length),
        Border::Clear | Border::Color(_) => at,
    };
    let inside = |at: i64| usize::try_from(at).ok().filter(|_| at < length);
    (start..start + i64::from(count)).map(|at| inside(place(at))).collect()
}

fn spread<T: Copy>(
    samples: &[T],
    width: usize,
    columns: &[Option<usize>],
    rows: &[Option<usize>],
    outside: T,
) -> Vec<T> {
    let mut result = Vec::with_capacity(columns.len() * rows.len());
    for row in rows {
        match row {
            None => result.resize(result.len() + columns.len(), outside),
            Some(row) => {
                let line = &samples[row * width..(row + 1) * width];
                result.extend(columns.iter().map(|column| column.map_or(outside, |at| line[at])));
            }
        }
    }
    result
}

/// One sample of what is beyond the edges.
#[expect(clippy::cast_possible_truncation, reason = "planes hold 32-bit values by definition")]
fn outside(image: &Image, kind: Kind, depth: Depth, border: Border) -> Result<Samples, CopyError> {
    let color = match border {
        Border::Color(color) => color,
        Border::Clear | Border::Edge | Border::Wrap => return Ok(zero(depth)),
    };
    let light = color.map(|value| Transfer::Srgb.decode(value));
    let (value, transfer) = match kind.role() {
        Role::Light => {
            let channel = COLOR.iter().position(|&other| other == kind);
            let grey = 0.2126 * light[0] + 0.7152 * light[1] + 0.0722 * light[2];
            (channel.map_or(grey, |channel| light[channel]), image.transfer(depth))
        }
        Role::Coverage => (1.0, Transfer::Linear),
        Role::Index => return Ok(Samples::U8(vec![nearest_index(image, color)])),
        _ => return Ok(zero(depth)),
    };
    let samples = Samples::encoded(&[value as f32], depth, transfer);
    samples.map_err(|_| ImageError::NotANumber { kind, column: 0, row: 0 }.into())
}

fn zero(depth: Depth) -> Samples {
    match depth {
        Depth::U8 => Samples::U8(vec![0]),
        Depth::U16 => Samples::U16(vec![0]),
        Depth::F32 => Samples::F32(vec![0.0]),
    }
}

/// The first entry of the table that is nearest to display values; 0 without a table.
fn nearest_index(image: &Image, color: [f64; 3]) -> u8 {
    let distance = |entry: &[u8; 3]| {
        let off = entry.iter().zip(color).map(|(&e, c)| f64::from(e) - 255.0 * c);
        off.map(|d| d * d).sum::<f64>()
    };
    let colors = image.lut.as_ref().map(|lut| lut.colors()).unwrap_or_default();
    let mut best = (f64::INFINITY, 0);
    for (entry, index) in colors.iter().zip(0_u8..) {
        if distance(entry) < best.0 {
            best = (distance(entry), index);
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use idf::{Lut, Matte};

    fn grey(columns: u32, samples: &[u8]) -> Image {
        let plane = Plane { kind: Kind::Grg, samples: Samples::U8(samples.into()) };
        let rows = u32::try_from(samples.len()).unwrap() / columns;
        Image::new(columns, rows, vec![plane]).unwrap()
    }

    fn bytes(image: &Image, kind: Kind) -> Vec<u8> {
        match image.plane(kind) {
            Some(Samples::U8(samples)) => samples.clone(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn edges_go_on_repeat_or_end() {
        let extent = Extent::By([2, 1, 1, 0]);
        let picture = grey(3, &[1, 2, 3, 4, 5, 6]);
        let found = |border| bytes(&extended(&picture, extent, border).unwrap(), Kind::Grg);
        assert_eq!(found(Border::Edge), [1, 1, 1, 2, 3, 3, 1, 1, 1, 2, 3, 3, 4, 4, 4, 5, 6, 6]);
        assert_eq!(found(Border::Wrap), [5, 6, 4, 5, 6, 4, 2, 3, 1, 2, 3, 1, 5, 6, 4, 5, 6, 4]);
        let clear = extended(&picture, extent, Border::Clear).unwrap();
        assert_eq!(
            bytes(&clear, Kind::Grg),
            [0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 0, 0, 0, 4, 5, 6, 0]
        );
        let coverage = bytes(&clear, Kind::Cvg);
        assert_eq!(coverage[6..12], [0, 0, 255, 255, 255, 0]);
        assert_eq!(
            (clear.properties.origin, clear.properties.matte),
            ([-2, -1], Matte::Premultiplied)
        );
        let white = found(Border::Color([1.0; 3]));
        assert_eq!(white[6..12], [255, 255, 1, 2, 3, 255]);
    }

    #[test]
    fn a_window_cuts_off_too() {
        let mut picture = grey(3, &[1, 2, 3, 4, 5, 6]);
        picture.properties.origin = [10, 20];
        let window = Window { column: 11, row: 19, columns: 3, rows: 2 };
        let copy = extended(&picture, Extent::To(window), Border::Edge).unwrap();
        assert_eq!(bytes(&copy, Kind::Grg), [2, 3, 3, 2, 3, 3]);
        assert_eq!(copy.window(), window);
        let inside = Window { column: 11, row: 20, columns: 1, rows: 2 };
        let copy = extended(&picture, Extent::To(inside), Border::Clear).unwrap();
        assert_eq!((bytes(&copy, Kind::Grg), copy.kinds()), (vec![2, 5], vec![Kind::Grg]));
    }

    #[test]
    fn a_color_is_the_nearest_of_the_table() {
        let plane = Plane { kind: Kind::Enc, samples: Samples::U8(vec![0]) };
        let mut picture = Image::new(1, 1, vec![plane]).unwrap();
        picture.lut = Lut::new(vec![[0; 3], [250, 0, 0], [0, 255, 0]]);
        let border = Border::Color([1.0, 0.0, 0.0]);
        let copy = extended(&picture, Extent::By([0, 0, 1, 0]), border).unwrap();
        assert_eq!(bytes(&copy, Kind::Enc), [0, 1]);
    }

    #[test]
    fn a_canvas_has_a_size() {
        let found = extended(&grey(1, &[1]), Extent::By([u32::MAX; 4]), Border::Wrap);
        assert!(matches!(found, Err(CopyError::Image(ImageError::Size { .. }))), "{found:?}");
    }
}
