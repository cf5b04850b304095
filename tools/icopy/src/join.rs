//! Several pictures put together in their windows.

use idf::plane::Role;
use idf::{Depth, Form, Image, Kind, Plane, Samples, Window, checked_size};

use crate::CopyError;

/// Several pictures in their windows, on a canvas that holds all; where they overlap, the last is
/// seen, whatever its coverage. What no window holds is black of coverage 0, and a picture without
/// coverage is covered.
///
/// They get the deepest depth, and transfer and matte of the first; what else the first says goes
/// for all, but their histories follow each other.
///
/// # Errors
///
/// If there is none, they have different channels but for coverage, or different tables, or
/// measured values of different depths, or the canvas is too large.
pub fn joined(images: &[Image]) -> Result<Image, CopyError> {
    let Some(first) = images.first() else { return Err(CopyError::NoImage) };
    if images.len() == 1 {
        return Ok(first.clone());
    }
    for other in &images[1..] {
        check_channels(first, other)?;
    }
    let canvas = canvas(images);
    let pixels = usize::try_from(checked_size(canvas.columns, canvas.rows)?)
        .map_err(|_| CopyError::NoImage)?;
    let has_coverage = images.iter().any(|image| image.plane(Kind::Cvg).is_some());
    let needs_coverage = has_coverage || has_gaps(images, canvas, pixels);
    let depth = images.iter().map(Image::depth).max().unwrap_or(Depth::U8);
    let form = Form { depth, transfer: first.transfer(depth), matte: first.properties.matte };
    let mut planes: Vec<Plane> = Vec::new();
    for image in images {
        let mut part = image.converted(form)?;
        if needs_coverage && part.plane(Kind::Cvg).is_none() {
            let planes = part.planes().iter().cloned().chain([covered(&part)]).collect();
            part = part.with_planes(part.columns(), part.rows(), planes)?;
        }
        for Plane { kind, samples } in part.planes() {
            let at = planes.iter().position(|plane| plane.kind == *kind).unwrap_or_else(|| {
                planes.push(Plane { kind: *kind, samples: black(samples.depth(), pixels) });
                planes.len() - 1
            });
            place(samples, part.window(), &mut planes[at], canvas)?;
        }
    }
    let mut copy = first.with_planes(canvas.columns, canvas.rows, planes)?;
    copy.properties.origin = [canvas.column, canvas.row];
    for image in &images[1..] {
        let history = &mut copy.properties.history;
        let new: Vec<String> = image
            .properties
            .history
            .iter()
            .filter(|line| !history.contains(line))
            .cloned()
            .collect();
        history.extend(new);
    }
    Ok(copy)
}

/// A plane of whole coverage for an image.
pub(crate) fn covered(image: &Image) -> Plane {
    let pixels = image.columns() as usize * image.rows() as usize;
    let samples = match image.depth() {
        Depth::U8 => Samples::U8(vec![u8::MAX; pixels]),
        Depth::U16 => Samples::U16(vec![u16::MAX; pixels]),
        Depth::F32 => Samples::F32(vec![1.0; pixels]),
    };
    Plane { kind: Kind::Cvg, samples }
}

fn black(depth: Depth, pixels: usize) -> Samples {
    match depth {
        Depth::U8 => Samples::U8(vec![0; pixels]),
        Depth::U16 => Samples::U16(vec![0; pixels]),
        Depth::F32 => Samples::F32(vec![0.0; pixels]),
    }
}

fn check_channels(first: &Image, other: &Image) -> Result<(), CopyError> {
    let kinds = |image: &Image| -> Vec<Kind> {
        image.kinds().into_iter().filter(|kind| kind.role() != Role::Coverage).collect()
    };
    let (mut a, mut b) = (kinds(first), kinds(other));
    a.sort_unstable();
    b.sort_unstable();
    if a != b {
        return Err(CopyError::Channels { first: first.kinds(), other: other.kinds() });
    }
    if first.lut != other.lut {
        return Err(CopyError::Tables);
    }
    Ok(())
}

/// The least rectangle that holds all windows.
fn canvas(images: &[Image]) -> Window {
    let windows = || images.iter().map(Image::window);
    let column = windows().map(|window| window.column).min().unwrap_or_default();
    let row = windows().map(|window| window.row).min().unwrap_or_default();
    let length = |from: i32, at: i32, size: u32| at.abs_diff(from).saturating_add(size);
    Window {
        column,
        row,
        columns: windows().map(|w| length(column, w.column, w.columns)).max().unwrap_or_default(),
        rows: windows().map(|w| length(row, w.row, w.rows)).max().unwrap_or_default(),
    }
}

