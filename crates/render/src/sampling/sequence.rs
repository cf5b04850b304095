//! Points that fill squares evenly, however many are taken: Sobol's sequence, each digit of it scrambled by the digits
//! before it (Owen, "Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences", 1995), by hashing (Burley, "Practical
//! Hash-based Owen Scrambling", 2020).

/// Direction numbers of Sobol's first four dimensions (Joe and Kuo, "Constructing Sobol Sequences with Better
/// Two-Dimensional Projections", 2008).
const DIRECTIONS: [[u32; 32]; 4] = [
    directions(0, 0, [0; 3]),
    directions(1, 0, [1, 0, 0]),
    directions(2, 1, [1, 3, 0]),
    directions(3, 1, [1, 3, 1]),
];

/// By the recurrence of a primitive polynomial of this degree, with `inner` as its coefficients between first and last.
const fn directions(degree: usize, inner: u32, first: [u32; 3]) -> [u32; 32] {
    let mut v = [0_u32; 32];
    let mut i = 0;
    while i < 32 {
        v[i] = if degree == 0 {
            1 << (31 - i)
        } else if i < degree {
            first[i] << (31 - i)
        } else {
            let mut next = v[i - degree] ^ (v[i - degree] >> degree);
            let mut k = 1;
            while k < degree {
                if (inner >> (degree - 1 - k)) & 1 == 1 {
                    next ^= v[i - k];
                }
                k += 1;
            }
            next
        };
        i += 1;
    }
    v
}

/// Digit `index` of Sobol's sequence in a dimension.
fn sobol(mut index: u32, dimension: usize) -> u32 {
    let mut x = 0;
    let mut directions = DIRECTIONS[dimension].iter();
    while let (1.., Some(direction)) = (index, directions.next()) {
        x ^= direction & (index & 1).wrapping_neg();
        index >>= 1;
    }
    x
}

/// Each bit flipped or not by what the lower ones are (Vegdahl, "Building a Better LK Hash", 2021).
fn nested_hash(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// Owen's scrambling: each bit flipped or not by what the higher ones are.
fn scrambled(x: u32, seed: u32) -> u32 {
    nested_hash(x.reverse_bits(), seed).reverse_bits()
}

/// A number from two that has nothing to do with either.
pub(crate) fn hash(a: u32, b: u32) -> u32 {
    // The finaliser of SplitMix64 (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
    let mut x = (u64::from(a) << 32 | u64::from(b)).wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 32) as u32
}

/// 0 up to, but not, 1.
fn fraction(x: u32) -> f64 {
    f64::from(x) / 4_294_967_296.0
}

/// A sample's choices: one point of a sequence in every pair of dimensions that is asked for. Samples of a pixel with
/// numbers 0, 1, 2 … fill each pair evenly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Draw {
    /// The number of the sample, or none for the middle of everything.
    number: u32,
    seed: u32,
}

impl Draw {
    /// The middle of every pair.
    pub(crate) const MIDDLE: Self = Self { number: u32::MAX, seed: 0 };

    /// Sample `number` of a pixel that has a seed of its own.
    pub(crate) fn new(number: u32, seed: u32) -> Self {
        Self { number, seed }
    }

    /// Where in the pixel, and where on the lens: four dimensions that fill evenly together.
    pub(crate) fn start(self) -> [f64; 4] {
        if self == Self::MIDDLE {
            return [0.5; 4];
        }
        let mut seed = self.seed;
        [0, 1, 2, 3].map(|dimension| {
            seed = hash(seed, 0x5eed);
            fraction(scrambled(sobol(self.number, dimension), seed))
        })
    }

    /// The point in a pair of dimensions, by its number; pairs have nothing to do with each other.
    pub(crate) fn pair(self, pair: u32) -> [f64; 2] {
        if self == Self::MIDDLE {
            return [0.5; 2];
        }
        let seed = hash(self.seed, pair);
        let number = scrambled(self.number, seed);
        let x = scrambled(number.reverse_bits(), hash(seed, 1));
        let y = scrambled(sobol(number, 1), hash(seed, 2));
        [fraction(x), fraction(y)]
    }

