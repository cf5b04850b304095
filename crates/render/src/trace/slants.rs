//! Volumes tighter than boxes, to measure whether they pay: boxes whose corners are cut off by four pairs of slanting
//! planes (Kay and Kajiya, "Ray Tracing Complex Scenes", 1986).

use glam::DVec3;
use scene::Bounds;
use scene::transform::apply_transposed;

use crate::world::chain::Operator;
use crate::world::hierarchy::{BoxRay, Hierarchy};
use crate::world::{Leaf, NodeId, ROUNDING, Step, World};

/// Normals of the planes, of length √3.
const NORMALS: [DVec3; 4] = [
    DVec3::new(1.0, 1.0, 1.0),
    DVec3::new(-1.0, 1.0, 1.0),
    DVec3::new(1.0, -1.0, 1.0),
    DVec3::new(1.0, 1.0, -1.0),
];

/// Slack of the test, relative to the largest number in it.
const SLACK: f64 = 1e-9;

/// Between which planes a solid lies: least and greatest products with each normal.
#[derive(Clone, Copy, Debug)]
struct Slants([[f64; 2]; 4]);

/// The slants of every numbered box.
#[derive(Debug, Default)]
pub(super) struct AllSlants(Vec<Slants>);

impl Slants {
    const EMPTY: Self = Self([[f64::INFINITY, f64::NEG_INFINITY]; 4]);
    const ALL: Self = Self([[f64::NEG_INFINITY, f64::INFINITY]; 4]);

    fn of(reach: impl Fn(DVec3) -> f64, error: f64) -> Self {
        Self(NORMALS.map(|normal| [-reach(-normal) - error, reach(normal) + error]))
    }

    fn of_box(bounds: &Bounds) -> Self {
        let reach = |normal: DVec3| {
            let foremost = DVec3::select(normal.cmpgt(DVec3::ZERO), bounds.high, bounds.low);
            normal.dot(foremost)
        };
        Self::of(reach, 0.0)
    }

    fn of_leaf(leaf: &Leaf, bounds: &Bounds) -> Self {
        let Some(primitive) = leaf.primitive() else { return Self::of_box(bounds) };
        let map = leaf.place.map();
        let reach = |normal: DVec3| {
            let inward = apply_transposed(&map.linear, normal);
            let size = inward.abs().max_element();
            let local = primitive.support(if size > 0.0 { inward / size } else { DVec3::ZERO });
            inward.dot(local) + normal.dot(map.place)
        };
        Self::of(reach, 8.0 * ROUNDING * leaf.magnitude)
    }

    fn joined(self, other: Self, choose: impl Fn([f64; 2], [f64; 2]) -> [f64; 2]) -> Self {
        Self(std::array::from_fn(|k| choose(self.0[k], other.0[k])))
    }

    fn hull(self, other: Self) -> Self {
        self.joined(other, |a, b| [least(a[0], b[0]), -least(-a[1], -b[1])])
    }

    fn common(self, other: Self) -> Self {
        self.joined(other, |a, b| [-least(-a[0], -b[0]), least(a[1], b[1])])
    }

    /// True if no point of the ray from `start` on lies between all pairs.
    fn misses(&self, ray: &BoxRay, start: f64) -> bool {
        let [origin, direction] = [ray.ray.origin, ray.ray.direction].map(DVec3::from_array);
        let (mut near, mut far) = (start, f64::INFINITY);
        for (normal, [low, high]) in NORMALS.iter().zip(self.0) {
            let (at, along) = (normal.dot(origin), normal.dot(direction));
            let slack = SLACK * (at.abs() + origin.abs().max_element());
            let (low, high) = (low - at - slack, high - at + slack);
            if along.abs() < SLACK {
                // Along the planes, or so nearly that it is of no use.
                continue;
            }
            let inverse = 1.0 / along;
            let (a, b) = (low * inverse, high * inverse);
            let (first, last) = if a < b { (a, b) } else { (b, a) };
            near = -least(-near, -first);
            far = least(far, last);
        }
        near > far
    }
}

fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

impl AllSlants {
    /// In the order of [`super::coherence::Numbers`].
    pub(super) fn new(world: &World) -> Self {
        let mut all: Vec<Slants> = Vec::new();
        for node in &world.nodes {
            let of = |child: NodeId| all[child as usize];
            let slants = match node.step {
                Step::Leaf(leaf) => Slants::of_leaf(&world.leaves[leaf as usize], &node.bounds()),
                Step::Instance(_) => Slants::of_box(&node.bounds()),
                Step::Or { first, count, .. } => world
                    .children(first, count)
                    .iter()
                    .fold(Slants::EMPTY, |hull, child| hull.hull(of(child.node))),
                Step::And { first, count } => world
                    .children(first, count)
                    .iter()
                    .filter(|child| !child.complemented)
                    .fold(Slants::ALL, |common, child| common.common(of(child.node))),
                Step::Chain(number) => {
                    world.chains[number as usize].links.iter().fold(Slants::EMPTY, |all, link| {
                        match link.operator {
                            Operator::Add => all.hull(of(link.node)),
                            Operator::Cut => all,
                            Operator::Clip => all.common(of(link.node)),
                        }
                    })
                }
            };
            all.push(slants);
        }
        let mut terms: Vec<(u32, u32)> = vec![(0, 0); world.hierarchies.len()];
        for node in &world.nodes {
            if let Step::Or { first, count, hierarchy: Some(tree) } = node.step {
                terms[tree as usize] = (first, count);
            }
        }
        let of_nodes = all.clone();
        let mut extend = |tree: &Hierarchy, nodes: &[NodeId]| {
            let item = |item: u32| of_nodes[nodes[item as usize] as usize];
            all.extend(tree.folded(Slants::EMPTY, item, Slants::hull));
        };
        for (tree, (first, count)) in world.hierarchies.iter().zip(terms) {
            let children = world.children(first, count).iter();
            extend(tree, &children.map(|child| child.node).collect::<Vec<_>>());
        }
        let parts = world.whole.parts.iter().map(|part| part.node);
        extend(&world.whole.part_boxes, &parts.collect::<Vec<_>>());
        Self(all)
    }

    /// True if the ray passes by what is in a box.
    pub(super) fn pass_by(&self, number: u32, ray: &BoxRay, start: f64) -> bool {
        self.0[number as usize].misses(ray, start)
    }
}
