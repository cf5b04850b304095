//! The scene as the tracer holds it: one flat array of nodes, leaves with all they need, the eye at the origin.
//!
//! Nodes are numbered so that children stand before their parents. A union of more than three terms carries a
//! hierarchy of boxes. Classes are expanded while the whole scene stays below [`load::EXPANSION_LIMIT`] leaves; beyond
//! that they are shared definitions, reached through [`Instance`]s.

mod build;
pub(crate) mod chain;
mod error;
pub(crate) mod hierarchy;
mod load;
mod merge_attributes;
pub(crate) mod omit;
mod parts;
mod pile;
mod place;
pub(crate) mod region;

pub use error::LoadError;
pub use omit::{LoadOptions, Omission};

use std::num::NonZeroU32;
use std::sync::Arc;

use glam::{BVec2, DVec2, DVec3};
use scene::{
    Bounds, Face, FacedSpan, Form, Index, Lanes, LightKind, Map, Optics, Paint, Primitive, Ray, Rgb,
};

use crate::sampling::lens::LoadedLens;
use crate::shade::texture_file::Picture;
use chain::Chain;
use hierarchy::{Box32, Hierarchy};
use place::Place;
use region::Region;

/// Rounding bound of a composed coordinate, relative to the largest magnitude that entered it.
pub(crate) const ROUNDING: f64 = 64.0 * 0.5 * f64::EPSILON;

/// Index of a node.
pub(crate) type NodeId = u32;
/// Index of a leaf.
pub(crate) type LeafId = u32;

/// Number of a [`PaintFrame`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct PaintId(NonZeroU32);

impl PaintId {
    fn new(index: usize) -> Self {
        let number = u32::try_from(index + 1).ok().and_then(NonZeroU32::new);
        Self(number.expect("fewer than leaves"))
    }

    pub(crate) fn index(self) -> usize {
        self.0.get() as usize - 1
    }
}

/// What fills space: equal bodies of equal priority are one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct MediumId(pub(crate) u32);

impl MediumId {
    /// All opaque bodies.
    pub(crate) const OPAQUE: Self = Self(0);
    /// Nothing: air.
    pub(crate) const AIR: Self = Self(u32::MAX);
}

/// What light meets on its way through a medium.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Medium {
    /// Equal for media that differ in priority alone.
    pub(crate) value: u32,
    /// Index of refraction; 1 for `fake`.
    pub(crate) index: f64,
    /// Halvings per unit of length, by channel.
    pub(crate) rate: Rgb,
}

/// Which of two solids fills shared space: the lesser. Opaque, then refracting, then `fake`; then priority.
type Strength = u64;

/// What a leaf is before it is placed: one byte, so that one jump tells them apart.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Kind {
    Convex(Primitive),
    /// With arguments; a line may be inside several times.
    Form,
}

/// A solid in its place.
#[derive(Debug)]
pub(crate) struct Leaf {
    pub(crate) place: Place,
    kind: Kind,
    /// With [`Kind::Form`].
    form: Option<Form>,
    /// K: bounds the numbers that went into the place, half extent included.
    pub(crate) magnitude: f64,
    pub(crate) surface: u32,
    pub(crate) medium: MediumId,
    /// Place in the source, among the leaves of its definition.
    pub(crate) rank: u64,
    /// Who fills shared space: the least wins. In scenes without instances its place among all claims, else strength and
    /// rank, to which an instance adds its own rank.
    pub(crate) claim: u64,
    /// The painted frame nearest to it within its definition.
    pub(crate) paint: Option<PaintId>,
}

// Two lines of cache.
const _: () = assert!(size_of::<Leaf>() <= 128, "a leaf has grown");

impl Leaf {
    /// A line is inside at most once.
    pub(crate) fn is_convex(&self) -> bool {
        matches!(self.kind, Kind::Convex(_))
    }

    /// None for one with arguments.
    pub(crate) fn primitive(&self) -> Option<Primitive> {
        match self.kind {
            Kind::Convex(primitive) => Some(primitive),
            Kind::Form => None,
        }
    }

    fn form(&self) -> &Form {
        self.form.as_ref().expect("leaves of this kind have one")
    }

    /// Where a point of the leaf's own space lies in the surface.
    pub(crate) fn texture_coordinates(&self, point: DVec3, face: Face) -> DVec2 {
        match self.kind {
            Kind::Convex(kind) => kind.texture_coordinates(point, face),
            Kind::Form => self.form().texture_coordinates(point, face),
        }
    }

    /// All its faces are planes.
    pub(crate) fn is_flat(&self) -> bool {
        matches!(self.kind, Kind::Convex(Primitive::Block))
    }

    /// Whether u and v of a face come round: go on from 1 at 0.
    pub(crate) fn comes_round(&self, face: Face) -> BVec2 {
        match self.kind {
            Kind::Convex(kind) => BVec2::new(kind != Primitive::Block, false),
            Kind::Form => self.form().comes_round(face),
        }
    }

