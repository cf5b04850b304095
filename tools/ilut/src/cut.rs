//! Points cut into boxes where the sum of squared distances to the boxes' means falls most.
//!
//! One box is cut after the other, but how a box is cut depends on it alone: so the halves of
//! several are found at once, those that will most likely come next. How many does not depend on
//! the number of threads, nor in which order sums are added; so the boxes do not either.

use rayon::prelude::*;

/// A weighted place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point<const D: usize> {
    pub(crate) place: [f32; D],
    pub(crate) weight: f32,
}

/// Points cut into boxes.
#[derive(Debug)]
pub(crate) struct Boxes<'a, const D: usize> {
    points: &'a mut [Point<D>],
    boxes: Vec<Part>,
}

/// A run of points, and where to cut it next.
#[derive(Debug)]
struct Part {
    start: usize,
    end: usize,
    /// How much the sum of squares falls by the best cut; 0 where there is none.
    gain: f32,
    axis: usize,
    /// Points below it go to the first half.
    at: f32,
    /// Its halves, where they are known already.
    halves: Option<Box<[Self; 2]>>,
}

/// Weight and weighted sum of points, about a middle.
#[derive(Clone, Copy)]
struct Moment<const D: usize> {
    weight: f32,
    sum: [f32; D],
}

/// Places where an axis can be cut, plus one.
const BUCKETS: usize = 32;

/// Boxes whose halves are found together. The last ones of them may be found in vain.
const AHEAD: usize = 16;

/// More boxes are taken together as long as their gains are at least this share of the largest:
/// those come soon, whatever their halves are like.
const SOON: f32 = 0.25;

/// Levels of halves of the first box that are found together.
const LEVELS: usize = 4;

/// Points up to which one thread does all: to wake another takes as long.
const ALONE: usize = 1 << 10;

/// Points that one thread sums up at a time.
const SLICE: usize = 1 << 14;

impl<'a, const D: usize> Boxes<'a, D> {
    /// All points in one box; none where there are no points.
    pub(crate) fn new(points: &'a mut [Point<D>]) -> Self {
        let boxes = if points.is_empty() { Vec::new() } else { vec![part(points, 0)] };
        Self { points, boxes }
    }

    /// Number of boxes.
    pub(crate) fn len(&self) -> usize {
        self.boxes.len()
    }

    /// How much the sum of squares falls by the next cut; 0 where none is left.
    pub(crate) fn gain(&self) -> f32 {
        self.boxes.iter().fold(0.0, |most, part| if part.gain > most { part.gain } else { most })
    }

    /// Cuts the box of the largest gain, the first of several. At most `left` cuts are to come,
    /// with this one.
    pub(crate) fn cut(&mut self, left: usize) {
        let mut widest = 0;
        for (at, part) in self.boxes.iter().enumerate() {
            if part.gain > self.boxes[widest].gain {
                widest = at;
            }
        }
        if self.boxes.get(widest).is_some_and(|part| part.halves.is_none()) {
            self.halve(left);
        }
        let Some(part) = self.boxes.get_mut(widest) else { return };
        if let Some(halves) = part.halves.take() {
            let [low, high] = *halves;
            *part = low;
            self.boxes.push(high);
        }
    }

    /// Finds the halves of the boxes of the largest gains whose halves are not known. At most
    /// `left` cuts are to come.
    fn halve(&mut self, left: usize) {
        if let [whole] = &mut self.boxes[..]
            && self.points.len() > ALONE
            && left >= 1 << LEVELS
        {
            return whole.halve(self.points, LEVELS);
        }
        let mut open: Vec<&mut Part> = self.boxes.iter_mut().collect();
        open.retain(|part| part.gain > 0.0 && part.halves.is_none());
        // Of equal gains the first stays first.
        open.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let most = open.first().map_or(0.0, |part| part.gain);
        let soon = open.partition_point(|part| part.gain >= SOON * most);
        open.truncate(soon.min(left / 2).max(AHEAD).min(left));
        open.sort_unstable_by_key(|part| part.start);
        let (mut rest, mut start) = (&mut *self.points, 0);
        let mut work = Vec::with_capacity(open.len());
        for part in open {
            let (before, others) = rest.split_at_mut(part.end - start);
            rest = others;
            let points = &mut before[part.start - start..];
            start = part.end;
            work.push((part, points));
        }
        let points: usize = work.iter().map(|(part, _)| part.end - part.start).sum();
        if points > ALONE {
            work.into_par_iter().with_max_len(1).for_each(|(part, points)| part.halve(points, 1));
        } else {
            work.into_iter().for_each(|(part, points)| part.halve(points, 1));
        }
    }

