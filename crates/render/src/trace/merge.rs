//! The paper's way: lists of spans along the whole ray, merged in post-order under union, intersection and subtraction.
//!
//! It is kept as the tests' reference and behind `--accel none|boxes|coherence`; it works on the same leaves, so it finds
//! the same boundaries to the bit. m-ary operators are merged as balanced binary trees, as the paper's compiler writes
//! them.

use super::Hit;
use super::coherence::Coherence;
use super::scope::ScopeId;
use super::seek::Seeker;
use crate::options::Accel;
use crate::world::hierarchy::{BoxRay, Hierarchy};
use crate::world::region::Region;
use crate::world::{NodeId, Step, World, chain};

/// Boundaries in order: inside from the first to the second, from the third to the fourth, and so on.
type Boundaries = Vec<Hit>;

/// All boundaries of one ray, found once.
#[derive(Debug)]
pub(crate) struct Lists {
    events: Vec<Hit>,
    /// What ends before this parameter is left out.
    start: f64,
    accel: Accel,
    pub(super) coherence: Coherence,
}

#[derive(Clone, Copy)]
enum Operator {
    Union,
    Intersection,
}

impl Lists {
    pub(crate) fn new(world: &World, accel: Accel) -> Self {
        let coherence = match accel {
            Accel::Coherence => Coherence::new(world),
            Accel::Remembered => Coherence::without_rectangles(),
            Accel::None | Accel::Boxes | Accel::Flat | Accel::Bvh => Coherence::default(),
        };
        Self { events: Vec::new(), start: 0.0, accel, coherence }
    }

    /// Finds all boundaries of all parts after `start`, at most 0; others, too.
    pub(crate) fn find(
        &mut self,
        seeker: &mut Seeker<'_>,
        region: &Region,
        ray: &BoxRay,
        start: f64,
    ) {
        self.events.clear();
        self.start = start;
        self.coherence.start(seeker.world, &ray.ray);
        for part in &region.parts {
            let spans = self.spans(seeker, part.node, ray, ScopeId::SCENE);
            self.events.extend(spans);
        }
        self.events.sort_by(|a, b| a.t.total_cmp(&b.t));
    }

    /// The first boundary strictly after `from`, before `limit`.
    pub(crate) fn next(&self, from: f64, limit: f64) -> Option<Hit> {
        let first = self.events.partition_point(|hit| hit.t <= from);
        self.events.get(first).filter(|hit| hit.t < limit).copied()
    }
}

impl Lists {
    /// True if the ray passes by the box of a node, as far as this way of tracing asks.
    fn passes_by(&self, world: &World, node: NodeId, ray: &BoxRay, scope: ScopeId) -> bool {
        let misses = || !ray.meets(&world.node(node).box32, self.start, f64::INFINITY);
        match self.accel {
            Accel::Boxes | Accel::Flat => misses(),
            Accel::Coherence | Accel::Remembered => {
                self.coherence.passes_by(node, scope).unwrap_or_else(misses)
            }
            Accel::None | Accel::Bvh => false,
        }
    }

    fn spans(
        &mut self,
        seeker: &mut Seeker<'_>,
        node: NodeId,
        ray: &BoxRay,
        scope: ScopeId,
    ) -> Boundaries {
        if matches!(seeker.world.node(node).step, Step::Leaf(_)) {
            return self.content(seeker, node, ray, scope);
        }
        if self.passes_by(seeker.world, node, ray, scope) {
            return Boundaries::new();
        }
        let list = self.content(seeker, node, ray, scope);
        if !list.is_empty() {
            self.coherence.hit(node);
        }
        list
    }