    /// Signed distance of a point of the leaf's own space to the surface, to first order, as `length` measures gradients.
    pub(crate) fn local_distance(&self, point: DVec3, length: impl Fn(DVec3) -> f64) -> f64 {
        match self.kind {
            Kind::Convex(kind) => kind.distance(point, length),
            Kind::Form => self.form().distance(point, length),
        }
    }

    /// Where the line of `ray` is inside, for the first time to end after `from`.
    #[inline(always)]
    pub(crate) fn span<L: Lanes>(&self, ray: &Ray<L>, from: L) -> FacedSpan<L> {
        self.span_or(ray, from, || {})
    }

    /// [`Leaf::span`]; `several` is called if there may be more of them.
    #[inline(always)]
    pub(crate) fn span_or<L: Lanes>(
        &self,
        ray: &Ray<L>,
        from: L,
        several: impl FnOnce(),
    ) -> FacedSpan<L> {
        match self.kind {
            Kind::Convex(kind) => kind.span(&self.place.ray_inward(ray)),
            Kind::Form => {
                several();
                self.form().span_at(&self.place.ray_inward(ray), from)
            }
        }
    }

    /// Where the line of `ray` is inside, the time that begins or ends nearest to `t`.
    #[inline(always)]
    pub(crate) fn span_about(&self, ray: &Ray, t: f64) -> FacedSpan {
        match self.kind {
            Kind::Convex(kind) => kind.span(&self.place.ray_inward(ray)),
            Kind::Form => self.form().span_about(&self.place.ray_inward(ray), t),
        }
    }

    /// A point of the outer space in the leaf's own.
    #[inline(always)]
    pub(crate) fn inward(&self, point: DVec3) -> DVec3 {
        DVec3::from_array(self.place.inward_lanes(point.to_array()))
    }

    /// A gradient of the leaf's own space in the outer space.
    #[inline(always)]
    pub(crate) fn gradient_outward(&self, gradient: DVec3) -> DVec3 {
        DVec3::from_array(self.place.gradient_outward_lanes(gradient.to_array()))
    }

    /// The outward gradient of a face, given as a number, at a point of the outer space; of any length but 0.
    #[inline(always)]
    pub(crate) fn gradient<L: Lanes>(&self, point: [L; 3], face: L) -> [L; 3] {
        let point = self.place.inward_lanes(point);
        self.place.gradient_outward_lanes(match self.kind {
            Kind::Convex(kind) => kind.gradient(point, face),
            Kind::Form => self.form().gradient_lanes(point, face),
        })
    }

    #[inline(always)]
    pub(crate) fn contains<L: Lanes>(&self, point: [L; 3]) -> L::Mask {
        let point = self.place.inward_lanes(point);
        match self.kind {
            Kind::Convex(kind) => kind.contains(point),
            Kind::Form => self.form().contains_lanes(point),
        }
    }

    /// Signed distance of a point of the outer space to the surface, to first order.
    pub(crate) fn distance(&self, point: DVec3) -> f64 {
        self.local_distance(self.inward(point), |gradient| self.gradient_outward(gradient).length())
    }
}

/// A class in its place, kept shared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Instance {
    pub(crate) map: Map,
    /// The largest factor by which lengths shrink on the way in.
    pub(crate) shrink: f64,
    pub(crate) root: NodeId,
    /// Added to the ranks of the leaves inside.
    pub(crate) rank: u64,
    pub(crate) paint: Option<PaintId>,
    definition: u32,
}

/// Operand of an intersection.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Child {
    pub(crate) node: NodeId,
    pub(crate) complemented: bool,
}

/// A step of the expression.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Step {
    Leaf(LeafId),
    Instance(u32),
    /// Children from `first` on; the hierarchy's items are their positions.
    Or {
        first: u32,
        count: u32,
        hierarchy: Option<u32>,
    },
    And {
        first: u32,
        count: u32,
    },
    Chain(u32),
}

/// A step with what is known of the solid it completes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(crate) step: Step,
    pub(crate) box32: Box32,
    /// The largest magnitude of its leaves.
    pub(crate) magnitude: f64,
    /// The one medium it can have, if it is one.
    medium: Option<MediumId>,
    depth: u32,
}

impl Node {
    /// The box about it.
    pub(crate) fn bounds(&self) -> Bounds {
        self.box32.bounds()
    }
}

/// A term of the scene in which only one medium counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    pub(crate) node: NodeId,
    /// Air for a solid that an object is made of, of which only the surfaces are known to count.
    pub(crate) medium: MediumId,
}

/// Paint on a frame: its coats, and the map to the frame's space from the definition's.
#[derive(Debug)]
pub(crate) struct PaintFrame {
    pub(crate) coats: Vec<Paint>,
    pub(crate) map: Map,
}

