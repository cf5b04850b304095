//! What the file holds although it follows from the rest.

use glam::DVec3;

use crate::csg::{Node, Solid};
use crate::ray::Bounds;
use crate::rectangle::Rectangle;
use crate::transform::Map;

/// Everything derived of one solid.
pub(super) struct Derived {
    maps: Vec<Map>,
    boxes: Vec<Bounds>,
}

impl Derived {
    /// Of a well-formed solid; `classes` holds the boxes of earlier classes.
    pub(super) fn new(solid: &Solid, classes: &[Bounds]) -> Self {
        let maps = solid.maps();
        let boxes = solid.node_bounds(&maps, classes);
        Self { maps, boxes }
    }

    pub(super) fn maps(&self) -> &[Map] {
        &self.maps
    }

    /// The box of the whole solid.
    pub(super) fn bounds(&self) -> Bounds {
        self.boxes.last().copied().unwrap_or(Bounds::EMPTY)
    }

    /// Map and box of each leaf, in order.
    pub(super) fn leaves(&self, solid: &Solid) -> impl Iterator<Item = (&Map, Bounds)> {
        solid.nodes.iter().zip(&self.boxes).filter_map(|(node, bounds)| match *node {
            Node::Primitive { frame, .. }
            | Node::Form { frame, .. }
            | Node::Instance { frame, .. } => Some((&self.maps[frame.0 as usize], *bounds)),
            Node::Union(_) | Node::Intersection(_) | Node::Complement => None,
        })
    }
}

/// The matrix of a map by rows, the place as last column; nothing if the map changes nothing.
pub(super) fn matrix(map: &Map) -> Option<[f64; 12]> {
    let (m, p) = (&map.linear, map.place);
    let moves = *m != Map::IDENTITY.linear || p != DVec3::ZERO;
    moves.then(|| {
        [
            [m.x_axis.x, m.y_axis.x, m.z_axis.x, p.x],
            [m.x_axis.y, m.y_axis.y, m.z_axis.y, p.y],
            [m.x_axis.z, m.y_axis.z, m.z_axis.z, p.z],
        ]
        .as_flattened()
        .try_into()
        .expect("three rows of four")
    })
}

/// The inverse matrix by rows; the place is taken off before.
pub(super) fn inverse(map: &Map) -> [f64; 9] {
    map.inverse.transpose().to_cols_array()
}

/// The corners of a box; nothing if it is empty.
pub(super) fn corners(bounds: &Bounds) -> Option<[f64; 6]> {
    let Bounds { low, high } = *bounds;
    (!bounds.is_empty()).then_some([low.x, low.y, low.z, high.x, high.y, high.z])
}

/// The corners of a rectangle.
pub(super) fn rectangle(rectangle: &Rectangle) -> [f64; 4] {
    let Rectangle { low, high } = rectangle;
    [low.x, low.y, high.x, high.y]
}
