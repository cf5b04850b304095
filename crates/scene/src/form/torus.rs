//! Ring about the x axis: all points no farther than `tube` from the circle of radius 1 in the plane x = 0.
//!
//! No quartic is solved. Along a line of unit direction, with u = 0 at the point nearest the centre, the squared distance
//! to the circle is f(u) = (ρ − 1)² + x², where ρ is the distance from the axis, and half its slope is u − ρ′(u). As ρ
//! is the length of an affine vector, ρ′ rises from −m to m, m the length of the direction across the axis, and is convex
//! before its middle and concave after: the slope turns at most twice, in places that are known in closed form. Between
//! them it is monotone, and between its roots so is f. Each root is then found in its own bracket by Newton's method,
//! on f itself, whose terms are never multiplied out.

use std::ops::ControlFlow;

use glam::{BVec2, DVec2, DVec3};

use super::{Arguments, Body, FormError, Row, Take};
use crate::primitive::{Face, turn};
use crate::ray::{FacedSpan, Ray};
use crate::texture::{Parameter, Range};

pub(super) const ROW: Row = Row {
    keyword: "torus",
    arguments: Arguments::Numbers(&[Parameter {
        name: "tube",
        default: 0.25,
        range: Range::Within(1e-6, 1.0),
    }]),
    make,
};

struct Torus {
    /// Radius of the tube.
    tube: f64,
}

fn make(arguments: &[f64]) -> Result<Box<dyn Body>, FormError> {
    Ok(Box::new(Torus { tube: arguments[0] }))
}

/// A line by its point nearest the centre and its unit direction.
struct Line {
    point: DVec3,
    direction: DVec3,
}

impl Line {
    fn at(&self, u: f64) -> DVec3 {
        self.point + u * self.direction
    }

    /// Distance from the axis, and its slope along the line.
    fn radius(&self, u: f64) -> (f64, f64) {
        let p = self.at(u);
        let radius = (p.y * p.y + p.z * p.z).sqrt();
        let slope = p.y * self.direction.y + p.z * self.direction.z;
        (radius, if radius > 0.0 { slope / radius } else { 0.0 })
    }

    /// Half the slope of the squared distance to the circle, and its own slope.
    fn slope(&self, u: f64) -> (f64, f64) {
        let (radius, slope) = self.radius(u);
        let p = self.at(u);
        let across = p.y * self.direction.z - p.z * self.direction.y;
        (u - slope, 1.0 - across * across / (radius * radius * radius))
    }

    /// Squared distance to the circle less `square`, and its slope.
    fn excess(&self, u: f64, square: f64) -> (f64, f64) {
        let (radius, slope) = self.radius(u);
        let x = self.at(u).x;
        let q = radius - 1.0;
        (q * q + x * x - square, 2.0 * (u - slope))
    }

    /// Where the squared distance to the circle has its minima, and its maximum between them if there are two.
    fn extremes(&self) -> (f64, Option<(f64, f64)>) {
        let (p, d) = (self.point, self.direction);
        let m = (d.y * d.y + d.z * d.z).sqrt();
        let single = || (root(-m, m, |u| self.slope(u)), None);
        if m <= 0.0 {
            return single();
        }
        // The least distance from the axis over m², and where it is.
        let k = libm::cbrt((p.y * d.z - p.z * d.y).abs() / (m * m * m));
        let middle = -(p.y * d.y + p.z * d.z) / (m * m);
        let share = 1.0 - k * k;
        if share.is_nan() || share <= 0.0 || middle.abs() >= m * share * share.sqrt() {
            return single();
        }
        let turn = m * k * k * share.sqrt();
        let (low, high) = (middle - turn, middle + turn);
        let first = root(-m, low, |u| self.slope(u));
        let second = root(high, m, |u| self.slope(u));
        let between = root(low, high, |u| {
            let (value, slope) = self.slope(u);
            (-value, -slope)
        });
        (first, Some((between, second)))
    }
}

/// Where a function, given with its slope, comes from below 0 between `low` and `high`: Newton's steps, halving where
/// they leave the bracket or gain too little (Press et al., "Numerical Recipes", `rtsafe`).
fn root(low: f64, high: f64, function: impl Fn(f64) -> (f64, f64)) -> f64 {
    let (mut low, mut high) = (low, high);
    let mut at = low + 0.5 * (high - low);
    let mut last = high - low;
    // Halving alone comes to the end in 53 steps and a few.
    for _ in 0..100 {
        if at <= low || at >= high {
            break;
        }
        let (value, slope) = function(at);
        if value < 0.0 {
            low = at;
        } else if value > 0.0 {
            high = at;
        } else {
            return at;
        }
        let step = value / slope;
        let next = at - step;
        let gains = step.abs() < 0.5 * last && low < next && next < high;
        last = if gains { step.abs() } else { 0.5 * (high - low) };
        let next = if gains { next } else { low + 0.5 * (high - low) };
        if (next - at).abs() <= 0.25 * f64::EPSILON * (1.0 + at.abs()) {
            return next;
        }
        at = next;
    }
    at
}

