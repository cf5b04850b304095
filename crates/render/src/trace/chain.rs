//! Lazy evaluation of a chain along a ray: only of the links that the ray meets, from the last one back to the one that
//! decides.

use super::Hit;
use super::scope::ScopeId;
use super::seek::Seeker;
use crate::world::NodeId;
use crate::world::chain::{Chain, Operator};
use crate::world::hierarchy::BoxRay;

/// A link that the ray meets, and where the ray is seen from it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Active {
    node: NodeId,
    operator: Operator,
    is_inside: bool,
    /// That holds up to here, if it is known at all.
    until: Hit,
}

/// Where a chain is looked at from.
#[derive(Clone, Copy)]
struct Look<'a> {
    ray: &'a BoxRay,
    scope: ScopeId,
    limit: f64,
}

impl Seeker<'_> {
    /// The least t at or after `from` where being inside of the chain is as `wanted`; what lies at or beyond `limit` need
    /// not be told apart.
    pub(crate) fn seek_chain(
        &mut self,
        chain: &Chain,
        ray: &BoxRay,
        scope: ScopeId,
        from: Hit,
        limit: f64,
        wanted: bool,
    ) -> Hit {
        let world = self.world;
        let mut met = std::mem::take(&mut self.room.met);
        chain.deciding(
            &mut met,
            |tree, take| {
                tree.nearest(ray, from.t, limit, &mut |item, to| {
                    take(item);
                    to
                });
            },
            |node| ray.meets(&world.node(node).box32, from.t, limit),
        );
        let mut active = self.room.spare.pop().unwrap_or_default();
        active.extend(met.iter().map(|&k| {
            let link = chain.links[k as usize];
            let until = Hit { t: f64::NEG_INFINITY, ..Hit::NONE };
            Active { node: link.node, operator: link.operator, is_inside: false, until }
        }));
        self.room.met = met;
        let look = Look { ray, scope, limit };
        let found = self.seek_links(&mut active, look, from, wanted);
        active.clear();
        self.room.spare.push(active);
        found
    }

    fn seek_links(
        &mut self,
        active: &mut [Active],
        look: Look<'_>,
        from: Hit,
        wanted: bool,
    ) -> Hit {
        let mut at = from;
        loop {
            let (mut is_inside, mut next) = (false, Hit::NONE);
            for link in active.iter_mut().rev() {
                // Not a number never comes here.
                if link.until.t <= at.t {
                    self.place(link, look, at);
                }
                if link.until.t < next.t {
                    next = link.until;
                }
                if link.is_inside != (link.operator == Operator::Clip) {
                    is_inside = link.operator == Operator::Add;
                    break;
                }
            }
            if is_inside == wanted {
                return at;
            }
            if next.t >= look.limit {
                return Hit::NONE;
            }
            at = next;
        }
    }

    /// Finds out whether the ray is inside of a link at `at`, and how far that holds.
    fn place(&mut self, link: &mut Active, Look { ray, scope, limit }: Look<'_>, at: Hit) {
        let start = Hit { t: at.t, ..Hit::NONE };
        let entered = self.seek_in(link.node, ray, scope, start, limit);
        link.is_inside = entered.t <= at.t;
        link.until = if link.is_inside {
            self.seek_out(link.node, ray, scope, start, f64::INFINITY)
        } else {
            entered
        };
    }
}
