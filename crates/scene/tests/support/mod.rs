//! Scenes at random, from a seed.

use glam::DVec3;
use scene::form::Row;
use scene::texture::{FUNCTIONS, Range, Texture, Weight};
use scene::{
    Attributes, AttributesId, Camera, Class, ClassId, Form, Frame, FrameId, ImageFile, ImageId,
    Index, Lens, Light, LightKind, Node, Paint, Placement, Primitive, Scene, Solid, Transparency,
};

/// Pictures of a random scene.
const IMAGES: u32 = 3;

fn image(number: u32) -> ImageFile {
    let path = [r"wall.png", r#"../a "b"\c d/é.idf"#, r"\"][number as usize].to_owned();
    ImageFile { path, source: "room 1.sdl".to_owned(), line: 1 + number, column: 7 }
}

/// `SplitMix64` (Steele et al., "Fast Splittable Pseudorandom Number Generators", 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub(crate) fn below(&mut self, end: u32) -> u32 {
        u32::try_from(self.bits() % u64::from(end)).unwrap()
    }

    pub(crate) fn chance(&mut self, one_in: u32) -> bool {
        self.below(one_in) == 0
    }

    /// From 0 to 1, both included now and then.
    pub(crate) fn share(&mut self) -> f64 {
        match self.below(12) {
            0 => 0.0,
            1 => 1.0,
            2 => 0.5,
            _ => f64::from(self.below(u32::MAX)) / f64::from(u32::MAX),
        }
    }

    /// Any size, any sign, either zero.
    pub(crate) fn number(&mut self) -> f64 {
        let sign = if self.chance(2) { -1.0 } else { 1.0 };
        sign * match self.below(8) {
            0 => 0.0,
            1 => f64::from(self.below(100)),
            2 => libm::exp10(f64::from(self.below(24)) - 12.0) * self.share(),
            _ => 10.0 * self.share(),
        }
    }

    pub(crate) fn above_zero(&mut self) -> f64 {
        self.number().abs() + 1e-3
    }

    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }

    pub(crate) fn color(&mut self) -> DVec3 {
        DVec3::new(self.share(), self.share(), self.share())
    }

    fn some<T>(&mut self, value: impl FnOnce(&mut Self) -> T) -> Option<T> {
        if self.chance(2) { Some(value(self)) } else { None }
    }

    fn placement(&mut self) -> Placement {
        let mut placement = Placement::default();
        if self.chance(2) {
            placement.scale = DVec3::from_array(std::array::from_fn(|_| {
                let factor = self.share() + 0.25;
                if self.chance(4) { -factor } else { factor }
            }));
        }
        if self.chance(2) {
            placement.rotation_degrees = self.vector();
        }
        if self.chance(2) {
            placement.place = self.vector();
        }
        placement
    }

    fn paint(&mut self) -> Paint {
        let function = &FUNCTIONS[self.below(u32::try_from(FUNCTIONS.len()).unwrap()) as usize];
        let mut texture = Texture::named(function.keyword).unwrap();
        for (i, parameter) in function.parameters.iter().enumerate() {
            let value = match parameter.range {
                Range::Above(low) => low + self.above_zero(),
                Range::Within(low, high) => low + (high - low) * self.share(),
                Range::Whole(low, high) => f64::from(low + self.below(high - low + 1)),
                Range::Any | Range::Coordinate(_) => self.number(),
                Range::Word(words) => f64::from(self.below(u32::try_from(words.len()).unwrap())),
            };
            texture.set(i, value).unwrap();
        }
        let texture = match function.weight {
            Weight::Formula(_) => texture,
            Weight::Picture(_) => texture.of_image(ImageId(self.below(IMAGES))),
            Weight::Relief => loop {
                let Paint { texture: inner, .. } = self.paint();
                if let Some(texture) = texture.clone().of_function(inner) {
                    break texture;
                }
            },
        };
        let color = if texture.needs_color() || self.chance(2) { Some(self.color()) } else { None };
        Paint { texture, color }
    }

    fn attributes(&mut self) -> Attributes {
        Attributes {
            color: self.some(Self::color),
            shininess: self.some(Self::share),
            smoothness: self.some(Self::share),
            pure: self.some(|random| random.chance(2)),
            transparency: self.some(|random| Transparency {
                half_distance: random.above_zero(),
                index: if random.chance(3) {
                    Index::Fake
                } else {
                    Index::Refractive(random.above_zero())
                },
            }),
            priority: self.some(|random| i32::try_from(random.below(200)).unwrap() - 100),
            paint: (0..self.below(3)).map(|_| self.paint()).collect(),
        }
    }

    fn light(&mut self) -> Light {
        let (at, toward) = (self.vector(), self.vector() + DVec3::new(0.5, 0.25, 100.0));
        let kind = match self.below(3) {
            0 => LightKind::Point { at },
            1 => LightKind::Beam { at, toward },
            _ => LightKind::Spot {
                at,
                toward,
                concentration: self.number().abs(),
                half_angle_degrees: 180.0 * self.share().max(0.01),
            },
        };
        let radius = if self.chance(3) { self.above_zero() } else { 0.0 };
        Light { kind, color: self.vector(), shadows: self.chance(2), radius }
    }

    /// A frame about every leaf, and groups as deep as `groups` about those.
    fn frames(&mut self, leaves: u32, groups: u32, sets: u32) -> Vec<Frame> {
        (0..groups + leaves)
            .map(|i| Frame {
                parent: if i == 0 || self.chance(5) {
                    None
                } else {
                    // The last group most times, so that chains get deep.
                    let nearest = i.min(groups) - u32::from(groups > 0);
                    Some(FrameId(if self.chance(3) { self.below(i) } else { nearest.min(i - 1) }))
                },
                placement: self.placement(),
                attributes: AttributesId(self.below(sets)),
            })
            .collect()
    }

    pub(crate) fn solid(&mut self, classes: u32, sets: u32) -> Solid {
        let mut forms = Solid::default();
        let (leaves, groups) = (1 + self.below(8), self.below(9));
        let frames = self.frames(leaves, groups, sets);
        let mut nodes = Vec::new();
        // For each operand so far, whether it may be the first of an intersection, or in a union.
        let mut plain: Vec<bool> = Vec::new();
        let mut leaf = 0;
        while leaf < leaves || plain.len() > 1 {
            let joined = plain.len();
            if joined >= 2 && (leaf == leaves || self.chance(3)) {
                let n = 2 + self.below(u32::try_from(joined).unwrap() - 1);
                let operands = &plain[joined - n as usize..];
                let union = operands.iter().all(|plain| *plain) && self.chance(2);
                if !operands[0] {
                    // A complement needs an operand before it; the first of all is plain.
                    continue;
                }
                nodes.push(if union { Node::Union(n) } else { Node::Intersection(n) });
                plain.truncate(joined - n as usize);
                plain.push(true);
                continue;
            }
            let frame = FrameId(groups + leaf);
            nodes.push(if self.chance(6) {
                Node::Form { form: forms.add_form(self.form()), frame }
            } else if classes > 0 && self.chance(2) {
                Node::Instance { class: ClassId(self.below(classes)), frame }
            } else {
                let all = Primitive::ALL;
                Node::Primitive {
                    kind: all[self.below(u32::try_from(all.len()).unwrap()) as usize],
                    frame,
                }
            });
            leaf += 1;
            let complement = joined > 0 && self.chance(3);
            if complement {
                nodes.push(Node::Complement);
            }
            plain.push(!complement);
        }
        Solid { frames, nodes, ..forms }
    }

    fn form(&mut self) -> Form {
        let (word, arguments) = if self.chance(2) {
            ("torus", vec![f64::from(1 + self.below(9)) * 0.1])
        } else {
            ("prism", vec![0.0, -0.1, f64::from(1 + self.below(9)), 0.3, 1.0 / 3.0, 2.0])
        };
        Form::new(Row::named(word).unwrap(), &arguments).unwrap()
    }

    pub(crate) fn scene(&mut self) -> Scene {
        let position = self.vector();
        let camera = Camera {
            parallel: self.below(2) == 0,
            position,
            target: position
                + self.color()
                + DVec3::new(0.0, 0.1, -1.0) * (1.0 + position.length()),
            focal_length_mm: self.above_zero(),
        };
        let sets = 1 + self.below(6);
        let camera = self.some(|_| camera);
        let lens =
            |random: &mut Self| Lens { aperture: random.above_zero(), focus: random.vector() };
        let mut scene = Scene {
            camera,
            lens: camera.and_then(|_| self.some(lens)),
            lights: (0..self.below(4)).map(|_| self.light()).collect(),
            ambient: self.some(Self::vector).unwrap_or_default(),
            background: self.some(Self::color).unwrap_or_default(),
            fog_half_distance: self.some(Self::above_zero),
            images: (0..IMAGES).map(image).collect(),
            ..Scene::default()
        };
        scene.attributes.extend((1..sets).map(|_| self.attributes()));
        for i in 0..self.below(5) {
            let solid = self.solid(i, sets);
            scene.classes.push(Class { name: format!("class_{i}"), solid });
        }
        for i in 0..self.below(5) {
            let solid = self.solid(u32::try_from(scene.classes.len()).unwrap(), sets);
            scene.add_object(self.some(|_| format!("object_é{i}")), solid);
        }
        scene
    }
}
