//! The instances a ray has entered, as a list that paths are read from.

use glam::DVec3;
use scene::Map;

use crate::world::{Instance, PaintId, World};

/// Index of a scope; it stands until the next ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ScopeId(u32);

impl ScopeId {
    /// Not inside any instance.
    pub(crate) const SCENE: Self = Self(0);
}

/// One way into an instance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scope {
    pub(crate) map: Map,
    pub(crate) rank: u64,
    pub(crate) parent: ScopeId,
    /// Instances on the way, this one counted; 0 for the scene itself.
    depth: u32,
    /// The instance's number; meaningless for the scene itself.
    pub(crate) instance: u32,
}

/// The scopes of one ray. Scenes without shared classes never grow it; others keep only the ways that results still
/// name, so copies that overlap, exponentially many of them, take time but no memory.
#[derive(Debug)]
pub(crate) struct Scopes(Vec<Scope>);

impl Scopes {
    pub(crate) fn new() -> Self {
        let scene = Scope {
            map: Map::IDENTITY,
            rank: 0,
            parent: ScopeId::SCENE,
            depth: 0,
            instance: u32::MAX,
        };
        Self(vec![scene])
    }

    /// For worlds without instances, where nothing is ever entered.
    pub(super) fn empty() -> Self {
        Self(Vec::new())
    }

    pub(crate) fn clear(&mut self) {
        self.0.truncate(1);
    }

    pub(crate) fn get(&self, scope: ScopeId) -> &Scope {
        &self.0[scope.0 as usize]
    }

    /// The scope inside of `instance`, met in `parent`.
    pub(crate) fn enter(&mut self, parent: ScopeId, number: u32, instance: &Instance) -> ScopeId {
        let outer = self.get(parent);
        let inner = Scope {
            map: outer.map.then_inner(&instance.map),
            rank: outer.rank + instance.rank,
            parent,
            depth: outer.depth + 1,
            instance: number,
        };
        self.0.push(inner);
        ScopeId(u32::try_from(self.0.len() - 1).expect("a ray enters fewer than 2³² instances"))
    }

    /// Forgets `first`, an instance whose search is over, and all that was entered after it, but for the way to
    /// `kept`. That way moves next to what stands before it; its new end is returned.
    pub(crate) fn leave(&mut self, first: ScopeId, kept: ScopeId) -> ScopeId {
        if kept.0 < first.0 {
            self.0.truncate(first.0 as usize);
            return kept;
        }
        let steps = self.get(kept).depth - self.get(first).depth;
        if kept.0 - first.0 != steps {
            return self.close_up(first, kept);
        }
        self.0.truncate(kept.0 as usize + 1);
        kept
    }

    /// Moves the way from `first` to `kept` together, and forgets what stood between and behind.
    fn close_up(&mut self, first: ScopeId, kept: ScopeId) -> ScopeId {
        // Turn the links round: each scope of the way then names the next one inward.
        let (mut at, mut inward) = (kept, ScopeId::SCENE);
        while at.0 >= first.0 {
            let outward = std::mem::replace(&mut self.0[at.0 as usize].parent, inward);
            (inward, at) = (at, outward);
        }
        let mut last = at;
        let mut free = first;
        loop {
            let scope = self.0[inward.0 as usize];
            self.0[free.0 as usize] = Scope { parent: last, ..scope };
            last = free;
            if scope.parent == ScopeId::SCENE {
                break;
            }
            inward = scope.parent;
            free.0 += 1;
        }
        self.0.truncate(last.0 as usize + 1);
        last
    }

    /// A leaf's rounding magnitude in scene units, everything on the path to it included.
    pub(crate) fn magnitude(&self, scope: ScopeId, leaf_magnitude: f64) -> f64 {
        if scope == ScopeId::SCENE {
            return leaf_magnitude;
        }
        let map = &self.get(scope).map;
        map.magnitude + map.stretch() * leaf_magnitude
    }

    /// The paint that holds for a leaf or instance with `own` paint in `scope`, and the scope it was written in.
    pub(crate) fn paint(
        &self,
        world: &World,
        mut scope: ScopeId,
        own: Option<PaintId>,
    ) -> Option<(PaintId, ScopeId)> {
        let mut paint = own;
        loop {
            if let Some(paint) = paint {
                return Some((paint, scope));
            }
            if scope == ScopeId::SCENE {
                return None;
            }
            let here = self.get(scope);
            paint = world.instances[here.instance as usize].paint;
            scope = here.parent;
        }
    }