    fn content(
        &mut self,
        seeker: &mut Seeker<'_>,
        node: NodeId,
        ray: &BoxRay,
        scope: ScopeId,
    ) -> Boundaries {
        let world = seeker.world;
        match world.node(node).step {
            Step::Leaf(leaf) => {
                let hit = |t, face| Hit { t, leaf, scope, face };
                let (body, mut boundaries) = (&world.leaves[leaf as usize], Vec::new());
                let mut span = body.span(&ray.ray, self.start);
                while span.from < span.to && span.to > self.start {
                    boundaries.extend([hit(span.from, span.entered()), hit(span.to, span.left())]);
                    if body.is_convex() {
                        break;
                    }
                    span = body.span(&ray.ray, span.to);
                }
                boundaries
            }
            Step::Instance(number) => {
                let instance = &world.instances[number as usize];
                let inner = seeker.scopes.enter(scope, number, instance);
                let list = self.spans(seeker, instance.root, &instance.box_ray(ray), inner);
                if list.is_empty() {
                    seeker.scopes.leave(inner, scope);
                }
                list
            }
            Step::Or { first, count, hierarchy } => {
                let children = world.children(first, count);
                let terms = match hierarchy {
                    Some(tree) if !matches!(self.accel, Accel::None | Accel::Flat) => {
                        met(&world.hierarchies[tree as usize], ray, self.start)
                    }
                    _ => (0..count).collect(),
                };
                let lists = terms
                    .into_iter()
                    .map(|term| self.spans(seeker, children[term as usize].node, ray, scope))
                    .filter(|list| !list.is_empty())
                    .collect();
                balanced(lists, Operator::Union)
            }
            Step::And { first, count } => {
                let mut lists = Vec::with_capacity(count as usize);
                for child in world.children(first, count) {
                    let list = self.spans(seeker, child.node, ray, scope);
                    if list.is_empty() && !child.complemented {
                        return Vec::new();
                    }
                    lists.push(if child.complemented { complement(list) } else { list });
                }
                balanced(lists, Operator::Intersection)
            }
            Step::Chain(number) => {
                let mut all = Boundaries::new();
                for link in &world.chains[number as usize].links {
                    let list = self.spans(seeker, link.node, ray, scope);
                    all = match link.operator {
                        chain::Operator::Add if all.is_empty() => list,
                        chain::Operator::Add if !list.is_empty() => {
                            merge(&all, &list, Operator::Union)
                        }
                        chain::Operator::Cut if !all.is_empty() && !list.is_empty() => {
                            merge(&all, &complement(list), Operator::Intersection)
                        }
                        chain::Operator::Clip => merge(&all, &list, Operator::Intersection),
                        chain::Operator::Add | chain::Operator::Cut => all,
                    };
                }
                all
            }
        }
    }
}

/// The terms of a union whose boxes a ray meets, by a balanced tree of boxes, in their order.
fn met(tree: &Hierarchy, ray: &BoxRay, start: f64) -> Vec<u32> {
    let mut met = Vec::new();
    tree.nearest(ray, start, f64::INFINITY, &mut |term, to| {
        met.push(term);
        to
    });
    met.sort_unstable();
    met
}

/// Inside becomes outside: a boundary at either end of the line, taken off again if it is there.
fn complement(mut list: Boundaries) -> Boundaries {
    let end = |t| Hit { t, ..Hit::NONE };
    if list.first().is_some_and(|hit| hit.t <= f64::NEG_INFINITY) {
        list.remove(0);
    } else {
        list.insert(0, end(f64::NEG_INFINITY));
    }
    if list.last().is_some_and(|hit| hit.t >= f64::INFINITY) {
        list.pop();
    } else {
        list.push(end(f64::INFINITY));
    }
    list
}

/// Merges neighbours, then neighbours of what comes of it: a balanced binary tree, order kept.
fn balanced(mut lists: Vec<Boundaries>, operator: Operator) -> Boundaries {
    while lists.len() > 1 {
        let mut pairs = lists.into_iter();
        let mut merged = Vec::new();
        while let Some(a) = pairs.next() {
            merged.push(match pairs.next() {
                Some(b) => merge(&a, &b, operator),
                None => a,
            });
        }
        lists = merged;
    }
    lists.pop().unwrap_or_default()
}

fn merge(a: &[Hit], b: &[Hit], operator: Operator) -> Boundaries {
    let mut result = Boundaries::with_capacity(a.len() + b.len());
    let (mut i, mut j) = (0, 0);
    while i < a.len() || j < b.len() {
        let at = match (a.get(i), b.get(j)) {
            (Some(x), Some(y)) if x.t <= y.t => *x,
            (_, Some(y)) => *y,
            (Some(x), None) => *x,
            (None, None) => break,
        };
        // Spans are half-open: all boundaries at this very t happen at once.
        while a.get(i).is_some_and(|hit| hit.t <= at.t) {
            i += 1;
        }
        while b.get(j).is_some_and(|hit| hit.t <= at.t) {
            j += 1;
        }
        let (in_a, in_b) = (i % 2 == 1, j % 2 == 1);
        let inside = match operator {
            Operator::Union => in_a || in_b,
            Operator::Intersection => in_a && in_b,
        };
        if inside != (result.len() % 2 == 1) {
            result.push(at);
        }
    }
    result
}
