//! `Histogram`: the colours of pictures, one by one where they are few, else by cells.

use std::ops::Range;

use rayon::prelude::*;

use crate::cells::{Cell, Cells, occupied};
use crate::cut::Point;
use crate::key;
use crate::translucent::Translucent;
use crate::unique::{Counted, counted};
use crate::visibility::Flatness;
use crate::{Metric, Pixels, oklab};

/// The colours of pictures.
#[derive(Debug)]
pub(crate) struct Histogram {
    opaque: Opaque,
    /// Colours of alpha 1 to 254, ascending; or groups of them, where they are many.
    translucent: Vec<([u8; 4], u32)>,
    /// Whether there are pixels of alpha 0.
    clear: bool,
}

/// Opaque colours, ascending by key.
#[derive(Debug)]
enum Opaque {
    Colors(Vec<(u32, u32)>),
    Cells(Vec<Cell>),
}

/// Pixels that one thread counts by itself: a table of cells has as many bytes, so that making
/// and merging it costs little.
const SHARE: usize = 1 << 19;

impl Histogram {
    /// Counts the colours of `pictures`, one by one if they are at most `most`; pixels as often as
    /// errors in them are seen (see [`Flatness`]), or once.
    pub(crate) fn new(pictures: &[&Pixels], most: usize, is_visual: bool) -> Self {
        match counted(pictures, most, is_visual) {
            Some(Counted { opaque, translucent, clear }) => {
                Self { opaque: Opaque::Colors(opaque), translucent, clear }
            }
            None => Self::of_cells(pictures, is_visual),
        }
    }

    fn of_cells(pictures: &[&Pixels], is_visual: bool) -> Self {
        let pixels: usize = pictures.iter().map(|picture| picture.colors().len()).sum();
        let shares = rayon::current_num_threads().min(pixels.div_ceil(SHARE)).max(1);
        let pieces = pieces(pictures, pixels.div_ceil(shares));
        let counted = pieces.into_par_iter().map(|pieces| {
            let (mut cells, mut translucent) = (Cells::new(), Translucent::default());
            let mut flatness = Flatness::default();
            for (picture, rows) in pieces {
                let columns = picture.columns() as usize;
                let colors = &picture.colors()[columns * rows.start..columns * rows.end];
                if is_visual {
                    for (row, colors) in rows.zip(colors.chunks_exact(columns)) {
                        let times = flatness.row(picture, row);
                        cells.add_weighted(colors, times, |color, times| {
                            translucent.add(color, times);
                        });
                    }
                } else if picture.is_opaque() {
                    cells.add_opaque(colors);
                } else {
                    cells.add(colors, |color| translucent.add(color, 1));
                }
            }
            (cells, translucent)
        });
        // Sums of integers: however they are shared out, they are the same.
        let (shares, others): (Vec<Cells>, Vec<Translucent>) =
            counted.collect::<Vec<_>>().into_iter().unzip();
        let mut translucent = Translucent::default();
        others.iter().for_each(|more| translucent.merge(more));
        let clear = translucent.clear();
        Self { opaque: Opaque::Cells(occupied(&shares)), translucent: translucent.sorted(), clear }
    }

    /// Whether there are pixels of alpha 0.
    pub(crate) fn clear(&self) -> bool {
        self.clear
    }

    /// All distinct colours, ascending by bytes but for those of alpha 0, which come first; nothing
    /// where they were not counted one by one.
    pub(crate) fn distinct(&self) -> Option<Vec<[u8; 4]>> {
        let Opaque::Colors(opaque) = &self.opaque else { return None };
        let clear = self.clear.then_some([0; 4]);
        let translucent = self.translucent.iter().map(|(color, _)| *color);
        let mut opaque: Vec<[u8; 4]> = opaque.iter().map(|(key, _)| color(*key)).collect();
        opaque.sort_unstable();
        Some(clear.into_iter().chain(translucent).chain(opaque).collect())
    }

    /// Keys of the cells that have opaque colours, ascending.
    pub(crate) fn cells(&self) -> Vec<u32> {
        match &self.opaque {
            Opaque::Cells(cells) => cells.iter().map(|cell| cell.key).collect(),
            Opaque::Colors(colors) => {
                let mut keys: Vec<u32> = colors.iter().map(|(key, _)| key::cell(*key)).collect();
                keys.dedup();
                keys
            }
        }
    }

