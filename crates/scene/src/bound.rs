//! Boxes of solids in the space they are written in.

use crate::class::Scene;
use crate::csg::{Node, Solid};
use crate::form::Form;
use crate::primitive::Primitive;
use crate::ray::Bounds;
use crate::transform::Map;

/// Boxes of a whole scene.
#[derive(Clone, Debug, Default)]
pub struct SceneBounds {
    /// One box for each class, in its own space.
    pub classes: Vec<Bounds>,
    /// One box for each object.
    pub objects: Vec<Bounds>,
}

impl Scene {
    /// The boxes of all classes and objects.
    #[must_use]
    pub fn bounds(&self) -> SceneBounds {
        let mut bounds = SceneBounds::default();
        for class in &self.classes {
            let own = class.solid.bounds(&class.solid.maps(), &bounds.classes);
            bounds.classes.push(own);
        }
        for object in &self.objects {
            let own = object.solid.bounds(&object.solid.maps(), &bounds.classes);
            bounds.objects.push(own);
        }
        bounds
    }
}

impl Solid {
    /// The box of the whole solid; `maps` as from [`Solid::maps`], `classes` holds the boxes of earlier classes.
    #[must_use]
    pub fn bounds(&self, maps: &[Map], classes: &[Bounds]) -> Bounds {
        self.node_bounds(maps, classes).last().copied().unwrap_or(Bounds::EMPTY)
    }

    /// The box of the solid that each node completes: the hull of a union, the overlap of an intersection,
    /// everything for a complement. Boxes are widened by the rounding of the maps.
    ///
    /// # Panics
    ///
    /// When the solid is not well formed (a reader has checked that).
    #[must_use]
    pub fn node_bounds(&self, maps: &[Map], classes: &[Bounds]) -> Vec<Bounds> {
        let mut all = Vec::with_capacity(self.nodes.len());
        self.node_bounds_into(&mut all, &mut Vec::new(), maps, classes);
        all
    }

    /// [`Self::node_bounds`] in place of what `all` holds, with room for the operands that are open.
    pub(crate) fn node_bounds_into(
        &self,
        all: &mut Vec<Bounds>,
        stack: &mut Vec<Bounds>,
        maps: &[Map],
        classes: &[Bounds],
    ) {
        all.clear();
        stack.clear();
        for node in &self.nodes {
            let bounds = match *node {
                Node::Primitive { kind, frame } => placed(kind, &maps[frame.0 as usize]),
                Node::Form { form, frame } => placed_form(self.form(form), &maps[frame.0 as usize]),
                Node::Instance { class, frame } => {
                    moved(classes[class.0 as usize], &maps[frame.0 as usize])
                }
                Node::Union(n) => fold(stack, n, Bounds::hull),
                Node::Intersection(n) => fold(stack, n, Bounds::overlap),
                Node::Complement => {
                    stack.pop();
                    Bounds::ALL
                }
            };
            stack.push(bounds);
            all.push(bounds);
        }
    }
}

fn fold(stack: &mut Vec<Bounds>, n: u32, join: fn(Bounds, Bounds) -> Bounds) -> Bounds {
    let start = stack.len() - n as usize;
    stack.drain(start..).reduce(join).expect("operators have operands")
}

/// Outward by some units in the last place of everything that entered the box: a plane face does not lie on it.
fn padded(bounds: Bounds, map: &Map) -> Bounds {
    if bounds.is_empty() {
        return Bounds::EMPTY;
    }
    let size = bounds.low.abs().max(bounds.high.abs()).max_element().max(map.magnitude);
    bounds.widened(16.0 * f64::EPSILON * size)
}

/// The box about a primitive under a map.
#[must_use]
pub fn placed(kind: Primitive, map: &Map) -> Bounds {
    padded(kind.bounds(&map.linear, map.place), map)
}

/// The box about a solid with arguments under a map.
#[must_use]
pub fn placed_form(form: &Form, map: &Map) -> Bounds {
    padded(form.bounds(&map.linear, map.place), map)
}

/// The box about a box under a map.
#[must_use]
pub fn moved(bounds: Bounds, map: &Map) -> Bounds {
    if bounds.is_empty() || bounds == Bounds::ALL {
        return bounds;
    }
    let hull = bounds
        .corners()
        .into_iter()
        .map(|corner| map.outward(corner))
        .fold(Bounds::EMPTY, |hull, p| hull.hull(Bounds { low: p, high: p }));
    padded(hull, map)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::csg::{Frame, FrameId};
    use crate::transform::Placement;
    use crate::{AttributesId, Scene};

    fn two(kind: Primitive, other: DVec3, operator: &[Node]) -> Solid {
        let frame = |place| Frame {
            parent: None,
            placement: Placement { place, ..Placement::default() },
            attributes: AttributesId::NONE,
        };
        let mut nodes = vec![
            Node::Primitive { kind, frame: FrameId(0) },
            Node::Primitive { kind, frame: FrameId(1) },
        ];
        nodes.extend_from_slice(operator);
        Solid { frames: vec![frame(DVec3::ZERO), frame(other)], nodes, ..Solid::default() }
    }

    #[test]
    fn operators_join_boxes() {
        let x = DVec3::new(1.5, 0.0, 0.0);
        let bounds = |operator: &[Node]| {
            let mut scene = Scene::default();
            scene.add_object(None, two(Primitive::Sphere, x, operator));
            scene.bounds().objects[0]
        };
        let near = |a: f64, b: f64| (a - b).abs() < 1e-13;
        let union = bounds(&[Node::Union(2)]);
        assert!(near(union.low.x, -1.0) && near(union.high.x, 2.5), "{union:?}");
        let common = bounds(&[Node::Intersection(2)]);
        assert!(near(common.low.x, 0.5) && near(common.high.x, 1.0), "{common:?}");
        let cut = bounds(&[Node::Complement, Node::Intersection(2)]);
        assert!(near(cut.low.x, -1.0) && near(cut.high.x, 1.0), "{cut:?}");
    }

    #[test]
    fn apart_is_empty() {
        let mut scene = Scene::default();
        let solid = two(Primitive::Block, DVec3::new(9.0, 0.0, 0.0), &[Node::Intersection(2)]);
        scene.add_object(None, solid);
        assert!(scene.bounds().objects[0].is_empty(), "disjoint blocks");
    }
}
