//! The part of the scene that some rays can meet.

use std::sync::Arc;

use glam::DVec3;
use scene::Bounds;

use super::hierarchy::Hierarchy;
use super::{Node, NodeId, Part, ROUNDING, World};

/// Objects to classify points by, and parts to seek boundaries in.
#[derive(Debug, Default)]
pub(crate) struct Region {
    /// Objects as written.
    pub(crate) objects: Vec<NodeId>,
    pub(crate) object_boxes: Arc<Hierarchy>,
    /// Terms of one medium each.
    pub(crate) parts: Vec<Part>,
    /// The same one where each object is a part.
    pub(crate) part_boxes: Arc<Hierarchy>,
}

/// More parts than this are not gone through one by one: the hierarchy of the whole scene finds those of a beam, and is
/// cut down to them.
const FEW_PARTS: usize = 256;
/// Past this many parts in a beam the whole hierarchy finds its way as quickly as what is left of it.
const MOST_PARTS: usize = 512;

impl Region {
    pub(crate) fn new(nodes: &[Node], objects: Vec<NodeId>, parts: Vec<Part>) -> Self {
        let boxed = |ids: &mut dyn Iterator<Item = NodeId>| {
            let boxes: Vec<_> = ids
                .map(|id| &nodes[id as usize])
                .map(|node| (node.bounds(), node.magnitude))
                .collect();
            Arc::new(Hierarchy::build(&boxes))
        };
        let object_boxes = boxed(&mut objects.iter().copied());
        let part_boxes = if objects.iter().copied().eq(parts.iter().map(|part| part.node)) {
            Arc::clone(&object_boxes)
        } else {
            boxed(&mut parts.iter().map(|part| part.node))
        };
        Self { object_boxes, part_boxes, objects, parts }
    }
}

/// The rays from one point between four directions, or parallel ones between four lines.
#[derive(Debug)]
pub(crate) struct Beam {
    /// A point of each plane.
    points: [DVec3; 5],
    /// Unit normals, inward.
    planes: [DVec3; 5],
}

impl Beam {
    /// `corners` in order around the beam.
    pub(crate) fn new(origin: DVec3, corners: [DVec3; 4]) -> Self {
        let middle = corners[0] + corners[1] + corners[2] + corners[3];
        // The fifth keeps out what lies behind, if the beam is not so wide that some of it goes back.
        let ahead = corners.iter().all(|corner| corner.dot(middle) >= 0.0);
        let planes = std::array::from_fn(|i| {
            if i == 4 {
                return if ahead { middle.normalize_or_zero() } else { DVec3::ZERO };
            }
            let normal = corners[i].cross(corners[(i + 1) % 4]).normalize_or_zero();
            if normal.dot(middle) < 0.0 { -normal } else { normal }
        });
        Self { points: [origin; 5], planes }
    }

    /// The rays that start between four `corners`, in order around them, along a unit direction across them.
    pub(crate) fn parallel(corners: [DVec3; 4], direction: DVec3) -> Self {
        let middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
        let planes = std::array::from_fn(|i| {
            if i == 4 {
                return direction;
            }
            let side = corners[(i + 1) % 4] - corners[i];
            let normal = side.cross(direction).normalize_or_zero();
            if normal.dot(middle - corners[i]) < 0.0 { -normal } else { normal }
        });
        let [a, b, c, d] = corners;
        Self { points: [a, b, c, d, middle], planes }
    }

    /// True if the box lies beyond one of the planes by more than `slack`.
    pub(crate) fn misses(&self, bounds: &Bounds, slack: f64) -> bool {
        self.planes.iter().zip(&self.points).any(|(&normal, &point)| {
            let foremost = DVec3::select(normal.cmpgt(DVec3::ZERO), bounds.high, bounds.low);
            (foremost - point).dot(normal) < -slack
        })
    }
}

impl World {
    /// Points are asked for up to a rounding bound off the rays: boxes of a beam that are no farther off are met.
    pub(crate) fn slack(&self) -> f64 {
        4.0 * ROUNDING * self.magnitude
    }

    /// What the many rays of `beam` can meet, if it pays to know.
    pub(crate) fn within(&self, beam: &Beam) -> Option<Region> {
        self.reached(beam, MOST_PARTS)
    }