    /// Means of the boxes.
    pub(crate) fn means(&self) -> Vec<[f32; D]> {
        let points = &self.points;
        let mean = |part: &Part| mean(&points[part.start..part.end]);
        if points.len() > ALONE {
            self.boxes.par_iter().map(mean).collect()
        } else {
            self.boxes.iter().map(mean).collect()
        }
    }
}

impl Part {
    /// Finds the halves, and theirs, for so many `levels`. Where rounding leaves one of them empty,
    /// there is nothing to gain.
    fn halve<const D: usize>(&mut self, points: &mut [Point<D>], levels: usize) {
        let middle = partition(points, self.axis, self.at);
        if middle == 0 || middle == points.len() {
            self.gain = 0.0;
            return;
        }
        let is_large = points.len() > ALONE;
        let start = self.start;
        let (low, high) = points.split_at_mut(middle);
        let of = |points: &mut [Point<D>], start| {
            let mut part = part(points, start);
            if levels > 1 && part.gain > 0.0 {
                part.halve(points, levels - 1);
            }
            part
        };
        let (low, high) = if is_large {
            rayon::join(|| of(low, start), || of(high, start + middle))
        } else {
            (of(low, start), of(high, start + middle))
        };
        self.halves = Some(Box::new([low, high]));
    }
}

/// Moves the points below `at` to the front, and counts them. Every point is written, as to guess
/// wrong which ones move takes longer.
fn partition<const D: usize>(points: &mut [Point<D>], axis: usize, at: f32) -> usize {
    let mut low = 0;
    for next in 0..points.len() {
        points.swap(low, next);
        low += usize::from(points[low].place[axis] < at);
    }
    low
}

#[expect(clippy::cast_possible_truncation, reason = "a mean is in the range of its points")]
pub(crate) fn mean<const D: usize>(points: &[Point<D>]) -> [f32; D] {
    let mut weight = 0.0;
    let mut sum = [0.0; D];
    for point in points {
        weight += f64::from(point.weight);
        for (sum, coordinate) in sum.iter_mut().zip(point.place) {
            *sum += f64::from(point.weight) * f64::from(coordinate);
        }
    }
    sum.map(|sum| (sum / weight) as f32)
}

/// A box of `points` that begins at `start`, with its best cut.
#[expect(clippy::cast_precision_loss, reason = "small numbers")]
fn part<const D: usize>(points: &[Point<D>], start: usize) -> Part {
    let end = start + points.len();
    let mut part = Part { start, end, gain: 0.0, axis: 0, at: 0.0, halves: None };
    if points.len() < 2 {
        return part;
    }
    let [low, high] = bounds(points);
    // Just below the number of buckets: the highest point falls into the last.
    let scale: [f32; D] = std::array::from_fn(|axis| {
        let side = high[axis] - low[axis];
        if side > 0.0 { (BUCKETS as f32 - 0.01) / side } else { 0.0 }
    });
    let buckets = buckets(points, low, high, scale);
    let total = buckets[0].iter().fold(Moment::ZERO, |sum, bucket| sum.plus(bucket));
    let whole = total.explained();
    for (axis, buckets) in buckets.iter().enumerate().filter(|(axis, _)| scale[*axis] > 0.0) {
        let mut below = Moment::ZERO;
        for (at, bucket) in buckets[..BUCKETS - 1].iter().enumerate() {
            if bucket.weight > 0.0 {
                below = below.plus(bucket);
                let gain = below.explained() + total.minus(&below).explained() - whole;
                if gain > part.gain {
                    let at = low[axis] + (at + 1) as f32 / scale[axis];
                    part = Part { gain, axis, at, ..part };
                }
            }
        }
    }
    part
}

