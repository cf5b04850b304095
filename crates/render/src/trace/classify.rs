//! Which media lie on the two sides of a surface, and whose surface it is.
//!
//! One walk answers for both points. At the scene and at unions the stronger claim wins; an intersection holds what all
//! its operands hold and has the medium of the first. The owner of the surface is found on the way: the term of the
//! stronger medium, and within an intersection the first operand whose membership turns as the result's does.

use glam::DVec3;

use super::scope::{ScopeId, Scopes};
use crate::world::chain::{Chain, Link, Operator};
use crate::world::hierarchy::Hierarchy;
use crate::world::region::Region;
use crate::world::{LeafId, MediumId, NodeId, ROUNDING, Step, World};

/// A leaf reached through instances.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Owner {
    pub(crate) leaf: LeafId,
    pub(crate) scope: ScopeId,
}

/// Who fills a point: the least claim wins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Claim {
    order: u64,
    pub(crate) medium: MediumId,
}

impl Claim {
    const NONE: Self = Self { order: u64::MAX, medium: MediumId::AIR };

    fn holds(&self) -> bool {
        self.order != u64::MAX
    }

    fn beats(&self, other: &Self) -> bool {
        self.order < other.order
    }
}

/// The claims on two points on either side of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sides {
    pub(crate) near: Claim,
    pub(crate) far: Claim,
    pub(crate) owner: Option<Owner>,
}

impl Sides {
    const OUTSIDE: Self = Self { near: Claim::NONE, far: Claim::NONE, owner: None };
}

/// Two points and how far off they are from the surface between them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Probe {
    pub(crate) near: DVec3,
    pub(crate) far: DVec3,
    pub(crate) middle: DVec3,
    pub(crate) tolerance: f64,
}

/// Union of claims, each with its own owner.
struct Stronger {
    near: (Claim, Option<Owner>),
    far: (Claim, Option<Owner>),
}

impl Stronger {
    fn new() -> Self {
        Self { near: (Claim::NONE, None), far: (Claim::NONE, None) }
    }

    fn add(&mut self, sides: &Sides) {
        if sides.near.beats(&self.near.0) {
            self.near = (sides.near, sides.owner);
        }
        if sides.far.beats(&self.far.0) {
            self.far = (sides.far, sides.owner);
        }
    }

    fn sides(self) -> Sides {
        let owner = if self.near.0.beats(&self.far.0) { self.near.1 } else { self.far.1 };
        Sides { near: self.near.0, far: self.far.0, owner }
    }
}

/// What lies on the two sides of `probe` in the whole scene.
pub(crate) fn sides(world: &World, region: &Region, scopes: &mut Scopes, probe: &Probe) -> Sides {
    let mut stronger = Stronger::new();
    region.object_boxes.around(probe.middle, probe.tolerance, -1.0, &mut |item| {
        let root = region.objects[item as usize];
        if !world.node(root).box32.nears(probe.middle, probe.tolerance) {
            return;
        }
        stronger.add(&node_sides(world, scopes, root, ScopeId::SCENE, probe, false));
    });
    stronger.sides()
}

/// The medium at a point well off every surface.
pub(crate) fn medium_at(world: &World, scopes: &mut Scopes, point: DVec3) -> MediumId {
    let probe = Probe { near: point, far: point, middle: point, tolerance: 0.0 };
    sides(world, &world.whole, scopes, &probe).near.medium
}

