//! From the compiled scene to the tracer's: maps composed, attributes looked up, classes expanded or kept shared.
//!
//! Solids are post-order arrays, so a stack of half-read solids takes the place of recursion.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use glam::DVec3;
use scene::bound::moved;
use scene::{Bounds, ClassId, Form, FrameId, Map, Scene, Solid};

use super::build::{Builder, Operand};
use super::error::LoadError;
use super::hierarchy::widened;
use super::merge_attributes::{MergeTable, Merged, NOTHING};
use super::omit::{
    Ledger, LoadOptions, coinciding, dark_lights, fog_half_distance, hide_paint,
    leave_out_what_is_inside, leave_out_what_is_unreached, paints_are_looked_up,
    sends_rays_elsewhere, stop_shadows,
};
use super::parts::{DefinitionParts, split};
use super::pile::join_piles;
use super::region::Region;
use crate::sampling::lens::LoadedLens;
use crate::shade::texture_file::{Picture, PictureCache};

use super::{
    Instance, Kind, Leaf, LoadedLight, MediumId, Node, NodeId, PaintFrame, PaintId, Part, Place,
    ROUNDING, Step, Strength, World,
};

/// Classes are expanded in scenes that stand for no more leaves than this.
pub(super) const EXPANSION_LIMIT: u64 = 1 << 16;
/// Deeper expressions would need more stack than a thread should take.
const DEPTH_LIMIT: u32 = 200_000;

/// What a solid becomes when it has been read.
#[derive(Clone, Copy, Debug)]
enum Target {
    Object,
    /// Operand of the solid below on the stack.
    Expansion,
    Definition(ClassId, Merged),
}

/// A solid half read.
struct Reading<'s> {
    solid: &'s Solid,
    maps: &'s [Map],
    next: usize,
    outer: Map,
    /// Looks of each frame.
    merged: Vec<Merged>,
    /// Paint that comes from outside the solid.
    paint: Option<PaintId>,
    rank: u64,
    target: Target,
}

struct Definition {
    root: Option<NodeId>,
    bounds: Bounds,
}

struct Loader<'s> {
    scene: &'s Scene,
    class_maps: Vec<Vec<Map>>,
    class_leaves: Vec<u64>,
    expand: bool,
    builder: Builder,
    /// Of the leaves.
    strengths: Vec<Strength>,
    table: MergeTable,
    paints: Vec<PaintFrame>,
    pictures: Vec<Arc<Picture>>,
    operands: Vec<Operand>,
    definitions: Vec<Definition>,
    definition_parts: DefinitionParts,
    by_class: HashMap<(ClassId, Merged), u32>,
    /// By their words and the bits of their arguments.
    forms: HashMap<(&'static str, Vec<u64>), Form>,
    objects: Vec<NodeId>,
    object_ranks: Vec<u64>,
    parts: Vec<Part>,
    rank: u64,
    /// Columns and rows of the one picture.
    picture: Option<(u32, u32)>,
    glossy: bool,
}

impl World {
    /// Makes the tracer's form of `scene`, for pictures of any size. What no picture needs is left out.
    ///
    /// # Errors
    ///
    /// [`LoadError`] for scenes without a camera, for those beyond a limit, and for pictures that cannot be read. Their
    /// paths begin at the working folder.
    pub fn load(scene: &Scene) -> Result<Self, LoadError> {
        Self::load_with(scene, &LoadOptions::default())
    }

    /// [`World::load`], with a choice of what is left out. All choices give the same picture.
    ///
    /// # Errors
    ///
    /// As [`World::load`].
    pub fn load_with(scene: &Scene, options: &LoadOptions) -> Result<Self, LoadError> {
        Self::load_keeping(scene, options, &mut PictureCache::default())
    }

