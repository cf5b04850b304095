//! What the file holds although it follows from the rest.

use crate::csg::Solid;
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

    /// True if all maps and boxes are within the range of numbers.
    pub(super) fn is_finite(&self) -> bool {
        let Bounds { low, high } = self.bounds();
        self.maps.iter().all(Map::is_finite)
            && (self.bounds().is_empty() || low.is_finite() && high.is_finite())
    }

    /// Where the solid can be seen, after its maps are known.
    pub(super) fn extent(&mut self, solid: &Solid, classes: &[Bounds], eye: &Eye) -> Extent {
        solid.extent_with(&mut self.open_extents, &self.maps, classes, eye)
    }

    /// The box of the whole solid.
    pub(super) fn bounds(&self) -> Bounds {
        self.boxes.last().copied().unwrap_or(Bounds::EMPTY)
    }
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
