//! An object of several media as one expression for each medium.
//!
//! Seen from one medium, leaves of the others that could give the medium are left out; what is taken away stays. Where
//! media meet inside an object the parts overlap, and classification by the whole expression decides.

use std::collections::{BTreeSet, HashMap};

use super::build::{Builder, Operand};
use super::{Child, Instance, MediumId, Node, NodeId, Part, Step};

/// The parts of each shared definition, by its number.
pub(super) type DefinitionParts = Vec<Vec<Part>>;

/// Children that can give a node its medium.
fn giving<'a>(builder: &'a Builder, node: &Node) -> &'a [Child] {
    match node.step {
        Step::Or { first, count, .. } => {
            &builder.children[first as usize..first as usize + count as usize]
        }
        Step::And { first, .. } => &builder.children[first as usize..=first as usize],
        Step::Leaf(_) | Step::Instance(_) => &[],
    }
}

/// The parts of the solid at `root`, one for each medium it can have.
pub(super) fn split(
    builder: &mut Builder,
    definitions: &DefinitionParts,
    root: NodeId,
) -> Vec<Part> {
    if let Some(medium) = builder.nodes[root as usize].medium {
        return vec![Part { node: root, medium }];
    }
    // The nodes on giving paths, least first: children stand before their parents.
    let mut path = BTreeSet::from([root]);
    let mut todo = vec![root];
    let mut media = BTreeSet::new();
    while let Some(id) = todo.pop() {
        let node = builder.nodes[id as usize];
        if let (Step::Instance(instance), None) = (node.step, node.medium) {
            let definition = builder.instances[instance as usize].definition;
            media.extend(definitions[definition as usize].iter().map(|part| part.medium));
        }
        media.extend(node.medium);
        // A node of one medium is kept or left out whole.
        if node.medium.is_none() {
            for child in giving(builder, &node).iter().map(|child| child.node) {
                if path.insert(child) {
                    todo.push(child);
                }
            }
        }
    }
    media
        .into_iter()
        .filter_map(|medium| {
            let mut kept: HashMap<NodeId, NodeId> = HashMap::new();
            for &id in &path {
                if let Some(node) = keep(builder, definitions, &kept, id, medium) {
                    kept.insert(id, node);
                }
            }
            kept.get(&root).map(|&node| Part { node, medium })
        })
        .collect()
}

/// What is left of `id` seen from `medium`; `kept` holds the answers for its children.
fn keep(
    builder: &mut Builder,
    definitions: &DefinitionParts,
    kept: &HashMap<NodeId, NodeId>,
    id: NodeId,
    medium: MediumId,
) -> Option<NodeId> {
    let node = builder.nodes[id as usize];
    if let Some(only) = node.medium {
        return (only == medium).then_some(id);
    }
    match node.step {
        Step::Leaf(_) => unreachable!("a leaf has one medium"),
        Step::Instance(instance) => {
            let whole = &builder.instances[instance as usize];
            let part =
                definitions[whole.definition as usize].iter().find(|part| part.medium == medium)?;
            let instance = Instance { root: part.node, ..*whole };
            Some(builder.instance(instance, node.bounds, node.magnitude))
        }
        Step::Or { first, count, .. } => {
            let children =
                builder.children[first as usize..first as usize + count as usize].to_vec();
            let terms = children.iter().filter_map(|child| kept.get(&child.node).copied());
            let union = builder.union(terms.map(Operand::Node));
            builder.finish(union)
        }
        Step::And { first, count } => {
            let children =
                builder.children[first as usize..first as usize + count as usize].to_vec();
            let leading = Operand::Node(*kept.get(&children[0].node)?);
            let rest = children[1..].iter().map(|child| {
                let node = Operand::Node(child.node);
                if child.complemented { Operand::Complement(Box::new(node)) } else { node }
            });
            let intersection = builder.intersection(std::iter::once(leading).chain(rest));
            builder.finish(intersection)
        }
    }
}