/// Whether a pixel of the canvas is in no window.
fn has_gaps(images: &[Image], canvas: Window, pixels: usize) -> bool {
    let mut seen = vec![false; pixels];
    for image in images {
        for line in lines(image.window(), canvas) {
            seen[line].fill(true);
        }
    }
    seen.contains(&false)
}

/// Where the rows of a window are in a canvas that holds it.
fn lines(window: Window, canvas: Window) -> impl Iterator<Item = std::ops::Range<usize>> {
    let left = window.column.abs_diff(canvas.column) as usize;
    let top = window.row.abs_diff(canvas.row) as usize;
    let (columns, width) = (window.columns as usize, canvas.columns as usize);
    (0..window.rows as usize).map(move |row| {
        let start = (top + row) * width + left;
        start..start + columns
    })
}

fn place(
    samples: &Samples,
    window: Window,
    plane: &mut Plane,
    canvas: Window,
) -> Result<(), CopyError> {
    fn copy<T: Copy>(samples: &[T], target: &mut [T], window: Window, canvas: Window) {
        let rows = samples.chunks_exact(window.columns as usize);
        for (line, row) in lines(window, canvas).zip(rows) {
            target[line].copy_from_slice(row);
        }
    }
    match (samples, &mut plane.samples) {
        (Samples::U8(from), Samples::U8(to)) => copy(from, to, window, canvas),
        (Samples::U16(from), Samples::U16(to)) => copy(from, to, window, canvas),
        (Samples::F32(from), Samples::F32(to)) => copy(from, to, window, canvas),
        (from, to) => {
            let depths = [to.depth(), from.depth()];
            return Err(CopyError::Depths { kind: plane.kind, depths });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use idf::Transfer;

    fn grey(origin: [i32; 2], columns: u32, samples: &[u8]) -> Image {
        let plane = Plane { kind: Kind::Grg, samples: Samples::U8(samples.into()) };
        let rows = u32::try_from(samples.len()).unwrap() / columns;
        let mut image = Image::new(columns, rows, vec![plane]).unwrap();
        image.properties.origin = origin;
        image
    }

    fn samples(image: &Image, kind: Kind) -> Samples {
        image.plane(kind).unwrap().clone()
    }

    #[test]
    fn parts_make_the_whole() {
        let parts = [grey([-1, 4], 2, &[1, 2, 4, 5]), grey([1, 4], 1, &[3, 6])];
        let whole = joined(&parts).unwrap();
        assert_eq!(whole, grey([-1, 4], 3, &[1, 2, 3, 4, 5, 6]));
        let [a, b] = parts;
        assert_eq!(joined(&[b, a]).unwrap(), whole);
    }

    #[test]
    fn gaps_are_uncovered_and_the_last_is_on_top() {
        let parts = [grey([0, 0], 2, &[1, 2]), grey([1, 0], 1, &[9]), grey([3, 1], 1, &[7])];
        let whole = joined(&parts).unwrap();
        assert_eq!(samples(&whole, Kind::Grg), Samples::U8(vec![1, 9, 0, 0, 0, 0, 0, 7]));
        let coverage = Samples::U8(vec![255, 255, 0, 0, 0, 0, 0, 255]);
        assert_eq!(samples(&whole, Kind::Cvg), coverage);
    }

    #[test]
    fn the_deepest_depth_and_the_first_transfer_hold() {
        let mut second = grey([1, 0], 1, &[255]).at_depth(Depth::U16).unwrap();
        second.properties.transfer = Some(Transfer::Linear);
        second.properties.history = vec!["b".into()];
        let mut first = grey([0, 0], 1, &[128]);
        first.properties.history = vec!["a".into()];
        let whole = joined(&[first, second]).unwrap();
        assert_eq!(samples(&whole, Kind::Grg), Samples::U16(vec![128 * 257, 65_535]));
        assert_eq!(whole.properties.history, ["a", "b"]);
    }

    #[test]
    fn different_channels_do_not_go_together() {
        let plane = Plane { kind: Kind::Dep, samples: Samples::U8(vec![1]) };
        let depth = Image::new(1, 1, vec![plane]).unwrap();
        let found = joined(&[grey([0, 0], 1, &[1]), depth]).unwrap_err().to_string();
        assert_eq!(found, "expected pictures of the same channels, found grg and dep");
        assert_eq!(joined(&[]), Err(CopyError::NoImage));
        let far = grey([i32::MAX, i32::MAX], 1, &[1]);
        let found = joined(&[grey([i32::MIN, 0], 1, &[1]), far]);
        assert!(matches!(found, Err(CopyError::Image(_))), "{found:?}");
    }
}
