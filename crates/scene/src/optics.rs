//! What light does at a surface and inside a body, as numbers.

use crate::color::Rgb;
use crate::texture::Texture;

/// How rays bend when they enter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Index {
    /// Index of refraction, above 0; air is 1.
    Refractive(f64),
    /// Straight through, and nothing reflected.
    Fake,
}

/// A body that lets light through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transparency {
    /// White light halves over this distance, in scene units; above 0.
    pub half_distance: f64,
    /// How rays bend.
    pub index: Index,
}

/// One coat of paint: the colour below is blended toward `color` by the texture's weight.
#[derive(Clone, Debug, PartialEq)]
pub struct Paint {
    /// Function and arguments.
    pub texture: Texture,
    /// Where the weight is 1. Without one a picture shows its own colours, and a relief has none.
    pub color: Option<Rgb>,
}

/// Index of a picture's file in its scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ImageId(pub u32);

/// A file with a picture that paint shows. Two are equal if they are the same file: the place is for messages.
#[derive(Clone, Debug)]
pub struct ImageFile {
    /// Where it is: from the working folder, or in a compiled scene from the folder of that.
    pub path: String,
    /// The file that names it; empty as a compiled scene is read, which knows no name.
    pub source: String,
    /// Line of the name in it, from 1.
    pub line: u32,
    /// Column of the name, from 1.
    pub column: u32,
}

impl PartialEq for ImageFile {
    fn eq(&self, other: &Self) -> bool {
        self.path == other.path
    }
}

impl Eq for ImageFile {}

/// Attributes with nothing left open.
#[derive(Clone, Debug, PartialEq)]
pub struct Optics {
    /// Body colour, linear, 0…1.
    pub color: Rgb,
    /// Specular share s, 0…1.
    pub shininess: f64,
    /// Beckmann slope m of the facets; 0 is a traced mirror.
    pub smoothness: f64,
    /// Highlights take the body colour.
    pub pure: bool,
    /// Opaque without.
    pub transparency: Option<Transparency>,
    /// Which of two refracting solids fills shared space: the higher.
    pub priority: i32,
}

impl Optics {
    /// What is left where nothing is said: white, dullest, rough, composite, opaque.
    pub const DEFAULT: Self = Self {
        color: Rgb::ONE,
        shininess: 0.0,
        smoothness: 0.25,
        pure: false,
        transparency: None,
        priority: 0,
    };
}
