//! The convex primitives as solid quadrics between planes, and the span of a whole line inside of them.

use scene::{Form, Primitive};

use super::dd::{Dd, Vec3, dot, unit};
use super::finish::Finish;
use super::form;
use super::place::Affine;

/// A body that lets light through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clear {
    pub(crate) half_distance: f64,
    /// `None` is `fake`.
    pub(crate) index: Option<f64>,
}

/// Which solid a body is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Kind {
    Convex(Primitive),
    /// With arguments; a line may be inside several times.
    Form(Form),
}

/// A primitive where it stands.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) kind: Kind,
    pub(crate) map: Affine,
    /// The largest number that went into its place, half extent included.
    pub(crate) magnitude: f64,
    pub(crate) color: [f64; 3],
    pub(crate) shininess: f64,
    pub(crate) finish: Finish,
    /// `None` is opaque.
    pub(crate) clear: Option<Clear>,
    pub(crate) priority: i32,
}

/// Where a line passes the surface, and the unit normal there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct End {
    pub(crate) t: Dd,
    pub(crate) outward: Vec3,
    pub(crate) surface: Surface,
}

/// The surface at an end of a span.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Surface {
    Curved,
    /// The plane across an axis, with the sign of its outward normal.
    Plane(usize, f64),
}

/// The part of a line that is still inside.
struct Span {
    from: Option<(Dd, Surface)>,
    to: Option<(Dd, Surface)>,
}

impl Span {
    fn begin(&mut self, t: Dd, surface: Surface) {
        if self.from.is_none_or(|(from, _)| t > from) {
            self.from = Some((t, surface));
        }
    }

    fn end(&mut self, t: Dd, surface: Surface) {
        if self.to.is_none_or(|(to, _)| t < to) {
            self.to = Some((t, surface));
        }
    }

    /// Cuts by the half-space `sign · x ≤ bound`; false if nothing is left.
    fn cut(&mut self, o: Dd, d: Dd, axis: usize, sign: f64, bound: f64) -> bool {
        let (o, d) = (o * Dd::from(sign), d * Dd::from(sign));
        let bound = Dd::from(bound);
        let plane = Surface::Plane(axis, sign);
        if d > Dd::ZERO {
            self.end((bound - o) / d, plane);
        } else if d < Dd::ZERO {
            self.begin((bound - o) / d, plane);
        } else {
            return o <= bound;
        }
        true
    }
}

/// A quadric about the x axis: `x² · form[0] + y² + z² − x · form[1] ≤ form[2]`.
fn quadric(kind: Primitive) -> Option<[f64; 3]> {
    match kind {
        Primitive::Sphere => Some([1.0, 0.0, 1.0]),
        Primitive::Cylinder => Some([0.0, 0.0, 1.0]),
        Primitive::Cone => Some([-1.0, 0.0, 0.0]),
        Primitive::Paraboloid => Some([0.0, 1.0, 0.0]),
        Primitive::Block => None,
    }
}

/// Half the gradient of a quadric, without the part that does not grow with the point.
fn weighed(v: &Vec3, form: [f64; 3]) -> Vec3 {
    [Dd::from(form[0]) * v[0], v[1], v[2]]
}

impl Body {
    /// Where the line `origin + t · direction` goes in and out, in order.
    pub(crate) fn spans(&self, origin: &Vec3, direction: &Vec3) -> Vec<[End; 2]> {
        let (o, d) = (self.map.point_inward(origin), self.map.direction_inward(direction));
        match &self.kind {
            Kind::Convex(kind) => self.convex(*kind, &o, &d).into_iter().collect(),
            Kind::Form(form) => {
                let outer = |end: End| End { outward: self.outer_normal(&end.outward), ..end };
                form::spans(form, &o, &d).into_iter().map(|span| span.map(outer)).collect()
            }
        }
    }

    fn outer_normal(&self, gradient: &Vec3) -> Vec3 {
        unit(&self.map.gradient_outward(gradient))
    }