    /// The choices of a ray that springs from this one, by the way it goes.
    pub(crate) fn sprung(self, way: u32) -> Self {
        if self == Self::MIDDLE { self } else { Self { seed: hash(self.seed, !way), ..self } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn alike(a: &[f64], b: &[f64]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
    }

    #[test]
    fn published_digits() {
        // Reference page on sampling: the second dimension's direction numbers, and the first points.
        let second = [
            0x8000_0000,
            0xc000_0000,
            0xa000_0000,
            0xf000_0000,
            0x8800_0000,
            0xcc00_0000,
            0xaa00_0000,
            0xff00_0000,
        ];
        assert_eq!(DIRECTIONS[1][..8], second);
        let points = [
            (0.0, 0.0),
            (0.5, 0.5),
            (0.25, 0.75),
            (0.75, 0.25),
            (0.125, 0.625),
            (0.625, 0.125),
            (0.375, 0.375),
            (0.875, 0.875),
        ];
        for (number, (x, y)) in (0_u32..).zip(points) {
            let found = [0, 1].map(|dimension| fraction(sobol(number, dimension)));
            assert!(alike(&found, &[x, y]), "point {number}: {found:?}");
        }
        // Joe and Kuo's own first points in four dimensions; they come in the order of Gray's code.
        for (at, expected) in (0_u32..).zip([
            [0.0, 0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25, 0.25],
            [0.25, 0.75, 0.75, 0.75],
            [0.375, 0.375, 0.625, 0.875],
            [0.875, 0.875, 0.125, 0.375],
            [0.625, 0.125, 0.875, 0.625],
            [0.125, 0.625, 0.375, 0.125],
            [0.1875, 0.3125, 0.9375, 0.4375],
            [0.6875, 0.8125, 0.4375, 0.9375],
        ]) {
            let number = at ^ (at >> 1);
            let found = [0, 1, 2, 3].map(|dimension| fraction(sobol(number, dimension)));
            assert!(alike(&found, &expected), "point {at}: {found:?}");
        }
    }

    #[test]
    fn published_scrambles() {
        let seed = 0x1234_5678;
        for (x, expected) in [
            (0, 0x6feb_9e68),
            (1, 0x60d4_c7e1),
            (0x8000_0000, 0xefeb_9e68),
            (0xdead_beef, 0xabdb_6de7),
        ] {
            assert_eq!(nested_hash(x, seed), expected, "{x:x}");
        }
        for (x, expected) in [(0, 0x1679_d7f6), (1, 0x1679_d7f7), (0xdead_beef, 0xdf20_be3d)] {
            assert_eq!(scrambled(x, seed), expected, "{x:x}");
        }
        for (number, index, x, y) in
            [(0, 0x1679_d7f6, 0xe4f1_0b4e, 0xaa4f_e86b), (1, 0x1679_d7f7, 0x501f_c53e, 0x2179_95b4)]
        {
            assert_eq!(scrambled(number, seed), index);
            assert_eq!(scrambled(sobol(index, 0), 0x9e37_79b9), x);
            assert_eq!(scrambled(sobol(index, 1), 0x7f4a_7c15), y);
        }
    }

    /// True if `points` are one in each of `columns` × `rows` equal rectangles.
    fn one_in_each(points: &[[f64; 2]], columns: usize, rows: usize) -> bool {
        let mut counts = vec![0; columns * rows];
        for point in points {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cell")]
            let cell = |x: f64, n: usize| (x * n as f64) as usize;
            counts[cell(point[1], rows) * columns + cell(point[0], columns)] += 1;
        }
        counts.iter().all(|&count| count == 1)
    }

    #[test]
    fn every_pair_is_stratified_in_every_shape() {
        for seed in [0, 1, 77, 0xffff_fffe] {
            for (way, pair) in [(0, 0), (1, 0), (2, 5)] {
                let draw = |number| Draw::new(number, seed).sprung(way);
                // The first 64, and the next: each fills all elementary rectangles.
                for first in [0, 64] {
                    let pairs: Vec<_> = (first..first + 64).map(|n| draw(n).pair(pair)).collect();
                    let starts: Vec<_> = (first..first + 64).map(|n| draw(n).start()).collect();
                    let in_pixel: Vec<_> = starts.iter().map(|p| [p[0], p[1]]).collect();
                    for (columns, rows) in [(64, 1), (32, 2), (16, 4), (8, 8), (4, 16), (1, 64)] {
                        assert!(one_in_each(&pairs, columns, rows), "pair {columns}×{rows}");
                        assert!(one_in_each(&in_pixel, columns, rows), "pixel {columns}×{rows}");
                    }
                    // Each dimension by itself.
                    for dimension in 2..4 {
                        let alone: Vec<_> = starts.iter().map(|p| [p[dimension], 0.0]).collect();
                        assert!(one_in_each(&alone, 64, 1), "dimension {dimension}");
                    }
                }
            }
        }
    }

    #[test]
    fn means_over_seeds_are_those_of_chance() {
        // A scrambled point is anywhere with equal chance, and two scrambles know nothing of each other.
        let (mut sum, mut square, mut product, seeds) = (0.0, 0.0, 0.0, 40_000);
        for seed in 0..seeds {
            let [x, _] = Draw::new(3, seed).pair(0);
            let [u, _] = Draw::new(3, hash(seed, 9)).pair(0);
            sum += x;
            square += x * x;
            product += (x - 0.5) * (u - 0.5);
        }
        let n = f64::from(seeds);
        // Five standard deviations.
        assert!((sum / n - 0.5).abs() < 5.0 * (1.0 / 12.0 / n).sqrt(), "mean {}", sum / n);
        assert!((square / n - 1.0 / 3.0).abs() < 5.0 * (4.0 / 45.0 / n).sqrt(), "{}", square / n);
        assert!((product / n).abs() < 5.0 / 12.0 / n.sqrt(), "correlation {}", product / n);
    }

    #[test]
    fn the_middle_stays_the_middle() {
        let draw = Draw::MIDDLE.sprung(1).sprung(7);
        assert!(alike(&draw.start(), &[0.5; 4]) && alike(&draw.pair(3), &[0.5; 2]));
    }
}