    /// Tells opaque colours, or one of each cell, with their counts. All colours of a cell have the
    /// same six high bits in each channel.
    pub(crate) fn each_opaque(&self, mut tell: impl FnMut([u8; 3], u64)) {
        match &self.opaque {
            Opaque::Cells(cells) => {
                cells.iter().for_each(|cell| tell(key::base(cell.key), cell.count));
            }
            Opaque::Colors(colors) => {
                colors.iter().for_each(|&(key, times)| tell(key::color(key), u64::from(times)));
            }
        }
    }

    /// Colours of alpha 1 to 254, or the middles of groups of them, with their counts.
    pub(crate) fn translucent(&self) -> &[([u8; 4], u32)] {
        &self.translucent
    }

    /// Opaque colours as places, with the parents of their keys.
    pub(crate) fn opaque_points(&self, metric: Metric) -> (Vec<Point<3>>, Vec<u32>) {
        match &self.opaque {
            Opaque::Cells(cells) => {
                let points = points(cells, |cell| (cell.mean, cell.count as f32), metric);
                (points, cells.par_iter().map(|cell| key::parent(cell.key)).collect())
            }
            Opaque::Colors(colors) => key_points(colors, metric),
        }
    }

    /// Colours of alpha 1 to 254 as places, with the high bits of their bytes.
    pub(crate) fn translucent_points(&self, metric: Metric) -> (Vec<Point<4>>, Vec<u32>) {
        let parent = |color: [u8; 4]| u32::from_be_bytes(color.map(|byte| byte & 0xf0));
        let mut colors = self.translucent.clone();
        colors.sort_by_key(|&(color, _)| (parent(color), color));
        let point = |&(color, times): &([u8; 4], u32)| Point {
            place: metric.place_with_alpha(color),
            weight: times as f32,
        };
        let parents = colors.iter().map(|&(color, _)| parent(color)).collect();
        (colors.iter().map(point).collect(), parents)
    }
}

/// Colours that one thread converts at a time.
const CHUNK: usize = 4096;

/// Colours by their keys, with counts, as places, with the parents of their keys.
pub(crate) fn key_points(colors: &[(u32, u32)], metric: Metric) -> (Vec<Point<3>>, Vec<u32>) {
    let point = |&(key, times): &(u32, u32)| (key::color(key).map(f32::from), times as f32);
    let parents = colors.par_iter().map(|(key, _)| key::parent(key::cell(*key)));
    (points(colors, point, metric), parents.collect())
}

/// Places of colours that have display values and weights.
fn points<T: Sync>(
    colors: &[T],
    color: impl Fn(&T) -> ([f32; 3], f32) + Sync,
    metric: Metric,
) -> Vec<Point<3>> {
    let mut points = vec![Point { place: [0.0; 3], weight: 0.0 }; colors.len()];
    let chunks = points.par_chunks_mut(CHUNK).zip(colors.par_chunks(CHUNK));
    chunks.for_each(|(points, colors)| {
        for (point, one) in points.iter_mut().zip(colors) {
            (point.place, point.weight) = color(one);
        }
        if metric == Metric::Oklab {
            let mut places: Vec<[f32; 3]> = points.iter().map(|point| point.place).collect();
            oklab::convert(&mut places);
            points.iter_mut().zip(places).for_each(|(point, place)| point.place = place);
        }
    });
    points
}

fn color(key: u32) -> [u8; 4] {
    let [red, green, blue] = key::color(key);
    [red, green, blue, u8::MAX]
}

/// Rows of a picture.
pub(crate) type Piece<'a> = (&'a Pixels, Range<usize>);

/// Shares of about `most` pixels, in whole rows.
pub(crate) fn pieces<'a>(pictures: &[&'a Pixels], most: usize) -> Vec<Vec<Piece<'a>>> {
    let mut shares = vec![Vec::new()];
    let mut left = most;
    for picture in pictures {
        let (columns, end) = (picture.columns() as usize, picture.rows() as usize);
        let mut row = 0;
        while row < end {
            if left == 0 {
                shares.push(Vec::new());
                left = most;
            }
            let rows = left.div_ceil(columns).min(end - row);
            let share = shares.last_mut().expect("there is one from the start");
            share.push((*picture, row..row + rows));
            left = left.saturating_sub(columns * rows);
            row += rows;
        }
    }
    shares
}