/// Least and most of each coordinate.
fn bounds<const D: usize>(points: &[Point<D>]) -> [[f32; D]; 2] {
    /// Points beside each other, so that none waits for the last one.
    const LANES: usize = 4;
    if points.len() > SLICE {
        let slices: Vec<_> = points.par_chunks(SLICE).map(bounds).collect();
        return slices.into_iter().fold(nowhere(), wider);
    }
    let (rows, last) = points.as_chunks::<LANES>();
    let mut lanes = [nowhere(); LANES];
    for row in rows {
        for (lane, point) in lanes.iter_mut().zip(row) {
            *lane = wider(*lane, [point.place; 2]);
        }
    }
    let whole = lanes.into_iter().fold(nowhere(), wider);
    last.iter().fold(whole, |bounds, point| wider(bounds, [point.place; 2]))
}

/// Bounds of no points.
fn nowhere<const D: usize>() -> [[f32; D]; 2] {
    [[f32::MAX; D], [f32::MIN; D]]
}

/// Bounds of what two have.
#[inline(always)]
fn wider<const D: usize>(a: [[f32; D]; 2], b: [[f32; D]; 2]) -> [[f32; D]; 2] {
    let least = |axis: usize| if a[0][axis] < b[0][axis] { a[0][axis] } else { b[0][axis] };
    let most = |axis: usize| if a[1][axis] > b[1][axis] { a[1][axis] } else { b[1][axis] };
    [std::array::from_fn(least), std::array::from_fn(most)]
}

/// Moments of equal slices along each axis. They are about the middle of the box, so that the
/// differences of large sums that a gain is keep their bits.
fn buckets<const D: usize>(
    points: &[Point<D>],
    low: [f32; D],
    high: [f32; D],
    scale: [f32; D],
) -> [[Moment<D>; BUCKETS]; D] {
    let middle: [f32; D] = std::array::from_fn(|axis| 0.5 * (low[axis] + high[axis]));
    if points.len() <= SLICE {
        return buckets_of(points, low, middle, scale);
    }
    let slices = points.par_chunks(SLICE).map(|points| buckets_of(points, low, middle, scale));
    let slices: Vec<_> = slices.collect();
    let mut sums = [[Moment::ZERO; BUCKETS]; D];
    for slice in &slices {
        add(&mut sums, slice);
    }
    sums
}

/// As [`buckets`], on one thread.
///
/// Neighbours mostly fall into the same bucket, and an addition there waits for the last one: so
/// two sets take turns.
fn buckets_of<const D: usize>(
    points: &[Point<D>],
    low: [f32; D],
    middle: [f32; D],
    scale: [f32; D],
) -> [[Moment<D>; BUCKETS]; D] {
    let count = |buckets: &mut [[Moment<D>; BUCKETS]; D], point: &Point<D>| {
        let slices: [f32; D] =
            std::array::from_fn(|axis| (point.place[axis] - low[axis]) * scale[axis]);
        let weight = point.weight;
        let sum = std::array::from_fn(|axis| weight * (point.place[axis] - middle[axis]));
        let moment = Moment { weight, sum };
        for (buckets, slice) in buckets.iter_mut().zip(slices.map(whole)) {
            let bucket = &mut buckets[slice % BUCKETS];
            *bucket = bucket.plus(&moment);
        }
    };
    let mut sums = [[Moment::ZERO; BUCKETS]; D];
    let mut others = sums;
    let (pairs, last) = points.as_chunks::<2>();
    for [one, other] in pairs {
        count(&mut sums, one);
        count(&mut others, other);
    }
    last.iter().for_each(|point| count(&mut sums, point));
    add(&mut sums, &others);
    sums
}

/// The whole part of a number of 0 or more.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and the number of buckets"
)]
fn whole(value: f32) -> usize {
    // To i32 it is one instruction.
    (value as i32) as usize
}

