//! The paper's way: lists of spans along the whole ray, merged in post-order under union, intersection and subtraction.
//!
//! It is kept as the tests' reference and behind `--accel none|boxes|coherence`; it works on the same leaves, so it finds
//! the same boundaries to the bit. m-ary operators are merged as balanced binary trees, as the paper's compiler writes
//! them; large unions, the scene among them, are trees of boxes, each tested by itself. Nothing that the paper had not
//! comes before: every ray is asked about the whole scene, whatever beam it is in.

use super::Hit;
use scene::Bounds;

use super::coherence::{Coherence, Numbers};
use super::scope::ScopeId;
use super::seek::Seeker;
use super::slants::AllSlants;
use crate::options::Accel;
use crate::world::hierarchy::{BoxRay, Descent};
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
    numbers: Numbers,
    slants: AllSlants,
    pub(super) coherence: Coherence,
}

#[derive(Clone, Copy)]
enum Operator {
    Union,
    Intersection,
}

impl Lists {
    pub(crate) fn new(world: &World, accel: Accel) -> Self {
        let numbers = if accel == Accel::Bvh { Numbers::default() } else { Numbers::of(world) };
        let coherence = match accel {
            Accel::Coherence => Coherence::new(world, &numbers),
            Accel::Remembered => Coherence::without_rectangles(&numbers),
            Accel::None | Accel::Boxes | Accel::Flat | Accel::Slanted | Accel::Bvh => {
                Coherence::default()
            }
        };
        let slants = match accel {
            Accel::Slanted => AllSlants::new(world),
            _ => AllSlants::default(),
        };
        Self { events: Vec::new(), start: 0.0, accel, numbers, slants, coherence }
    }

    /// Finds all boundaries of all parts of the scene after `start`, at most 0; others, too.
    pub(crate) fn find(&mut self, seeker: &mut Seeker<'_>, ray: &BoxRay, start: f64) {
        let world = seeker.world;
        self.start = start;
        self.coherence.start(&ray.ray);
        let parts = &world.whole.parts;
        let node = |part: u32| parts[part as usize].node;
        let lists = self.terms(seeker, None, parts.len(), &node, ray, ScopeId::SCENE);
        self.events.clear();
        self.events.extend(lists.into_iter().flatten());
        self.events.sort_by(|a, b| a.t.total_cmp(&b.t));
    }

    /// The first boundary strictly after `from`, before `limit`.
    pub(crate) fn next(&self, from: f64, limit: f64) -> Option<Hit> {
        let first = self.events.partition_point(|hit| hit.t <= from);
        self.events.get(first).filter(|hit| hit.t < limit).copied()
    }
}

impl Lists {
    /// True if the ray passes by a box, as far as this way of tracing asks.
    fn passes_by(&self, number: u32, bounds: &Bounds, ray: &BoxRay, scope: ScopeId) -> bool {
        let misses = || !ray.meets_after(bounds, self.start);
        match self.accel {
            Accel::Boxes | Accel::Flat => misses(),
            Accel::Slanted => misses() || self.slants.pass_by(number, ray, self.start),
            Accel::Coherence | Accel::Remembered => {
                self.coherence.passes_by(number, scope).unwrap_or_else(misses)
            }
            Accel::None | Accel::Bvh => false,
        }
    }

    /// The lists of `count` terms that are not empty, in their order: by the tree of boxes over them, where there is one.
    fn terms(
        &mut self,
        seeker: &mut Seeker<'_>,
        tree: Option<u32>,
        count: usize,
        node: &dyn Fn(u32) -> NodeId,
        ray: &BoxRay,
        scope: ScopeId,
    ) -> Vec<Boundaries> {
        if matches!(self.accel, Accel::None | Accel::Flat) {
            let all = 0..u32::try_from(count).expect("terms are numbered by u32");
            let lists = all.map(|term| self.spans(seeker, node(term), ray, scope));
            return lists.filter(|list| !list.is_empty()).collect();
        }
        let (tree, first) = self.numbers.tree(seeker.world, tree);
        let mut terms = Terms { lists: self, seeker, first, node, ray, scope, found: Vec::new() };
        tree.descend(&mut terms);
        let mut found = terms.found;
        found.sort_unstable_by_key(|(term, _)| *term);
        found.into_iter().map(|(_, list)| list).collect()
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
        if self.passes_by(node, &seeker.world.node(node).bounds(), ray, scope) {
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
                let node = |term: u32| children[term as usize].node;
                let lists = if hierarchy.is_some() {
                    self.terms(seeker, hierarchy, children.len(), &node, ray, scope)
                } else {
                    let all =
                        children.iter().map(|child| self.spans(seeker, child.node, ray, scope));
                    all.filter(|list| !list.is_empty()).collect()
                };
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

/// The terms of a union, asked through the tree over them.
struct Terms<'a, 's, 'w> {
    lists: &'a mut Lists,
    seeker: &'a mut Seeker<'w>,
    /// The number of the tree's first box.
    first: u32,
    node: &'s dyn Fn(u32) -> NodeId,
    ray: &'s BoxRay,
    scope: ScopeId,
    found: Vec<(u32, Boundaries)>,
}

impl Descent for Terms<'_, '_, '_> {
    fn enter(&mut self, number: u32, bounds: &Bounds) -> bool {
        !self.lists.passes_by(self.first + number, bounds, self.ray, self.scope)
    }

    fn item(&mut self, term: u32) -> bool {
        let list = self.lists.spans(self.seeker, (self.node)(term), self.ray, self.scope);
        let met = !list.is_empty();
        if met {
            self.found.push((term, list));
        }
        met
    }

    fn met(&mut self, number: u32) {
        self.lists.coherence.hit(self.first + number);
    }
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
