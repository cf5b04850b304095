//! A block whose top is fractal ground: −1 ≤ x, z ≤ 1, from y = −1 up to heights in 0…1 that reach both ends.
//!
//! The heights are made by random displacement of midpoints (Fournier, Fussell and Carpenter, "Computer Rendering of
//! Stochastic Models", 1982) and stand at the corners of square cells, each of two triangles. A line is followed through
//! a pyramid of least and greatest heights. Along it the height above the ground is looked at where the line passes
//! from one triangle to the next, so what is inside at the end of one is inside at the start of the other: no gap opens
//! between triangles, whatever rounding does.

use std::ops::ControlFlow;

use glam::{DVec2, DVec3};

use super::{Arguments, Body, FormError, Row, Take};
use crate::primitive::Face;
use crate::ray::{FacedSpan, Ray};
use crate::texture::{Parameter, Range};

pub(super) const ROW: Row = Row {
    keyword: "terrain",
    arguments: Arguments::Numbers(&[
        Parameter { name: "seed", default: 1.0, range: Range::Whole(0, 1_000_000) },
        Parameter { name: "roughness", default: 0.5, range: Range::Within(0.1, 1.0) },
        Parameter { name: "detail", default: 7.0, range: Range::Whole(1, 10) },
    ]),
    make,
};

/// The sides are numbered −x, +x, −y, +y, −z, +z, as those of a block; triangles of the ground from here on.
const GROUND: u32 = 6;
/// Whoever is this much above or below all heights of a part is so wherever it is asked for.
const SLACK: f64 = 32.0 * f64::EPSILON;

struct Terrain {
    /// Cells along a side are 2 to this power.
    detail: u32,
    /// Row by row along x.
    heights: Vec<f32>,
    /// Least and greatest height of each part: first of single cells, then of four of them, and so on.
    levels: Vec<Vec<[f32; 2]>>,
}

/// A number in −1…1 of its own for each place (a step of Steele et al., "Fast Splittable Pseudorandom Number
/// Generators", 2014).
fn displacement(seed: u64, x: usize, z: usize) -> f64 {
    let mut bits = (seed << 40 | (x as u64) << 20 | z as u64).wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    #[expect(clippy::cast_precision_loss, reason = "53 bits")]
    let unit = (bits >> 11) as f64 / (1_u64 << 53) as f64;
    2.0 * unit - 1.0
}

/// Heights at the corners of `n` × `n` cells, `n` a power of two.
fn heights(n: usize, seed: u64, roughness: f64) -> Vec<f64> {
    let row = n + 1;
    let mut heights = vec![0.0; row * row];
    for (x, z) in [(0, 0), (n, 0), (0, n), (n, n)] {
        heights[z * row + x] = displacement(seed, x, z);
    }
    let (mut step, mut amplitude) = (n, 1.0);
    while step > 1 {
        let half = step / 2;
        amplitude *= roughness;
        let mut middles = |diagonal: bool| {
            for z in (0..=n).step_by(half) {
                for x in (0..=n).step_by(half) {
                    let odd = (x / half % 2, z / half % 2);
                    if odd != (1, 1) && diagonal || odd.0 + odd.1 != 1 && !diagonal {
                        continue;
                    }
                    // Those about it that are there: left, right, before, behind, or across the corners.
                    let (mut sum, mut count) = (0.0, 0.0);
                    let around: [(usize, usize); 4] = if diagonal {
                        [(0, 0), (2, 0), (0, 2), (2, 2)]
                    } else {
                        [(0, 1), (2, 1), (1, 0), (1, 2)]
                    };
                    for (right, behind) in around {
                        let (there_x, there_z) = (x + right * half, z + behind * half);
                        if there_x < half || there_z < half {
                            continue;
                        }
                        let (there_x, there_z) = (there_x - half, there_z - half);
                        if there_x <= n && there_z <= n {
                            sum += heights[there_z * row + there_x];
                            count += 1.0;
                        }
                    }
                    let moved = amplitude * displacement(seed, x, z);
                    heights[z * row + x] = sum / count + moved;
                }
            }
        };
        middles(true);
        middles(false);
        step = half;
    }
    heights
}