    /// A scene point in the space of a scope.
    pub(crate) fn inward(&self, scope: ScopeId, point: DVec3) -> DVec3 {
        if scope == ScopeId::SCENE { point } else { self.get(scope).map.inward(point) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::seek::{Seeker, box_ray};
    use crate::world::{MediumId, World};
    use scene::{AttributesId, Camera, Frame, FrameId, Node, Placement, Primitive, Scene, Solid};

    /// Two of `node` side by side, `apart` from each other.
    fn pair(apart: f64, node: impl Fn(FrameId) -> Node) -> Solid {
        let mut solid = Solid::default();
        for k in 0..2_u32 {
            let place = f64::from(k) * apart * DVec3::X;
            let placement = Placement { place, ..Placement::default() };
            let attributes = AttributesId::NONE;
            solid.frames.push(Frame { parent: None, placement, attributes });
            solid.nodes.push(node(FrameId(k)));
        }
        solid.nodes.push(Node::Union(2));
        solid
    }

    /// A class of two of a class of two of …, all of which overlap.
    fn overlapping(levels: u32) -> World {
        let mut scene = Scene::default();
        let mut class = scene.add_class(
            "c0".into(),
            pair(0.25, |frame| Node::Primitive { kind: Primitive::Sphere, frame }),
        );
        for level in 1..levels {
            let solid = pair(0.3 / f64::from(level), |frame| Node::Instance { class, frame });
            class = scene.add_class(format!("c{level}"), solid);
        }
        scene.add_object(None, pair(0.01, |frame| Node::Instance { class, frame }));
        scene.camera = Some(Camera {
            parallel: false,
            position: DVec3::new(0.5, 0.0, 5.0),
            target: DVec3::ZERO,
            focal_length_mm: 50.0,
        });
        World::load(&scene).expect("it loads")
    }

    #[test]
    fn copies_that_overlap_take_no_memory() {
        let levels = 17;
        let world = overlapping(levels);
        assert!(!world.instances.is_empty(), "classes stay shared");
        let mut seeker = Seeker::new(&world);
        let ray = box_ray(world.eye, DVec3::new(-0.05, 0.0, -1.0).normalize());
        let hit = seeker.next(&world.whole, &ray, 0.0, f64::INFINITY, MediumId::AIR);
        let hit = hit.expect("the ray meets the heap");
        // The way to the surface, and ways to surfaces that were nearest for a while.
        let entered = seeker.scopes.0.len();
        assert!(entered <= 8 * levels as usize, "{entered} of 2^17 instances are remembered");
        let mut steps = 0;
        let mut at = hit.scope;
        while at != ScopeId::SCENE {
            (at, steps) = (seeker.scopes.get(at).parent, steps + 1);
        }
        assert_eq!(steps, levels, "the way to the surface is whole");
    }

    #[test]
    fn the_way_kept_closes_up() {
        let scope = |parent, depth, instance| Scope {
            map: Map::IDENTITY,
            rank: u64::from(instance),
            parent: ScopeId(parent),
            depth,
            instance,
        };
        let mut scopes = Scopes::new();
        // Before: 1; entered: 2 in it, 3 and 4 in 2, 5 in 3, 6 in 5, 7 in 2.
        scopes.0.extend([
            scope(0, 1, 1),
            scope(1, 2, 2),
            scope(2, 3, 3),
            scope(2, 3, 4),
            scope(3, 4, 5),
            scope(5, 5, 6),
            scope(2, 3, 7),
        ]);
        let end = scopes.leave(ScopeId(2), ScopeId(6));
        let way: Vec<_> = scopes.0.iter().map(|s| (s.instance, s.parent.0)).collect();
        assert_eq!(end, ScopeId(5), "the end of the way");
        assert_eq!(way[1..], [(1, 0), (2, 1), (3, 2), (5, 3), (6, 4)], "in one piece");
        assert_eq!(scopes.leave(ScopeId(2), end), end, "nothing to do");
        assert_eq!(scopes.leave(ScopeId(2), ScopeId(1)), ScopeId(1), "something older is kept");
        assert_eq!(scopes.0.len(), 2, "all that was entered since is forgotten");
    }
}
