//! Which media lie on the two sides of four surfaces: the walk of [`super::super::classify`], lane by lane.

use glam::DVec3;
use scene::{Bounds, Four, FourMask, Lanes};

use crate::trace::classify::Owner;
use crate::trace::scope::ScopeId;
use crate::world::chain::{Chain, Link, Operator};
use crate::world::region::Region;
use crate::world::{LeafId, MediumId, NodeId, Step, World};

/// Two points in each lane, on either side of a surface between them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FourProbes {
    pub(super) near: [Four; 3],
    pub(super) far: [Four; 3],
    pub(super) middle: [Four; 3],
    pub(super) tolerance: Four,
    pub(super) lanes: FourMask,
}

/// Who fills the two points of each lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FourSides {
    /// Place of the claim among all of the scene, the least wins; infinite where nobody claims the point.
    near: Four,
    far: Four,
    /// Leaf that owns the surface; below 0 where there is none.
    owner: Four,
}

impl FourProbes {
    /// Lanes whose probe comes near a box.
    #[inline(always)]
    pub(crate) fn near(&self, low: DVec3, high: DVec3) -> FourMask {
        let mut near = self.lanes;
        for (k, (low, high)) in low.to_array().into_iter().zip(high.to_array()).enumerate() {
            let above = (Four::splat(low) - self.tolerance).at_most(self.middle[k]);
            let below = self.middle[k].at_most(Four::splat(high) + self.tolerance);
            near = Four::and(near, Four::and(above, below));
        }
        near
    }

    #[inline(always)]
    fn near_box(&self, bounds: &Bounds) -> bool {
        self.near(bounds.low, bounds.high).any()
    }
}

impl FourSides {
    fn outside() -> Self {
        let nobody = Four::splat(f64::INFINITY);
        Self { near: nobody, far: nobody, owner: Four::splat(-1.0) }
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

/// [`FourSides`] in memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Claimed {
    near: [f64; Four::LANES],
    far: [f64; Four::LANES],
    owner: [f64; Four::LANES],
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
    near: (Four, Four),
    far: (Four, Four),
}

impl Stronger {
    fn new() -> Self {
        let nobody = (Four::splat(f64::INFINITY), Four::splat(-1.0));
        Self { near: nobody, far: nobody }
    }

    #[inline(always)]
    fn add(&mut self, sides: &FourSides) {
        let take = |best: &mut (Four, Four), claim: Four| {
            let beats = claim.less(best.0);
            best.0 = Four::select(beats, claim, best.0);
            best.1 = Four::select(beats, sides.owner, best.1);
        };
        take(&mut self.near, sides.near);
        take(&mut self.far, sides.far);
    }

    fn sides(self) -> FourSides {
        let owner = Four::select(self.near.0.less(self.far.0), self.near.1, self.far.1);
        FourSides { near: self.near.0, far: self.far.0, owner }
    }
}

/// What lies on the two sides of each probe in the whole scene.
pub(crate) fn sides(world: &World, region: &Region, probes: &FourProbes) -> FourSides {
    let mut stronger = Stronger::new();
    region.object_boxes.around_four(probes, &mut |item| {
        let root = region.objects[item as usize];
        if probes.near_box(&world.node(root).bounds) {
            stronger.add(&node_sides(world, root, probes, false));
        }
    });
    stronger.sides()
}

fn node_sides(world: &World, node: NodeId, probes: &FourProbes, taken: bool) -> FourSides {
    match world.node(node).step {
        Step::Leaf(number) => {
            let leaf = &world.leaves[number as usize];
            let own = Four::splat(if taken { leaf.rank as f64 } else { leaf.order });
            let nobody = Four::splat(f64::INFINITY);
            let claim = |points| Four::select(leaf.contains(points), own, nobody);
            let owner = Four::splat(f64::from(number));
            FourSides { near: claim(probes.near), far: claim(probes.far), owner }
        }
        Step::Instance(_) => unreachable!("worlds with instances are traced one ray at a time"),
        Step::Or { first, count, hierarchy } => {
            let children = world.children(first, count);
            let mut stronger = Stronger::new();
            let mut visit = |item: u32| {
                let child = children[item as usize].node;
                if probes.near_box(&world.node(child).bounds) {
                    stronger.add(&node_sides(world, child, probes, taken));
                }
            };
            match hierarchy {
                Some(tree) => world.hierarchies[tree as usize].around_four(probes, &mut visit),
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
    probes: &FourProbes,
    taken: bool,
) -> FourSides {
    let mut shared = Shared::new(probes.lanes);
    for child in world.children(first, count) {
        let sides = if probes.near_box(&world.node(child.node).bounds) {
            node_sides(world, child.node, probes, taken || child.complemented)
        } else {
            FourSides::outside()
        };
        if !shared.add(&sides, child.complemented) {
            return FourSides::outside();
        }
    }
    shared.sides()
}

/// What the operands of an intersection have in common.
struct Shared {
    leftmost: Option<FourSides>,
    near: FourMask,
    far: FourMask,
    /// First operand inside at the near point only, and at the far point only.
    near_only: Four,
    far_only: Four,
}

impl Shared {
    #[inline(always)]
    fn new(lanes: FourMask) -> Self {
        let none = Four::splat(-1.0);
        Self { leftmost: None, near: lanes, far: lanes, near_only: none, far_only: none }
    }

    /// Takes an operand in; false if all points are outside from then on.
    #[inline(always)]
    fn add(&mut self, sides: &FourSides, complemented: bool) -> bool {
        self.leftmost = self.leftmost.or(Some(*sides));
        let inside = |claims: Four| {
            let holds = claims.less(Four::splat(f64::INFINITY));
            if complemented { Four::not(holds) } else { holds }
        };
        let (at_near, at_far) = (inside(sides.near), inside(sides.far));
        self.near = Four::and(self.near, at_near);
        self.far = Four::and(self.far, at_far);
        let first_of = |only: Four, turns: FourMask| {
            let turns = Four::and(turns, only.less(Four::splat(0.0)));
            Four::select(turns, sides.owner, only)
        };
        self.near_only = first_of(self.near_only, Four::and(at_near, Four::not(at_far)));
        self.far_only = first_of(self.far_only, Four::and(at_far, Four::not(at_near)));
        Four::or(self.near, self.far).any()
    }

    #[inline(always)]
    fn sides(self) -> FourSides {
        let (nobody, none) = (Four::splat(f64::INFINITY), Four::splat(-1.0));
        let Some(leftmost) = self.leftmost else { return FourSides::outside() };
        let one =
            Four::select(self.near, self.near_only, Four::select(self.far, self.far_only, none));
        FourSides {
            near: Four::select(self.near, leftmost.near, nobody),
            far: Four::select(self.far, leftmost.far, nobody),
            owner: Four::select(Four::and(self.near, self.far), leftmost.owner, one),
        }
    }
}

/// Only the links whose boxes come near any of the probes are asked.
fn chain_sides(world: &World, chain: &Chain, probes: &FourProbes, taken: bool) -> FourSides {
    let mut met = Vec::new();
    let nears = |node: NodeId| probes.near_box(&world.node(node).bounds);
    chain.deciding(&mut met, |tree, take| tree.around_four(probes, &mut |item| take(item)), nears);
    let mut all = FourSides::outside();
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
