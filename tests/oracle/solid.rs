//! The expression as a binary tree, classes written out, and what its bodies make of a point.

use scene::{AttributesId, FrameId, Node, Scene, Solid};

use super::body::{Body, Clear, Kind};
use super::dd::{Vec3, largest};
use super::finish::Finish;
use super::form;
use super::paint::Coat;
use super::place::Affine;

/// A solid as written; leaves are numbers of bodies.
#[derive(Debug)]
pub(crate) enum Tree {
    Body(usize),
    Union(Box<Self>, Box<Self>),
    Intersection(Box<Self>, Box<Self>),
    Difference(Box<Self>, Box<Self>),
}

/// Who fills a point: opaque before clear before `fake`, then the higher priority, then the earlier in the source.
type Claim = (u8, i64, usize);

/// Claims on either side of a surface.
type Claims = [Option<Claim>; 2];

/// All bodies of a scene in source order and the tree of each object.
#[derive(Debug, Default)]
pub(crate) struct Solids {
    pub(crate) bodies: Vec<Body>,
    /// Surfaces coincide that are at most this many rounding bounds apart.
    pub(crate) grain: f64,
    /// Unless 0, lots are drawn, from this and the ray, wherever surfaces may coincide or not: see `line::coincide`.
    pub(crate) salt: u64,
    objects: Vec<Tree>,
}

/// Attributes, and the map to the space of the factor that they are written at.
type Level = (AttributesId, Affine);

/// What a solid is read in: its place, and the attributes around it from the inside out.
struct Around<'a> {
    map: &'a Affine,
    magnitude: f64,
    attributes: &'a [Level],
}

impl Solids {
    /// The objects of `scene` moved by `by`, but for those called `ballast`, which nothing sees.
    pub(crate) fn read(scene: &Scene, by: Vec3) -> Self {
        let mut solids = Self { grain: 2.0, ..Self::default() };
        let map = Affine::translation(by);
        let around = Around { map: &map, magnitude: largest(&by), attributes: &[] };
        for object in scene.objects.iter().filter(|o| o.name.as_deref() != Some("ballast")) {
            let tree = solids.expand(scene, &object.solid, &around);
            solids.objects.push(tree);
        }
        solids
    }

    fn expand(&mut self, scene: &Scene, solid: &Solid, around: &Around<'_>) -> Tree {
        let mut stack: Vec<(Tree, bool)> = Vec::new();
        for node in &solid.nodes {
            let operand = match *node {
                Node::Primitive { kind, frame } => {
                    (self.body(scene, solid, frame, around, Kind::Convex(kind)), false)
                }
                Node::Form { form, frame } => {
                    let kind = Kind::Form(solid.form(form).clone());
                    (self.body(scene, solid, frame, around, kind), false)
                }
                Node::Instance { class, frame } => {
                    let (map, magnitude, attributes) = stand(solid, frame, around);
                    let inner = Around { map: &map, magnitude, attributes: &attributes };
                    let class = &scene.classes[class.0 as usize];
                    (self.expand(scene, &class.solid, &inner), false)
                }
                Node::Complement => {
                    let (tree, _) = stack.pop().expect("an operand");
                    (tree, true)
                }
                Node::Union(n) | Node::Intersection(n) => {
                    let mut operands = stack.split_off(stack.len() - n as usize).into_iter();
                    let (first, _) = operands.next().expect("two operands");
                    let tree = operands.fold(first, |left, (right, complement)| {
                        let pair = (Box::new(left), Box::new(right));
                        match (node, complement) {
                            (Node::Union(_), _) => Tree::Union(pair.0, pair.1),
                            (_, false) => Tree::Intersection(pair.0, pair.1),
                            (_, true) => Tree::Difference(pair.0, pair.1),
                        }
                    });
                    (tree, false)
                }
            };
            stack.push(operand);
        }
        stack.pop().expect("one operand is left").0
    }

    fn body(
        &mut self,
        scene: &Scene,
        solid: &Solid,
        frame: FrameId,
        around: &Around<'_>,
        kind: Kind,
    ) -> Tree {
        let (map, magnitude, attributes) = stand(solid, frame, around);
        let mut body = look(scene, &attributes);
        let reach = match &kind {
            Kind::Convex(_) => 1.0,
            Kind::Form(form) => form::reach(form),
        };
        body.magnitude = magnitude + reach * map.half_extent();
        self.bodies.push(Body { kind, map, ..body });
        Tree::Body(self.bodies.len() - 1)
    }

    fn claim(&self, tree: &Tree, inside: &[bool]) -> Option<Claim> {
        match tree {
            Tree::Body(number) => inside[*number].then(|| {
                let body = &self.bodies[*number];
                let class = match body.clear {
                    None => 0,
                    Some(Clear { index: Some(_), .. }) => 1,
                    Some(Clear { index: None, .. }) => 2,
                };
                (class, -i64::from(body.priority), *number)
            }),
            Tree::Union(a, b) => {
                self.claim(a, inside).into_iter().chain(self.claim(b, inside)).min()
            }
            Tree::Intersection(a, b) => self.claim(b, inside).and_then(|_| self.claim(a, inside)),
            Tree::Difference(a, b) => match self.claim(b, inside) {
                None => self.claim(a, inside),
                Some(_) => None,
            },
        }
    }