    /// [`World::load_with`], with pictures that were read before. They are taken as they are there, whatever has become of
    /// their files.
    ///
    /// # Errors
    ///
    /// As [`World::load`].
    pub fn load_keeping(
        scene: &Scene,
        options: &LoadOptions,
        pictures: &mut PictureCache,
    ) -> Result<Self, LoadError> {
        let camera = scene.camera.ok_or(LoadError::NoCamera)?;
        if camera.position == camera.target {
            return Err(LoadError::CameraAtTarget);
        }
        let class_leaves = leaf_counts(scene)?;
        let total = scene
            .objects
            .iter()
            .try_fold(0, |sum, object| add(sum, count(&object.solid, &class_leaves)?))?;
        let eye = camera.position;
        let loader = Loader {
            scene,
            class_maps: scene.classes.iter().map(|class| class.solid.maps()).collect(),
            class_leaves,
            expand: total <= EXPANSION_LIMIT,
            builder: Builder { ledger: Ledger::new(options), ..Builder::default() },
            strengths: Vec::new(),
            table: MergeTable::new(),
            paints: Vec::new(),
            pictures: pictures.read_all(scene).map_err(LoadError::Image)?,
            operands: Vec::new(),
            definitions: Vec::new(),
            definition_parts: Vec::new(),
            by_class: HashMap::new(),
            forms: HashMap::new(),
            objects: Vec::new(),
            object_ranks: Vec::new(),
            parts: Vec::new(),
            rank: 0,
            picture: options.picture,
            glossy: options.glossy,
        };
        loader.run(Map { place: -eye, magnitude: eye.abs().max_element(), ..Map::IDENTITY })
    }
}

fn add(a: u64, b: u64) -> Result<u64, LoadError> {
    a.checked_add(b).filter(|&sum| sum < 1 << 62).ok_or(LoadError::TooManyLeaves)
}

/// Leaves a solid stands for.
fn count(solid: &Solid, classes: &[u64]) -> Result<u64, LoadError> {
    solid.nodes.iter().try_fold(0, |sum, node| match node {
        scene::Node::Primitive { .. } | scene::Node::Form { .. } => add(sum, 1),
        scene::Node::Instance { class, .. } => add(sum, classes[class.0 as usize]),
        _ => Ok(sum),
    })
}

fn leaf_counts(scene: &Scene) -> Result<Vec<u64>, LoadError> {
    let mut counts: Vec<u64> = Vec::with_capacity(scene.classes.len());
    for class in &scene.classes {
        counts.push(count(&class.solid, &counts)?);
    }
    Ok(counts)
}

impl<'s> Loader<'s> {
    fn run(mut self, eye: Map) -> Result<World, LoadError> {
        let scene = self.scene;
        for (number, object) in scene.objects.iter().enumerate() {
            let maps = object.solid.maps();
            self.object_ranks.push(self.rank);
            self.solid(&object.solid, &maps, eye);
            let operand = self.operands.pop().unwrap_or(Operand::Nothing);
            self.object(operand);
            if !self.builder.nodes.last().is_none_or(|node| node.magnitude.is_finite()) {
                return Err(LoadError::OutOfRange { object: number + 1 });
            }
        }
        let depth = self.builder.nodes.iter().map(|node| node.depth).max().unwrap_or(0);
        if depth > DEPTH_LIMIT {
            return Err(LoadError::TooDeep { found: depth, limit: DEPTH_LIMIT });
        }
        number_claims(&mut self.builder.leaves, &self.strengths, self.rank)?;
        Ok(self.finish(depth))
    }

    fn finish(mut self, depth: u32) -> World {
        let scene = self.scene;
        level_magnitudes(&mut self.builder);
        let claimants = order_claims(&mut self.builder);
        let camera = scene.camera.expect("checked by load");
        let sight = camera.target - camera.position;
        let reach = sight.abs().max(camera.position.abs()).max(camera.target.abs()).max_element();
        // Rays of a symmetric view would lie in faces and run through edges; this much is below every feature.
        let eye = 4.0 * ROUNDING * reach * DVec3::new(0.61, 0.53, 0.47);
        let lights = scene.lights.iter().map(|l| LoadedLight::new(l, camera.position)).collect();
        let lights = self.leave_out(lights, &camera, eye);
        join_piles(&mut self.builder, &mut self.parts);
        let is_painted = self.builder.leaves.iter().any(|leaf| leaf.paint.is_some())
            || self.builder.instances.iter().any(|instance| instance.paint.is_some());
        let is_painted = paints_are_looked_up(&mut self.builder.ledger, is_painted);
        if !is_painted {
            self.paints.clear();
        }
        let fog = fog_half_distance(&mut self.builder.ledger, scene.fog_half_distance);
        let mut ledger = std::mem::take(&mut self.builder.ledger);
        let mirrors = self.table.surfaces.iter().any(|s| s.smoothness <= 0.0 && s.shininess > 0.0);
        let mut world = World {
            cones: is_painted || (mirrors && !lights.is_empty()),
            glossy: self.glossy,
            whole: Region::new(&self.builder.nodes, self.objects, self.parts),
            magnitude: self.builder.nodes.iter().fold(0.0, |m, node| f64::max(m, node.magnitude)),
            nodes: self.builder.nodes,
            children: self.builder.children,
            leaves: self.builder.leaves,
            instances: self.builder.instances,
            hierarchies: self.builder.hierarchies,
            chains: self.builder.chains,
            surfaces: self.table.surfaces,
            media: self.table.media,
            claimants,
            object_ranks: self.object_ranks,
            paints: self.paints,
            pictures: self.pictures,
            lights,
            is_painted,
            ambient: scene.ambient,
            background: scene.background,
            fog_half_distance: fog,
            eye,
            trusts_boundaries: false,
            view_from: camera,
            lens: scene
                .lens
                .filter(|_| !camera.parallel)
                .map(|lens| LoadedLens::new(&lens, &camera)),
            depth,
            stands_for: self.rank,
            omissions: Vec::new(),
        };
        stop_shadows(&mut ledger, &mut world);
        world.omissions = ledger.omissions();
        world
    }

