//! Places of table entries, and which of them can be nearest to any place in a ball.

use idf::Lut;

/// Places of up to 256 table entries, axis by axis, padded with places beyond all others.
#[derive(Clone, Debug)]
pub(crate) struct Entries<const D: usize> {
    axes: [[f32; Lut::MOST]; D],
    /// Index in the table of each entry, ascending.
    indices: [u8; Lut::MOST],
    len: usize,
}

/// A place and how far from it things lie.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball<const D: usize> {
    pub(crate) centre: [f32; D],
    pub(crate) radius: f32,
}

/// As many places as are searched for at once, axis by axis.
pub(crate) type Lanes<const D: usize> = [[f32; LANES]; D];

/// One register of AVX2, two of SSE2. With 16 lanes SSE2 runs out of registers, and a round takes
/// half as long again.
pub(crate) const LANES: usize = 8;

/// Farther from any colour than any other colour, and its square far from the largest `f32`.
const BEYOND: f32 = 1e9;

/// Rounding of a distance in `f32` is below 1e-6 of it; these leave a hundred times of that.
const SLACK: [f32; 2] = [1.0001, 1e-3];

impl<const D: usize> Entries<D> {
    pub(crate) const EMPTY: Self =
        Self { axes: [[BEYOND; Lut::MOST]; D], indices: [0; Lut::MOST], len: 0 };

    /// The first 256 of `places`, with their indices.
    pub(crate) fn new(places: impl IntoIterator<Item = (u8, [f32; D])>) -> Self {
        let mut entries = Self::EMPTY;
        for (index, place) in places.into_iter().take(Lut::MOST) {
            for (axis, coordinate) in entries.axes.iter_mut().zip(place) {
                axis[entries.len] = coordinate;
            }
            entries.indices[entries.len] = index;
            entries.len += 1;
        }
        entries
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Indices of the entries.
    pub(crate) fn indices(&self) -> &[u8] {
        &self.indices[..self.len]
    }

    /// Index of the nearest entry, the lowest where several are.
    pub(crate) fn nearest(&self, place: [f32; D]) -> u8 {
        let mut best = (f32::MAX, 0);
        for (at, &index) in self.indices().iter().enumerate() {
            let squares = square(column(&self.axes, at), place);
            if squares < best.0 {
                best = (squares, index);
            }
        }
        best.1
    }

    /// Position of the entry nearest to each of `places`, the first where several are, and the
    /// squared distance. The kernel of everything: rounds, maps and tables of cells.
    #[inline(always)]
    pub(crate) fn nearest_lanes(&self, places: &Lanes<D>) -> ([u32; LANES], [f32; LANES]) {
        let mut best = [f32::MAX; LANES];
        let mut positions = [0; LANES];
        for (at, position) in (0..self.len).zip(0_u32..) {
            let entry = column(&self.axes, at);
            for lane in 0..LANES {
                let squares = square(entry, column(places, lane));
                let nearer = squares < best[lane];
                best[lane] = if nearer { squares } else { best[lane] };
                positions[lane] = if nearer { position } else { positions[lane] };
            }
        }
        (positions, best)
    }

    /// Keeps in `near` the entries that are nearest to some place in `ball`.
    ///
    /// If `d` is the distance of the entry nearest to the centre, every place in the ball has an
    /// entry within `d + radius`, and an entry beyond `d + 2 radius` from the centre is farther.
    pub(crate) fn within(&self, ball: &Ball<D>, near: &mut Self) {
        let mut squares = [f32::MAX; Lut::MOST];
        let padded = self.len.next_multiple_of(LANES);
        let mut least = [f32::MAX; LANES];
        for start in (0..padded).step_by(LANES) {
            for (lane, least) in least.iter_mut().enumerate() {
                let distance = square(column(&self.axes, start + lane), ball.centre);
                squares[start + lane] = distance;
                *least = if distance < *least { distance } else { *least };
            }
        }
        let least = least.iter().fold(f32::MAX, |least, &d| if d < least { d } else { least });
        let limit = (least.sqrt() + 2.0 * ball.radius) * SLACK[0] + SLACK[1];
        let limit = limit * limit;
        near.clear();
        for (start, group) in (0..).step_by(8).zip(squares[..padded].chunks_exact(8)) {
            if group.iter().fold(false, |any, &square| any | (square <= limit)) {
                for (at, &square) in (start..).zip(group) {
                    if square <= limit {
                        near.push(self, at);
                    }
                }
            }
        }
        near.pad();
    }

    fn clear(&mut self) {
        self.len = 0;
    }

    fn push(&mut self, from: &Self, at: usize) {
        for (axis, from) in self.axes.iter_mut().zip(&from.axes) {
            axis[self.len] = from[at];
        }
        self.indices[self.len] = from.indices[at];
        self.len += 1;
    }

    fn pad(&mut self) {
        for axis in &mut self.axes {
            axis[self.len..self.len.next_multiple_of(LANES)].fill(BEYOND);
        }
    }
}

impl<const D: usize> Ball<D> {
    /// A ball about the box of `places`.
    pub(crate) fn around<'a>(places: impl Iterator<Item = &'a [f32; D]> + Clone) -> Self {
        let (mut low, mut high) = ([f32::MAX; D], [f32::MIN; D]);
        for place in places.clone() {
            for axis in 0..D {
                let coordinate = place[axis];
                low[axis] = if coordinate < low[axis] { coordinate } else { low[axis] };
                high[axis] = if coordinate > high[axis] { coordinate } else { high[axis] };
            }
        }
        let centre: [f32; D] = std::array::from_fn(|axis| 0.5 * (low[axis] + high[axis]));
        let distances = places.map(|place| square(*place, centre));
        let radius = distances.fold(0.0, |most, d| if d > most { d } else { most }).sqrt();
        Self { centre, radius }
    }
}

/// One place of several.
#[inline(always)]
pub(crate) fn column<const N: usize, const D: usize>(axes: &[[f32; N]; D], at: usize) -> [f32; D] {
    std::array::from_fn(|axis| axes[axis][at])
}

/// Square of a distance. Always added up in this order, so that all ways to search agree to the
/// bit.
#[inline(always)]
pub(crate) fn square<const D: usize>(a: [f32; D], b: [f32; D]) -> f32 {
    let mut sum = (a[0] - b[0]) * (a[0] - b[0]);
    for axis in 1..D {
        sum += (a[axis] - b[axis]) * (a[axis] - b[axis]);
    }
    sum
}
