//! The expression, flattened while it is read: nested unions and intersections become one, empty operands go.

use std::collections::VecDeque;

use scene::Bounds;
use scene::bound::moved;

use super::chain::{Chain, Link, Operator};
use super::hierarchy::{Box32, Hierarchy, widened};
use super::omit::{Ledger, Twins, is_apart, is_empty, outside_terms};
use super::{Child, Instance, Leaf, MediumId, Node, NodeId, Step};

/// Unions with more terms than this get a hierarchy.
const LINEAR_UNION: usize = 3;
/// Operators that take turns more often than this make a chain.
const NESTED_TURNS: usize = 16;

/// A solid whose operator may still take in more operands.
#[derive(Debug)]
pub(super) enum Operand {
    /// No volume.
    Nothing,
    Node(NodeId),
    Or(VecDeque<NodeId>),
    /// With the box that all of it but the complements share.
    And(VecDeque<Child>, Bounds),
    /// Operators in turn, from the innermost operand on.
    Turns(Turns),
    /// The outside of another operand.
    Complement(Box<Self>),
}

/// Links of what may become a chain.
#[derive(Debug)]
pub(super) struct Turns {
    links: Vec<Link>,
    /// Holds all of it.
    bounds: Bounds,
    magnitude: f64,
}

impl Turns {
    /// Without a link, nothing.
    fn new() -> Self {
        Self { links: Vec::new(), bounds: Bounds::EMPTY, magnitude: 0.0 }
    }

    fn push(&mut self, nodes: &[Node], node: NodeId, operator: Operator) {
        self.links.push(Link { node, operator });
        let node = &nodes[node as usize];
        self.bounds = operator.bounds(self.bounds, node.bounds());
        self.magnitude = f64::max(self.magnitude, node.magnitude);
    }

    /// Takes the factors of an intersection in, the first one by an operator of its own.
    fn extend(&mut self, nodes: &[Node], factors: VecDeque<Child>, first: Operator) {
        for (k, Child { node, complemented }) in factors.into_iter().enumerate() {
            let kept = if k == 0 { first } else { Operator::Clip };
            self.push(nodes, node, if complemented { Operator::Cut } else { kept });
        }
    }
}

/// Nodes under construction.
#[derive(Debug, Default)]
pub(super) struct Builder {
    pub(super) nodes: Vec<Node>,
    pub(super) children: Vec<Child>,
    pub(super) leaves: Vec<Leaf>,
    pub(super) instances: Vec<Instance>,
    pub(super) hierarchies: Vec<Hierarchy>,
    pub(super) chains: Vec<Chain>,
    /// What is left out on the way.
    pub(super) ledger: Ledger,
}

fn index(n: usize) -> u32 {
    u32::try_from(n).expect("fewer than 2³² nodes fit in memory")
}

impl Builder {
    pub(super) fn leaf(&mut self, leaf: Leaf, bounds: &Bounds) -> Operand {
        let node = Node {
            step: Step::Leaf(index(self.leaves.len())),
            box32: Box32::about(bounds),
            magnitude: leaf.magnitude,
            medium: Some(leaf.medium),
            depth: 1,
        };
        self.leaves.push(leaf);
        Operand::Node(self.push(node))
    }

    pub(super) fn instance(
        &mut self,
        instance: Instance,
        bounds: Bounds,
        magnitude: f64,
    ) -> NodeId {
        let root = self.nodes[instance.root as usize];
        let node = Node {
            step: Step::Instance(index(self.instances.len())),
            box32: Box32::about(&bounds),
            magnitude,
            medium: root.medium,
            depth: root.depth + 1,
        };
        self.instances.push(instance);
        self.push(node)
    }

    pub(super) fn push(&mut self, node: Node) -> NodeId {
        self.nodes.push(node);
        index(self.nodes.len() - 1)
    }