    /// Takes out of the lists what the scene as a whole does not need, and returns the lights that are left.
    fn leave_out(
        &mut self,
        mut lights: Vec<LoadedLight>,
        camera: &scene::Camera,
        eye: DVec3,
    ) -> Vec<LoadedLight> {
        let Self { builder, objects, parts, table, paints, .. } = self;
        // Through a lens rays come from places beside the eye.
        let pinhole = self.scene.lens.is_none();
        if !camera.parallel && pinhole {
            leave_out_what_is_inside(builder, objects, parts);
        }
        let solids: Vec<_> = objects.iter().map(|&root| &builder.nodes[root as usize]).collect();
        let mut dark = dark_lights(&mut builder.ledger, &lights, &solids).into_iter();
        lights.retain(|_| dark.next() == Some(false));
        if let Some(size) = self.picture.filter(|_| pinhole) {
            let view = (camera, size, eye);
            let wanders = table.surfaces.iter().any(|s| sends_rays_elsewhere(s, self.glossy));
            leave_out_what_is_unreached(builder, view, wanders, &lights, objects, parts);
        }
        let cuts = |node: &Node| matches!(node.step, Step::And { .. } | Step::Chain(_));
        let is_kept = !builder.instances.is_empty()
            || (builder.nodes.iter().any(cuts)
                && builder.leaves.iter().any(|leaf| leaf.medium == MediumId::OPAQUE));
        hide_paint(&mut builder.ledger, &mut builder.leaves, &table.surfaces, paints, is_kept);
        lights
    }

    /// Makes an object's root and its parts. A union's terms of one medium are parts of their own: the hierarchy at
    /// the top then sees them all.
    fn object(&mut self, operand: Operand) {
        let operand = self.builder.settled(operand);
        let is_union = matches!(operand, Operand::Or(_));
        let Some(root) = self.builder.finish(operand) else { return };
        self.objects.push(root);
        let terms: Vec<NodeId> = match self.builder.nodes[root as usize].step {
            Step::Or { first, count, .. } if is_union => {
                let terms = &self.builder.children[first as usize..first as usize + count as usize];
                terms.iter().map(|child| child.node).collect()
            }
            _ => vec![root],
        };
        for term in terms {
            let parts = split(&mut self.builder, &self.definition_parts, term);
            self.parts.extend(parts);
        }
    }

    fn merged(&mut self, solid: &Solid, outer: Merged) -> Vec<Merged> {
        let mut merged: Vec<Merged> = Vec::with_capacity(solid.frames.len());
        for frame in &solid.frames {
            let around = frame.parent_index().map_or(outer, |parent| merged[parent]);
            let own = self.table.within(self.scene, around, frame.attributes);
            merged.push(own);
        }
        merged
    }