    /// The body that fills a point of which is known what it is inside of.
    pub(crate) fn filling(&self, inside: &[bool]) -> Option<usize> {
        self.objects.iter().filter_map(|tree| self.claim(tree, inside)).min().map(|claim| claim.2)
    }

    fn claims(&self, tree: &Tree, sides: [&[bool]; 2]) -> Claims {
        sides.map(|inside| self.claim(tree, inside))
    }

    /// Whose surface lies between two points: of terms, that of the stronger medium; of factors, and of what is taken
    /// away, the first that turns as the whole does.
    pub(crate) fn owner(&self, sides: [&[bool]; 2]) -> usize {
        let terms: Vec<&Tree> = self.objects.iter().collect();
        self.descend(self.stronger(&terms, sides), sides, false)
    }

    fn stronger<'t>(&self, terms: &[&'t Tree], sides: [&[bool]; 2]) -> &'t Tree {
        let strongest = |tree: &&Tree| {
            let claims = self.claims(tree, sides);
            claims.into_iter().flatten().min().unwrap_or((u8::MAX, 0, 0))
        };
        terms.iter().copied().min_by_key(strongest).expect("a surface has an owner")
    }

    /// What is taken away fills nothing, so there no medium is stronger than another.
    fn descend(&self, tree: &Tree, sides: [&[bool]; 2], taken: bool) -> usize {
        match tree {
            Tree::Body(number) => *number,
            Tree::Union(a, b) if !taken => {
                self.descend(self.stronger(&[a, b], sides), sides, false)
            }
            Tree::Union(a, _) | Tree::Intersection(a, _) | Tree::Difference(a, _)
                if self.turns(a, sides) == self.turns(tree, sides) =>
            {
                self.descend(a, sides, taken)
            }
            Tree::Union(_, b) | Tree::Intersection(_, b) => self.descend(b, sides, taken),
            Tree::Difference(_, b) => self.descend(b, sides, true),
        }
    }

    /// Inside at either side.
    fn turns(&self, tree: &Tree, sides: [&[bool]; 2]) -> [bool; 2] {
        self.claims(tree, sides).map(|claim| claim.is_some())
    }
}

/// Map, magnitude and attributes of a frame.
fn stand(solid: &Solid, frame: FrameId, around: &Around<'_>) -> (Affine, f64, Vec<Level>) {
    let mut path = Vec::new();
    let mut at = Some(frame);
    while let Some(id) = at {
        let frame = &solid.frames[id.0 as usize];
        path.push(frame);
        at = frame.parent;
    }
    let mut levels = Vec::new();
    let (mut map, mut magnitude) = (around.map.clone(), around.magnitude);
    for frame in path.iter().rev() {
        let own = Affine::new(&frame.placement);
        let next = map.then_inner(&own);
        let step = largest(&super::dd::minus(&next.place, &map.place));
        magnitude = magnitude.max(step).max(largest(&next.place));
        map = next;
        levels.push((frame.attributes, map.clone()));
    }
    levels.reverse();
    levels.extend_from_slice(around.attributes);
    (map, magnitude, levels)
}

/// A body's attributes: what is written closest to it wins, defaults come last.
fn look(scene: &Scene, levels: &[Level]) -> Body {
    let sets = || levels.iter().map(|(id, _)| &scene.attributes[id.0 as usize]);
    let clear = sets().find_map(|set| set.transparency).map(|transparency| Clear {
        half_distance: transparency.half_distance,
        index: match transparency.index {
            scene::Index::Refractive(index) => Some(index),
            scene::Index::Fake => None,
        },
    });
    let painted = sets().zip(levels).find(|(set, _)| !set.paint.is_empty());
    let coats = painted.map_or_else(Vec::new, |(set, (_, map))| {
        let coat = |paint: &scene::Paint| Coat {
            texture: paint.texture.clone(),
            color: paint.color.expect("the oracle knows no pictures").to_array(),
            map: map.clone(),
        };
        set.paint.iter().map(coat).collect()
    });
    let default = if clear.is_some() { 1.0 } else { 0.0 };
    Body {
        kind: Kind::Convex(scene::Primitive::Sphere),
        map: Affine::translation([super::dd::Dd::ZERO; 3]),
        magnitude: 0.0,
        color: sets().find_map(|set| set.color).map_or([1.0; 3], |color| color.to_array()),
        shininess: sets().find_map(|set| set.shininess).unwrap_or(default),
        finish: Finish {
            slope: sets().find_map(|set| set.smoothness).unwrap_or(Finish::PLAIN.slope),
            pure: sets().find_map(|set| set.pure).unwrap_or(Finish::PLAIN.pure),
            coats,
        },
        clear,
        priority: sets().find_map(|set| set.priority).unwrap_or(0),
    }
}