/// For a node whose box comes near the probe. What is `taken` away fills nothing: there the surface earlier in the source
/// shows, whatever its medium.
fn node_sides(
    world: &World,
    scopes: &mut Scopes,
    node: NodeId,
    scope: ScopeId,
    probe: &Probe,
    taken: bool,
) -> Sides {
    match world.node(node).step {
        Step::Leaf(number) => {
            let leaf = &world.leaves[number as usize];
            let order = scopes.get(scope).rank + if taken { leaf.rank } else { leaf.claim };
            let own = Claim { order, medium: leaf.medium };
            let claim =
                |point: DVec3| if leaf.contains(point.to_array()) { own } else { Claim::NONE };
            let owner = Some(Owner { leaf: number, scope });
            Sides { near: claim(probe.near), far: claim(probe.far), owner }
        }
        Step::Instance(number) => {
            let instance = &world.instances[number as usize];
            let inner = Probe {
                near: instance.map.inward(probe.near),
                far: instance.map.inward(probe.far),
                middle: instance.map.inward(probe.middle),
                tolerance: probe.tolerance * instance.shrink,
            };
            if !world.node(instance.root).box32.nears(inner.middle, inner.tolerance) {
                return Sides::OUTSIDE;
            }
            let inside = scopes.enter(scope, number, instance);
            let sides = node_sides(world, scopes, instance.root, inside, &inner, taken);
            let kept = sides.owner.map_or(scope, |owner| owner.scope);
            let kept = scopes.leave(inside, kept);
            Sides { owner: sides.owner.map(|owner| Owner { scope: kept, ..owner }), ..sides }
        }
        Step::Or { first, count, hierarchy } => {
            let children = world.children(first, count);
            let mut stronger = Stronger::new();
            let mut visit = |item: u32| {
                let child = children[item as usize].node;
                if !world.node(child).box32.nears(probe.middle, probe.tolerance) {
                    return;
                }
                stronger.add(&node_sides(world, scopes, child, scope, probe, taken));
            };
            match hierarchy {
                Some(tree) => world.hierarchies[tree as usize].around(
                    probe.middle,
                    probe.tolerance,
                    -1.0,
                    &mut visit,
                ),
                None => (0..count).for_each(visit),
            }
            stronger.sides()
        }
        Step::And { first, count } => and_sides(world, scopes, (first, count), scope, probe, taken),
        Step::Chain(number) => {
            chain_sides(world, scopes, &world.chains[number as usize], scope, probe, taken)
        }
    }
}

fn and_sides(
    world: &World,
    scopes: &mut Scopes,
    (first, count): (u32, u32),
    scope: ScopeId,
    probe: &Probe,
    taken: bool,
) -> Sides {
    let mut shared = Shared::new();
    for child in world.children(first, count) {
        let sides = if world.node(child.node).box32.nears(probe.middle, probe.tolerance) {
            node_sides(world, scopes, child.node, scope, probe, taken || child.complemented)
        } else {
            Sides::OUTSIDE
        };
        if !shared.add(&sides, child.complemented) {
            return Sides::OUTSIDE;
        }
    }
    shared.sides()
}

/// What the operands of an intersection have in common.
struct Shared {
    leftmost: Option<Sides>,
    near: bool,
    far: bool,
    /// First operand inside at the near point only, and at the far point only.
    near_only: Option<Owner>,
    far_only: Option<Owner>,
}

impl Shared {
    fn new() -> Self {
        Self { leftmost: None, near: true, far: true, near_only: None, far_only: None }
    }

    /// Takes an operand in; false if both points are outside from then on.
    fn add(&mut self, sides: &Sides, complemented: bool) -> bool {
        self.leftmost = self.leftmost.or(Some(*sides));
        let at_near = sides.near.holds() != complemented;
        let at_far = sides.far.holds() != complemented;
        self.near &= at_near;
        self.far &= at_far;
        match (at_near, at_far) {
            (true, false) => self.near_only = self.near_only.or(sides.owner),
            (false, true) => self.far_only = self.far_only.or(sides.owner),
            _ => {}
        }
        self.near || self.far
    }

    fn sides(self) -> Sides {
        let Some(leftmost) = self.leftmost else { return Sides::OUTSIDE };
        match (self.near, self.far) {
            (false, false) => Sides::OUTSIDE,
            (true, true) => leftmost,
            (true, false) => Sides { near: leftmost.near, far: Claim::NONE, owner: self.near_only },
            (false, true) => Sides { near: Claim::NONE, far: leftmost.far, owner: self.far_only },
        }
    }
}

