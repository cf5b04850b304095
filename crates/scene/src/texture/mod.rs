//! The table of texture functions. A function is one file here and one row.
//!
//! A function gives a weight in 0…1 at a point; paint blends toward its colour by it. Surface functions see the u, v
//! of the primitive, solid functions the point in the coordinates of the factor the paint is written at.

mod checker;
mod checker3d;
mod gradient;
mod marble;
mod noise;
mod stripes;
mod wood;

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
    /// Only values above this are meant.
    pub above: f64,
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
    checker::FUNCTION,
    checker3d::FUNCTION,
    gradient::FUNCTION,
    marble::FUNCTION,
    stripes::FUNCTION,
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
    /// The parameter, if there is one, when `value` is not above its bound or not finite.
    pub fn set(&mut self, index: usize, value: f64) -> Result<(), Option<&'static Parameter>> {
        let parameter = self.function().parameters.get(index).ok_or(None)?;
        if !value.is_finite() || value <= parameter.above {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_distinct_lower_case_and_files() {
        for (i, function) in FUNCTIONS.iter().enumerate() {
            assert_eq!(function.keyword, function.keyword.to_ascii_lowercase(), "case");
            assert!(FUNCTIONS[..i].iter().all(|f| f.keyword < function.keyword), "sorted");
            let file =
                format!("{}/src/texture/{}.rs", env!("CARGO_MANIFEST_DIR"), function.keyword);
            assert!(std::path::Path::new(&file).exists(), "{file}");
            for parameter in function.parameters {
                assert!(parameter.default > parameter.above, "{}", parameter.name);
            }
        }
    }

    #[test]
    fn weights_stay_in_range_over_many_decades() {
        for function in FUNCTIONS {
            let texture = Texture::named(function.keyword).unwrap();
            let mut sum = 0.0;
            for decade in -12..=12 {
                for i in 0..200 {
                    let f = f64::from(i);
                    let p = DVec3::new(f * 0.37 - 31.0, f * -0.11 + 7.0, f * 0.53)
                        * libm::exp10(f64::from(decade));
                    let weight = texture.weight(p);
                    assert!((0.0..=1.0).contains(&weight), "{} at {p}: {weight}", function.keyword);
                    sum += weight;
                }
            }
            assert!(sum > 1.0 && sum < 4999.0, "{} says something: {sum}", function.keyword);
        }
    }

    #[test]
    fn values_by_hand() {
        let at = |keyword: &str, x: f64, y: f64, z: f64| {
            Texture::named(keyword).unwrap().weight(DVec3::new(x, y, z))
        };
        // 8 × 8 fields; the first is unpainted.
        assert!(at("checker", 0.01, 0.01, 0.0) < 0.5, "first field");
        assert!(at("checker", 0.13, 0.01, 0.0) > 0.5, "second field");
        assert!(at("checker", 0.13, 0.13, 0.0) < 0.5, "diagonal");
        assert!(at("checker3d", 0.5, 0.5, 0.5) < 0.5, "first cube");
        assert!(at("checker3d", -0.5, 0.5, 0.5) > 0.5, "across the origin");
        assert!(at("stripes", 0.0, 0.01, 0.0) < 0.5, "first stripe");
        assert!(at("stripes", 0.0, 0.13, 0.0) > 0.5, "second stripe");
        assert!((at("gradient", 9.0, 0.25, 9.0) - 0.25).abs() < 1e-16, "height");
    }

    #[test]
    fn bad_arguments_are_refused() {
        let mut texture = Texture::named("wood").unwrap();
        assert!(texture.set(0, 2.0).is_ok(), "in range");
        assert_eq!(texture.set(0, 0.0).unwrap_err().unwrap().name, "scale", "not above 0");
        assert!(texture.set(0, f64::NAN).is_err(), "not a number");
        assert!(texture.set(9, 1.0).unwrap_err().is_none(), "no such parameter");
    }
}
