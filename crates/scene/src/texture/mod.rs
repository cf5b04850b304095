//! The table of texture functions. A function is one file here and one row.
//!
//! A function gives a weight in 0…1 at a point; paint blends toward its colour by it. Surface functions see the u, v
//! of the primitive, solid functions the point in the coordinates of the factor the paint is written at.

mod brick;
mod checker;
mod checker3d;
mod fourier;
mod gradient;
mod granite;
mod grid;
mod lattice;
mod marble;
mod noise;
mod rings;
mod spots;
mod stripes;
mod turbulence;
mod wood;

use std::fmt;

use glam::DVec3;

/// What a function is evaluated on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// (u, v, 0) of the primitive's surface.
    Surface,
    /// A point in space.
    Solid,
}

/// An argument of a texture function.
#[derive(Debug)]
pub struct Parameter {
    /// Its name in the language.
    pub name: &'static str,
    /// Its value where none is given.
    pub default: f64,
    /// The values it may have.
    pub range: Range,
}

/// What an argument may be, beside finite. Printed as it stands in messages: `above 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// More than this.
    Above(f64),
    /// From the first to the second, both included.
    Within(f64, f64),
    /// A whole number from the first to the second, both included.
    Whole(u32, u32),
}

impl Range {
    /// True if `value` is finite and in the range.
    #[must_use]
    pub fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Above(low) => value > low,
                Self::Within(low, high) => low <= value && value <= high,
                Self::Whole(low, high) => {
                    let whole = libm::floor(value) >= value;
                    whole && f64::from(low) <= value && value <= f64::from(high)
                }
            }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Above(low) => write!(out, "above {low}"),
            Self::Within(low, high) => write!(out, "from {low} to {high}"),
            Self::Whole(low, high) => write!(out, "a whole number from {low} to {high}"),
        }
    }
}

/// A texture function.
#[derive(Debug)]
pub struct Function {
    /// Its name in the language.
    pub keyword: &'static str,
    /// What it sees.
    pub domain: Domain,
    /// Its arguments, in the order they are given without names.
    pub parameters: &'static [Parameter],
    /// The weight; arguments are as many as there are parameters.
    weight: fn(&[f64], DVec3) -> f64,
}

/// Every texture function.
pub const FUNCTIONS: &[Function] = &[
    brick::FUNCTION,
    checker::FUNCTION,
    checker3d::FUNCTION,
    fourier::FUNCTION,
    gradient::FUNCTION,
    granite::FUNCTION,
    grid::FUNCTION,
    marble::FUNCTION,
    noise::FUNCTION,
    rings::FUNCTION,
    spots::FUNCTION,
    stripes::FUNCTION,
    turbulence::FUNCTION,
    wood::FUNCTION,
];

/// A texture function with its arguments.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    function: usize,
    arguments: Vec<f64>,
}

impl Texture {
    /// The function called `keyword` (in any case) with all arguments at their defaults.
    #[must_use]
    pub fn named(keyword: &str) -> Option<Self> {
        let function = FUNCTIONS.iter().position(|f| f.keyword.eq_ignore_ascii_case(keyword))?;
        let arguments = FUNCTIONS[function].parameters.iter().map(|p| p.default).collect();
        Some(Self { function, arguments })
    }

    /// The row of the table.
    #[must_use]
    pub fn function(&self) -> &'static Function {
        &FUNCTIONS[self.function]
    }

    /// The arguments, one for each parameter.
    #[must_use]
    pub fn arguments(&self) -> &[f64] {
        &self.arguments
    }

    /// Sets argument `index`.
    ///
    /// # Errors
    ///
    /// The parameter, if there is one, when `value` is not in its range.
    pub fn set(&mut self, index: usize, value: f64) -> Result<(), Option<&'static Parameter>> {
        let parameter = self.function().parameters.get(index).ok_or(None)?;
        if !parameter.range.contains(value) {
            return Err(Some(parameter));
        }
        self.arguments[index] = value;
        Ok(())
    }

    /// The weight in 0…1 at a point of the function's domain.
    #[must_use]
    pub fn weight(&self, point: DVec3) -> f64 {
        (self.function().weight)(&self.arguments, point)
    }
}

/// The argument of a parameter whose range is [`Range::Whole`].
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole, in its range")]
fn whole(argument: f64) -> u32 {
    argument as u32
}

#[cfg(test)]
mod tests;