    /// The union of operands in source order.
    pub(super) fn union(&mut self, mut operands: impl Iterator<Item = Operand>) -> Operand {
        let mut terms: VecDeque<NodeId> = VecDeque::new();
        let mut turns = match operands.next() {
            Some(Operand::Turns(turns)) => turns,
            Some(Operand::And(factors, _)) => {
                let mut turns = Turns::new();
                turns.extend(&self.nodes, factors, Operator::Add);
                turns
            }
            Some(Operand::Or(more)) => {
                terms = more;
                Turns::new()
            }
            Some(other) => {
                terms.extend(self.finish(other));
                Turns::new()
            }
            None => return Operand::Nothing,
        };
        for operand in operands {
            match self.settled(operand) {
                Operand::Or(more) => join(&mut terms, more),
                other => terms.extend(self.finish(other)),
            }
        }
        if !turns.links.is_empty() {
            for node in terms {
                turns.push(&self.nodes, node, Operator::Add);
            }
            return Operand::Turns(turns);
        }
        match terms.len() {
            0 => Operand::Nothing,
            1 => Operand::Node(terms[0]),
            _ => Operand::Or(terms),
        }
    }

    /// A chain, if there is one, as the union or intersection that it ends with, or as a node if it is long.
    pub(super) fn settled(&mut self, operand: Operand) -> Operand {
        let Operand::Turns(Turns { links, .. }) = operand else { return operand };
        let is_same =
            |a: &Link, b: &Link| (a.operator == Operator::Add) == (b.operator == Operator::Add);
        if links.chunk_by(is_same).count() > NESTED_TURNS
            && let Some(node) = self.chain(&links)
        {
            return Operand::Node(node);
        }
        let mut inner = Operand::Nothing;
        for run in links.chunk_by(is_same) {
            let first = self.finish(inner);
            inner = if run[0].operator == Operator::Add {
                match (first, run) {
                    (None, [only]) => Operand::Node(only.node),
                    _ => Operand::Or(first.into_iter().chain(run.iter().map(|l| l.node)).collect()),
                }
            } else {
                let kept = first.map(|node| Child { node, complemented: false });
                let factors = run.iter().map(|link| {
                    let complemented = link.operator == Operator::Cut;
                    Child { node: link.node, complemented }
                });
                let factors: VecDeque<Child> = kept.into_iter().chain(factors).collect();
                let bounds = self.common(&factors);
                Operand::And(factors, bounds)
            };
        }
        inner
    }

    /// What all operands but complements share.
    fn common(&self, factors: &VecDeque<Child>) -> Bounds {
        let kept = factors.iter().filter(|factor| !factor.complemented);
        kept.fold(Bounds::ALL, |all, kept| between(all, self.nodes[kept.node as usize].bounds()))
    }

    /// The node of a chain.
    fn chain(&mut self, links: &[Link]) -> Option<NodeId> {
        let mut kept: Vec<Link> = Vec::with_capacity(links.len());
        let (mut bounds, mut magnitude, mut depth) = (Bounds::EMPTY, 0.0, 0);
        let mut medium = self.nodes[links.first()?.node as usize].medium;
        for link in links {
            let node = &self.nodes[link.node as usize];
            match link.operator {
                Operator::Add if node.medium != medium => medium = None,
                Operator::Cut if is_apart(&mut self.ledger, node, &bounds, magnitude) => continue,
                Operator::Add | Operator::Cut | Operator::Clip => {}
            }
            bounds = link.operator.bounds(bounds, node.bounds());
            (magnitude, depth) = (f64::max(magnitude, node.magnitude), depth.max(node.depth));
            kept.push(*link);
        }
        self.chains.push(Chain::new(kept, &self.nodes));
        let step = Step::Chain(index(self.chains.len() - 1));
        let box32 = Box32::about(&bounds);
        Some(self.push(Node { step, box32, magnitude, medium, depth: depth + 1 }))
    }

    /// Another entrance to what an instance holds, or to a piece of it.
    pub(super) fn entrance(&mut self, instance: u32, root: NodeId) -> NodeId {
        let instance = Instance { root, ..self.instances[instance as usize] };
        let inner = self.nodes[root as usize];
        let magnitude = instance.map.magnitude + instance.map.stretch() * inner.magnitude;
        let bounds = widened(moved(inner.bounds(), &instance.map), magnitude);
        self.instance(instance, bounds, magnitude)
    }