    /// What the rays of `beam` can meet, if those are few enough that it pays to know.
    pub(crate) fn reached(&self, beam: &Beam, most: usize) -> Option<Region> {
        let slack = self.slack();
        if self.whole.parts.len() > FEW_PARTS {
            return self.cut_down(beam, slack, most);
        }
        let meets = |node: NodeId| !beam.misses(&self.node(node).bounds(), slack);
        let objects = self.whole.objects.iter().copied().filter(|&root| meets(root)).collect();
        let parts = self.whole.parts.iter().copied().filter(|part| meets(part.node)).collect();
        Some(Region::new(&self.nodes, objects, parts))
    }

    /// The whole region without what a beam misses, if that leaves at most so many parts.
    fn cut_down(&self, beam: &Beam, slack: f64, most: usize) -> Option<Region> {
        let meets = |bounds: &Bounds| !beam.misses(bounds, slack);
        let whole = &self.whole;
        let (part_boxes, parts) = whole.part_boxes.cut_down(meets, most)?;
        let part_boxes = Arc::new(part_boxes);
        let (object_boxes, objects) = if Arc::ptr_eq(&whole.part_boxes, &whole.object_boxes) {
            (Arc::clone(&part_boxes), parts.clone())
        } else {
            let (boxes, objects) = whole.object_boxes.cut_down(meets, most)?;
            (Arc::new(boxes), objects)
        };
        let parts = parts.into_iter().map(|part| whole.parts[part as usize]).collect();
        let objects = objects.into_iter().map(|object| whole.objects[object as usize]).collect();
        Some(Region { objects, object_boxes, parts, part_boxes })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_beam_misses_what_is_beside_or_behind_it() {
        let corner = |x, y| DVec3::new(x, y, -1.0);
        let corners = [corner(-0.1, 0.1), corner(0.1, 0.1), corner(0.1, -0.1), corner(-0.1, -0.1)];
        let beam = Beam::new(DVec3::ZERO, corners);
        let cube = |x, y, z| Bounds::about(DVec3::new(x, y, z), DVec3::splat(0.5));
        assert!(!beam.misses(&cube(0.0, 0.0, -5.0), 0.0), "ahead");
        assert!(!beam.misses(&cube(1.0, 0.0, -5.0), 0.0), "half in");
        assert!(beam.misses(&cube(1.2, 0.0, -5.0), 0.0), "beside");
        assert!(!beam.misses(&cube(1.2, 0.0, -5.0), 0.2), "within the slack");
        assert!(beam.misses(&cube(0.0, 0.0, 5.0), 0.0), "behind");
    }

    #[test]
    fn a_parallel_beam_misses_what_is_beside_or_behind_it() {
        let corner = |x, y| DVec3::new(x, y, 3.0);
        let corners = [corner(-1.0, 1.0), corner(2.0, 1.0), corner(2.0, -1.0), corner(-1.0, -1.0)];
        let beam = Beam::parallel(corners, DVec3::NEG_Z);
        let cube = |x, y, z| Bounds::about(DVec3::new(x, y, z), DVec3::splat(0.5));
        assert!(!beam.misses(&cube(0.0, 0.0, -500.0), 0.0), "ahead");
        assert!(!beam.misses(&cube(2.4, 0.0, -500.0), 0.0), "half in");
        assert!(beam.misses(&cube(2.6, 0.0, -500.0), 0.0), "beside");
        assert!(beam.misses(&cube(0.0, 1.6, 0.0), 0.0), "above");
        assert!(beam.misses(&cube(0.0, 0.0, 3.6), 0.0), "behind");
        assert!(!beam.misses(&cube(0.0, 0.0, 3.4), 0.0), "across the plane of the picture");
    }

    #[test]
    fn a_wide_beam_holds_its_corners() {
        // Corners as far apart as rays to a light may be; their sum leans to the long one.
        let corner = |x, y| DVec3::new(x, y, -1.0);
        let corners = [corner(-2.0, 0.1), corner(9.0, 0.1), corner(9.0, -0.1), corner(-2.0, -0.1)];
        let beam = Beam::new(DVec3::ZERO, corners);
        for corner in corners {
            let speck = Bounds::about(3.0 * corner, DVec3::splat(1e-9));
            assert!(!beam.misses(&speck, 1e-8), "{corner}");
        }
        let beside = Bounds::about(DVec3::new(-4.0, 0.0, -1.0), DVec3::splat(0.5));
        assert!(beam.misses(&beside, 0.0), "beside");
    }
}
