//! Which media lie on the two sides of eight surfaces: the walk of [`super::super::classify`], lane by lane.

use scene::{Eight, EightMask, Lanes};
use wide::f32x8;

use crate::trace::classify::Owner;
use crate::trace::scope::ScopeId;
use crate::world::chain::{Chain, Link, Operator};
use crate::world::hierarchy::Box32;
use crate::world::region::Region;
use crate::world::{LeafId, MediumId, NodeId, Step, World};

/// Two points in each lane, on either side of a surface between them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EightProbes {
    near: [Eight; 3],
    far: [Eight; 3],
    /// The point between them with the tolerance added, rounded up.
    up: [f32x8; 3],
    /// With the tolerance taken away, rounded down.
    down: [f32x8; 3],
    lanes: EightMask,
    bits: u32,
}

/// Who fills the two points of each lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EightSides {
    /// Place of the claim among all of the scene, the least wins; infinite where nobody claims the point.
    near: Eight,
    far: Eight,
    /// Leaf that owns the surface; below 0 where there is none.
    owner: Eight,
}

impl EightProbes {
    /// About points between the two sides, which are no farther off than a tolerance.
    #[inline(always)]
    pub(super) fn new(
        [near, far]: [[Eight; 3]; 2],
        middle: [Eight; 3],
        tolerance: Eight,
        lanes: EightMask,
    ) -> Self {
        Self {
            near,
            far,
            up: middle.map(|x| rounded_up(x + tolerance)),
            down: middle.map(|x| -rounded_up(tolerance - x)),
            lanes,
            bits: lanes.bits(),
        }
    }

    /// If any probe comes near a box.
    #[inline(always)]
    pub(crate) fn near_box(&self, bounds: &Box32) -> bool {
        let (low, high) = bounds.corners();
        let mut near = f32x8::splat(low[0]).simd_le(self.up[0]);
        near &= self.down[0].simd_le(f32x8::splat(high[0]));
        for k in 1..3 {
            near &= f32x8::splat(low[k]).simd_le(self.up[k]);
            near &= self.down[k].simd_le(f32x8::splat(high[k]));
        }
        near.to_bitmask() & self.bits != 0
    }
}

/// At least the numbers, in single precision.
#[inline(always)]
fn rounded_up(x: Eight) -> f32x8 {
    const STEP: f64 = 1.0 / (1 << 22) as f64;
    #[expect(clippy::cast_possible_truncation, reason = "rounded up before")]
    let narrow = (x + x.abs() * Eight::splat(STEP)).to_array().map(|x| x as f32);
    f32x8::new(narrow) + f32x8::splat(f32::MIN_POSITIVE)
}

impl EightSides {
    fn outside() -> Self {
        let nobody = Eight::splat(f64::INFINITY);
        Self { near: nobody, far: nobody, owner: Eight::splat(-1.0) }
    }

    /// The claims lane by lane.
    #[inline(always)]
    pub(crate) fn lanes(&self) -> Claimed {
        Claimed {
            near: self.near.to_array(),
            far: self.far.to_array(),
            owner: self.owner.to_array(),
        }
    }
}

/// [`EightSides`] in memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Claimed {
    near: [f64; Eight::LANES],
    far: [f64; Eight::LANES],
    owner: [f64; Eight::LANES],
}

impl Claimed {
    /// Media of the two points of a lane, and whose surface lies between them.
    #[inline(always)]
    pub(crate) fn get(&self, world: &World, lane: usize) -> (MediumId, MediumId, Option<Owner>) {
        let number = self.owner[lane];
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a LeafId")]
        let owner = Owner { leaf: number as LeafId, scope: ScopeId::SCENE };
        let owner = (number >= 0.0).then_some(owner);
        (world.claimant(self.near[lane]), world.claimant(self.far[lane]), owner)
    }
}

/// Union of claims, each with its own owner.
struct Stronger {
    near: (Eight, Eight),
    far: (Eight, Eight),
}

impl Stronger {
    fn new() -> Self {
        let nobody = (Eight::splat(f64::INFINITY), Eight::splat(-1.0));
        Self { near: nobody, far: nobody }
    }

    #[inline(always)]
    fn add(&mut self, sides: &EightSides) {
        let take = |best: &mut (Eight, Eight), claim: Eight| {
            let beats = claim.less(best.0);
            best.0 = Eight::select(beats, claim, best.0);
            best.1 = Eight::select(beats, sides.owner, best.1);
        };
        take(&mut self.near, sides.near);
        take(&mut self.far, sides.far);
    }

    fn sides(self) -> EightSides {
        let owner = Eight::select(self.near.0.less(self.far.0), self.near.1, self.far.1);
        EightSides { near: self.near.0, far: self.far.0, owner }
    }
}

/// What lies on the two sides of each probe in the whole scene.
pub(crate) fn sides(world: &World, region: &Region, probes: &EightProbes) -> EightSides {
    let mut stronger = Stronger::new();
    region.object_boxes.around_eight(probes, &mut |item| {
        let root = region.objects[item as usize];
        if probes.near_box(&world.node(root).box32) {
            stronger.add(&node_sides(world, root, probes, false));
        }
    });
    stronger.sides()
}

