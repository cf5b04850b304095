//! Groups of which nothing is said.

use scene::AttributesId;

use crate::ast::{Frame, Node, Solid};

/// Leaves out the frames of groups of which nothing is said.
pub(super) fn without_idle_frames(mut solid: Solid) -> Solid {
    let mut used = vec![false; solid.frames.len()];
    for node in &solid.nodes {
        if let Some(frame) = node.frame() {
            used[frame as usize] = true;
        }
    }
    // For each frame the one that stands for it now: itself, or the nearest used one about it.
    let mut place: Vec<Option<u32>> = Vec::with_capacity(solid.frames.len());
    let mut kept = Vec::with_capacity(solid.frames.len());
    for (frame, used) in solid.frames.iter().zip(used) {
        let parent = frame.parent.and_then(|parent| place[parent as usize]);
        let says = frame.attributes != AttributesId::NONE || !frame.placement.is_identity();
        if used || says {
            place.push(u32::try_from(kept.len()).ok());
            kept.push(Frame { parent, ..*frame });
        } else {
            place.push(parent);
        }
    }
    for node in &mut solid.nodes {
        if let Node::Primitive { frame, .. }
        | Node::Form { frame, .. }
        | Node::Named { frame, .. }
        | Node::Made { frame, .. } = node
        {
            *frame = place[*frame as usize].unwrap_or_default();
        }
    }
    solid.frames = kept;
    solid
}
