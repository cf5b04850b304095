//! The entries of a table, from a histogram.

use crate::cut::{Boxes, Point};
use crate::entries::Entries;
use crate::heckbert::median_cut;
use crate::histogram::Histogram;
use crate::points::Points;
use crate::refine::refine;
use crate::spread::{MOST_ENTRIES, spread};
use crate::visibility::{in_lightness, of_size};
use crate::{Method, Metric, Options};

/// The colours of a histogram as places under a metric.
#[derive(Debug)]
pub(crate) struct Places {
    metric: Metric,
    is_visual: bool,
    opaque: Vec<Point<3>>,
    opaque_groups: Points<3>,
    translucent: Vec<Point<4>>,
    translucent_groups: Points<4>,
}

/// A table of at most `most` colours: those that are kept, one for alpha 0 where there is such a
/// pixel, those of translucent pixels, opaque ones. All colours exactly, where they fit.
pub(crate) fn choose<'a>(
    histogram: &Histogram,
    places: impl FnOnce() -> &'a Places,
    options: &Options,
    most: usize,
) -> Vec<[u8; 4]> {
    let keep = &options.keep;
    if let Some(colors) = histogram.distinct() {
        let others = colors.into_iter().filter(|color| !keep.contains(color));
        let table: Vec<[u8; 4]> = keep.iter().copied().chain(others).collect();
        if table.len() <= most {
            return table;
        }
    }
    let mut table = keep.clone();
    // An opaque pixel must have an opaque entry, so the one for alpha 0 comes second.
    let is_clear_kept = keep.iter().any(|color| color[3] == 0);
    if histogram.clear() && !is_clear_kept && most > table.len() + 1 {
        table.push([0; 4]);
    }
    let free = most - table.len();
    table.extend(match options.method {
        Method::Heckbert => median_cut(histogram, free),
        Method::Fast => places().variance_cut(options, free, 1),
        Method::Best => places().variance_cut(options, free, 10),
    });
    table
}

impl Places {
    pub(crate) fn new(histogram: &Histogram, options: &Options) -> Self {
        let (metric, is_visual) = (options.metric, options.is_visual());
        let (mut opaque, opaque_parents) = histogram.opaque_points(metric);
        let (mut translucent, translucent_parents) = histogram.translucent_points(metric);
        if is_visual {
            for point in &mut opaque {
                point.weight *= in_lightness(point.place[0]);
            }
            for point in &mut translucent {
                // Midway between black and white behind.
                point.weight *= in_lightness(point.place[0] + 127.5);
            }
        }
        let opaque_groups = Points::new(&opaque, &opaque_parents);
        let translucent_groups = Points::new(&translucent, &translucent_parents);
        Self { metric, is_visual, opaque, opaque_groups, translucent, translucent_groups }
    }

    /// At most `most` colours beside those of `keep`, by variance cut and rounds of k-means.
    /// Opaque and translucent pixels never share an entry, so that opaque ones stay opaque.
    fn variance_cut(&self, options: &Options, most: usize, rounds: usize) -> Vec<[u8; 4]> {
        let (metric, keep) = (self.metric, &options.keep);
        let kept_opaque = keep.iter().filter(|color| color[3] == u8::MAX);
        let kept_opaque: Vec<[f32; 3]> =
            kept_opaque.map(|&[red, green, blue, _]| metric.place([red, green, blue])).collect();
        let kept: Vec<[f32; 4]> =
            keep.iter().map(|&color| metric.place_with_alpha(color)).collect();

        let (mut opaque, mut translucent) =
            means(&mut self.opaque.clone(), &mut self.translucent.clone(), most);
        if self.is_visual {
            refine(&self.opaque_groups, &kept_opaque, &mut opaque, rounds, of_size);
            refine(&self.translucent_groups, &kept, &mut translucent, rounds, of_size);
        } else {
            refine(&self.opaque_groups, &kept_opaque, &mut opaque, rounds, |_| 1.0);
            refine(&self.translucent_groups, &kept, &mut translucent, rounds, |_| 1.0);
        }
        if options.spread && (1..=MOST_ENTRIES).contains(&(kept_opaque.len() + opaque.len())) {
            let gamut = |place| metric.place(metric.color(place));
            spread(&self.opaque_groups, &kept_opaque, &mut opaque, gamut);
        }

        let translucent = translucent.into_iter().map(|place| metric.color_with_alpha(place));
        let opaque = opaque.into_iter().map(|place| {
            let [red, green, blue] = metric.color(place);
            [red, green, blue, u8::MAX]
        });
        translucent.chain(opaque).collect()
    }

    /// The index of the opaque entry nearest to each opaque colour or cell of the histogram.
    pub(crate) fn opaque_indices(&self, entries: &Entries<3>) -> Vec<u8> {
        self.opaque_groups.nearest(entries)
    }
}

/// Means of at most `most` boxes of both kinds of points; the largest gain decides of which kind
/// the next box is cut, as squares mean the same in both spaces.
fn means(
    opaque: &mut [Point<3>],
    translucent: &mut [Point<4>],
    most: usize,
) -> (Vec<[f32; 3]>, Vec<[f32; 4]>) {
    let mut opaque = Boxes::new(if most > 0 { opaque } else { &mut [] });
    let mut translucent = Boxes::new(if most > opaque.len() { translucent } else { &mut [] });
    while opaque.len() + translucent.len() < most {
        let left = most - opaque.len() - translucent.len();
        let (gain, other) = (opaque.gain(), translucent.gain());
        if gain.max(other) <= 0.0 {
            break;
        }
        if gain >= other { opaque.cut(left) } else { translucent.cut(left) }
    }
    (opaque.means(), translucent.means())
}
