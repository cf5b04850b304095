//! The instances a ray has entered, as a list that paths are read from.

use glam::DVec3;
use scene::Map;

use crate::world::{Instance, World};

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
    /// The instance's number; meaningless for the scene itself.
    pub(crate) instance: u32,
}

/// The scopes of one ray. Scenes without shared classes never grow it.
#[derive(Debug)]
pub(crate) struct Scopes(Vec<Scope>);

impl Scopes {
    pub(crate) fn new() -> Self {
        let scene =
            Scope { map: Map::IDENTITY, rank: 0, parent: ScopeId::SCENE, instance: u32::MAX };
        Self(vec![scene])
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
            instance: number,
        };
        self.0.push(inner);
        ScopeId(u32::try_from(self.0.len() - 1).expect("a ray enters fewer than 2³² instances"))
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
        own: Option<u32>,
    ) -> Option<(u32, ScopeId)> {
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