impl Torus {
    /// Where the line is inside, up to two times.
    fn inside(&self, line: &Line) -> [Option<(f64, f64)>; 2] {
        let square = self.tube * self.tube;
        let outer = 1.0 + self.tube;
        let reach = outer * outer - line.point.length_squared();
        if reach <= 0.0 || reach.is_nan() {
            return [None, None];
        }
        let reach = reach.sqrt();
        let excess = |u: f64| line.excess(u, square);
        let rises = |low: f64, high: f64| root(low, high, excess);
        let falls = |low: f64, high: f64| {
            root(low, high, |u| {
                let (value, slope) = excess(u);
                (-value, -slope)
            })
        };
        let is_in = |u: f64| excess(u).0 < 0.0;
        let (first, rest) = line.extremes();
        let start = || falls(-reach, first);
        let Some((between, second)) = rest else {
            return [is_in(first).then(|| (start(), rises(first, reach))), None];
        };
        if excess(between).0 <= 0.0 {
            return [is_in(first).then(|| (start(), rises(second, reach))), None];
        }
        [
            is_in(first).then(|| (start(), rises(first, between))),
            is_in(second).then(|| (falls(between, second), rises(second, reach))),
        ]
    }
}

impl Body for Torus {
    fn spans(&self, ray: &Ray, take: Take<'_>) -> ControlFlow<()> {
        let (origin, direction) = (DVec3::from_array(ray.origin), DVec3::from_array(ray.direction));
        let length = direction.length();
        let direction = direction / length;
        let nearest = -origin.dot(direction);
        let line = Line { point: origin + nearest * direction, direction };
        let mut last: Option<(f64, f64)> = None;
        let span = |(from, to): (f64, f64)| FacedSpan {
            from: (nearest + from) / length,
            to: (nearest + to) / length,
            ..FacedSpan::line()
        };
        for (from, to) in self.inside(&line).into_iter().flatten() {
            match last {
                // Nothing is left between them.
                Some((begin, end)) if span((from, to)).from <= span((begin, end)).to => {
                    last = Some((begin, to));
                    continue;
                }
                Some(done) => take(span(done))?,
                None => {}
            }
            last = Some((from, to));
        }
        match last.map(span) {
            Some(span) if span.from < span.to => take(span),
            _ => ControlFlow::Continue(()),
        }
    }

    fn contains(&self, p: DVec3) -> bool {
        let q = (p.y * p.y + p.z * p.z).sqrt() - 1.0;
        q * q + p.x * p.x <= self.tube * self.tube
    }

    /// Away from the nearest point of the circle.
    fn gradient(&self, p: DVec3, _face: Face) -> DVec3 {
        let radius = (p.y * p.y + p.z * p.z).sqrt();
        if radius <= 0.0 {
            return if p.x < 0.0 { DVec3::NEG_X } else { DVec3::X };
        }
        let share = (radius - 1.0) / radius;
        DVec3::new(p.x, share * p.y, share * p.z)
    }

    /// u turns about the axis, v about the tube from its outermost circle.
    fn texture_coordinates(&self, p: DVec3, _face: Face) -> DVec2 {
        let q = (p.y * p.y + p.z * p.z).sqrt() - 1.0;
        DVec2::new(turn(p.y, p.z), turn(q, p.x))
    }

    fn comes_round(&self, _face: Face) -> BVec2 {
        BVec2::TRUE
    }

    fn support(&self, n: DVec3) -> DVec3 {
        let ring = DVec2::new(n.y, n.z).normalize_or(DVec2::X);
        DVec3::new(0.0, ring.x, ring.y) + self.tube * n.normalize_or_zero()
    }

    fn distance(&self, p: DVec3, length: &dyn Fn(DVec3) -> f64) -> f64 {
        let gradient = self.gradient(p, Face(0));
        let away = gradient.length();
        let value = away - self.tube;
        if away > 0.0 { value / length(gradient / away) } else { f64::NEG_INFINITY }
    }
}
