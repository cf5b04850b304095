//! The table of solids that take arguments. A solid is one file here and one row.
//!
//! Each stands in its own local space and need not be convex: a line may be inside it several times. So it is asked for
//! the span that holds a parameter or follows it.

mod prism;
mod terrain;
mod torus;

use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{BVec2, DMat3, DVec2, DVec3};

use crate::lanes::Lanes;
use crate::primitive::{Face, boxed};
use crate::ray::{Bounds, FacedSpan, Ray};
use crate::texture::Parameter;

/// Takes spans in order until it has seen enough.
type Take<'a> = &'a mut dyn FnMut(FacedSpan) -> ControlFlow<()>;

/// What a row of the table makes of its arguments.
trait Body: Send + Sync {
    /// All spans of the line of `ray`, in order, none empty and no two touching.
    fn spans(&self, ray: &Ray, take: Take<'_>) -> ControlFlow<()>;
    fn contains(&self, point: DVec3) -> bool;
    /// Any face may be asked for: lanes that mean nothing have those of other solids.
    fn gradient(&self, point: DVec3, face: Face) -> DVec3;
    fn texture_coordinates(&self, point: DVec3, face: Face) -> DVec2;
    fn comes_round(&self, _face: Face) -> BVec2 {
        BVec2::FALSE
    }
    fn support(&self, direction: DVec3) -> DVec3;
    fn distance(&self, point: DVec3, length: &dyn Fn(DVec3) -> f64) -> f64;
}

/// Makes a solid of arguments that are as many, and in the ranges, as the row says.
type Make = fn(&[f64]) -> Result<Box<dyn Body>, FormError>;

/// What stands in the parentheses behind the word.
#[derive(Clone, Copy, Debug)]
pub enum Arguments {
    /// Numbers with names and defaults.
    Numbers(&'static [Parameter]),
    /// Points (x, y) in a plane: two numbers each.
    Points,
}

/// A solid that takes arguments.
pub struct Row {
    /// Its name in the language.
    pub keyword: &'static str,
    /// What it takes.
    pub arguments: Arguments,
    make: Make,
}

/// Every solid that takes arguments.
pub const FORMS: &[Row] = &[prism::ROW, terrain::ROW, torus::ROW];

/// Why arguments make no solid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormError {
    /// Which of the numbers is at fault.
    pub argument: usize,
    /// What is expected.
    pub expected: String,
    /// What is there.
    pub found: String,
}

impl fmt::Display for FormError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "expected {}, found {}", self.expected, self.found)
    }
}

impl std::error::Error for FormError {}

struct Inner {
    row: &'static Row,
    arguments: Vec<f64>,
    body: Box<dyn Body>,
}

/// A solid with its arguments, ready to be met by rays. A copy shares all of it.
///
/// What rays ask is kept out of line, so that scenes without such solids do not pay for them.
#[derive(Clone)]
pub struct Form(Arc<Inner>);

impl Row {
    /// The row of the solid called `word`, in any case.
    #[must_use]
    pub fn named(word: &str) -> Option<&'static Self> {
        FORMS.iter().find(|row| row.keyword.eq_ignore_ascii_case(word))
    }

    /// The defaults of all arguments, if each has one.
    #[must_use]
    pub fn defaults(&self) -> Option<Vec<f64>> {
        match self.arguments {
            Arguments::Numbers(parameters) => Some(parameters.iter().map(|p| p.default).collect()),
            Arguments::Points => None,
        }
    }

    /// How it is written.
    #[must_use]
    pub fn shape(&self) -> String {
        let inside = match self.arguments {
            Arguments::Numbers(parameters) => {
                let one = |p: &Parameter| format!("{} = {}", p.name, p.default);
                parameters.iter().map(one).collect::<Vec<_>>().join(", ")
            }
            Arguments::Points => "(x, y), (x, y), (x, y), …".to_owned(),
        };
        format!("{} ({inside})", self.keyword)
    }
}

impl Form {
    /// The solid of a row with these arguments.
    ///
    /// # Errors
    ///
    /// The first argument that is at fault: too few or too many of them, one out of its range, or an outline that
    /// crosses itself.
    pub fn new(row: &'static Row, arguments: &[f64]) -> Result<Self, FormError> {
        if let Arguments::Numbers(parameters) = row.arguments {
            if arguments.len() != parameters.len() {
                return Err(FormError {
                    argument: arguments.len().min(parameters.len()),
                    expected: format!("{} arguments", parameters.len()),
                    found: arguments.len().to_string(),
                });
            }
            let wrong = parameters.iter().zip(arguments).position(|(p, a)| !p.range.contains(*a));
            if let Some(argument) = wrong {
                let Parameter { name, range, .. } = &parameters[argument];
                let (expected, found) = (format!("`{name}` {range}"), arguments[argument]);
                return Err(FormError { argument, expected, found: found.to_string() });
            }
        }
        let body = (row.make)(arguments)?;
        Ok(Self(Arc::new(Inner { row, arguments: arguments.to_vec(), body })))
    }

