//! A polygon in the plane z = 0, extruded to z = 1.

use std::ops::ControlFlow;

use glam::{BVec2, DVec2, DVec3};

use super::{Arguments, Body, FormError, Row, Take};
use crate::primitive::Face;
use crate::ray::{FacedSpan, Ray};

pub(super) const ROW: Row = Row { keyword: "prism", arguments: Arguments::Points, make };

const BOTTOM: u8 = 0;
const TOP: u8 = 1;
/// Faces from here on are sides, in the order of the points.
const SIDES: u32 = 2;

/// Every pair of edges is looked at once, and every edge by every ray.
const MOST_POINTS: usize = 2000;

/// Coordinates beyond this are refused: a scale is for that.
const FARTHEST: f64 = 1e9;

struct Prism {
    /// Counterclockwise.
    points: Vec<DVec2>,
    low: DVec2,
    high: DVec2,
    /// Lengths of the outline up to each point, and of all of it.
    along: Vec<f64>,
    /// The points were given the other way around.
    turned: bool,
}

/// Twice the area of a triangle, positive if its corners are counterclockwise.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// True if `p`, on the line through `a` and `b`, is between them or one of them.
fn between(a: DVec2, b: DVec2, p: DVec2) -> bool {
    p.cmpge(a.min(b)).all() && p.cmple(a.max(b)).all()
}