fn node_sides(world: &World, node: NodeId, probes: &EightProbes, taken: bool) -> EightSides {
    match world.node(node).step {
        Step::Leaf(number) => {
            let leaf = &world.leaves[number as usize];
            let own = Eight::splat(if taken { leaf.rank } else { leaf.claim } as f64);
            let nobody = Eight::splat(f64::INFINITY);
            let claim = |points| Eight::select(leaf.contains(points), own, nobody);
            let owner = Eight::splat(f64::from(number));
            EightSides { near: claim(probes.near), far: claim(probes.far), owner }
        }
        Step::Instance(_) => unreachable!("worlds with instances are traced one ray at a time"),
        Step::Or { first, count, hierarchy } => {
            let children = world.children(first, count);
            let mut stronger = Stronger::new();
            let mut visit = |item: u32| {
                let child = children[item as usize].node;
                if probes.near_box(&world.node(child).box32) {
                    stronger.add(&node_sides(world, child, probes, taken));
                }
            };
            match hierarchy {
                Some(tree) => world.hierarchies[tree as usize].around_eight(probes, &mut visit),
                None => (0..count).for_each(visit),
            }
            stronger.sides()
        }
        Step::And { first, count } => and_sides(world, (first, count), probes, taken),
        Step::Chain(number) => chain_sides(world, &world.chains[number as usize], probes, taken),
    }
}

fn and_sides(
    world: &World,
    (first, count): (u32, u32),
    probes: &EightProbes,
    taken: bool,
) -> EightSides {
    let mut shared = Shared::new(probes.lanes);
    for child in world.children(first, count) {
        let sides = if probes.near_box(&world.node(child.node).box32) {
            node_sides(world, child.node, probes, taken || child.complemented)
        } else {
            EightSides::outside()
        };
        if !shared.add(&sides, child.complemented) {
            return EightSides::outside();
        }
    }
    shared.sides()
}

/// What the operands of an intersection have in common.
struct Shared {
    leftmost: Option<EightSides>,
    near: EightMask,
    far: EightMask,
    /// First operand inside at the near point only, and at the far point only.
    near_only: Eight,
    far_only: Eight,
}

impl Shared {
    #[inline(always)]
    fn new(lanes: EightMask) -> Self {
        let none = Eight::splat(-1.0);
        Self { leftmost: None, near: lanes, far: lanes, near_only: none, far_only: none }
    }

    /// Takes an operand in; false if all points are outside from then on.
    #[inline(always)]
    fn add(&mut self, sides: &EightSides, complemented: bool) -> bool {
        self.leftmost = self.leftmost.or(Some(*sides));
        let inside = |claims: Eight| {
            let holds = claims.less(Eight::splat(f64::INFINITY));
            if complemented { Eight::not(holds) } else { holds }
        };
        let (at_near, at_far) = (inside(sides.near), inside(sides.far));
        self.near = Eight::and(self.near, at_near);
        self.far = Eight::and(self.far, at_far);
        let first_of = |only: Eight, turns: EightMask| {
            let turns = Eight::and(turns, only.less(Eight::splat(0.0)));
            Eight::select(turns, sides.owner, only)
        };
        self.near_only = first_of(self.near_only, Eight::and(at_near, Eight::not(at_far)));
        self.far_only = first_of(self.far_only, Eight::and(at_far, Eight::not(at_near)));
        Eight::or(self.near, self.far).any()
    }

    #[inline(always)]
    fn sides(self) -> EightSides {
        let (nobody, none) = (Eight::splat(f64::INFINITY), Eight::splat(-1.0));
        let Some(leftmost) = self.leftmost else { return EightSides::outside() };
        let one =
            Eight::select(self.near, self.near_only, Eight::select(self.far, self.far_only, none));
        EightSides {
            near: Eight::select(self.near, leftmost.near, nobody),
            far: Eight::select(self.far, leftmost.far, nobody),
            owner: Eight::select(Eight::and(self.near, self.far), leftmost.owner, one),
        }
    }
}

/// Only the links whose boxes come near any of the probes are asked.
fn chain_sides(world: &World, chain: &Chain, probes: &EightProbes, taken: bool) -> EightSides {
    let mut met = Vec::new();
    let nears = |node: NodeId| probes.near_box(&world.node(node).box32);
    chain.deciding(&mut met, |tree, take| tree.around_eight(probes, &mut |item| take(item)), nears);
    let mut all = EightSides::outside();
    for k in met {
        let Link { node, operator } = chain.links[k as usize];
        if !nears(node) {
            continue;
        }
        let cut = operator == Operator::Cut;
        let sides = node_sides(world, node, probes, taken || cut);
        all = if operator == Operator::Add {
            let mut stronger = Stronger::new();
            stronger.add(&all);
            stronger.add(&sides);
            stronger.sides()
        } else {
            let mut shared = Shared::new(probes.lanes);
            shared.add(&all, false);
            shared.add(&sides, cut);
            shared.sides()
        };
    }
    all
}
