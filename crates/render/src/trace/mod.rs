//! Where a ray meets the scene.
//!
//! [`seek`] and [`merge`] find boundaries of the expression along a ray, lazily or by whole span lists; [`classify`]
//! tells the media on both sides of a point and who owns the surface there; [`event`] joins them to the next boundary
//! that counts; [`tree`] follows the rays that spring from it.

mod chain;
pub(crate) mod classify;
mod coherence;
pub(crate) mod event;
pub(crate) mod merge;
pub(crate) mod packet;
pub(crate) mod record;
pub(crate) mod scope;
pub(crate) mod seek;
mod shadow;
mod slants;

pub(crate) mod tree;

use scene::Face;
use scope::ScopeId;

use crate::world::LeafId;

/// A boundary on a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    pub(crate) t: f64,
    pub(crate) leaf: LeafId,
    /// The instance the leaf was reached through.
    pub(crate) scope: ScopeId,
    pub(crate) face: Face,
}

impl Hit {
    pub(crate) const NONE: Self =
        Self { t: f64::INFINITY, leaf: LeafId::MAX, scope: ScopeId::SCENE, face: Face(0) };
}