    /// Box and magnitude of an operand; everything for a complement.
    fn zone(&self, operand: &Operand) -> (Bounds, f64) {
        let node = |node: NodeId| {
            let node = &self.nodes[node as usize];
            (node.bounds(), node.magnitude)
        };
        match operand {
            Operand::Nothing => (Bounds::EMPTY, 0.0),
            Operand::Node(id) => node(*id),
            Operand::Or(terms) => terms.iter().fold((Bounds::EMPTY, 0.0), |(hull, most), &term| {
                let (bounds, magnitude) = node(term);
                (hull.hull(bounds), f64::max(most, magnitude))
            }),
            Operand::And(factors, bounds) => {
                let most = factors.iter().fold(0.0, |most, f| f64::max(most, node(f.node).1));
                (*bounds, most)
            }
            Operand::Turns(turns) => (turns.bounds, turns.magnitude),
            Operand::Complement(_) => (Bounds::ALL, 0.0),
        }
    }

    /// Takes terms that lie outside of the other operands out of the unions among them.
    fn without_outside_terms(&mut self, operands: &mut [Operand]) {
        if !operands.iter().any(|operand| matches!(operand, Operand::Or(_))) {
            return;
        }
        let zones: Vec<(Bounds, f64)> = operands.iter().map(|operand| self.zone(operand)).collect();
        for (k, operand) in operands.iter_mut().enumerate() {
            let Operand::Or(terms) = operand else { continue };
            let others = zones.iter().enumerate().filter(|&(other, _)| other != k);
            let (zone, magnitude) =
                others.fold((Bounds::ALL, 0.0), |(zone, most), (_, &(bounds, magnitude))| {
                    (between(zone, bounds), f64::max(most, magnitude))
                });
            let nodes = terms.iter().map(|&term| &self.nodes[term as usize]);
            let outside = outside_terms(&mut self.ledger, nodes, &zone, magnitude);
            let mut outside = outside.into_iter();
            terms.retain(|_| outside.next() == Some(false));
        }
    }

    /// The intersection of operands in source order, some of them complements.
    pub(super) fn intersection(&mut self, operands: impl Iterator<Item = Operand>) -> Operand {
        let mut operands: Vec<Operand> = operands.collect();
        for operand in operands.iter_mut().skip(1) {
            let own = std::mem::replace(operand, Operand::Nothing);
            *operand = self.settled(own);
        }
        self.without_outside_terms(&mut operands);
        let (mut bounds, mut magnitude) = (Bounds::ALL, 0.0);
        let mut turns = Turns::new();
        if let Some(first @ (Operand::Or(_) | Operand::Turns(_))) = operands.first_mut() {
            (bounds, magnitude) = self.zone(first);
            match std::mem::replace(first, Operand::Nothing) {
                Operand::Turns(more) => turns = more,
                Operand::Or(terms) => {
                    for node in terms {
                        turns.push(&self.nodes, node, Operator::Add);
                    }
                }
                _ => {}
            }
        }
        let is_chain = !turns.links.is_empty();
        let mut factors: VecDeque<Child> = VecDeque::new();
        for operand in operands.into_iter().skip(usize::from(is_chain)) {
            match operand {
                Operand::And(more, common) => {
                    join(&mut factors, more);
                    bounds = between(bounds, common);
                }
                Operand::Complement(inner) => match self.settled(*inner) {
                    // Outside a union is outside all of its terms.
                    Operand::Or(terms) => factors
                        .extend(terms.into_iter().map(|node| Child { node, complemented: true })),
                    inner => factors
                        .extend(self.finish(inner).map(|node| Child { node, complemented: true })),
                },
                other => match self.finish(other) {
                    Some(node) => {
                        factors.push_back(Child { node, complemented: false });
                        let node = &self.nodes[node as usize];
                        bounds = between(bounds, node.bounds());
                        magnitude = f64::max(magnitude, node.magnitude);
                    }
                    None => return Operand::Nothing,
                },
            }
        }
        if is_empty(&mut self.ledger, &bounds, magnitude) {
            return Operand::Nothing;
        }
        if is_chain {
            turns.extend(&self.nodes, factors, Operator::Clip);
            return Operand::Turns(turns);
        }
        Operand::And(factors, bounds)
    }

