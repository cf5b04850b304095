//! The table of texture functions. A function is one file here and one row.
//!
//! Most give a weight in 0…1 at a point; paint blends toward its colour by it. Surface functions see the u, v of the
//! primitive, solid functions the point in the coordinates of the factor the paint is written at. Others say which place
//! of a picture is there, or raise the surface by another function.

mod brick;
mod bump;
mod checker;
mod checker3d;
mod decal;
mod filter;
mod fourier;
mod gradient;
mod granite;
mod grid;
mod image;
mod lattice;
mod marble;
mod noise;
mod parameter;
mod projection;
mod rings;
mod site;
mod spots;
mod stripes;
mod turbulence;
mod wood;

pub use filter::Spot;
pub(crate) use parameter::word;
pub use parameter::{Parameter, Range, Setting};
pub use site::{Edge, Placed, Site};

use parameter::whole;

use crate::optics::ImageId;

/// What a function is evaluated on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// (u, v, 0) of the primitive's surface.
    Surface,
    /// A point in space.
    Solid,
}

/// Where a function has its weight from.
#[derive(Clone, Copy, Debug)]
pub enum Weight {
    /// A formula: the mean in 0…1 over a spot of the function's domain. Arguments are as many as there are parameters.
    Formula(fn(&[f64], &Spot) -> f64),
    /// A picture: the place in it, or nothing where it is not seen.
    Picture(fn(&[f64], &Site) -> Option<Placed>),
    /// Another function, which raises the surface.
    Relief,
}

/// A texture function.
#[derive(Debug)]
pub struct Function {
    /// Its name in the language.
    pub keyword: &'static str,
    /// What it sees.
    pub domain: Domain,
    /// The numbers it takes, in the order they are given without names.
    pub parameters: &'static [Parameter],
    /// Where its weight comes from.
    pub weight: Weight,
}

impl Function {
    /// Its arguments as they are written, in the order they are given without names.
    pub fn settings(&self) -> impl Iterator<Item = Setting> + use<> {
        Setting::all(self.parameters)
    }

    /// What is given before the arguments: `file` or `function`.
    #[must_use]
    pub fn subject(&self) -> Option<&'static str> {
        match self.weight {
            Weight::Formula(_) => None,
            Weight::Picture(_) => Some("file"),
            Weight::Relief => Some("function"),
        }
    }
}

/// Every texture function.
pub const FUNCTIONS: &[Function] = &[
    brick::FUNCTION,
    bump::FUNCTION,
    checker::FUNCTION,
    checker3d::FUNCTION,
    decal::FUNCTION,
    fourier::FUNCTION,
    gradient::FUNCTION,
    granite::FUNCTION,
    grid::FUNCTION,
    image::FUNCTION,
    marble::FUNCTION,
    noise::FUNCTION,
    projection::FUNCTION,
    rings::FUNCTION,
    spots::FUNCTION,
    stripes::FUNCTION,
    turbulence::FUNCTION,
    wood::FUNCTION,
];

/// What a function works on beside its arguments.
#[derive(Clone, Debug, PartialEq)]
enum Subject {
    Nothing,
    Image(ImageId),
    /// Never a relief itself: there is one level of this.
    Function(Box<Texture>),
}

/// A texture function with its arguments, and the picture or the function that it works on.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    function: usize,
    arguments: Vec<f64>,
    subject: Subject,
}

impl Texture {
    /// The function called `keyword` (in any case) with all arguments at their defaults. One that works on a picture or
    /// on another function does nothing before it is given one.
    #[must_use]
    pub fn named(keyword: &str) -> Option<Self> {
        let function = FUNCTIONS.iter().position(|f| f.keyword.eq_ignore_ascii_case(keyword))?;
        let arguments = FUNCTIONS[function].parameters.iter().map(|p| p.default).collect();
        Some(Self { function, arguments, subject: Subject::Nothing })
    }

    /// The same with the picture that it works on.
    #[must_use]
    pub fn of_image(self, image: ImageId) -> Self {
        Self { subject: Subject::Image(image), ..self }
    }

    /// The same with the function that it works on; none if that is a relief.
    #[must_use]
    pub fn of_function(self, function: Self) -> Option<Self> {
        let relief = matches!(function.function().weight, Weight::Relief);
        (!relief).then(|| Self { subject: Subject::Function(Box::new(function)), ..self })
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

    /// The picture that it works on, itself or by the function that it works on.
    #[must_use]
    pub fn image(&self) -> Option<ImageId> {
        match &self.subject {
            Subject::Nothing => None,
            Subject::Image(image) => Some(*image),
            Subject::Function(function) => function.image(),
        }
    }

    /// Gives the picture that it works on, if there is one, another number.
    pub fn renumber_image(&mut self, number: impl Fn(ImageId) -> ImageId) {
        match &mut self.subject {
            Subject::Nothing => {}
            Subject::Image(image) => *image = number(*image),
            Subject::Function(function) => function.renumber_image(number),
        }
    }

    /// The function that it works on.
    #[must_use]
    pub fn inner(&self) -> Option<&Self> {
        match &self.subject {
            Subject::Function(function) => Some(function),
            Subject::Nothing | Subject::Image(_) => None,
        }
    }

    /// True if it has what it works on.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        match (self.function().weight, &self.subject) {
            (Weight::Formula(_), Subject::Nothing) | (Weight::Picture(_), Subject::Image(_)) => {
                true
            }
            (Weight::Relief, Subject::Function(function)) => function.is_whole(),
            _ => false,
        }
    }

    /// True if paint by it needs a colour: a picture has its own, and a relief can do without.
    #[must_use]
    pub fn needs_color(&self) -> bool {
        matches!(self.function().weight, Weight::Formula(_))
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

    /// The weight in 0…1 over a spot of the function's domain; none if it is not a formula.
    #[must_use]
    pub fn weight(&self, spot: &Spot) -> Option<f64> {
        match self.function().weight {
            Weight::Formula(formula) => Some(formula(&self.arguments, spot)),
            Weight::Picture(_) | Weight::Relief => None,
        }
    }
}

#[cfg(test)]
mod tests;
