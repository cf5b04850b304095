//! Scenes for the comparison, written as trees and turned into scene data.

use glam::DVec3;
use scene::class::AttributesTable;
use scene::{
    Attributes, Camera, ClassId, Frame, FrameId, Index, Light, LightKind, Node, Placement,
    Primitive, Rgb, Scene, Solid, Transparency,
};

/// A solid to be written.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    Primitive(Primitive, Placement, Attributes),
    Form(scene::Form, Placement, Attributes),
    Instance(ClassId, Placement, Attributes),
    Group(Box<Self>, Placement, Attributes),
    Union(Vec<Self>),
    /// The first, less the others.
    Difference(Vec<Self>),
    Intersection(Vec<Self>),
}

impl Shape {
    pub(crate) fn plus(self, other: Self) -> Self {
        Self::Union(vec![self, other])
    }

    pub(crate) fn minus(self, other: Self) -> Self {
        Self::Difference(vec![self, other])
    }
}

/// How the objects of a scene are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Writing {
    Plain,
    /// Each as an instance of a class of its own, turned, stretched and mirrored with everything else.
    Instances,
    /// The same, in a scene that stands for so many primitives that its classes stay shared.
    Shared,
}

/// The size of a scene, where it stands, and how it is written.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Site {
    pub(crate) scale: f64,
    pub(crate) offset: f64,
    pub(crate) form: Writing,
}

impl Site {
    const fn new(scale: f64, offset: f64, form: Writing) -> Self {
        Self { scale, offset, form }
    }

    pub(crate) const UNIT: Self = Self::new(1.0, 0.0, Writing::Plain);
    /// Three sizes at the origin, and as many far from it.
    pub(crate) const ALL: [Self; 6] = [
        Self::UNIT,
        Self::new(1e-6, 0.0, Writing::Plain),
        Self::new(1e9, 0.0, Writing::Plain),
        Self::new(1.0, 1e6, Writing::Plain),
        Self::new(1e-6, 1.0, Writing::Plain),
        Self::new(1e9, 1e15, Writing::Plain),
    ];
    /// Those at the origin.
    pub(crate) const SIZES: [Self; 3] = [Self::ALL[0], Self::ALL[1], Self::ALL[2]];
    /// Behind instances.
    pub(crate) const INSTANCES: [Self; 6] = [
        Self::new(1.0, 0.0, Writing::Instances),
        Self::new(1e9, 0.0, Writing::Instances),
        Self::new(1e-6, 1.0, Writing::Instances),
        Self::new(1.0, 0.0, Writing::Shared),
        Self::new(1e9, 0.0, Writing::Shared),
        Self::new(1e-6, 1.0, Writing::Shared),
    ];

    /// Where an instance stands before the site is scaled and moved.
    fn instance() -> Placement {
        Placement {
            scale: DVec3::new(1.2, 1.0, -0.8),
            rotation_degrees: DVec3::new(10.0, 30.0, -20.0),
            place: DVec3::new(0.5, -1.0, 2.0),
        }
    }

    fn point(&self, point: DVec3) -> DVec3 {
        let point = match self.form {
            Writing::Plain => point,
            Writing::Instances | Writing::Shared => Self::instance().map().outward(point),
        };
        point * self.scale + self.offset
    }

    fn placement(&self, placement: &Placement) -> Placement {
        Placement {
            scale: placement.scale * self.scale,
            place: placement.place * self.scale + self.offset,
            ..*placement
        }
    }
}

/// A scene being written at a site.
#[derive(Debug)]
pub(crate) struct Author {
    pub(crate) scene: Scene,
    table: AttributesTable,
    site: Site,
}

impl Author {
    /// An empty scene with a camera.
    pub(crate) fn new(site: Site, eye: DVec3, target: DVec3) -> Self {
        let camera = Camera {
            position: site.point(eye),
            target: site.point(target),
            focal_length_mm: 50.0,
            parallel: false,
        };
        let scene = Scene {
            camera: Some(camera),
            ambient: Rgb::splat(0.3),
            background: Rgb::new(0.83, 0.75, 0.6),
            ..Scene::default()
        };
        Self { scene, table: AttributesTable::default(), site }
    }

    pub(crate) fn light(&mut self, mut kind: LightKind, color: Rgb) {
        match &mut kind {
            LightKind::Point { at } => *at = self.site.point(*at),
            LightKind::Beam { at, toward } | LightKind::Spot { at, toward, .. } => {
                *at = self.site.point(*at);
                *toward = self.site.point(*toward);
            }
        }
        self.scene.lights.push(Light { kind, color, shadows: true, radius: 0.0 });
    }

    /// Adds an object that stands at the site.
    pub(crate) fn object(&mut self, shape: &Shape) {
        let solid = if self.site.form == Writing::Plain {
            self.solid(shape, Some(self.site))
        } else {
            let class = self.class(shape);
            let instance = Shape::Instance(class, Site::instance(), Attributes::default());
            self.solid(&instance, Some(self.site))
        };
        self.scene.add_object(None, solid);
    }

    /// The scene; if its classes are to stay shared, with something small behind the camera that stands for 2¹⁷ spheres.
    pub(crate) fn finish(mut self) -> Scene {
        if let (Writing::Shared, Some(camera)) = (self.site.form, self.scene.camera) {
            let here = Attributes::default();
            let mut class = self.class(&sphere([0.0; 3], 1.0, &here));
            for level in 0..17 {
                let one = |x| Shape::Instance(class, stands([x, 0.0, 0.0], [0.5; 3]), here.clone());
                let two = one(0.5).plus(one(if level % 2 == 0 { 0.5 } else { -0.5 }));
                class = self.class(&two);
            }
            let away = camera.position - camera.target;
            let behind = (camera.position + 3.0 * away).to_array();
            let speck = stands(behind, [1e-3 * away.length(); 3]);
            let solid = self.solid(&Shape::Instance(class, speck, here), None);
            self.scene.add_object(Some("ballast".to_owned()), solid);
        }
        self.scene
    }