    /// The node of an operand that takes no more; `None` if it has no volume.
    pub(super) fn finish(&mut self, operand: Operand) -> Option<NodeId> {
        match self.settled(operand) {
            Operand::Nothing => None,
            Operand::Node(node) => Some(node),
            Operand::Or(terms) => {
                let terms = terms
                    .into_iter()
                    .map(|node| Child { node, complemented: false })
                    .collect::<Vec<_>>();
                Some(self.or_node(&terms))
            }
            Operand::And(mut factors, bounds) => {
                let (nodes, ledger) = (&self.nodes, &mut self.ledger);
                let kept = factors.iter().filter(|child| !child.complemented);
                let magnitude =
                    kept.fold(0.0, |m, c| f64::max(m, nodes[c.node as usize].magnitude));
                factors.retain(|child| {
                    !child.complemented
                        || !is_apart(ledger, &nodes[child.node as usize], &bounds, magnitude)
                });
                match (factors.len(), factors.front()) {
                    (1, Some(only)) => Some(only.node),
                    _ => Some(self.and_node(factors.into(), bounds)),
                }
            }
            Operand::Complement(_) | Operand::Turns(_) => {
                unreachable!("a complement is taken in by its intersection, a chain is settled")
            }
        }
    }

    fn or_node(&mut self, terms: &[Child]) -> NodeId {
        let mut ledger = std::mem::take(&mut self.ledger);
        let twins = Twins::among(self, &mut ledger, terms.iter().map(|term| term.node));
        self.ledger = ledger;
        let terms = terms.iter().zip(twins).filter(|(_, twin)| !twin);
        let terms = &*terms.map(|(term, _)| *term).collect::<Vec<_>>();
        if let [only] = terms {
            return only.node;
        }
        let boxes: Vec<(Bounds, f64)> = terms
            .iter()
            .map(|child| &self.nodes[child.node as usize])
            .map(|node| (node.bounds(), node.magnitude))
            .collect();
        let bounds = boxes.iter().fold(Bounds::EMPTY, |hull, b| hull.hull(b.0));
        let hierarchy = (terms.len() > LINEAR_UNION).then(|| {
            self.hierarchies.push(Hierarchy::build(&boxes));
            index(self.hierarchies.len() - 1)
        });
        let (first, count) = self.adopt(terms);
        self.operator(Step::Or { first, count, hierarchy }, bounds, terms, |medium, more| {
            if medium == more { medium } else { None }
        })
    }

    fn and_node(&mut self, factors: Vec<Child>, bounds: Bounds) -> NodeId {
        let taken = factors.iter().filter(|child| child.complemented).count();
        let factors = if taken > LINEAR_UNION {
            // Many subtrahends: one union with a hierarchy.
            let mut kept: Vec<Child> = Vec::new();
            for run in factors.chunk_by(|a, b| a.complemented == b.complemented) {
                if !run[0].complemented || run.len() <= LINEAR_UNION {
                    kept.extend_from_slice(run);
                    continue;
                }
                let plain: Vec<Child> =
                    run.iter().map(|child| Child { complemented: false, ..*child }).collect();
                kept.push(Child { node: self.or_node(&plain), complemented: true });
            }
            kept
        } else {
            factors
        };
        let (first, count) = self.adopt(&factors);
        // The inside belongs to the leftmost operand.
        self.operator(Step::And { first, count }, bounds, &factors, |medium, _| medium)
    }

    fn adopt(&mut self, children: &[Child]) -> (u32, u32) {
        let first = index(self.children.len());
        self.children.extend_from_slice(children);
        (first, index(children.len()))
    }

    fn operator(
        &mut self,
        step: Step,
        bounds: Bounds,
        children: &[Child],
        join: impl Fn(Option<MediumId>, Option<MediumId>) -> Option<MediumId>,
    ) -> NodeId {
        let nodes = || children.iter().map(|child| &self.nodes[child.node as usize]);
        let node = Node {
            step,
            box32: Box32::about(&bounds),
            magnitude: nodes().fold(0.0, |m, node| f64::max(m, node.magnitude)),
            medium: nodes().map(|node| node.medium).reduce(join).flatten(),
            depth: 1 + nodes().map(|node| node.depth).max().unwrap_or(0),
        };
        self.push(node)
    }
}

/// What two boxes share; where they lie apart, what lies between them, with the corners on the wrong sides.
pub(super) fn between(a: Bounds, b: Bounds) -> Bounds {
    Bounds { low: a.low.max(b.low), high: a.high.min(b.high) }
}

/// Appends `more`, moving the shorter of the two: nesting to either side stays linear.
fn join<T>(items: &mut VecDeque<T>, mut more: VecDeque<T>) {
    if items.len() < more.len() {
        while let Some(item) = items.pop_back() {
            more.push_front(item);
        }
        *items = more;
    } else {
        items.append(&mut more);
    }
}