/// True if two edges share a point.
fn meet([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let (c_side, d_side) = (area(a, b, c), area(a, b, d));
    let (a_side, b_side) = (area(c, d, a), area(c, d, b));
    let apart = |x: f64, y: f64| x < 0.0 && y > 0.0 || x > 0.0 && y < 0.0;
    let on = |side: f64| side.abs() <= 0.0;
    apart(c_side, d_side) && apart(a_side, b_side)
        || on(c_side) && between(a, b, c)
        || on(d_side) && between(a, b, d)
        || on(a_side) && between(c, d, a)
        || on(b_side) && between(c, d, b)
}

/// The edge that meets an earlier one other than in the point they share, and how.
fn crossing(points: &[DVec2]) -> Option<(usize, String)> {
    let count = points.len();
    let edge = |k: usize| [points[k % count], points[(k + 1) % count]];
    let name = |k: usize| format!("the edge from point {} to {}", k + 1, (k + 1) % count + 1);
    for k in 0..count {
        let ([a, b], [_, c]) = (edge(k), edge(k + 1));
        if a == b {
            return Some((k, format!("{} without length", name(k))));
        }
        if area(a, b, c).abs() <= 0.0 && (b - a).dot(c - b) < 0.0 {
            return Some((
                (k + 1) % count,
                format!("{} back along the one before", name((k + 1) % count)),
            ));
        }
        // The last edge and the first are neighbours, too.
        let others = k + 2..count - usize::from(k == 0);
        for other in others {
            if meet([a, b], edge(other)) {
                return Some((other, format!("{} meeting {}", name(other), name(k))));
            }
        }
    }
    None
}

fn make(arguments: &[f64]) -> Result<Box<dyn Body>, FormError> {
    let count = arguments.len() / 2;
    let odd = !arguments.len().is_multiple_of(2);
    let fail = |point: usize, expected: &str, found: String| {
        Err(FormError { argument: 2 * point, expected: expected.to_owned(), found })
    };
    if odd || count < 3 {
        return fail(count, "three points or more, two numbers each", format!("{count} points"));
    }
    if count > MOST_POINTS {
        let expected = format!("at most {MOST_POINTS} points");
        return fail(MOST_POINTS, &expected, count.to_string());
    }
    let mut points: Vec<DVec2> =
        arguments.chunks_exact(2).map(|pair| DVec2::new(pair[0], pair[1])).collect();
    let near = |point: &DVec2| point.abs().max_element() <= FARTHEST;
    if let Some(far) = points.iter().position(|point| !near(point)) {
        let expected = format!("a point not farther than {FARTHEST:e} from the origin");
        return fail(far, &expected, points[far].to_string());
    }
    if let Some((edge, found)) = crossing(&points) {
        return fail(edge, "an outline that does not meet itself", found);
    }
    let edge = |k: usize| [points[k], points[(k + 1) % count]];
    let twice: f64 = (0..count).map(|k| edge(k)[0].perp_dot(edge(k)[1])).sum();
    let turned = twice < 0.0;
    if turned {
        points.reverse();
        points.rotate_right(1);
    }
    let mut along = vec![0.0];
    for k in 0..count {
        along.push(along[k] + points[k].distance(points[(k + 1) % count]));
    }
    let fold = |f: fn(DVec2, DVec2) -> DVec2| points.iter().copied().reduce(f).unwrap_or_default();
    Ok(Box::new(Prism { low: fold(DVec2::min), high: fold(DVec2::max), points, along, turned }))
}

impl Prism {
    fn edge(&self, k: usize) -> [DVec2; 2] {
        [self.points[k], self.points[if k + 1 == self.points.len() { 0 } else { k + 1 }]]
    }

    fn covers(&self, p: DVec2) -> bool {
        let crossed = (0..self.points.len()).filter(|&k| {
            let [a, b] = self.edge(k);
            (a.y > p.y) != (b.y > p.y) && (area(a, b, p) > 0.0) == (b.y > a.y)
        });
        crossed.count() % 2 == 1
    }

    /// Where a line in the plane crosses the outline, in order, and the edges there; an even number.
    ///
    /// The points are told apart by the side of the line they lie on, each once, so that a line through a point crosses
    /// both of its edges or neither.
    fn crossings(&self, point: DVec2, direction: DVec2) -> Vec<(f64, usize)> {
        let square = direction.length_squared();
        let side = |p: DVec2| direction.perp_dot(p - point);
        let mut crossings = Vec::new();
        let first = side(self.points[0]);
        let mut from = first;
        for k in 0..self.points.len() {
            let [a, b] = self.edge(k);
            let to = if k + 1 == self.points.len() { first } else { side(b) };
            if (from < 0.0) != (to < 0.0) {
                let there = a + (from / (from - to)) * (b - a);
                crossings.push(((there - point).dot(direction) / square, k));
            }
            from = to;
        }
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        crossings
    }
}

fn side(k: usize) -> f64 {
    let face = SIDES + u32::try_from(k).expect("few points");
    Face(face).number()
}

impl Body for Prism {
    fn spans(&self, ray: &Ray, take: Take<'_>) -> ControlFlow<()> {
        let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin, ray.direction);
        let slab = FacedSpan::slab(oz, dz, 0.0, 1.0, BOTTOM, TOP);
        let (origin, direction) = (DVec2::new(ox, oy), DVec2::new(dx, dy));
        // With the largest coordinate as unit no square is lost.
        let unit = direction.abs().max_element();
        if unit <= 0.0 {
            return if slab.from < slab.to && self.covers(origin) {
                take(slab)
            } else {
                ControlFlow::Continue(())
            };
        }
        let direction = direction / unit;
        let middle = 0.5 * (self.low + self.high);
        let nearest = (middle - origin).dot(direction) / direction.length_squared();
        let point = origin + nearest * direction;
        let mut last: Option<FacedSpan> = None;
        for pair in self.crossings(point, direction).chunks_exact(2) {
            let span = FacedSpan {
                from: (nearest + pair[0].0) / unit,
                to: (nearest + pair[1].0) / unit,
                from_face: side(pair[0].1),
                to_face: side(pair[1].1),
            };
            let span = span.clip(slab);
            if span.from >= span.to {
                continue;
            }
            last = Some(match last {
                Some(before) if span.from <= before.to => {
                    FacedSpan { to: span.to, to_face: span.to_face, ..before }
                }
                Some(before) => {
                    take(before)?;
                    span
                }
                None => span,
            });
        }
        last.map_or(ControlFlow::Continue(()), take)
    }

    fn contains(&self, p: DVec3) -> bool {
        0.0 <= p.z && p.z <= 1.0 && self.covers(p.truncate())
    }

    fn gradient(&self, _point: DVec3, face: Face) -> DVec3 {
        if face.0 < SIDES {
            return if face.0 == u32::from(BOTTOM) { DVec3::NEG_Z } else { DVec3::Z };
        }
        let [a, b] = self.edge((face.0 - SIDES) as usize % self.points.len());
        DVec3::new(b.y - a.y, a.x - b.x, 0.0)
    }

    /// On the sides u runs along the outline from its first point in the order given and v along z; the ends are seen in
    /// the box about the outline.
    fn texture_coordinates(&self, p: DVec3, face: Face) -> DVec2 {
        if face.0 < SIDES {
            return (p.truncate() - self.low) / (self.high - self.low);
        }
        let k = (face.0 - SIDES) as usize;
        let [a, b] = self.edge(k);
        let share = ((p.truncate() - a).dot(b - a) / a.distance_squared(b)).clamp(0.0, 1.0);
        let whole = self.along[self.points.len()];
        let u = (self.along[k] + share * (self.along[k + 1] - self.along[k])) / whole;
        DVec2::new(if self.turned { 1.0 - u } else { u }, p.z)
    }

    fn comes_round(&self, face: Face) -> BVec2 {
        BVec2::new(face.0 >= SIDES, false)
    }

    fn support(&self, n: DVec3) -> DVec3 {
        let reach = |p: &&DVec2| n.truncate().dot(**p);
        let farthest = self.points.iter().max_by(|a, b| reach(a).total_cmp(&reach(b)));
        let z = if n.z < 0.0 { 0.0 } else { 1.0 };
        farthest.copied().unwrap_or_default().extend(z)
    }

    fn distance(&self, p: DVec3, length: &dyn Fn(DVec3) -> f64) -> f64 {
        let flat = p.truncate();
        let nearest = (0..self.points.len()).fold(f64::INFINITY, |nearest, k| {
            let [a, b] = self.edge(k);
            let share = ((flat - a).dot(b - a) / a.distance_squared(b)).clamp(0.0, 1.0);
            let off = flat - (a + share * (b - a));
            let distance = off.length();
            let slope = if distance > 0.0 { length((off / distance).extend(0.0)) } else { 1.0 };
            nearest.min(distance / slope)
        });
        let outline = if self.covers(flat) { -nearest } else { nearest };
        let slope = length(DVec3::Z);
        outline.max((p.z - 1.0) / slope).max(-p.z / slope)
    }
}
