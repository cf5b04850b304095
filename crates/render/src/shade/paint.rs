//! The body colour under its coats of paint.

use glam::DVec3;
use scene::Rgb;
use scene::texture::Domain;

use crate::trace::event::Event;
use crate::trace::scope::Scopes;
use crate::world::World;

/// `color` with the paint that holds at the event's surface.
pub(crate) fn painted(world: &World, scopes: &Scopes, event: &Event, color: Rgb) -> Rgb {
    if world.paints.is_empty() {
        return color;
    }
    let leaf = &world.leaves[event.owner.leaf as usize];
    let Some((paint, scope)) = scopes.paint(world, event.owner.scope, leaf.paint) else {
        return color;
    };
    let frame = &world.paints[paint as usize];
    frame.coats.iter().fold(color, |color, coat| {
        let place = match coat.texture.function().domain {
            Domain::Surface => {
                let local = leaf.inward(scopes.inward(event.owner.scope, event.point));
                let uv = leaf.texture_coordinates(local, event.face);
                DVec3::new(uv.x, uv.y, 0.0)
            }
            // Off the surface by the rounding bound: a face in a lattice plane has one side of it.
            Domain::Solid => frame.map.inward(scopes.inward(scope, event.behind())),
        };
        color + (coat.color - color) * coat.texture.weight(place)
    })
}