fn add<const D: usize>(sums: &mut [[Moment<D>; BUCKETS]; D], more: &[[Moment<D>; BUCKETS]; D]) {
    for (sum, more) in sums.as_flattened_mut().iter_mut().zip(more.as_flattened()) {
        *sum = sum.plus(more);
    }
}

impl<const D: usize> Moment<D> {
    const ZERO: Self = Self { weight: 0.0, sum: [0.0; D] };

    fn plus(&self, other: &Self) -> Self {
        let sum = std::array::from_fn(|axis| self.sum[axis] + other.sum[axis]);
        Self { weight: self.weight + other.weight, sum }
    }

    fn minus(&self, other: &Self) -> Self {
        let sum = std::array::from_fn(|axis| self.sum[axis] - other.sum[axis]);
        Self { weight: self.weight - other.weight, sum }
    }

    /// What the mean takes off the sum of squares; 0 where there is no weight.
    fn explained(&self) -> f32 {
        let squares = self.sum.iter().map(|sum| sum * sum).sum::<f32>();
        if self.weight > 0.0 { squares / self.weight } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(points: &[Point<2>]) -> f64 {
        let weight: f64 = points.iter().map(|point| f64::from(point.weight)).sum();
        let squares = (0..2).map(|axis| {
            let at = |point: &Point<2>| f64::from(point.place[axis]);
            let weighted = points.iter().map(|point| f64::from(point.weight) * at(point));
            let mean = weighted.sum::<f64>() / weight;
            let off = |point: &Point<2>| at(point) - mean;
            points.iter().map(|p| f64::from(p.weight) * off(p) * off(p)).sum::<f64>()
        });
        squares.sum()
    }

    /// Points on a grid of 32 steps, which the buckets part exactly.
    fn points(seed: u32) -> Vec<Point<2>> {
        let mut state = seed;
        let mut next = |most: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) % most
        };
        let corners = [[0.0, 0.0], [31.0, 31.0]];
        let corners = corners.map(|place| Point { place, weight: 1.0 });
        let others = (0..60).map(|_| Point {
            place: [next(32) as f32, (next(32) * next(32) / 31) as f32],
            weight: 1.0 + next(5) as f32,
        });
        corners.into_iter().chain(others.collect::<Vec<_>>()).collect()
    }

    #[test]
    fn the_first_cut_is_the_best_of_all() {
        for seed in 0..20 {
            let mut points = points(seed);
            let whole = error(&points);
            let mut best: f64 = 0.0;
            for axis in 0..2 {
                for plane in 1..32_u8 {
                    let (low, high): (Vec<_>, Vec<_>) =
                        points.iter().partition(|p| p.place[axis] < f32::from(plane));
                    if !low.is_empty() && !high.is_empty() {
                        best = best.max(whole - error(&low) - error(&high));
                    }
                }
            }
            let mut boxes = Boxes::new(&mut points);
            assert!((f64::from(boxes.gain()) - best).abs() < 1e-3 * best, "seed {seed}");
            boxes.cut(1);
            let ends = boxes.boxes.iter().map(|part| part.start..part.end).collect::<Vec<_>>();
            let left: f64 = ends.into_iter().map(|range| error(&points[range])).sum();
            assert!((whole - left - best).abs() < 1e-3 * best, "seed {seed}");
        }
    }

    #[test]
    fn boxes_are_cut_until_each_has_one_place() {
        let mut points = points(3);
        points.extend(points.clone());
        let mut places: Vec<[f32; 2]> = points.iter().map(|point| point.place).collect();
        places.sort_by(|a, b| a.partial_cmp(b).unwrap());
        places.dedup();
        let mut boxes = Boxes::new(&mut points);
        while boxes.gain() > 0.0 {
            boxes.cut(places.len());
        }
        let mut means = boxes.means();
        means.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(means, places);
        assert_eq!(Boxes::<3>::new(&mut []).means(), Vec::<[f32; 3]>::new());
    }
}