    /// The row of the table.
    #[must_use]
    pub fn row(&self) -> &'static Row {
        self.0.row
    }

    /// The arguments, as they were given.
    #[must_use]
    pub fn arguments(&self) -> &[f64] {
        &self.0.arguments
    }

    /// The first span of the line of `ray`, given in local space, that ends after `t`; an empty one if there is none.
    #[must_use]
    #[cold]
    #[inline(never)]
    pub fn span_at<L: Lanes>(&self, ray: &Ray<L>, t: L) -> FacedSpan<L> {
        let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin, ray.direction);
        let of_one = |[ox, oy, oz, dx, dy, dz, t]: [f64; 7]| {
            let ray = Ray { origin: [ox, oy, oz], direction: [dx, dy, dz] };
            let FacedSpan { from, to, from_face, to_face } = self.span_of_one(&ray, t);
            [from, to, from_face, to_face]
        };
        let [from, to, from_face, to_face] = L::each([ox, oy, oz, dx, dy, dz, t], of_one);
        FacedSpan { from, to, from_face, to_face }
    }

    fn span_of_one(&self, ray: &Ray, t: f64) -> FacedSpan {
        let mut found = FacedSpan::line().only(false);
        let _ = self.0.body.spans(ray, &mut |span| {
            if t < span.to {
                found = span;
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        found
    }

    /// The span of the line of `ray`, given in local space, one end of which is nearest to `t`; an empty one if there
    /// is none.
    #[must_use]
    #[cold]
    #[inline(never)]
    pub fn span_about(&self, ray: &Ray, t: f64) -> FacedSpan {
        let (mut found, mut least) = (FacedSpan::line().only(false), f64::INFINITY);
        let _ = self.0.body.spans(ray, &mut |span| {
            let off = (span.from - t).abs().min((span.to - t).abs());
            if off < least {
                (found, least) = (span, off);
            }
            ControlFlow::Continue(())
        });
        found
    }

    /// True if the local `point` is inside or on the surface.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        self.0.body.contains(point)
    }

    /// [`Form::contains`] in lanes.
    #[must_use]
    #[cold]
    #[inline(never)]
    pub fn contains_lanes<L: Lanes>(&self, point: [L; 3]) -> L::Mask {
        let inside = |p: [f64; 3]| [if self.contains(DVec3::from_array(p)) { 1.0 } else { 0.0 }];
        L::each(point, inside)[0].is(1.0)
    }

    /// [`Form::gradient`] in lanes, of a face as a number.
    #[must_use]
    #[cold]
    #[inline(never)]
    pub fn gradient_lanes<L: Lanes>(&self, [x, y, z]: [L; 3], face: L) -> [L; 3] {
        L::each([x, y, z, face], |[x, y, z, face]| {
            self.gradient(DVec3::new(x, y, z), Face::from_number(face)).to_array()
        })
    }

    /// The outward gradient at a local point of `face`; of any length but 0.
    #[must_use]
    pub fn gradient(&self, point: DVec3, face: Face) -> DVec3 {
        self.0.body.gradient(point, face)
    }

    /// Where a local point of `face` lies in the surface: u and v in 0…1.
    #[must_use]
    pub fn texture_coordinates(&self, point: DVec3, face: Face) -> DVec2 {
        self.0.body.texture_coordinates(point, face)
    }

    /// Whether u and v of `face` come round: go on from 1 at 0.
    #[must_use]
    pub fn comes_round(&self, face: Face) -> BVec2 {
        self.0.body.comes_round(face)
    }

    /// The local point farthest along `direction`; one of them if there are several.
    #[must_use]
    pub fn support(&self, direction: DVec3) -> DVec3 {
        self.0.body.support(direction)
    }

    /// The least box about the solid under the map `linear · p + place`, up to rounding.
    #[must_use]
    pub fn bounds(&self, linear: &DMat3, place: DVec3) -> Bounds {
        boxed(linear, place, |direction| self.support(direction))
    }

    /// Signed distance of a local point to the surface, to first order, in the units of `length`, which measures a
    /// local gradient there. Negative inside.
    #[must_use]
    pub fn distance(&self, point: DVec3, length: impl Fn(DVec3) -> f64) -> f64 {
        self.0.body.distance(point, &length)
    }
}

impl PartialEq for Form {
    fn eq(&self, other: &Self) -> bool {
        let bits = |form: &Self| form.arguments().iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        Arc::ptr_eq(&self.0, &other.0)
            || self.row().keyword == other.row().keyword && bits(self) == bits(other)
    }
}

impl fmt::Debug for Form {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.debug_tuple(self.row().keyword).field(&self.arguments()).finish()
    }
}

impl fmt::Debug for Row {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.debug_struct("Row").field("keyword", &self.keyword).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
