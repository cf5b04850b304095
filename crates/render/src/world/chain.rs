//! Long chains of operators in turn, such as `a + b − c + d − …`: no union or intersection takes in another there, so an
//! expression would be as deep as the chain is long.
//!
//! A chain is read from its end: a point is in it if the last link that decides about the point lets it in. A solid
//! added or cut away decides about its own points, one clipped to decides about all others. So a ray has to look only at
//! the links that it meets, which a hierarchy over all of them finds.

use scene::Bounds;

use super::build::between;
use super::hierarchy::Hierarchy;
use super::{Node, NodeId};

/// What a link does with all before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operator {
    /// Union with it.
    Add,
    /// Its space is taken away.
    Cut,
    /// Intersection with it.
    Clip,
}

impl Operator {
    /// The box of what comes of it.
    pub(super) fn bounds(self, all: Bounds, own: Bounds) -> Bounds {
        match self {
            Self::Add => all.hull(own),
            Self::Cut => all,
            Self::Clip => between(all, own),
        }
    }
}

/// One operand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    pub(crate) node: NodeId,
    pub(crate) operator: Operator,
}

/// All links from the innermost on, which is added to nothing.
#[derive(Debug)]
pub(crate) struct Chain {
    pub(crate) links: Vec<Link>,
    /// Over the links that decide about their own points, by their places.
    local: Hierarchy,
    places: Vec<u32>,
    /// Places of the others.
    clips: Vec<u32>,
}

impl Chain {
    pub(super) fn new(links: Vec<Link>, nodes: &[Node]) -> Self {
        let count = u32::try_from(links.len()).expect("nodes are numbered by u32");
        let is_clip = |&k: &u32| links[k as usize].operator == Operator::Clip;
        let (clips, places): (Vec<u32>, Vec<u32>) = (0..count).partition(is_clip);
        let boxes: Vec<(Bounds, f64)> = places
            .iter()
            .map(|&k| &nodes[links[k as usize].node as usize])
            .map(|node| (node.bounds(), node.magnitude))
            .collect();
        Self { local: Hierarchy::build(&boxes), links, places, clips }
    }

    /// Puts the places of the links that can decide into `met`, in order: `local` shows those of a hierarchy that are
    /// met, and `clip` says whether a clip's box is; what stands before one that is not decides nothing.
    #[inline]
    pub(crate) fn deciding(
        &self,
        met: &mut Vec<u32>,
        local: impl FnOnce(&Hierarchy, &mut dyn FnMut(u32)),
        clip: impl Fn(NodeId) -> bool,
    ) {
        met.clear();
        let mut first = 0;
        for &k in self.clips.iter().rev() {
            if !clip(self.links[k as usize].node) {
                first = k + 1;
                break;
            }
            met.push(k);
        }
        local(&self.local, &mut |item| {
            let k = self.places[item as usize];
            if k >= first {
                met.push(k);
            }
        });
        met.sort_unstable();
    }
}