fn make(arguments: &[f64]) -> Result<Box<dyn Body>, FormError> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small and whole")]
    let (seed, detail) = (arguments[0] as u64, arguments[2] as u32);
    let n = 1_usize << detail;
    let raw = heights(n, seed, arguments[1]);
    let least = raw.iter().copied().fold(f64::INFINITY, f64::min);
    let range = raw.iter().copied().fold(f64::NEG_INFINITY, f64::max) - least;
    #[expect(clippy::cast_possible_truncation, reason = "this is where they are rounded")]
    let heights: Vec<f32> = raw.iter().map(|height| ((height - least) / range) as f32).collect();
    let mut level: Vec<[f32; 2]> = Vec::with_capacity(n * n);
    for z in 0..n {
        for x in 0..n {
            let at = z * (n + 1) + x;
            level.push(range_of([at, at + 1, at + n + 1, at + n + 2].map(|k| [heights[k]; 2])));
        }
    }
    let mut levels = vec![level];
    for up in 1..=detail {
        let (below, side) = (&levels[up as usize - 1], n >> up);
        let above = (0..side * side).map(|k| {
            let corner = k / side * 4 * side + k % side * 2;
            range_of(
                [corner, corner + 1, corner + 2 * side, corner + 2 * side + 1].map(|k| below[k]),
            )
        });
        let above = above.collect();
        levels.push(above);
    }
    Ok(Box::new(Terrain { detail, heights, levels }))
}

fn range_of(parts: [[f32; 2]; 4]) -> [f32; 2] {
    parts.into_iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], [l, h]| {
        [if l < low { l } else { low }, if h > high { h } else { high }]
    })
}

/// A plane through the ground of one triangle: height = base + slope · (place in the cell).
struct Plane {
    base: f64,
    slope: DVec2,
}

impl Terrain {
    fn cells(&self) -> usize {
        1 << self.detail
    }

    fn height(&self, x: usize, z: usize) -> f64 {
        f64::from(self.heights[z * (self.cells() + 1) + x])
    }

    /// The lower triangle holds the corner of a cell where x and z are least.
    fn plane(&self, x: usize, z: usize, upper: bool) -> Plane {
        let (right, behind) = (self.height(x + 1, z), self.height(x, z + 1));
        if upper {
            let last = self.height(x + 1, z + 1);
            let slope = DVec2::new(last - behind, last - right);
            Plane { base: right + behind - last, slope }
        } else {
            let base = self.height(x, z);
            Plane { base, slope: DVec2::new(right - base, behind - base) }
        }
    }

    /// A place of the solid in cells.
    fn place(&self, x: f64, z: f64) -> DVec2 {
        #[expect(clippy::cast_precision_loss, reason = "at most 2¹⁰")]
        let half = 0.5 * self.cells() as f64;
        DVec2::new((x + 1.0) * half, (z + 1.0) * half)
    }

    /// The triangle at a place, the nearest for one beside the ground, and the place in its cell.
    fn triangle_at(&self, place: DVec2) -> (usize, usize, bool, DVec2) {
        let last = self.cells() - 1;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a saturated index"
        )]
        let index = |along: f64| (along.max(0.0) as usize).min(last);
        let (x, z) = (index(place.x), index(place.y));
        #[expect(clippy::cast_precision_loss, reason = "at most 2¹⁰")]
        let within = (place - DVec2::new(x as f64, z as f64)).clamp(DVec2::ZERO, DVec2::ONE);
        (x, z, within.x + within.y > 1.0, within)
    }

    /// Height above the ground, and its gradient.
    fn above(&self, p: DVec3) -> (f64, DVec3) {
        let (x, z, upper, within) = self.triangle_at(self.place(p.x, p.z));
        let plane = self.plane(x, z, upper);
        (p.y - (plane.base + plane.slope.dot(within)), self.upward(&plane))
    }

    fn upward(&self, plane: &Plane) -> DVec3 {
        let slope = self.place(1.0, 1.0) * 0.5 * plane.slope;
        DVec3::new(-slope.x, 1.0, -slope.y)
    }
}

/// A line on its way through the ground.
struct Walk<'a, 't> {
    terrain: &'a Terrain,
    /// In cells along x and z, where the line comes into the block.
    start: DVec3,
    direction: DVec3,
    /// Parameter of the start.
    from: f64,
    /// Where the line has come in, while it is inside.
    inside: Option<(f64, f64)>,
    /// A span that is complete, unless the next one touches it.
    last: Option<FacedSpan>,
    take: Take<'t>,
}

