//! Where in the picture a solid can be seen: straight edges of the box about it, the silhouette of its curved side and the
//! rims of its caps.
//!
//! What lies beyond one of these is proved to be missed. All proofs hold for the cone of all lines from the eye through
//! the solid, so solids that reach behind the eye need no clipping.

use glam::DVec3;
use scene::transform::{apply, apply_transposed};
use scene::{Bounds, Map, Primitive};

use super::band::Band;
use super::quadratic::Quadratic;
use super::sheet::{Cell, Covector, Form, Sheet};
use crate::world::Leaf;

/// Edges that a box shows at most; more are left out, which proves less.
const EDGES: usize = 6;
/// Rounding of what tells the sides of an edge apart, relative to its terms.
const SLACK: f64 = 1e-11;

/// A cap's rim.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rim {
    /// Positive where lines miss the cap.
    pub(crate) outside: Quadratic,
    /// Rays that meet the cap enter the solid there; else they leave it.
    pub(crate) entered: bool,
}

/// What a solid looks like.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    /// None where only the box about it is known.
    solid: Option<Primitive>,
    /// Least and greatest depth, rounding included.
    pub(crate) depth: [f64; 2],
    /// Where the middle of the box is seen, or the middle of the picture.
    about: [f64; 2],
    /// Of places less `about`: positive beyond an edge of the box.
    edges: [DVec3; EDGES],
    edge_count: usize,
    /// Positive where lines meet the quadric.
    side: Option<Quadratic>,
    pub(crate) rims: [Option<Rim>; 2],
    /// [`Sheet::image`] for points of the solid's own space.
    image: [Covector; 3],
    /// Where the tip of a cone is seen.
    pub(crate) apex: Option<[f64; 2]>,
    /// Where its middle is seen.
    pub(crate) center: Option<[f64; 2]>,
    /// Of the pixels that it covers, about.
    pub(crate) area: f64,
}

impl Outline {
    /// `bounds` are those of the leaf.
    pub(crate) fn of_leaf(sheet: &Sheet, leaf: &Leaf, bounds: &Bounds) -> Self {
        let Some(solid) = leaf.primitive() else {
            return Self::of_box(sheet, bounds, leaf.magnitude);
        };
        let map = &leaf.place.map();
        let middle = match solid {
            Primitive::Sphere | Primitive::Block => DVec3::ZERO,
            Primitive::Cylinder | Primitive::Cone | Primitive::Paraboloid => 0.5 * DVec3::X,
        };
        let half = match solid {
            Primitive::Sphere | Primitive::Block => DVec3::ONE,
            Primitive::Cylinder | Primitive::Cone | Primitive::Paraboloid => {
                DVec3::new(0.5, 1.0, 1.0)
            }
        };
        let corners = Bounds::about(middle, half).corners().map(|p| map.outward(p));
        let image = sheet.image.map(|covector| inward(&covector, map));
        let depth = inward(&sheet.depth, map);
        let reach = |sign: f64| {
            let direction = sign * depth.0;
            let longest = direction.abs().max_element();
            sign * direction.dot(solid.support(direction / longest)) + depth.1
        };
        let mut outline = Self {
            solid: Some(solid),
            depth: widened([reach(-1.0), reach(1.0)], leaf.magnitude),
            image,
            ..Self::of_corners(sheet, &corners)
        };
        outline.curves(sheet, map, solid);
        let ellipse = outline.side.as_ref().filter(|_| solid == Primitive::Sphere);
        if let Some(area) = ellipse.and_then(Quadratic::area) {
            outline.area = area;
        }
        outline
    }

