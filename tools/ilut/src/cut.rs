//! Points cut into boxes where the sum of squared distances to the boxes' means falls most.

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
#[derive(Clone, Copy, Debug)]
struct Part {
    start: usize,
    end: usize,
    /// How much the sum of squares falls by the best cut; 0 where there is none.
    gain: f32,
    axis: usize,
    /// Points below it go to the first half.
    at: f32,
}

/// Weight and weighted sum of points, about a middle.
#[derive(Clone, Copy)]
struct Moment<const D: usize> {
    weight: f32,
    sum: [f32; D],
}

/// Places where an axis can be cut, plus one.
const BUCKETS: usize = 32;

/// Points of a box up to which its halves are done one after the other: to wake a thread takes as
/// long.
const ALONE: usize = 1 << 12;

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

    /// Cuts the box of the largest gain, the first of several.
    pub(crate) fn cut(&mut self) {
        let mut widest = 0;
        for (at, part) in self.boxes.iter().enumerate() {
            if part.gain > self.boxes[widest].gain {
                widest = at;
            }
        }
        let Some(&Part { start, end, axis, at, .. }) = self.boxes.get(widest) else { return };
        let middle = start + partition(&mut self.points[start..end], axis, at);
        if middle == start || middle == end {
            self.boxes[widest].gain = 0.0;
            return;
        }
        let (low, high) = self.points[start..end].split_at(middle - start);
        let (low, high) = if end - start > ALONE {
            rayon::join(|| part(low, start), || part(high, middle))
        } else {
            (part(low, start), part(high, middle))
        };
        self.boxes[widest] = low;
        self.boxes.push(high);
    }

    /// Means of the boxes.
    pub(crate) fn means(&self) -> Vec<[f32; D]> {
        self.boxes.iter().map(|part| mean(&self.points[part.start..part.end])).collect()
    }
}

/// Moves the points below `at` to the front, and counts them.
fn partition<const D: usize>(points: &mut [Point<D>], axis: usize, at: f32) -> usize {
    let (mut low, mut high) = (0, points.len());
    while low < high {
        if points[low].place[axis] < at {
            low += 1;
        } else {
            high -= 1;
            points.swap(low, high);
        }
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
    let mut part = Part { start, end: start + points.len(), gain: 0.0, axis: 0, at: 0.0 };
    if points.len() < 2 {
        return part;
    }
    let (low, high) = bounds(points);
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

fn bounds<const D: usize>(points: &[Point<D>]) -> ([f32; D], [f32; D]) {
    let (mut low, mut high) = ([f32::MAX; D], [f32::MIN; D]);
    for point in points {
        for axis in 0..D {
            let coordinate = point.place[axis];
            low[axis] = if coordinate < low[axis] { coordinate } else { low[axis] };
            high[axis] = if coordinate > high[axis] { coordinate } else { high[axis] };
        }
    }
    (low, high)
}

/// Moments of equal slices along each axis. They are about the middle of the box, so that the
/// differences of large sums that a gain is keep their bits.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and the number of buckets"
)]
fn buckets<const D: usize>(
    points: &[Point<D>],
    low: [f32; D],
    high: [f32; D],
    scale: [f32; D],
) -> [[Moment<D>; BUCKETS]; D] {
    let mut buckets = [[Moment::ZERO; BUCKETS]; D];
    let middle: [f32; D] = std::array::from_fn(|axis| 0.5 * (low[axis] + high[axis]));
    for point in points {
        let weight = point.weight;
        let sum = std::array::from_fn(|axis| weight * (point.place[axis] - middle[axis]));
        let moment = Moment { weight, sum };
        for axis in 0..D {
            let slice = (point.place[axis] - low[axis]) * scale[axis];
            let bucket = &mut buckets[axis][slice as usize % BUCKETS];
            *bucket = bucket.plus(&moment);
        }
    }
    buckets
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
            boxes.cut();
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
            boxes.cut();
        }
        let mut means = boxes.means();
        means.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(means, places);
        assert_eq!(Boxes::<3>::new(&mut []).means(), Vec::<[f32; 3]>::new());
    }
}
