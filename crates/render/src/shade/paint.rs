//! The body colour under its coats of paint, and the relief they give the surface.

use glam::{BVec2, DVec2, DVec3};
use scene::Rgb;
use scene::texture::{Domain, Site, Spot, Texture, Weight};
use scene::transform::{apply, apply_transposed};

use super::footprint::{Cone, Footprint};
use super::pyramid::{Between, Pyramid};
use super::relief::{Facing, Relief};
use crate::trace::event::Event;
use crate::trace::scope::{ScopeId, Scopes};
use crate::world::{Leaf, MediumId, PaintFrame, World};

/// A painted surface: its colour, and which way it faces if not as the event does.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Painted {
    pub(crate) color: Rgb,
    pub(crate) raised: Option<Facing>,
    /// What is to be added to the square of the facets' slope.
    pub(crate) roughening: f64,
}

/// `color` with the paint that holds at the event's surface, met along a unit `direction` by a ray of this cone.
#[inline(always)]
pub(crate) fn painted(
    world: &World,
    scopes: &Scopes,
    event: &Event,
    direction: DVec3,
    cone: Cone,
    color: Rgb,
) -> Painted {
    if !world.is_painted {
        return Painted { color, raised: None, roughening: 0.0 };
    }
    // Taken apart and put together: in registers on either way.
    let Painted { color, raised, roughening } =
        coated(world, scopes, event, direction, cone, color);
    Painted { color, raised, roughening }
}

/// [`painted`] where there is paint; the code of a ray is smaller without.
#[inline(never)]
fn coated(
    world: &World,
    scopes: &Scopes,
    event: &Event,
    direction: DVec3,
    cone: Cone,
    color: Rgb,
) -> Painted {
    let plain = Painted { color, raised: None, roughening: 0.0 };
    let leaf = &world.leaves[event.owner.leaf as usize];
    let Some((paint, scope)) = scopes.paint(world, event.owner.scope, leaf.paint) else {
        return plain;
    };
    let frame = &world.paints[paint.index()];
    let footprint = cone.footprint(event, direction);
    let surface = Surface { world, scopes, event, leaf, frame, scope, footprint };
    let mut relief = Relief::default();
    let color = frame.coats.iter().fold(color, |color, coat| {
        if let Weight::Relief = coat.texture.function().weight {
            let Some(function) = coat.texture.inner() else { return color };
            let pieces = surface.footprint.pieces();
            let at = |number, away: DVec3| {
                let (footprint, aside) = surface.footprint.piece(number, pieces);
                let piece = Surface { footprint, ..surface };
                piece.weight(function, aside + away, Between::Curved)
            };
            let weight = relief.raise(coat.texture.arguments()[0], surface.steps(), pieces, at);
            return coat.color.map_or(color, |paint| color + (paint - color) * weight);
        }
        match coat.color {
            Some(paint) => {
                let weight = surface.weight(&coat.texture, DVec3::ZERO, Between::Straight);
                color + (paint - color) * weight
            }
            None => surface.shown_over(color, &coat.texture),
        }
    });
    let raised = |height: f64| surface.outer_vector(height * surface.frame_normal());
    let roughening = relief.roughening(raised(1.0).dot(event.normal));
    if relief.is_flat() {
        return Painted { color, roughening, ..plain };
    }
    let facing = relief.facing(event, direction, surface.steps(), raised);
    Painted { color, raised: Some(facing), roughening }
}

/// A painted surface where a ray meets it.
#[derive(Clone, Copy)]
struct Surface<'a> {
    world: &'a World,
    scopes: &'a Scopes,
    event: &'a Event,
    leaf: &'a Leaf,
    frame: &'a PaintFrame,
    /// What the frame is in.
    scope: ScopeId,
    footprint: Footprint,
}

