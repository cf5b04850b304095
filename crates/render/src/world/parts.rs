//! An object of several media as parts of one medium each.
//!
//! Seen from one medium, leaves of the others that could give the medium are left out; what is taken away stays. Where
//! media meet inside an object the parts overlap, and classification by the whole expression decides.
//!
//! Leaves of one medium share a part only if no other clear medium stands between them in the source: in
//! `glass + water + glass` the second glass may begin inside the first, where water has it, and a part of both would
//! have no boundary there. Opaque leaves share one part always, since nothing is stronger.
//!
//! Where that would copy operands over and over, as in a long chain of several media, each solid is sought by itself: a
//! surface of the object is one of a solid in it, and classification passes over those that the others hide.

use std::collections::{BTreeMap, HashMap};

use super::build::{Builder, Operand};
use super::{Instance, MediumId, NodeId, Part, Step};

/// The parts of each shared definition, by its number.
pub(super) type DefinitionParts = Vec<Vec<Part>>;

/// More operands of intersections than this are not copied for the parts of one object.
const MOST_COPIES: usize = 4096;

/// What gives a medium: a node of one medium, or one part of an instance's definition.
#[derive(Clone, Copy, Debug)]
struct Piece {
    node: NodeId,
    /// Which part of the definition; `None` for a node taken whole.
    part: Option<usize>,
    medium: MediumId,
}

/// The giving pieces of the solid at `root` in source order, the parents on the way to them, and how many operands each
/// part would copy; `None` if its solids are to be sought by themselves.
fn pieces(
    builder: &Builder,
    definitions: &DefinitionParts,
    root: NodeId,
) -> Option<(Vec<Piece>, HashMap<NodeId, NodeId>, usize)> {
    let (mut pieces, mut parents, mut copies) = (Vec::new(), HashMap::new(), 0);
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
                if definitions[definition].iter().any(|part| part.medium == MediumId::AIR) {
                    return None;
                }
                pieces.extend(definitions[definition].iter().enumerate().map(|(part, given)| {
                    Piece { node: id, part: Some(part), medium: given.medium }
                }));
                continue;
            }
            Step::Leaf(_) => continue,
            Step::Chain(_) => return None,
            Step::Or { first, count, .. } => first as usize..first as usize + count as usize,
            // The inside belongs to the leftmost operand.
            Step::And { first, count } => {
                copies += count as usize;
                first as usize..first as usize + 1
            }
        };
        for child in builder.children[giving].iter().rev() {
            parents.insert(child.node, id);
            todo.push(child.node);
        }
    }
    Some((pieces, parents, copies))
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
    let Some((pieces, parents, copies)) = pieces(builder, definitions, root) else {
        return solids(builder, definitions, root);
    };
    let runs = runs(pieces);
    if runs.len().saturating_mul(copies) > MOST_COPIES {
        return solids(builder, definitions, root);
    }
    runs.into_iter()
        .filter_map(|run| {
            let medium = run[0].medium;
            let node = part(builder, definitions, &parents, root, &run)?;
            Some(Part { node, medium })
        })
        .collect()
}

/// All solids of one medium that the one at `root` is made of, whatever it does with them: parts of no medium.
fn solids(builder: &mut Builder, definitions: &DefinitionParts, root: NodeId) -> Vec<Part> {
    let (mut parts, mut todo) = (Vec::new(), vec![root]);
    while let Some(id) = todo.pop() {
        let node = builder.nodes[id as usize];
        if node.medium.is_some() {
            parts.push(Part { node: id, medium: MediumId::AIR });
            continue;
        }
        match node.step {
            Step::Leaf(_) => unreachable!("a leaf has a medium"),
            Step::Instance(instance) => {
                let definition = builder.instances[instance as usize].definition as usize;
                for number in 0..definitions[definition].len() {
                    let node = instance_part(builder, definitions, id, number);
                    parts.push(Part { node, medium: MediumId::AIR });
                }
            }
            Step::Or { first, count, .. } | Step::And { first, count } => {
                let operands = first as usize..first as usize + count as usize;
                todo.extend(builder.children[operands].iter().rev().map(|child| child.node));
            }
            Step::Chain(number) => {
                let links = &builder.chains[number as usize].links;
                todo.extend(links.iter().rev().map(|link| link.node));
            }
        }
    }
    parts
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
    builder.instance(instance, whole.bounds(), whole.magnitude)
}
