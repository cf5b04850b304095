//! Coats of paint: where a point lies in a surface or in a factor's own space, and what a function makes of it.

use scene::Primitive;
use scene::texture::Texture;

use super::body::{Body, Kind, Surface};
use super::dd::{Vec3, along};
use super::line::Crossing;
use super::place::Affine;

type Color = [f64; 3];

/// One coat, and the coordinates of the factor that it is written at.
#[derive(Clone, Debug)]
pub(crate) struct Coat {
    pub(crate) texture: Texture,
    pub(crate) color: Color,
    pub(crate) map: Affine,
}

/// The colour of a body under its coats.
pub(crate) fn painted(body: &Body, at: &Crossing) -> Color {
    // Space functions see the point as far behind the surface as it may be off it.
    let behind = along(&at.point, super::dd::Dd::from(-at.rounding), &at.normal);
    body.finish.coats.iter().fold(body.color, |color, coat| {
        let weight = weight(
            &coat.texture,
            || uv(&body.kind, at.surface, &body.map.point_inward(&at.point)),
            || coat.map.point_inward(&behind).map(|x| x.value()),
        );
        std::array::from_fn(|k| (1.0 - weight) * color[k] + weight * coat.color[k])
    })
}

/// The share of a turn from one axis toward another.
#[expect(clippy::disallowed_methods, reason = "the oracle shares nothing with the tracer")]
fn turn(from: f64, toward: f64) -> f64 {
    (toward.atan2(from) / std::f64::consts::TAU).rem_euclid(1.0)
}

/// Where a point of the canonical solid lies in its surface.
#[expect(clippy::disallowed_methods, reason = "the oracle shares nothing with the tracer")]
fn uv(kind: &Kind, surface: Surface, point: &Vec3) -> [f64; 2] {
    let [x, y, z] = point.map(|x| x.value());
    let Kind::Convex(kind) = *kind else { panic!("the oracle knows no paint on these solids") };
    match (kind, surface) {
        (Primitive::Sphere, _) => [turn(x, -z), 0.5 + y.atan2(x.hypot(z)) / std::f64::consts::PI],
        // To the right and upward, as seen from outside.
        (Primitive::Block, Surface::Plane(0, sign)) => [0.5 - 0.5 * sign * z, 0.5 + 0.5 * y],
        (Primitive::Block, Surface::Plane(1, sign)) => [0.5 + 0.5 * x, 0.5 - 0.5 * sign * z],
        (Primitive::Block, Surface::Plane(_, sign)) => [0.5 + 0.5 * sign * x, 0.5 + 0.5 * y],
        (Primitive::Block, Surface::Curved) => unreachable!("blocks are flat"),
        (_, Surface::Curved) => [turn(y, z), x],
        (_, Surface::Plane(..)) => [turn(y, z), y.hypot(z)],
    }
}

/// Odd fields are painted.
fn odd(fields: f64) -> f64 {
    fields.rem_euclid(2.0).round()
}

fn weight(texture: &Texture, uv: impl Fn() -> [f64; 2], point: impl Fn() -> [f64; 3]) -> f64 {
    let a = texture.arguments();
    match texture.function().keyword {
        "checker" => {
            let [u, v] = uv();
            odd((u * a[0]).floor() + (v * a[1]).floor())
        }
        "stripes" => odd((uv()[1] * a[0]).floor()),
        "rings" => {
            let [u, v] = uv();
            odd((2.0 * a[0] * (u - a[1]).hypot(v - a[2])).floor())
        }
        "grid" => {
            let [u, v] = uv();
            // Within half a width of a whole number.
            let line = |x: f64| (x - x.round()).abs() <= 0.5 * a[2];
            f64::from(u8::from(line(u * a[0]) || line(v * a[1])))
        }
        "checker3d" => odd(point().map(|x| (x * a[0]).floor()).iter().sum()),
        "gradient" => (point()[1] / a[0]).clamp(0.0, 1.0),
        other => panic!("the oracle knows no `{other}`"),
    }
}