impl Walk<'_, '_> {
    fn enter(&mut self, u: f64, face: f64) {
        self.inside = Some((self.from + u, face));
    }

    fn leave(&mut self, u: f64, face: f64) -> ControlFlow<()> {
        let Some((from, from_face)) = self.inside.take() else { return ControlFlow::Continue(()) };
        let span = FacedSpan { from, to: self.from + u, from_face, to_face: face };
        if span.from >= span.to {
            return ControlFlow::Continue(());
        }
        match self.last {
            Some(last) if span.from <= last.to => {
                self.last = Some(FacedSpan { to: span.to, to_face: face, ..last });
                ControlFlow::Continue(())
            }
            Some(done) => {
                self.last = Some(span);
                (self.take)(done)
            }
            None => {
                self.last = Some(span);
                ControlFlow::Continue(())
            }
        }
    }

    /// One part of the ground, from `a` to `b` along the line; parts at `level` 0 are cells.
    fn part(&mut self, level: u32, x: usize, z: usize, a: f64, b: f64) -> ControlFlow<()> {
        let side = self.terrain.cells() >> level;
        let [low, high] = self.terrain.levels[level as usize][z * side + x].map(f64::from);
        let y = |u: f64| self.start.y + u * self.direction.y;
        let (first, second) = (y(a), y(b));
        if first.min(second) > high + SLACK && self.inside.is_none()
            || first.max(second) < low - SLACK && self.inside.is_some()
        {
            return ControlFlow::Continue(());
        }
        if level == 0 {
            return self.cell(x, z, a, b);
        }
        // Where the line passes from one half to the other.
        #[expect(clippy::cast_precision_loss, reason = "at most 2¹⁰")]
        let middle = |part: usize| ((2 * part + 1) << (level - 1)) as f64;
        let across = |from: f64, along: f64, middle: f64| {
            if along.abs() > 0.0 { (middle - from) / along } else { f64::INFINITY }
        };
        let (middle_x, middle_z) = (middle(x), middle(z));
        let over_x = across(self.start.x, self.direction.x, middle_x);
        let over_z = across(self.start.z, self.direction.z, middle_z);
        let mut stops = [a, over_x.clamp(a, b), over_z.clamp(a, b), b];
        if stops[1] > stops[2] {
            stops.swap(1, 2);
        }
        let half = |from: f64, along: f64, middle: f64, over: f64, end: f64| {
            let beyond =
                if along.abs() > 0.0 { (end > over) == (along > 0.0) } else { from >= middle };
            usize::from(beyond)
        };
        for stop in 0..3 {
            let (begin, end) = (stops[stop], stops[stop + 1]);
            if begin < end {
                let right = half(self.start.x, self.direction.x, middle_x, over_x, end);
                let behind = half(self.start.z, self.direction.z, middle_z, over_z, end);
                self.part(level - 1, 2 * x + right, 2 * z + behind, begin, end)?;
            }
        }
        ControlFlow::Continue(())
    }

    fn cell(&mut self, x: usize, z: usize, a: f64, b: f64) -> ControlFlow<()> {
        #[expect(clippy::cast_precision_loss, reason = "at most 2¹⁰")]
        let corner = DVec2::new(x as f64, z as f64);
        let start = DVec2::new(self.start.x, self.start.z) - corner;
        let direction = DVec2::new(self.direction.x, self.direction.z);
        // The triangles meet where x + z = 1 in the cell.
        let (sum, rise) = (start.x + start.y, direction.x + direction.y);
        let over = if rise.abs() > 0.0 { (1.0 - sum) / rise } else { f64::INFINITY };
        let stops = [a, over.clamp(a, b), b];
        for stop in 0..2 {
            let (begin, end) = (stops[stop], stops[stop + 1]);
            if begin >= end {
                continue;
            }
            let upper = if rise.abs() > 0.0 { (end > over) == (rise > 0.0) } else { sum > 1.0 };
            let plane = self.terrain.plane(x, z, upper);
            let above = |u: f64| {
                let y = self.start.y + u * self.direction.y;
                y - (plane.base + plane.slope.dot(start + u * direction))
            };
            let ends_inside = above(end) < 0.0;
            if ends_inside == self.inside.is_some() {
                continue;
            }
            // What is inside at the end of one triangle is so at the start of the next: the crossing is in here.
            let (first, second) = (above(begin), above(end));
            let crosses = (first < 0.0) != ends_inside;
            let share = if crosses { first / (first - second) } else { 0.0 };
            let u = (begin + share * (end - begin)).clamp(begin, end);
            let number = 2 * (z * self.terrain.cells() + x) + usize::from(upper);
            let face = GROUND + u32::try_from(number).expect("at most 2²¹ triangles");
            let face = Face(face).number();
            if ends_inside {
                self.enter(u, face);
            } else {
                self.leave(u, face)?;
            }
        }
        ControlFlow::Continue(())
    }
}

