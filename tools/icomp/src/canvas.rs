//! Layers on the canvas: the union of their windows, and rows of one filled up to it.

use std::borrow::Cow;
use std::ops::Range;

use idf::{Depth, Image, ImageError, Kind, Plane, Samples, Window};

use crate::plan::Layer;

/// The smallest window that holds all.
pub(crate) fn union(windows: impl Iterator<Item = Window>) -> Result<Window, ImageError> {
    let mut ends: Option<[i64; 4]> = None;
    for window in windows {
        let (left, top) = (i64::from(window.column), i64::from(window.row));
        let (right, bottom) = (left + i64::from(window.columns), top + i64::from(window.rows));
        let [l, t, r, b] = ends.unwrap_or([left, top, right, bottom]);
        ends = Some([l.min(left), t.min(top), r.max(right), b.max(bottom)]);
    }
    let [left, top, right, bottom] = ends.unwrap_or_default();
    let size = [right - left, bottom - top].map(|length| u32::try_from(length).unwrap_or(u32::MAX));
    let origin = [left, top].map(i32::try_from);
    let [Ok(column), Ok(row)] = origin else {
        return Err(ImageError::Size { columns: size[0], rows: size[1] });
    };
    Ok(Window { column, row, columns: size[0], rows: size[1] })
}

/// The rows of a window that lie among `rows` of the canvas, counted from the top of the window.
pub(crate) fn shared_rows(window: Window, canvas: Window, rows: Range<u32>) -> Range<u32> {
    let above = i64::from(window.row) - i64::from(canvas.row);
    let inside = |row: u32| (i64::from(row) - above).clamp(0, i64::from(window.rows));
    let inside = |row| u32::try_from(inside(row)).unwrap_or(0);
    inside(rows.start)..inside(rows.end)
}

/// Rows of a layer with nothing about them, up to the canvas. `image` has the rows of the layer that
/// are among `rows`, or is not there where there are none. Where nothing is to be added it is lent.
pub(crate) fn fitted<'a>(
    layer: &Layer,
    image: Option<&'a Image>,
    canvas: Window,
    rows: Range<u32>,
    depth: Depth,
) -> Result<Cow<'a, Image>, ImageError> {
    let window = layer.window;
    let (width, height) = (canvas.columns as usize, rows.len());
    if let Some(image) = image {
        let fills = image.size() == [canvas.columns, rows.end - rows.start];
        if fills && (layer.coverage.is_none() || image.plane(Kind::Cvg).is_some()) {
            return Ok(Cow::Borrowed(image));
        }
    }
    let left = (i64::from(window.column) - i64::from(canvas.column)).unsigned_abs();
    let left = usize::try_from(left).unwrap_or(width);
    let top = i64::from(window.row) - i64::from(canvas.row) - i64::from(rows.start);
    let top = usize::try_from(top).unwrap_or(0);
    let mut planes = Vec::new();
    let kinds = layer.light.iter().flatten().map(|(kind, _)| *kind);
    let mut kinds: Vec<Kind> = kinds.chain([Kind::Cvg]).collect();
    kinds.dedup();
    for kind in kinds {
        let own = image.and_then(|image| image.plane(kind));
        let missing = image.filter(|_| own.is_none()).map(|image| {
            let pixels = image.columns() as usize * image.rows() as usize;
            covered(pixels, depth)
        });
        let samples = match own.or(missing.as_ref()) {
            Some(part) => placed(part, window.columns as usize, left, top, width, height),
            None => zeros(width * height, layer.depth_of(kind).unwrap_or(depth)),
        };
        planes.push(Plane { kind, samples });
    }
    Image::new(canvas.columns, rows.end - rows.start, planes).map(Cow::Owned)
}

/// No light or coverage.
pub(crate) fn zeros(count: usize, depth: Depth) -> Samples {
    match depth {
        Depth::U8 => Samples::U8(vec![0; count]),
        Depth::U16 => Samples::U16(vec![0; count]),
        Depth::F32 => Samples::F32(vec![0.0; count]),
    }
}

/// Coverage of 1.
fn covered(count: usize, depth: Depth) -> Samples {
    match depth {
        Depth::U8 => Samples::U8(vec![u8::MAX; count]),
        Depth::U16 => Samples::U16(vec![u16::MAX; count]),
        Depth::F32 => Samples::F32(vec![1.0; count]),
    }
}

/// A plane with nothing about it.
fn placed(
    samples: &Samples,
    columns: usize,
    left: usize,
    top: usize,
    width: usize,
    height: usize,
) -> Samples {
    fn place<T: Copy>(part: &[T], columns: usize, left: usize, all: &mut [T], width: usize) {
        for (row, target) in part.chunks(columns).zip(all.chunks_mut(width)) {
            target[left..left + columns].copy_from_slice(row);
        }
    }
    let from = top * width;
    match samples {
        Samples::U8(part) => {
            let mut all = vec![0; width * height];
            place(part, columns, left, &mut all[from..], width);
            Samples::U8(all)
        }
        Samples::U16(part) => {
            let mut all = vec![0; width * height];
            place(part, columns, left, &mut all[from..], width);
            Samples::U16(all)
        }
        Samples::F32(part) => {
            let mut all = vec![0.0; width * height];
            place(part, columns, left, &mut all[from..], width);
            Samples::F32(all)
        }
    }
}