impl Surface<'_> {
    /// The weight of a function at a point that lies `away` in the tangent plane.
    fn weight(&self, texture: &Texture, away: DVec3, between: Between) -> f64 {
        match texture.function().weight {
            Weight::Formula(formula) => {
                let domain = texture.function().domain;
                let at = |(footprint, aside): (Footprint, DVec3)| {
                    formula(texture.arguments(), &self.spot(domain, footprint, away + aside))
                };
                match domain {
                    // Integrals along u and v.
                    Domain::Surface => at((self.footprint, DVec3::ZERO)),
                    // Means over a cube about a point stand for the pieces of what is slanted.
                    Domain::Solid => {
                        let pieces = self.footprint.pieces();
                        let (mut sum, mut piece) = (0.0, 0.0);
                        while piece < pieces {
                            sum += at(self.footprint.piece(piece, pieces));
                            piece += 1.0;
                        }
                        sum / pieces
                    }
                }
            }
            Weight::Picture(_) => {
                let picture = texture.image().and_then(|i| self.world.pictures.get(i.0 as usize));
                let weights = picture.and_then(|picture| picture.weights.as_ref());
                weights.map_or(0.0, |weights| self.seen(texture, weights, away, between)[0])
            }
            // No function of a relief is one.
            Weight::Relief => 0.0,
        }
    }

    /// A picture in its own colours over `color`.
    fn shown_over(&self, color: Rgb, texture: &Texture) -> Rgb {
        let picture = texture.image().and_then(|i| self.world.pictures.get(i.0 as usize));
        let Some(colors) = picture.and_then(|picture| picture.colors.as_ref()) else {
            return color;
        };
        let [red, green, blue, coverage] =
            self.seen(texture, colors, DVec3::ZERO, Between::Straight);
        Rgb::new(red, green, blue) + color * (1.0 - coverage)
    }

    /// What the ray takes in of a picture.
    fn seen<const N: usize>(
        &self,
        texture: &Texture,
        picture: &Pyramid<N>,
        away: DVec3,
        between: Between,
    ) -> [f64; N] {
        let nothing = [0.0; N];
        let Weight::Picture(place) = texture.function().weight else { return nothing };
        let at = |away: DVec3| place(texture.arguments(), &self.site(away, picture.aspect()));
        let Some(placed) = at(away) else { return nothing };
        let edge = |edge: DVec3| {
            let Some(there) = at(away + edge) else { return DVec2::ZERO };
            let mut way = there.place - placed.place;
            if placed.period.is_finite() {
                way.x -= placed.period * (way.x / placed.period).round();
            }
            way
        };
        picture.mean(&placed, [edge(self.footprint.across), edge(self.footprint.along)], between)
    }

    fn spot(&self, domain: Domain, footprint: Footprint, away: DVec3) -> Spot {
        match domain {
            Domain::Surface => {
                let here = self.uv(away);
                let edge = |edge: DVec3| {
                    let mut way = self.uv(away + edge) - here;
                    way -= DVec2::select(self.comes_round(), way.round(), DVec2::ZERO);
                    DVec3::new(way.x, way.y, 0.0)
                };
                let width = footprint.moved(edge).extent();
                Spot { point: DVec3::new(here.x, here.y, 0.0), width }
            }
            Domain::Solid => {
                let width = footprint.moved(|edge| self.frame_vector(edge)).extent();
                Spot { point: self.frame_point(away), width }
            }
        }
    }

    fn site(&self, away: DVec3, aspect: f64) -> Site {
        Site {
            surface: self.uv(away),
            closed: self.comes_round().x,
            point: self.frame_point(away),
            normal: self.frame_normal(),
            aspect,
        }
    }

    /// u and v of the primitive.
    fn uv(&self, away: DVec3) -> DVec2 {
        let Event { owner, point, face, .. } = *self.event;
        let local = self.leaf.inward(self.scopes.inward(owner.scope, point + away));
        self.leaf.texture_coordinates(local, face)
    }

    /// Whether u and v come round.
    fn comes_round(&self) -> BVec2 {
        self.leaf.comes_round(self.event.face)
    }

    /// A point in the coordinates of the paint, off the surface by the rounding bound: a face in a lattice plane has one
    /// side of it.
    fn frame_point(&self, away: DVec3) -> DVec3 {
        self.frame.map.inward(self.scopes.inward(self.scope, self.event.behind() + away))
    }

    /// A vector in the coordinates of the paint.
    fn frame_vector(&self, vector: DVec3) -> DVec3 {
        apply(&self.frame.map.inverse, apply(&self.scopes.get(self.scope).map.inverse, vector))
    }

    /// A vector of the coordinates of the paint in those of the scene.
    fn outer_vector(&self, vector: DVec3) -> DVec3 {
        apply(&self.scopes.get(self.scope).map.linear, apply(&self.frame.map.linear, vector))
    }

    /// The normal out of the body, of length 1 in the coordinates of the paint.
    fn frame_normal(&self) -> DVec3 {
        let Event { normal, far, .. } = *self.event;
        let outward = if far == MediumId::AIR { -normal } else { normal };
        let outer = apply_transposed(&self.scopes.get(self.scope).map.linear, outward);
        scene::transform::unit(apply_transposed(&self.frame.map.linear, outer))
    }

    /// Steps in the tangent plane over which a relief is measured: the width of the ray, as far as numbers tell.
    fn steps(&self) -> [DVec3; 2] {
        /// A slope is known to a millionth when its step is this many rounding bounds.
        const LEAST: f64 = 1_048_576.0;
        let width = self.footprint.across.length();
        let least = LEAST * self.event.offset;
        let across = self.event.normal.any_orthonormal_vector();
        let step = if width > least { width } else { least };
        [step * across, step * self.event.normal.cross(across)]
    }
}