/// A light, moved with the scene, with what does not depend on the point lit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LoadedLight {
    pub(crate) kind: LightKind,
    pub(crate) color: Rgb,
    pub(crate) shadows: bool,
    /// How far it reaches about where it is; 0 for a point.
    pub(crate) radius: f64,
    /// Unit vector the light travels along; zero for a point.
    pub(crate) axis: DVec3,
    /// Cosine of the half-angle of a spot.
    pub(crate) edge: f64,
}

/// Everything the tracer reads.
#[derive(Debug)]
pub struct World {
    pub(crate) nodes: Vec<Node>,
    pub(crate) children: Vec<Child>,
    pub(crate) leaves: Vec<Leaf>,
    pub(crate) instances: Vec<Instance>,
    pub(crate) hierarchies: Vec<Hierarchy>,
    pub(crate) chains: Vec<Chain>,
    pub(crate) surfaces: Vec<Optics>,
    pub(crate) media: Vec<Medium>,
    /// Whose claim it is, by place; empty in scenes with instances.
    claimants: Vec<MediumId>,
    /// The rank of the first leaf of each object of the scene.
    object_ranks: Vec<u64>,
    pub(crate) paints: Vec<PaintFrame>,
    /// Paint is looked for where rays end.
    pub(crate) is_painted: bool,
    /// Pictures that paint shows, by their number in the scene.
    pub(crate) pictures: Vec<Arc<Picture>>,
    pub(crate) lights: Vec<LoadedLight>,
    /// What rays stand for can be seen: something is painted, or a mirror shows lights.
    pub(crate) cones: bool,
    /// Rough surfaces mirror what is around them.
    pub(crate) glossy: bool,
    pub(crate) whole: Region,
    /// The largest magnitude of all.
    pub(crate) magnitude: f64,
    pub(crate) ambient: Rgb,
    pub(crate) background: Rgb,
    pub(crate) fog_half_distance: Option<f64>,
    /// Where primary rays start: the eye, moved off every symmetry by a few rounding bounds.
    pub(crate) eye: DVec3,
    pub(crate) view_from: scene::Camera,
    /// Boundaries are taken for what they seem to be; see [`World::trusting_boundaries`].
    pub(crate) trusts_boundaries: bool,
    /// None for a pinhole.
    pub(crate) lens: Option<LoadedLens>,
    depth: u32,
    stands_for: u64,
    omissions: Vec<Omission>,
}

impl World {
    /// Levels of the deepest expression, which bounds the stack a tracing thread needs.
    #[must_use]
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// The world without what keeps pictures right where surfaces touch: no boundary is asked what lies on its sides.
    /// Only to measure what that costs, on scenes of which no two solids of any medium touch or overlap, without shared
    /// classes, and with hierarchies.
    #[doc(hidden)]
    #[must_use]
    pub fn trusting_boundaries(self) -> Self {
        Self { trusts_boundaries: true, ..self }
    }

    /// Primitives held in memory.
    #[must_use]
    pub fn leaf_count(&self) -> usize {
        self.leaves.len()
    }

    /// The light of what lies behind everything.
    #[must_use]
    pub fn background(&self) -> Rgb {
        self.background
    }

    /// Primitives that the scene stands for, each as often as classes are used.
    #[must_use]
    pub fn stands_for(&self) -> u64 {
        self.stands_for
    }

    /// What each pass of leaving out did, in the order of their table.
    #[must_use]
    pub fn omissions(&self) -> &[Omission] {
        &self.omissions
    }

    /// Objects of the scene, empty ones too.
    pub(crate) fn object_count(&self) -> usize {
        self.object_ranks.len()
    }

    /// The object, counted from 1, that has the leaf of this rank.
    pub(crate) fn object_of(&self, rank: u64) -> usize {
        self.object_ranks.partition_point(|&first| first <= rank)
    }

    pub(crate) fn children(&self, first: u32, count: u32) -> &[Child] {
        &self.children[first as usize..first as usize + count as usize]
    }

    pub(crate) fn node(&self, node: NodeId) -> &Node {
        &self.nodes[node as usize]
    }

    /// True if light cannot tell the two apart: priority decides who fills space, not what it is filled with.
    pub(crate) fn alike(&self, a: MediumId, b: MediumId) -> bool {
        a == b
            || matches!((self.medium(a), self.medium(b)), (Some(a), Some(b)) if a.value == b.value)
    }

    /// The medium of whoever fills a point by the claim of this place; air where it is infinite.
    pub(crate) fn claimant(&self, order: f64) -> MediumId {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "an index, or beyond all"
        )]
        self.claimants.get(order as usize).copied().unwrap_or(MediumId::AIR)
    }

    pub(crate) fn medium(&self, medium: MediumId) -> Option<&Medium> {
        self.media.get(medium.0 as usize)
    }
}

/// True if rays go straight through the surface.
pub(crate) fn is_fake(optics: &Optics) -> bool {
    optics.transparency.is_some_and(|transparency| transparency.index == Index::Fake)
}