    /// Of anything in a box.
    pub(crate) fn of_box(sheet: &Sheet, bounds: &Bounds, magnitude: f64) -> Self {
        let corners = bounds.corners();
        let mut outline = Self::of_corners(sheet, &corners);
        let depths = corners.map(|corner| sheet.depth_of(corner));
        let range = depths.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &z| {
            [if z < low { z } else { low }, if z > high { z } else { high }]
        });
        outline.depth = widened(range, magnitude);
        outline
    }

    /// If cells in which it is seen may be proved.
    pub(crate) fn is_provable(&self) -> bool {
        self.solid.is_some()
    }

    /// The edges of a box by its corners.
    fn of_corners(sheet: &Sheet, corners: &[DVec3; 8]) -> Self {
        let center = place(sheet.seen(0.5 * (corners[0] + corners[7])));
        let about = center.unwrap_or(sheet.size.map(|side| 0.5 * side));
        // Seen from there, what is small and far off is not lost in the rounding of where it is.
        let corners = corners.map(|corner| {
            let DVec3 { x, y, z } = sheet.seen(corner);
            DVec3::new(x - about[0] * z, y - about[1] * z, z)
        });
        let mut outline = Self {
            about,
            solid: None,
            depth: [0.0; 2],
            edges: [DVec3::ZERO; EDGES],
            edge_count: 0,
            side: None,
            rims: [None; 2],
            image: [(DVec3::ZERO, 0.0); 3],
            apex: None,
            center,
            area: covered(&corners),
        };
        for (first, second) in
            (0..8).flat_map(|a| [1, 2, 4].map(|bit| (a, a ^ bit))).filter(|(a, b)| a < b)
        {
            let normal = corners[first].cross(corners[second]);
            let size = normal.abs().element_sum();
            if size.is_nan() || size <= 0.0 {
                continue;
            }
            let within = |sign: f64| {
                corners.iter().all(|&corner| {
                    sign * normal.dot(corner) <= SLACK * normal.abs().dot(corner.abs())
                })
            };
            let sign = if within(1.0) {
                1.0
            } else if within(-1.0) {
                -1.0
            } else {
                continue;
            };
            if outline.edge_count < EDGES {
                outline.edges[outline.edge_count] = sign / size * normal;
                outline.edge_count += 1;
            }
        }
        outline
    }

    /// The silhouette of the curved side and the rims of caps.
    fn curves(&mut self, sheet: &Sheet, map: &Map, solid: Primitive) {
        let about = self.about;
        let moved = |form: &Form<DVec3>| form[0] + about[0] * form[1] + about[1] * form[2];
        let turn = |v: DVec3| apply(&map.inverse, v);
        let o = [map.inward(moved(&sheet.origin)), turn(sheet.origin[1]), turn(sheet.origin[2])];
        let d = [sheet.direction[0], sheet.direction[1], sheet.direction[2]];
        let d = [turn(moved(&d)), turn(d[1]), turn(d[2])];
        // One of both does not change, so what is a product of both is linear.
        let both = |f: &dyn Fn(DVec3, DVec3) -> f64| -> Form {
            [f(o[0], d[0]), f(o[1], d[0]) + f(o[0], d[1]), f(o[2], d[0]) + f(o[0], d[2])]
        };
        let xy = both(&|o, d| o.x * d.y - o.y * d.x);
        let xz = both(&|o, d| o.x * d.z - o.z * d.x);
        let yz = both(&|o, d| o.y * d.z - o.z * d.y);
        let [dx, dy, dz] = [d.map(|d| d.x), d.map(|d| d.y), d.map(|d| d.z)];
        let product = |f: Form, g: Form| Quadratic::product(about, f, g);
        let square = |f: Form| product(f, f);
        let turned = square(yz);
        let across = square(dy).plus(1.0, &square(dz));
        self.side = match solid {
            Primitive::Block => None,
            Primitive::Sphere => {
                let less = [square(xy), square(xz), turned];
                let all = across.plus(1.0, &square(dx));
                Some(less.iter().fold(all, |sum, minor| sum.plus(-1.0, minor)))
            }
            Primitive::Cylinder => Some(across.plus(-1.0, &turned)),
            Primitive::Cone => Some(square(xy).plus(1.0, &square(xz)).plus(-1.0, &turned)),
            Primitive::Paraboloid => {
                let along = both(&|o, d| o.y * d.y + o.z * d.z);
                let ox = o.map(|o| o.x);
                let tall = if sheet.parallel {
                    let constant = dy[0] * dy[0] + dz[0] * dz[0];
                    product(ox, [constant, 0.0, 0.0])
                } else {
                    Quadratic::ZERO.plus(ox[0], &across)
                };
                let tall = tall.plus(0.25, &square(dx)).plus(-1.0, &product(dx, along));
                Some(tall.plus(-1.0, &turned))
            }
        };
        let rim = |height: f64| {
            let off = |minor: Form, d: Form| -> Form {
                std::array::from_fn(|k| height * d[k] - minor[k])
            };
            let outside = square(off(xy, dy)).plus(1.0, &square(off(xz, dz)));
            let outside = outside.plus(-1.0, &square(dx));
            // Above 0 if the eye is on the outer side.
            let toward = if sheet.parallel { -dx[0] } else { o[0].x - height };
            let entered = if height > 0.0 { toward > 0.0 } else { toward < 0.0 };
            Some(Rim { outside, entered })
        };
        self.rims = match solid {
            Primitive::Sphere | Primitive::Block => [None; 2],
            Primitive::Cylinder => [rim(0.0), rim(1.0)],
            Primitive::Cone | Primitive::Paraboloid => [rim(1.0), None],
        };
        if solid == Primitive::Cone {
            self.apex = place(self.image.map(|covector| covector.1).into());
        }
    }

    /// True if no ray of the cell meets the solid.
    pub(crate) fn is_missed(&self, cell: &Cell) -> bool {
        if self.depth[1] <= 0.0 {
            return true;
        }
        let ([x, y], h) = (self.off(cell), cell.half);
        if self.edges[..self.edge_count].iter().any(|edge| {
            let terms = edge.x.abs() * (x.abs() + h) + edge.y.abs() * (y.abs() + h) + edge.z.abs();
            let nearest = edge.x * x + edge.y * y + edge.z - (edge.x.abs() + edge.y.abs()) * h;
            nearest > 16.0 * SLACK * terms
        }) {
            return true;
        }
        let Some(side) = &self.side else { return false };
        let side = side.over(cell);
        if side.high < 0.0 {
            return true;
        }
        // Lines that meet the quadric behind the eye, or on the other side of a tip.
        let other = self.depth[0] <= 0.0 || self.rims[0].is_some();
        if other && side.middle > 0.0 && self.is_beyond(cell, side.slope) {
            return true;
        }
        self.rims.iter().flatten().any(|rim| {
            let outside = rim.outside.over(cell);
            outside.middle > 0.0 && self.is_beyond(cell, outside.slope)
        })
    }

    /// The middle of a cell, from where edges are measured.
    fn off(&self, cell: &Cell) -> [f64; 2] {
        [cell.middle[0] - self.about[0], cell.middle[1] - self.about[1]]
    }

    /// True if the solid lies behind the line through the corner of the cell that is least far along `way`.
    fn is_beyond(&self, cell: &Cell, way: [f64; 2]) -> bool {
        let Some(solid) = self.solid else { return false };
        let longest = way[0].abs() + way[1].abs();
        let [a, b] = way.map(|component| component / longest);
        let start = a * cell.middle[0] + b * cell.middle[1] - (a.abs() + b.abs()) * cell.half;
        let [column, row, weight] = &self.image;
        let normal = a * column.0 + b * row.0 - start * weight.0;
        let more = a * column.1 + b * row.1 - start * weight.1;
        let size = normal.abs().max_element();
        if size.is_nan() || size <= 0.0 {
            return false;
        }
        let terms =
            [column, row, weight].iter().zip([a, b, start]).fold(0.0, |sum, (covector, factor)| {
                sum + factor.abs() * (covector.0.abs().element_sum() + covector.1.abs())
            });
        normal.dot(solid.support(normal / size)) + more < -SLACK * terms
    }

    /// Curves that bound the solid, or parts of its surface, and may run through the cell; two stand for any number.
    pub(crate) fn curves_in(&self, cell: &Cell) -> usize {
        let curve = |quadratic: &Quadratic| {
            let range = quadratic.over(cell);
            match (range.low > 0.0 || range.high < 0.0, range.steady) {
                (true, _) => 0,
                (false, true) => 1,
                (false, false) => 2,
            }
        };
        let ([x, y], h) = (self.off(cell), cell.half);
        let crosses = |edge: &&DVec3| {
            let reach = (edge.x.abs() + edge.y.abs()) * h;
            (edge.x * x + edge.y * y + edge.z).abs() <= reach
        };
        match &self.side {
            None => self.edges[..self.edge_count].iter().filter(crosses).count(),
            Some(side) => {
                let rims = self.rims.iter().flatten().map(|rim| curve(&rim.outside));
                curve(side) + rims.sum::<usize>()
            }
        }
    }
}

/// A range of depths with the rounding of places of a magnitude, and what is not told apart.
fn widened([near, far]: [f64; 2], magnitude: f64) -> [f64; 2] {
    [near - Band::off(near, magnitude), far + Band::off(far, magnitude)]
}

/// A covector of the outer space in a solid's own.
fn inward(&(vector, more): &Covector, map: &Map) -> Covector {
    (apply_transposed(&map.linear, vector), vector.dot(map.place) + more)
}

/// Where a point is seen that lies ahead.
fn place(seen: DVec3) -> Option<[f64; 2]> {
    let place = [seen.x / seen.z, seen.y / seen.z];
    (seen.z > 0.0 && place.iter().all(|x| x.is_finite())).then_some(place)
}

/// Pixels of the rectangle about some points that are seen.
fn covered(corners: &[DVec3; 8]) -> f64 {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &corner in corners {
        if corner.z <= 0.0 {
            return f64::INFINITY;
        }
        (low, high) = (low.min(corner / corner.z), high.max(corner / corner.z));
    }
    (high.x - low.x) * (high.y - low.y)
}
