//! An object of several media as parts of one medium each.
//!
//! Seen from one medium, leaves of the others that could give the medium are left out; what is taken away stays. Where
//! media meet inside an object the parts overlap, and classification by the whole expression decides.
//!
//! Leaves of one medium share a part only if no other clear medium stands between them in the source: in
//! `glass + water + glass` the second glass may begin inside the first, where water has it, and a part of both would
//! have no boundary there. Opaque leaves share one part always, since nothing is stronger.

use std::collections::{BTreeMap, HashMap};

use super::build::{Builder, Operand};
use super::{Instance, MediumId, NodeId, Part, Step};

/// The parts of each shared definition, by its number.
pub(super) type DefinitionParts = Vec<Vec<Part>>;

/// What gives a medium: a node of one medium, or one part of an instance's definition.
#[derive(Clone, Copy, Debug)]
struct Piece {
    node: NodeId,
    /// Which part of the definition; `None` for a node taken whole.
    part: Option<usize>,
    medium: MediumId,
}

/// The giving pieces of the solid at `root` in source order, and the parents on the way to them.
fn pieces(
    builder: &Builder,
    definitions: &DefinitionParts,
    root: NodeId,
) -> (Vec<Piece>, HashMap<NodeId, NodeId>) {
    let (mut pieces, mut parents) = (Vec::new(), HashMap::new());
    let mut todo = vec![root];
    while let Some(id) = todo.pop() {
        let node = &builder.nodes[id as usize];
        if let Some(medium) = node.medium {
            pieces.push(Piece { node: id, part: None, medium });
            continue;
        }
        let giving = match node.step {
            Step::Instance(instance) => {
                let definition = builder.instances[instance as usize].definition as usize;
                pieces.extend(definitions[definition].iter().enumerate().map(|(part, given)| {
                    Piece { node: id, part: Some(part), medium: given.medium }
                }));
                continue;
            }
            // A chain has one medium.
            Step::Leaf(_) | Step::Chain(_) => continue,
            Step::Or { first, count, .. } => first as usize..first as usize + count as usize,
            // The inside belongs to the leftmost operand.
            Step::And { first, .. } => first as usize..first as usize + 1,
        };
        for child in builder.children[giving].iter().rev() {
            parents.insert(child.node, id);
            todo.push(child.node);
        }
    }
    (pieces, parents)
}

/// Pieces that may be one part.
fn runs(pieces: Vec<Piece>) -> Vec<Vec<Piece>> {
    let (mut runs, mut opaque): (Vec<Vec<Piece>>, Vec<Piece>) = (Vec::new(), Vec::new());
    for piece in pieces {
        if piece.medium == MediumId::OPAQUE {
            opaque.push(piece);
            continue;
        }
        match runs.last_mut() {
            Some(run) if run[0].medium == piece.medium => run.push(piece),
            _ => runs.push(vec![piece]),
        }
    }
    if !opaque.is_empty() {
        runs.push(opaque);
    }
    runs
}

/// The parts of the solid at `root`.
pub(super) fn split(
    builder: &mut Builder,
    definitions: &DefinitionParts,
    root: NodeId,
) -> Vec<Part> {
    if let Some(medium) = builder.nodes[root as usize].medium {
        return vec![Part { node: root, medium }];
    }
    let (pieces, parents) = pieces(builder, definitions, root);
    runs(pieces)
        .into_iter()
        .filter_map(|run| {
            let medium = run[0].medium;
            let node = part(builder, definitions, &parents, root, &run)?;
            Some(Part { node, medium })
        })
        .collect()
}

/// What is left of the solid at `root` when only the pieces of `run` give a medium.
fn part(
    builder: &mut Builder,
    definitions: &DefinitionParts,
    parents: &HashMap<NodeId, NodeId>,
    root: NodeId,
    run: &[Piece],
) -> Option<NodeId> {
    // What is left of each node, and from the pieces up, the children of each operator that leave something.
    let mut left: HashMap<NodeId, NodeId> = HashMap::new();
    let mut operators: BTreeMap<NodeId, Vec<NodeId>> = BTreeMap::new();
    for piece in run {
        let kept = match piece.part {
            None => piece.node,
            Some(number) => instance_part(builder, definitions, piece.node, number),
        };
        left.insert(piece.node, kept);
        let mut child = piece.node;
        while let Some(&parent) = parents.get(&child) {
            let children = operators.entry(parent).or_default();
            let known = !children.is_empty();
            if children.last() != Some(&child) {
                children.push(child);
            }
            if known {
                break;
            }
            child = parent;
        }
    }
    // Children stand before their parents.
    for (operator, children) in operators {
        let kept: Vec<NodeId> =
            children.iter().filter_map(|child| left.get(child).copied()).collect();
        let solid = match builder.nodes[operator as usize].step {
            Step::Or { .. } => builder.union(kept.into_iter().map(Operand::Node)),
            Step::And { first, count } => {
                let Some(&leading) = kept.first() else { continue };
                let rest = first as usize + 1..first as usize + count as usize;
                let rest = builder.children[rest].to_vec();
                let rest = rest.iter().map(|child| {
                    let node = Operand::Node(child.node);
                    if child.complemented { Operand::Complement(Box::new(node)) } else { node }
                });
                builder.intersection(std::iter::once(Operand::Node(leading)).chain(rest))
            }
            Step::Leaf(_) | Step::Instance(_) | Step::Chain(_) => {
                unreachable!("an operator of several media has children")
            }
        };
        if let Some(node) = builder.finish(solid) {
            left.insert(operator, node);
        }
    }
    left.get(&root).copied()
}

/// The instance at `node` with one part of its definition.
fn instance_part(
    builder: &mut Builder,
    definitions: &DefinitionParts,
    node: NodeId,
    number: usize,
) -> NodeId {
    let whole = builder.nodes[node as usize];
    let Step::Instance(instance) = whole.step else { unreachable!("pieces say what they are") };
    let instance = &builder.instances[instance as usize];
    let root = definitions[instance.definition as usize][number].node;
    let instance = Instance { root, ..*instance };
    builder.instance(instance, whole.bounds, whole.magnitude)
}
