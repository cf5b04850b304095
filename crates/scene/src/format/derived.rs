//! What the file holds although it follows from the rest.

use glam::DVec3;

use crate::csg::{Node, Solid};
use crate::ray::Bounds;
use crate::rectangle::{Extent, Eye, Rectangle};
use crate::transform::Map;

/// Everything derived of one solid, and room to work it out, which the next one uses again.
#[derive(Default)]
pub(super) struct Derived {
    maps: Vec<Map>,
    boxes: Vec<Bounds>,
    open: Vec<Bounds>,
    open_extents: Vec<Extent>,
}

impl Derived {
    /// Works out maps and boxes of a well-formed solid; `classes` holds the boxes of earlier classes.
    pub(super) fn derive(&mut self, solid: &Solid, classes: &[Bounds]) {
        solid.maps_into(&mut self.maps);
        solid.node_bounds_into(&mut self.boxes, &mut self.open, &self.maps, classes);
    }

    /// Where the solid can be seen, after its maps are known.
    pub(super) fn extent(&mut self, solid: &Solid, classes: &[Bounds], eye: &Eye) -> Extent {
        solid.extent_with(&mut self.open_extents, &self.maps, classes, eye)
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
