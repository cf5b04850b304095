//! The expression, flattened while it is read: nested unions and intersections become one, empty operands go.

use std::collections::VecDeque;

use scene::Bounds;

use super::hierarchy::Hierarchy;
use super::{Child, Instance, Leaf, MediumId, Node, NodeId, Step};

/// Unions with more terms than this get a hierarchy.
const LINEAR_UNION: usize = 3;

/// A solid whose operator may still take in more operands.
#[derive(Debug)]
pub(super) enum Operand {
    /// No volume.
    Nothing,
    Node(NodeId),
    Or(VecDeque<NodeId>),
    /// With the box that all of it but the complements share.
    And(VecDeque<Child>, Bounds),
    /// The outside of another operand.
    Complement(Box<Self>),
}

/// Nodes under construction.
#[derive(Debug, Default)]
pub(super) struct Builder {
    pub(super) nodes: Vec<Node>,
    pub(super) children: Vec<Child>,
    pub(super) leaves: Vec<Leaf>,
    pub(super) instances: Vec<Instance>,
    pub(super) hierarchies: Vec<Hierarchy>,
}

fn index(n: usize) -> u32 {
    u32::try_from(n).expect("fewer than 2³² nodes fit in memory")
}

impl Builder {
    pub(super) fn leaf(&mut self, leaf: Leaf) -> Operand {
        let node = Node {
            step: Step::Leaf(index(self.leaves.len())),
            bounds: leaf.bounds,
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
            bounds,
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
    pub(super) fn union(&mut self, operands: impl Iterator<Item = Operand>) -> Operand {
        let mut terms: VecDeque<NodeId> = VecDeque::new();
        for operand in operands {
            match operand {
                Operand::Or(more) => join(&mut terms, more),
                other => terms.extend(self.finish(other)),
            }
        }
        match terms.len() {
            0 => Operand::Nothing,
            1 => Operand::Node(terms[0]),
            _ => Operand::Or(terms),
        }
    }

    /// The intersection of operands in source order, some of them complements.
    pub(super) fn intersection(&mut self, operands: impl Iterator<Item = Operand>) -> Operand {
        let mut factors: VecDeque<Child> = VecDeque::new();
        let mut bounds = Bounds::ALL;
        for operand in operands {
            match operand {
                Operand::And(more, common) => {
                    join(&mut factors, more);
                    bounds = bounds.overlap(common);
                }
                Operand::Complement(inner) => match *inner {
                    // Outside a union is outside all of its terms.
                    Operand::Or(terms) => factors
                        .extend(terms.into_iter().map(|node| Child { node, complemented: true })),
                    inner => factors
                        .extend(self.finish(inner).map(|node| Child { node, complemented: true })),
                },
                other => match self.finish(other) {
                    Some(node) => {
                        factors.push_back(Child { node, complemented: false });
                        bounds = bounds.overlap(self.nodes[node as usize].bounds);
                    }
                    None => return Operand::Nothing,
                },
            }
        }
        if bounds.is_empty() { Operand::Nothing } else { Operand::And(factors, bounds) }
    }

    /// The node of an operand that takes no more; `None` if it has no volume.
    pub(super) fn finish(&mut self, operand: Operand) -> Option<NodeId> {
        match operand {
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
                // What is taken away outside the box changes nothing in it.
                factors.retain(|child| {
                    let own = &self.nodes[child.node as usize].bounds;
                    !child.complemented || !own.overlap(bounds).is_empty()
                });
                match (factors.len(), factors.front()) {
                    (1, Some(only)) => Some(only.node),
                    _ => Some(self.and_node(factors.into(), bounds)),
                }
            }
            Operand::Complement(_) => unreachable!("a complement is taken in by its intersection"),
        }
    }

    fn or_node(&mut self, terms: &[Child]) -> NodeId {
        let boxes: Vec<(Bounds, f64)> = terms
            .iter()
            .map(|child| &self.nodes[child.node as usize])
            .map(|node| (node.bounds, node.magnitude))
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
            bounds,
            magnitude: nodes().fold(0.0, |m, node| f64::max(m, node.magnitude)),
            medium: nodes().map(|node| node.medium).reduce(join).flatten(),
            depth: 1 + nodes().map(|node| node.depth).max().unwrap_or(0),
        };
        self.push(node)
    }
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