/// Only the links whose boxes come near the probe are asked.
fn chain_sides(
    world: &World,
    scopes: &mut Scopes,
    chain: &Chain,
    scope: ScopeId,
    probe: &Probe,
    taken: bool,
) -> Sides {
    let mut met = Vec::new();
    let nears = |node: NodeId| world.node(node).box32.nears(probe.middle, probe.tolerance);
    chain.deciding(
        &mut met,
        |tree, take| tree.around(probe.middle, probe.tolerance, -1.0, &mut |item| take(item)),
        nears,
    );
    let mut all = Sides::OUTSIDE;
    for k in met {
        let Link { node, operator } = chain.links[k as usize];
        let is_outside = !all.near.holds() && !all.far.holds();
        if !nears(node) || (operator != Operator::Add && is_outside) {
            continue;
        }
        let cut = operator == Operator::Cut;
        let sides = node_sides(world, scopes, node, scope, probe, taken || cut);
        if operator == Operator::Add {
            let mut stronger = Stronger::new();
            stronger.add(&all);
            stronger.add(&sides);
            all = stronger.sides();
        } else {
            let mut shared = Shared::new();
            shared.add(&all, false);
            shared.add(&sides, cut);
            all = shared.sides();
        }
    }
    all
}

/// The rounding magnitude at `point`: of the primitive hit, `least`, and of every primitive whose surface passes within
/// twice its own bound. That a box holds the point is not enough: a sky dome would blur all that is finer.
pub(crate) fn magnitude_near(
    world: &World,
    region: &Region,
    scopes: &mut Scopes,
    point: DVec3,
    least: f64,
) -> f64 {
    if world.magnitude <= least {
        return least;
    }
    let mut search = Search { found: least, tolerance: ROUNDING * least, origin: point };
    region.object_boxes.around(point, search.tolerance, least, &mut |item| {
        search.node(world, scopes, region.objects[item as usize], ScopeId::SCENE, point, 1.0);
    });
    search.found
}

struct Search {
    found: f64,
    tolerance: f64,
    origin: DVec3,
}

impl Search {
    /// `point` and `shrink` lead from the scene into the space of `scope`.
    fn node(
        &mut self,
        world: &World,
        scopes: &mut Scopes,
        node: NodeId,
        scope: ScopeId,
        point: DVec3,
        shrink: f64,
    ) {
        let node = world.node(node);
        if scopes.magnitude(scope, node.magnitude) <= self.found
            || !node.box32.nears(point, self.tolerance * shrink)
        {
            return;
        }
        match node.step {
            Step::Leaf(number) => {
                let leaf = &world.leaves[number as usize];
                let magnitude = scopes.magnitude(scope, leaf.magnitude);
                let distance = if scope == ScopeId::SCENE {
                    leaf.distance(point)
                } else {
                    let map = scopes.get(scope).map;
                    leaf.local_distance(leaf.inward(point), |gradient| {
                        map.gradient_outward(leaf.gradient_outward(gradient)).length()
                    })
                };
                if distance.abs() <= 2.0 * ROUNDING * magnitude {
                    self.found = magnitude;
                }
            }
            Step::Instance(number) => {
                let instance = &world.instances[number as usize];
                let inside = scopes.enter(scope, number, instance);
                let inner = scopes.inward(inside, self.origin);
                let shrink = shrink * instance.shrink;
                self.node(world, scopes, instance.root, inside, inner, shrink);
                scopes.leave(inside, scope);
            }
            Step::Or { first, count, hierarchy } => {
                let children = world.children(first, count);
                let tolerance = self.tolerance * shrink;
                // Magnitudes in the tree are of the space of the scope; only the scene's compare with those found.
                let above = if scope == ScopeId::SCENE { self.found } else { -1.0 };
                let mut visit = |item: u32| {
                    self.node(world, scopes, children[item as usize].node, scope, point, shrink);
                };
                match hierarchy {
                    Some(tree) => {
                        world.hierarchies[tree as usize]
                            .around(point, tolerance, above, &mut visit);
                    }
                    None => (0..count).for_each(visit),
                }
            }
            Step::And { first, count } => {
                for child in world.children(first, count) {
                    self.node(world, scopes, child.node, scope, point, shrink);
                }
            }
            Step::Chain(number) => {
                let chain = &world.chains[number as usize];
                let (tolerance, mut near) = (self.tolerance * shrink, Vec::new());
                let find = |tree: &Hierarchy, take: &mut dyn FnMut(u32)| {
                    tree.around(point, tolerance, -1.0, &mut |item| take(item));
                };
                chain.deciding(&mut near, find, |_| true);
                for k in near {
                    self.node(world, scopes, chain.links[k as usize].node, scope, point, shrink);
                }
            }
        }
    }
}
