//! A picture that tiles: opposite edges meet.

use idf::{Image, Samples};

use crate::CopyError;
use crate::mix::remixed;

/// The picture with edges that meet when it is repeated.
///
/// First across, then down, it is mixed with itself shifted by half its length, whose seam is in
/// the middle and whose ends are neighbours: at an edge all is the shifted picture, from a quarter
/// of the length on all is the picture itself, and between it is a smooth step, in linear light
/// multiplied by coverage. Indices and measured values are taken from the picture that has more
/// weight.
pub(crate) fn seamless(image: &Image) -> Result<Image, CopyError> {
    let [columns, rows] = image.size().map(|length| length as usize);
    let position = |at: usize| {
        let column = source(at % columns, columns);
        source(at / columns, rows) * columns + column
    };
    let pick = |samples: &Samples| samples.gathered((0..columns * rows).map(position));
    remixed(image, image.size(), |values| blended(values, columns, rows), pick)
}

fn blended(values: &[f32], columns: usize, rows: usize) -> Vec<f32> {
    let shares: Vec<f32> = (0..columns).map(|column| share(column, columns)).collect();
    let mut across = Vec::with_capacity(values.len());
    for row in values.chunks_exact(columns) {
        across.extend(
            (0..columns)
                .map(|column| mix(row[column], row[opposite(column, columns)], shares[column])),
        );
    }
    let mut both = Vec::with_capacity(values.len());
    for row in 0..rows {
        let share = share(row, rows);
        let line = |row: usize| &across[row * columns..(row + 1) * columns];
        let pairs = line(row).iter().zip(line(opposite(row, rows)));
        both.extend(pairs.map(|(&here, &there)| mix(here, there, share)));
    }
    both
}

fn mix(here: f32, there: f32, share: f32) -> f32 {
    share * here + (1.0 - share) * there
}

/// Half the length further on, around the end.
fn opposite(at: usize, length: usize) -> usize {
    (at + length / 2) % length
}

/// The pixel that weighs more.
fn source(at: usize, length: usize) -> usize {
    if share(at, length) < 0.5 { opposite(at, length) } else { at }
}

/// Weight of the picture itself: 0 at the edges, 1 from a quarter of the length on.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "its error is far below that of a sample"
)]
fn share(at: usize, length: usize) -> f32 {
    let quarter = (length as f64 / 4.0).max(1.0);
    let t = (at.min(length - 1 - at) as f64 / quarter).min(1.0);
    (t * t * (3.0 - 2.0 * t)) as f32
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these pixels are taken as they are, not mixed")]
mod tests {
    use super::*;
    use idf::{Kind, Plane};

    fn grey(columns: u32, values: &[f32]) -> Image {
        let rows = u32::try_from(values.len()).unwrap() / columns;
        let plane = Plane { kind: Kind::Grg, samples: Samples::F32(values.into()) };
        Image::new(columns, rows, vec![plane]).unwrap()
    }

    fn floats(image: &Image) -> Vec<f32> {
        image.decoded(Kind::Grg).unwrap()
    }

    #[test]
    fn opposite_edges_are_neighbours_of_the_original() {
        for (columns, rows) in [(16_u32, 9_u32), (5, 4), (33, 12)] {
            let (c, r) = (columns as usize, rows as usize);
            let value = |column: usize, row: usize| {
                f32::from(u16::try_from(column * column * 3 + row * 7).unwrap())
            };
            let values: Vec<f32> = (0..c * r).map(|at| value(at % c, at / c)).collect();
            let found = floats(&seamless(&grey(columns, &values)).unwrap());
            // Away from the top and bottom, an edge is the middle of the row.
            let middle = r / 2;
            let line = &found[middle * c..(middle + 1) * c];
            if share(middle, r) >= 1.0 {
                let expected = [c / 2, c / 2, c / 2 - 1].map(|column| value(column, middle));
                assert_eq!([line[0], line[c / 2], line[c - 1]], expected);
            }
            // In a corner, the middle of all.
            let expected = [value(c / 2, r / 2), value(c / 2 - 1, r / 2 - 1)];
            assert_eq!([found[0], found[c * r - 1]], expected);
        }
    }

    #[test]
    fn a_ramp_has_no_step_larger_than_the_blend_needs() {
        let columns = 64_u8;
        let values: Vec<f32> = (0..columns).map(f32::from).collect();
        let found = floats(&seamless(&grey(columns.into(), &values)).unwrap());
        let around = found.iter().zip(found.iter().cycle().skip(1));
        let most = around.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        // Half the ramp within a quarter of it, at most 3/2 as steep as evenly: 32 / 16 · 1.5 + 1.
        assert!(most <= 4.0, "{most}");
        // The ramp itself steps by 63 where it is repeated.
        assert_eq!([found[63], found[0]], [31.0, 32.0]);
    }

    #[test]
    fn a_level_stays_and_one_pixel_too() {
        assert_eq!(floats(&seamless(&grey(4, &[0.5; 12])).unwrap()), [0.5; 12]);
        assert_eq!(floats(&seamless(&grey(1, &[0.25])).unwrap()), [0.25]);
    }
}