    /// Reads one object, and whatever definitions and expansions it needs.
    fn solid(&mut self, solid: &'s Solid, maps: &[Map], outer: Map) {
        let scene = self.scene;
        let class_maps = std::mem::take(&mut self.class_maps);
        let merged = self.merged(solid, NOTHING);
        let mut stack = vec![Reading {
            solid,
            maps,
            next: 0,
            outer,
            merged,
            paint: None,
            rank: self.rank,
            target: Target::Object,
        }];
        while let Some(mut reading) = stack.pop() {
            let Some(&node) = reading.solid.nodes.get(reading.next) else {
                self.complete(&reading, stack.last_mut());
                continue;
            };
            reading.next += 1;
            match node {
                scene::Node::Primitive { kind, frame } => {
                    let bounds = |map: &Map| kind.bounds(&map.linear, map.place);
                    self.leaf(&mut reading, Kind::Convex(kind), None, bounds, frame);
                }
                scene::Node::Form { form, frame } => {
                    let form = self.form(reading.solid.form(form));
                    let placed = form.clone();
                    let bounds = |map: &Map| placed.bounds(&map.linear, map.place);
                    self.leaf(&mut reading, Kind::Form, Some(form), bounds, frame);
                }
                scene::Node::Instance { class, frame } => {
                    let merged = reading.merged[frame.0 as usize];
                    let known = self.by_class.get(&(class, merged)).copied();
                    let map = reading.outer.then_inner(&reading.maps[frame.0 as usize]);
                    if let (false, Some(definition)) = (self.expand, known) {
                        self.instance(&mut reading, definition, class, map, frame);
                    } else {
                        let inner = &scene.classes[class.0 as usize].solid;
                        let paint = self.paint(&reading, frame);
                        let (outer, paint, rank, target) = if self.expand {
                            (map, paint, reading.rank, Target::Expansion)
                        } else {
                            // Defined first, then this node is read again.
                            reading.next -= 1;
                            (Map::IDENTITY, None, 0, Target::Definition(class, merged))
                        };
                        let merged = self.merged(inner, merged);
                        stack.push(reading);
                        let maps = &class_maps[class.0 as usize];
                        let solid = inner;
                        stack.push(Reading {
                            solid,
                            maps,
                            next: 0,
                            outer,
                            merged,
                            paint,
                            rank,
                            target,
                        });
                        continue;
                    }
                }
                scene::Node::Union(n) => {
                    let operands = self.take(n);
                    let union = self.builder.union(operands.into_iter());
                    self.operands.push(union);
                }
                scene::Node::Intersection(n) => {
                    let operands = self.take(n);
                    let intersection = self.builder.intersection(operands.into_iter());
                    self.operands.push(intersection);
                }
                scene::Node::Complement => {
                    let inner = self.operands.pop().unwrap_or(Operand::Nothing);
                    self.operands.push(Operand::Complement(Box::new(inner)));
                }
            }
            stack.push(reading);
        }
        self.class_maps = class_maps;
    }

    fn take(&mut self, n: u32) -> Vec<Operand> {
        self.operands.split_off(self.operands.len().saturating_sub(n as usize))
    }

    /// A solid has been read; its one operand is on the stack of operands.
    fn complete(&mut self, reading: &Reading<'_>, below: Option<&mut Reading<'_>>) {
        match reading.target {
            Target::Object => self.rank = reading.rank,
            Target::Expansion => {
                if let Some(below) = below {
                    below.rank = reading.rank;
                }
            }
            Target::Definition(class, merged) => {
                let operand = self.operands.pop().unwrap_or(Operand::Nothing);
                let operand = match self.builder.settled(operand) {
                    Operand::Or(terms) => {
                        Operand::Or(coinciding(&mut self.builder, terms.into()).into())
                    }
                    other => other,
                };
                let root = self.builder.finish(operand);
                let parts = root.map_or_else(Vec::new, |root| {
                    split(&mut self.builder, &self.definition_parts, root)
                });
                let bounds =
                    root.map_or(Bounds::EMPTY, |r| self.builder.nodes[r as usize].bounds());
                let number =
                    u32::try_from(self.definitions.len()).expect("fewer than classes × looks");
                self.by_class.insert((class, merged), number);
                self.definitions.push(Definition { root, bounds });
                self.definition_parts.push(parts);
            }
        }
    }

    /// Equal solids with arguments are one.
    fn form(&mut self, form: &Form) -> Form {
        let bits = form.arguments().iter().map(|argument| argument.to_bits()).collect();
        self.forms.entry((form.row().keyword, bits)).or_insert_with(|| form.clone()).clone()
    }

