//! The scene: classes as shared definitions, objects, and attributes looked up along the path to a leaf.

use std::collections::HashMap;

use crate::camera::{Camera, Lens};
use crate::color::Rgb;
use crate::csg::{ClassId, Solid};
use crate::light::Light;
use crate::optics::{ImageFile, Optics, Paint, Transparency};

/// Index of a set of attributes in its scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct AttributesId(pub u32);

impl AttributesId {
    /// Nothing is said.
    pub const NONE: Self = Self(0);
}

/// Attributes as written at one place; what is `None` comes from further out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes {
    /// Body colour, linear, 0…1.
    pub color: Option<Rgb>,
    /// Specular share, 0…1.
    pub shininess: Option<f64>,
    /// Beckmann slope, 0…1.
    pub smoothness: Option<f64>,
    /// `pure` or `composite`.
    pub pure: Option<bool>,
    /// Lets light through.
    pub transparency: Option<Transparency>,
    /// Rank among refracting solids.
    pub priority: Option<i32>,
    /// Coats in the order written; any coat here hides those further out.
    pub paint: Vec<Paint>,
}

impl Attributes {
    /// True if nothing is said.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// These attributes, with what they leave open taken from `outer`. Paint is not carried: it belongs to its frame.
    #[must_use]
    pub fn within(&self, outer: &Self) -> Self {
        Self {
            color: self.color.or(outer.color),
            shininess: self.shininess.or(outer.shininess),
            smoothness: self.smoothness.or(outer.smoothness),
            pure: self.pure.or(outer.pure),
            transparency: self.transparency.or(outer.transparency),
            priority: self.priority.or(outer.priority),
            paint: Vec::new(),
        }
    }

    /// The defaults in every place still open. A body that lets light through is shiniest by default.
    #[must_use]
    pub fn resolved(&self) -> Optics {
        let default = Optics::DEFAULT;
        let shininess = if self.transparency.is_some() { 1.0 } else { default.shininess };
        Optics {
            color: self.color.unwrap_or(default.color),
            shininess: self.shininess.unwrap_or(shininess),
            smoothness: self.smoothness.unwrap_or(default.smoothness),
            pure: self.pure.unwrap_or(default.pure),
            transparency: self.transparency,
            priority: self.priority.unwrap_or(default.priority),
        }
    }
}

/// A named solid that objects and later classes use as if it were a primitive.
#[derive(Clone, Debug, PartialEq)]
pub struct Class {
    /// Lower case.
    pub name: String,
    /// What it stands for.
    pub solid: Solid,
}

/// A solid that is in the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Lower case, if it was given one.
    pub name: Option<String>,
    /// Its shape.
    pub solid: Solid,
}

/// Everything a picture is made from.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// From where it is seen; a scene without one cannot be rendered.
    pub camera: Option<Camera>,
    /// Of its camera; none for a pinhole, and of no effect where rays are parallel.
    pub lens: Option<Lens>,
    /// Lights with a place or a direction.
    pub lights: Vec<Light>,
    /// Intensity times linear colour of the light from everywhere.
    pub ambient: Rgb,
    /// Linear colour of the infinitely distant sphere.
    pub background: Rgb,
    /// Rays in air fade to the background by half over this distance.
    pub fog_half_distance: Option<f64>,
    /// Pictures that paint shows, each file once.
    pub images: Vec<ImageFile>,
    /// Distinct sets of attributes; the first is empty.
    pub attributes: Vec<Attributes>,
    /// Classes; each refers only to earlier ones.
    pub classes: Vec<Class>,
    /// Objects in the order written.
    pub objects: Vec<Object>,
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            camera: None,
            lens: None,
            lights: Vec::new(),
            ambient: Rgb::ZERO,
            background: Rgb::ZERO,
            fog_half_distance: None,
            images: Vec::new(),
            attributes: vec![Attributes::default()],
            classes: Vec::new(),
            objects: Vec::new(),
        }
    }
}

impl Scene {
    /// Adds an object.
    pub fn add_object(&mut self, name: Option<String>, solid: Solid) {
        self.objects.push(Object { name, solid });
    }

    /// Adds a class.
    ///
    /// # Panics
    ///
    /// With more than 2³² classes.
    pub fn add_class(&mut self, name: String, solid: Solid) -> ClassId {
        self.classes.push(Class { name, solid });
        ClassId(u32::try_from(self.classes.len() - 1).expect("fewer than 2³² classes"))
    }
}

/// Gives equal sets of attributes the same index.
#[derive(Debug, Default)]
pub struct AttributesTable {
    by_text: HashMap<String, AttributesId>,
}

impl AttributesTable {
    /// The index of `attributes` in `scene`, added if it is new.
    ///
    /// # Panics
    ///
    /// With more than 2³² distinct sets.
    pub fn intern(&mut self, scene: &mut Scene, attributes: Attributes) -> AttributesId {
        if attributes.is_empty() {
            return AttributesId::NONE;
        }
        let next = AttributesId(
            u32::try_from(scene.attributes.len()).expect("fewer than 2³² sets of attributes"),
        );
        // The debug text tells any two sets apart, numbers to the last bit.
        *self.by_text.entry(format!("{attributes:?}")).or_insert_with(|| {
            scene.attributes.push(attributes);
            next
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Index;

    #[test]
    fn the_nearer_attribute_wins_and_defaults_come_last() {
        let inner = Attributes { shininess: Some(0.5), ..Attributes::default() };
        let outer =
            Attributes { shininess: Some(0.2), smoothness: Some(0.0), ..Attributes::default() };
        let optics = inner.within(&outer).resolved();
        assert!((optics.shininess - 0.5).abs() < 1e-16, "nearer");
        assert!(optics.smoothness.abs() < 1e-16, "outer");
        assert_eq!(optics.color, Rgb::ONE, "default");
    }

    #[test]
    fn clear_bodies_are_shiniest_unless_told_otherwise() {
        let glass = Transparency { half_distance: 1.0, index: Index::Refractive(1.5) };
        let clear = Attributes { transparency: Some(glass), ..Attributes::default() };
        assert!((clear.resolved().shininess - 1.0).abs() < 1e-16, "default of trans");
        let dull = Attributes { shininess: Some(0.0), ..clear };
        assert!(dull.resolved().shininess.abs() < 1e-16, "as written");
    }

    #[test]
    fn equal_sets_share_an_index() {
        let (mut scene, mut table) = (Scene::default(), AttributesTable::default());
        let red = Attributes { color: Some(Rgb::X), ..Attributes::default() };
        let a = table.intern(&mut scene, red.clone());
        let b = table.intern(&mut scene, Attributes { pure: Some(true), ..red.clone() });
        assert_eq!(table.intern(&mut scene, red), a, "same set");
        assert_ne!(a, b, "other set");
        assert_eq!(table.intern(&mut scene, Attributes::default()), AttributesId::NONE, "empty");
    }
}