    fn convex(&self, kind: Primitive, o: &Vec3, d: &Vec3) -> Option<[End; 2]> {
        let mut span = Span { from: None, to: None };
        let planes: &[(usize, f64, f64)] = match kind {
            Primitive::Sphere => &[],
            Primitive::Cylinder | Primitive::Cone => &[(0, -1.0, 0.0), (0, 1.0, 1.0)],
            Primitive::Paraboloid => &[(0, 1.0, 1.0)],
            Primitive::Block => &[
                (0, -1.0, 1.0),
                (0, 1.0, 1.0),
                (1, -1.0, 1.0),
                (1, 1.0, 1.0),
                (2, -1.0, 1.0),
                (2, 1.0, 1.0),
            ],
        };
        for &(axis, sign, bound) in planes {
            if !span.cut(o[axis], d[axis], axis, sign, bound) {
                return None;
            }
        }
        let quadric = quadric(kind);
        if let Some(form) = quadric {
            curve(&mut span, o, d, form)?;
        }
        let ((from, entered), (to, left)) = (span.from?, span.to?);
        let end =
            |t: Dd, surface| End { t, outward: self.outward(quadric, o, d, t, surface), surface };
        (from < to).then(|| [end(from, entered), end(to, left)])
    }

    fn outward(
        &self,
        quadric: Option<[f64; 3]>,
        o: &Vec3,
        d: &Vec3,
        t: Dd,
        surface: Surface,
    ) -> Vec3 {
        let mut gradient = [Dd::ZERO; 3];
        match (surface, quadric) {
            (Surface::Plane(axis, sign), _) => gradient[axis] = Dd::from(sign),
            (Surface::Curved, Some(form)) => {
                gradient = weighed(&std::array::from_fn(|k| o[k] + t * d[k]), form);
                gradient[0] = gradient[0] - Dd::from(0.5 * form[1]);
            }
            (Surface::Curved, None) => unreachable!("blocks are flat"),
        }
        self.outer_normal(&gradient)
    }
}

/// Cuts a span by the inside of a quadric: the roots of `a t² + 2 b t + c`. For the cone the plane at the apex has been
/// there before, so of two nappes the one that is meant is that which `x ≥ 0` leaves.
fn curve(span: &mut Span, o: &Vec3, d: &Vec3, form: [f64; 3]) -> Option<()> {
    let a = dot(&weighed(d, form), d);
    let b = dot(&weighed(o, form), d) - Dd::from(0.5 * form[1]) * d[0];
    let c = dot(&weighed(o, form), o) - Dd::from(form[1]) * o[0] - Dd::from(form[2]);
    let discriminant = b * b - a * c;
    if a > Dd::ZERO {
        if discriminant <= Dd::ZERO {
            return None;
        }
        let [near, far] = roots(a, b, c, discriminant.sqrt());
        span.begin(near, Surface::Curved);
        span.end(far, Surface::Curved);
    } else if a < Dd::ZERO {
        // Steeper than the generators: outside between the roots, one nappe before them and one after.
        let [first, last] = roots(a, b, c, discriminant.sqrt());
        if d[0] > Dd::ZERO {
            span.begin(last, Surface::Curved);
        } else {
            span.end(first, Surface::Curved);
        }
    } else if b > Dd::ZERO {
        span.end(-c / (b + b), Surface::Curved);
    } else if b < Dd::ZERO {
        span.begin(-c / (b + b), Surface::Curved);
    } else if c > Dd::ZERO {
        return None;
    }
    Some(())
}

/// The roots of `a t² + 2 b t + c` in order, the one that would cancel by way of the other: along a generator or the axis
/// of a paraboloid `a` is next to nothing.
fn roots(a: Dd, b: Dd, c: Dd, root: Dd) -> [Dd; 2] {
    let sum = if b > Dd::ZERO { -b - root } else { root - b };
    let roots = [sum / a, if sum == Dd::ZERO { Dd::ZERO } else { c / sum }];
    if roots[0] < roots[1] { roots } else { [roots[1], roots[0]] }
}