    fn leaf(
        &mut self,
        reading: &mut Reading<'_>,
        kind: Kind,
        form: Option<Form>,
        bounds: impl Fn(&Map) -> Bounds,
        frame: FrameId,
    ) {
        let map = reading.outer.then_inner(&reading.maps[frame.0 as usize]);
        let bounds = bounds(&map);
        let magnitude = map.magnitude + bounds.half_extent();
        let looks = self.table.looks(reading.merged[frame.0 as usize]);
        let leaf = Leaf {
            place: Place::of(map),
            kind,
            form,
            magnitude,
            surface: looks.surface,
            medium: looks.medium,
            rank: reading.rank,
            claim: 0,
            paint: self.paint(reading, frame),
        };
        reading.rank += 1;
        self.strengths.push(looks.strength);
        let operand = self.builder.leaf(leaf, &widened(bounds, magnitude));
        self.operands.push(operand);
    }

    fn instance(
        &mut self,
        reading: &mut Reading<'_>,
        definition: u32,
        class: ClassId,
        map: Map,
        frame: FrameId,
    ) {
        let rank = reading.rank;
        reading.rank += self.class_leaves[class.0 as usize];
        let Definition { root, bounds } = self.definitions[definition as usize];
        let Some(root) = root else {
            self.operands.push(Operand::Nothing);
            return;
        };
        let paint = self.paint(reading, frame);
        let inner = self.builder.nodes[root as usize].magnitude;
        let magnitude = map.magnitude + map.stretch() * inner;
        let shrink = [map.inverse.x_axis, map.inverse.y_axis, map.inverse.z_axis]
            .into_iter()
            .fold(DVec3::ZERO, |sum, column| sum + column.abs())
            .max_element();
        let instance = Instance { map, shrink, root, rank, paint, definition };
        let bounds = widened(moved(bounds, &map), magnitude);
        let node = self.builder.instance(instance, bounds, magnitude);
        self.operands.push(Operand::Node(node));
    }

    /// The nearest painted frame about `frame`, within the solid or outside of it.
    fn paint(&mut self, reading: &Reading<'_>, frame: FrameId) -> Option<PaintId> {
        let mut at = Some(frame.0 as usize);
        while let Some(index) = at {
            let frame = &reading.solid.frames[index];
            let coats = &self.scene.attributes[frame.attributes.0 as usize].paint;
            if !coats.is_empty() {
                let map = reading.outer.then_inner(&reading.maps[index]);
                self.paints.push(PaintFrame { coats: coats.clone(), map });
                return Some(PaintId::new(self.paints.len() - 1));
            }
            at = frame.parent_index();
        }
        reading.paint
    }
}

/// Packs strength and rank into one number: the strengths that occur are few, ranks up to `total` many.
fn number_claims(leaves: &mut [Leaf], strengths: &[Strength], total: u64) -> Result<(), LoadError> {
    let different: BTreeSet<_> = strengths.iter().copied().collect();
    let index: HashMap<_, u64> = different.into_iter().zip(0..).collect();
    // One more than the strengths there are: all ones is nobody's claim.
    let bits = u64::BITS - (index.len() as u64).leading_zeros();
    let shift = u64::BITS - bits.max(1);
    if total >> shift > 0 {
        return Err(LoadError::TooManyLeaves);
    }
    for (leaf, strength) in leaves.iter_mut().zip(strengths) {
        leaf.claim = index[strength] << shift | leaf.rank;
    }
    Ok(())
}

/// Gives each leaf the place of its claim, and returns the media by place; none where instances add to the claims.
fn order_claims(builder: &mut Builder) -> Vec<MediumId> {
    if !builder.instances.is_empty() {
        return Vec::new();
    }
    let leaves = &mut builder.leaves;
    let mut order: Vec<usize> = (0..leaves.len()).collect();
    order.sort_unstable_by_key(|&leaf| leaves[leaf].claim);
    for (place, &leaf) in (0..).zip(&order) {
        leaves[leaf].claim = place;
    }
    order.into_iter().map(|leaf| leaves[leaf].medium).collect()
}

/// Where no magnitude is far above another, all take the largest: then no point has to be asked which are near.
fn level_magnitudes(builder: &mut Builder) {
    /// A rounding bound this much above what is needed costs no visible detail.
    const ALIKE: f64 = 4.0;
    let range = builder.leaves.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), leaf| {
        (low.min(leaf.magnitude), high.max(leaf.magnitude))
    });
    if builder.instances.is_empty() && range.1 <= ALIKE * range.0 {
        builder.leaves.iter_mut().for_each(|leaf| leaf.magnitude = range.1);
        builder.nodes.iter_mut().for_each(|node| node.magnitude = range.1);
    }
}