impl Body for Terrain {
    fn spans(&self, ray: &Ray, take: Take<'_>) -> ControlFlow<()> {
        let slab = |axis: usize, face: u8| {
            FacedSpan::slab(ray.origin[axis], ray.direction[axis], -1.0, 1.0, face, face + 1)
        };
        let block = slab(0, 0).clip(slab(1, 2)).clip(slab(2, 4));
        if block.from >= block.to || !block.from.is_finite() || !block.to.is_finite() {
            return ControlFlow::Continue(());
        }
        let at = |t: f64| -> DVec3 { ray.at(t).clamp(DVec3::NEG_ONE, DVec3::ONE) };
        let (begin, end) = (at(block.from), at(block.to));
        let length = block.to - block.from;
        let place = |p: DVec3| {
            let flat = self.place(p.x, p.z);
            DVec3::new(flat.x, p.y, flat.y)
        };
        let start = place(begin);
        let direction = (place(end) - start) / length;
        let mut walk = Walk {
            terrain: self,
            start,
            direction,
            from: block.from,
            inside: None,
            last: None,
            take,
        };
        if self.above(begin).0 < 0.0 {
            walk.enter(0.0, block.from_face);
        }
        walk.part(self.detail, 0, 0, 0.0, length)?;
        walk.leave(length, block.to_face)?;
        match walk.last {
            Some(span) => (walk.take)(span),
            None => ControlFlow::Continue(()),
        }
    }

    fn contains(&self, p: DVec3) -> bool {
        p.abs().max_element() <= 1.0 && self.above(p).0 <= 0.0
    }

    fn gradient(&self, _point: DVec3, face: Face) -> DVec3 {
        if face.0 < GROUND {
            let axis = DVec3::AXES[(face.0 / 2) as usize];
            return if face.0.is_multiple_of(2) { -axis } else { axis };
        }
        let (number, upper) = ((face.0 - GROUND) as usize / 2, (face.0 - GROUND) % 2 == 1);
        let (x, z) = (number % self.cells(), number / self.cells() % self.cells());
        self.upward(&self.plane(x, z, upper))
    }

    /// The ground and the floor are seen from above, each side whole as that of a block.
    fn texture_coordinates(&self, p: DVec3, face: Face) -> DVec2 {
        let (u, v) = match face.0 / 2 {
            0 => (p.z, p.y),
            2 => (p.x, p.y),
            _ => (p.x, p.z),
        };
        DVec2::new(0.5 * (u + 1.0), 0.5 * (v + 1.0))
    }

    fn support(&self, n: DVec3) -> DVec3 {
        if n.y <= 0.0 {
            let corner = DVec3::select(n.cmplt(DVec3::ZERO), DVec3::NEG_ONE, DVec3::ONE);
            return DVec3::new(corner.x, -1.0, corner.z);
        }
        let side = self.cells() + 1;
        #[expect(clippy::cast_precision_loss, reason = "at most 2¹⁰")]
        let along = |k: usize| 2.0 * k as f64 / self.cells() as f64 - 1.0;
        let mut best = (f64::NEG_INFINITY, DVec3::ZERO);
        for (k, height) in self.heights.iter().enumerate() {
            let point = DVec3::new(along(k % side), f64::from(*height), along(k / side));
            let reach = n.dot(point);
            if reach > best.0 {
                best = (reach, point);
            }
        }
        best.1
    }

    fn distance(&self, p: DVec3, length: &dyn Fn(DVec3) -> f64) -> f64 {
        let (above, gradient) = self.above(p);
        let sides = [(p.x.abs(), DVec3::X), (-p.y, DVec3::Y), (p.z.abs(), DVec3::Z)];
        sides.into_iter().fold(above / length(gradient), |most, (along, axis)| {
            let distance = (along - 1.0) / length(axis);
            if distance > most { distance } else { most }
        })
    }
}