    /// Adds a class; its own coordinates know nothing of the site.
    pub(crate) fn class(&mut self, shape: &Shape) -> ClassId {
        let solid = self.solid(shape, None);
        let name = format!("c{}", self.scene.classes.len());
        self.scene.add_class(name, solid)
    }

    fn solid(&mut self, shape: &Shape, site: Option<Site>) -> Solid {
        let mut solid = Solid::default();
        self.write(&mut solid, shape, None, site);
        solid
    }

    /// `site` holds outside of every group.
    fn write(
        &mut self,
        to: &mut Solid,
        shape: &Shape,
        parent: Option<FrameId>,
        site: Option<Site>,
    ) {
        let count = |n: usize| u32::try_from(n).expect("a small solid");
        match shape {
            Shape::Primitive(kind, placement, attributes) => {
                let frame = self.frame(to, placement, attributes, parent, site);
                to.nodes.push(Node::Primitive { kind: *kind, frame });
            }
            Shape::Form(form, placement, attributes) => {
                let frame = self.frame(to, placement, attributes, parent, site);
                let form = to.add_form(form.clone());
                to.nodes.push(Node::Form { form, frame });
            }
            Shape::Instance(class, placement, attributes) => {
                let frame = self.frame(to, placement, attributes, parent, site);
                to.nodes.push(Node::Instance { class: *class, frame });
            }
            Shape::Group(inner, placement, attributes) => {
                let frame = self.frame(to, placement, attributes, parent, site);
                self.write(to, inner, Some(frame), None);
            }
            Shape::Union(terms) => {
                terms.iter().for_each(|term| self.write(to, term, parent, site));
                to.nodes.push(Node::Union(count(terms.len())));
            }
            Shape::Intersection(factors) => {
                factors.iter().for_each(|factor| self.write(to, factor, parent, site));
                to.nodes.push(Node::Intersection(count(factors.len())));
            }
            Shape::Difference(operands) => {
                for (number, operand) in operands.iter().enumerate() {
                    self.write(to, operand, parent, site);
                    if number > 0 {
                        to.nodes.push(Node::Complement);
                    }
                }
                to.nodes.push(Node::Intersection(count(operands.len())));
            }
        }
    }

    fn frame(
        &mut self,
        to: &mut Solid,
        placement: &Placement,
        attributes: &Attributes,
        parent: Option<FrameId>,
        site: Option<Site>,
    ) -> FrameId {
        let placement = site.map_or(*placement, |site| site.placement(placement));
        let mut attributes = attributes.clone();
        if let Some(transparency) = &mut attributes.transparency {
            transparency.half_distance *= self.site.scale;
        }
        let attributes = self.table.intern(&mut self.scene, attributes);
        to.frames.push(Frame { parent, placement, attributes });
        FrameId(u32::try_from(to.frames.len() - 1).expect("a small solid"))
    }
}

/// Scale and place, unturned.
pub(crate) fn stands(place: [f64; 3], scale: [f64; 3]) -> Placement {
    Placement {
        scale: DVec3::from_array(scale),
        place: DVec3::from_array(place),
        ..Placement::default()
    }
}

/// The block between two corners.
pub(crate) fn block(low: [f64; 3], high: [f64; 3], attributes: &Attributes) -> Shape {
    let middle = std::array::from_fn(|k| 0.5 * (low[k] + high[k]));
    let half = std::array::from_fn(|k| 0.5 * (high[k] - low[k]));
    Shape::Primitive(Primitive::Block, stands(middle, half), attributes.clone())
}

pub(crate) fn sphere(center: [f64; 3], radius: f64, attributes: &Attributes) -> Shape {
    Shape::Primitive(Primitive::Sphere, stands(center, [radius; 3]), attributes.clone())
}

/// A cylinder or a cone that stands on its start, or its apex, with its axis turned from x toward y by `degrees`.
pub(crate) fn upright(
    kind: Primitive,
    place: [f64; 3],
    (height, radius): (f64, f64),
    degrees: f64,
    attributes: &Attributes,
) -> Shape {
    let rotation_degrees = DVec3::new(0.0, 0.0, degrees);
    let placement = Placement { rotation_degrees, ..stands(place, [height, radius, radius]) };
    Shape::Primitive(kind, placement, attributes.clone())
}

/// A dull opaque body.
pub(crate) fn opaque(color: [f64; 3]) -> Attributes {
    Attributes { color: Some(Rgb::from_array(color)), ..Attributes::default() }
}

/// A clear body with smoothest surfaces; without an index it is `fake`.
pub(crate) fn clear(color: [f64; 3], half_distance: f64, index: Option<f64>) -> Attributes {
    let index = index.map_or(Index::Fake, Index::Refractive);
    Attributes {
        color: Some(Rgb::from_array(color)),
        smoothness: Some(0.0),
        transparency: Some(Transparency { half_distance, index }),
        ..Attributes::default()
    }
}

/// Random numbers that are the same everywhere (Steele et al., "Fast Splittable Pseudorandom Number Generators", 2014).
#[derive(Clone, Debug)]
pub(crate) struct Chance(u64);

impl Chance {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0xD134_2543_DE82_EF95))
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A whole number below `n`.
    pub(crate) fn below(&mut self, n: u32) -> u32 {
        u32::try_from(((self.next() >> 32) * u64::from(n)) >> 32).expect("below n")
    }

    /// A number from `low` to `high`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        let share = f64::from(self.below(u32::MAX)) / f64::from(u32::MAX);
        low + share * (high - low)
    }
}
