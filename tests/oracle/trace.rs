//! The tree of rays below a pixel and the light it gathers, by plain recursion.

use scene::{Light, LightKind, Scene};

use super::body::Clear;
use super::dd::{Dd, Vec3, along, cross, dot, largest, minus, sin_cos_degrees, unit, vector};
use super::finish::{Opaque, half_angle, lobe, spark};
use super::line::{Crossing, ROUNDING, Ray, crossing};
use super::paint::painted;
use super::solid::Solids;

type Color = [f64; 3];

/// Limits of the tree of rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    pub(crate) depth: u32,
    pub(crate) min_weight: f64,
}

/// A scene with the eye at the origin.
#[derive(Debug)]
pub(crate) struct Oracle<'s> {
    scene: &'s Scene,
    limits: Limits,
    pub(crate) solids: Solids,
    /// Minus the eye: added to every point of the scene.
    by: Vec3,
    start: Vec3,
    /// Right, up and forward; the first two as long as half the picture one unit away, or as half of it if it is parallel.
    frame: [Vec3; 3],
    parallel: bool,
    size: (u32, u32),
    /// Every ray's origin is moved by this many rounding bounds: shows whether it runs through an edge.
    pub(crate) nudge: [f64; 3],
    /// Unless 0, rays are moved by as much, each to a side that hangs on this number and the ray.
    pub(crate) salt: u64,
}

fn each(a: Color, b: Color, f: impl Fn(f64, f64) -> f64) -> Color {
    std::array::from_fn(|k| f(a[k], b[k]))
}

fn most(color: Color) -> f64 {
    color.into_iter().fold(f64::NEG_INFINITY, f64::max)
}

#[expect(clippy::disallowed_methods, reason = "the oracle shares nothing with the tracer")]
fn halved(times: f64) -> f64 {
    (-times).exp2()
}

#[expect(clippy::disallowed_methods, reason = "the oracle shares nothing with the tracer")]
fn power(base: f64, exponent: f64) -> f64 {
    if exponent <= 0.0 { 1.0 } else { base.max(0.0).powf(exponent) }
}

/// Width and height of the picture on 35 mm film: as large as fits, the film held upright for upright pictures.
fn film_mm((columns, rows): (u32, u32)) -> [f64; 2] {
    let (columns, rows) = (f64::from(columns), f64::from(rows));
    let film = if columns >= rows { [36.0, 24.0] } else { [24.0, 36.0] };
    let pixel = f64::min(film[0] / columns, film[1] / rows);
    [pixel * columns, pixel * rows]
}

/// Unpolarised light at a smooth interface (Fresnel): the share reflected, and the cosine beyond, 0 in total reflection.
fn fresnel(n1: f64, n2: f64, cosine: Dd) -> (f64, Dd) {
    let ratio = Dd::from(n1) / Dd::from(n2);
    if ratio == Dd::ONE {
        return (0.0, cosine);
    }
    let beyond = (Dd::ONE - ratio * ratio * (Dd::ONE - cosine * cosine)).sqrt();
    if beyond <= Dd::ZERO {
        return (1.0, Dd::ZERO);
    }
    let (c1, c2) = (cosine.value(), beyond.value());
    let senkrecht = (n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2);
    let parallel = (n1 * c2 - n2 * c1) / (n1 * c2 + n2 * c1);
    (0.5 * (senkrecht * senkrecht + parallel * parallel), beyond)
}

impl<'s> Oracle<'s> {
    pub(crate) fn new(scene: &'s Scene, size: (u32, u32), limits: Limits) -> Self {
        let camera = scene.camera.expect("a camera");
        let by = vector(camera.position).map(|x| -x);
        let sight = minus(&vector(camera.target), &vector(camera.position));
        let forward = unit(&sight);
        let level = cross(&forward, &[Dd::ZERO, Dd::ONE, Dd::ZERO]);
        // Straight up or down, the top is +z or −z.
        let top = if forward[1] > Dd::ZERO { Dd::ONE } else { -Dd::ONE };
        let upright = dot(&level, &level) > Dd::from(1e-18);
        let right =
            unit(&if upright { level } else { cross(&forward, &[Dd::ZERO, Dd::ZERO, top]) });
        let up = cross(&right, &forward);
        let away = if camera.parallel { dot(&sight, &sight).sqrt() } else { Dd::ONE };
        let half = film_mm(size).map(|side| Dd::from(side / (2.0 * camera.focal_length_mm)) * away);
        // The eye stands off every symmetry of the scene.
        let most = largest(&sight).max(largest(&by)).max(largest(&vector(camera.target)));
        let off = 4.0 * ROUNDING * most;
        Self {
            scene,
            limits,
            solids: Solids::read(scene, by),
            by,
            start: [0.61, 0.53, 0.47].map(|share| Dd::from(off * share)),
            frame: [right.map(|x| x * half[0]), up.map(|x| x * half[1]), forward],
            parallel: camera.parallel,
            size,
            nudge: [0.0; 3],
            salt: 0,
        }
    }

    /// Start and direction of the ray through the centre of a pixel.
    fn sight(&self, column: u32, row: u32) -> (Vec3, Vec3) {
        let across = |at: u32, of: u32| Dd::from(2 * at + 1) / Dd::from(of) - Dd::ONE;
        let [right, up, forward] = &self.frame;
        let place = |from: &Vec3| {
            let place = along(from, across(column, self.size.0), right);
            along(&place, -across(row, self.size.1), up)
        };
        if self.parallel {
            (place(&self.start), *forward)
        } else {
            (self.start, unit(&place(forward)))
        }
    }

    /// The first surface behind the centre of a pixel.
    pub(crate) fn first(&self, column: u32, row: u32) -> Option<Crossing> {
        let (origin, direction) = self.sight(column, row);
        crossing(&self.solids, &Ray { origin, direction, on: Vec::new() }, None)
    }

    /// Linear colour of the centre of a pixel, background included.
    pub(crate) fn pixel(&self, column: u32, row: u32) -> Color {
        let (start, direction) = self.sight(column, row);
        // A ray that meets nothing may miss anything by its rounding.
        let least =
            || ROUNDING * self.solids.bodies.iter().fold(0.0, |k, b| f64::max(k, b.magnitude));
        let rounding = if self.nudge.iter().all(|step| step.abs() <= 0.0) {
            0.0
        } else {
            self.first(column, row).map_or_else(least, |at| at.rounding)
        };
        self.seen(&self.ray(&start, &direction, Vec::new(), rounding), 1.0, 0)
    }

    fn ray(&self, origin: &Vec3, direction: &Vec3, on: Vec<(usize, bool)>, rounding: f64) -> Ray {
        let bits = direction.iter().fold(self.salt, |bits, x| {
            (bits ^ x.value().to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15)
        });
        let nudge: Vec3 = std::array::from_fn(|k| {
            let back = self.salt > 0 && bits >> (40 + k) & 1 == 1;
            Dd::from(self.nudge[k] * rounding * if back { -1.0 } else { 1.0 })
        });
        Ray { origin: along(origin, Dd::ONE, &nudge), direction: unit(direction), on }
    }

    fn clear(&self, filling: Option<usize>) -> Option<Clear> {
        filling.and_then(|number| self.solids.bodies[number].clear)
    }

    fn opaque(&self, filling: Option<usize>) -> bool {
        filling.is_some_and(|number| self.solids.bodies[number].clear.is_none())
    }

    fn index(&self, filling: Option<usize>) -> f64 {
        self.clear(filling).and_then(|clear| clear.index).unwrap_or(1.0)
    }

    /// What `length` units of a body leave of each channel.
    fn left(&self, filling: Option<usize>, length: f64) -> Color {
        let (Some(number), Some(clear)) = (filling, self.clear(filling)) else { return [1.0; 3] };
        let color = self.solids.bodies[number].color;
        color.map(|c| halved(length * (1.0 + 8.0 * (1.0 - c)) / clear.half_distance))
    }

    fn seen(&self, ray: &Ray, weight: f64, depth: u32) -> Color {
        let background = self.scene.background.to_array();
        let Some(crossing) = crossing(&self.solids, ray, None) else { return background };
        let length = crossing.t.value();
        if crossing.near.is_some() {
            let left = self.left(crossing.near, length);
            let color = self.surface(ray, &crossing, weight * most(left), depth);
            return each(left, color, |share, c| share * c);
        }
        let left = self.scene.fog_half_distance.map_or(1.0, |half| halved(length / half));
        let color = self.surface(ray, &crossing, weight * left, depth);
        each(color, background, |c, b| left * c + (1.0 - left) * b)
    }

    fn child(&self, ray: &Ray, weight: f64, depth: u32) -> Color {
        if depth > self.limits.depth {
            self.scene.background.to_array()
        } else if weight < self.limits.min_weight {
            [0.0; 3]
        } else {
            self.seen(ray, weight, depth)
        }
    }

    /// What leaves the surface toward the ray's origin.
    fn surface(&self, ray: &Ray, at: &Crossing, weight: f64, depth: u32) -> Color {
        let owner = &self.solids.bodies[at.owner];
        let color = painted(owner, at);
        if self.opaque(at.far) {
            // The hole that a clear body leaves in an opaque one is as shiny as the clear body.
            let surface = Opaque::new(color, owner.shininess, &owner.finish);
            return self.glossy(ray, at, &surface, owner.finish.slope <= 0.0, weight, depth);
        }
        let share = owner.shininess;
        let mut light = [0.0; 3];
        if share < 1.0 {
            let ambient = self.scene.ambient.to_array();
            let lit = self.lit(at, |toward| [dot(&at.normal, toward).value(); 3]);
            light = std::array::from_fn(|k| (1.0 - share) * color[k] * (ambient[k] + lit[k]));
        }
        if share <= 0.0 {
            return light;
        }
        let clear = self.clear_share(ray, at, weight, depth);
        each(light, clear, |a, b| a + b)
    }

    fn glossy(
        &self,
        ray: &Ray,
        at: &Crossing,
        surface: &Opaque,
        mirror: bool,
        weight: f64,
        depth: u32,
    ) -> Color {
        let view = ray.direction.map(|x| -x);
        let (cosine, ambient) = (at.cosine.value(), self.scene.ambient.to_array());
        let lit = self.lit(at, |toward| surface.lit(&at.normal, &view, toward));
        let all = each(surface.ambient(cosine), ambient, |a, b| a * b);
        let light = each(lit, all, |a, b| a + b);
        let share: Color = std::array::from_fn(|k| surface.reflects(k, cosine));
        if !mirror || most(share) <= 0.0 {
            return light;
        }
        let color = self.mirrored(ray, at, weight * most(share), depth);
        std::array::from_fn(|k| light[k] + share[k] * color[k])
    }

    fn mirrored(&self, ray: &Ray, at: &Crossing, weight: f64, depth: u32) -> Color {
        let mirrored = along(&ray.direction, at.cosine + at.cosine, &at.normal);
        self.child(&self.ray(&at.point, &mirrored, at.back(), at.rounding), weight, depth + 1)
    }

    /// The share of a clear body's surface that light goes through, or is mirrored by.
    fn clear_share(&self, ray: &Ray, at: &Crossing, weight: f64, depth: u32) -> Color {
        let owner = &self.solids.bodies[at.owner];
        let (share, slope) = (owner.shininess, owner.finish.slope);
        let (n1, n2) = (self.index(at.near), self.index(at.far));
        let fake = owner.clear.is_some_and(|clear| clear.index.is_none());
        let (reflected, beyond) = if fake { (0.0, at.cosine) } else { fresnel(n1, n2, at.cosine) };
        let view = ray.direction.map(|x| -x);
        let mut light = [0.0; 3];
        if reflected > 0.0 && slope > 0.0 {
            let lit = self.lit(at, |toward| {
                // A facet reflects by its own angle, but no more than the surface at those of the eye and the light.
                let angles = [Dd::from(half_angle(&view, toward)), dot(&at.normal, toward)];
                let facets = angles.map(|angle| fresnel(n1, n2, angle).0);
                let facets = facets.into_iter().fold(reflected, f64::min);
                [facets * std::f64::consts::PI * lobe(&at.normal, &view, toward, slope); 3]
            });
            // What is reflected beyond that of a surface met straight on is mirrored, so that none is lost.
            let straight = f64::min(fresnel(n1, n2, Dd::ONE).0, reflected);
            light = each(lit, self.scene.ambient.to_array(), |l, a| share * (l + straight * a));
            let rest = share * (reflected - straight);
            if rest > 0.0 {
                let color = self.mirrored(ray, at, weight * rest, depth);
                light = each(light, color, |l, c| l + rest * c);
            }
        } else if reflected > 0.0 {
            let sparks = self.lit(at, |toward| [spark(&at.normal, &view, toward); 3]);
            let color = self.mirrored(ray, at, weight * share * reflected, depth);
            light = each(color, sparks, |c, s| share * reflected * (c + s));
        }
        if reflected < 1.0 {
            let through = share * (1.0 - reflected);
            let ratio = if fake { Dd::ONE } else { Dd::from(n1) / Dd::from(n2) };
            let bent = ray.direction.map(|x| x * ratio);
            let bent = along(&bent, ratio * at.cosine - beyond, &at.normal);
            let on = self.ray(&at.point, &bent, at.beyond(), at.rounding);
            let color = self.child(&on, weight * through, depth + 1);
            light = each(light, color, |a, b| a + through * b);
        }
        light
    }

    /// The light that comes to a surface, times what it makes of each direction.
    fn lit(&self, at: &Crossing, response: impl Fn(&Vec3) -> Color) -> Color {
        self.scene.lights.iter().fold([0.0; 3], |sum, light| {
            let Some((toward, distance, strength)) = self.arriving(light, &at.point) else {
                return sum;
            };
            if dot(&at.normal, &toward) <= Dd::ZERO {
                return sum;
            }
            let answer = response(&toward).map(|share| share * strength);
            if most(answer) <= 0.0 {
                return sum;
            }
            let ray = self.ray(&at.point, &toward, at.back(), at.rounding);
            let open = if light.shadows { self.open(ray, distance, at.near) } else { [1.0; 3] };
            let color = light.color.to_array();
            std::array::from_fn(|k| sum[k] + answer[k] * color[k] * open[k])
        })
    }

    /// Direction to a light, its distance if it has one, and its strength.
    fn arriving(&self, light: &Light, point: &Vec3) -> Option<(Vec3, Option<Dd>, f64)> {
        let stands = |at| along(&self.by, Dd::ONE, &vector(at));
        match light.kind {
            LightKind::Beam { at, toward } => {
                Some((unit(&minus(&vector(at), &vector(toward))), None, 1.0))
            }
            LightKind::Point { at } => {
                let way = minus(&stands(at), point);
                Some((unit(&way), Some(dot(&way, &way).sqrt()), 1.0))
            }
            LightKind::Spot { at, toward, concentration, half_angle_degrees } => {
                let way = minus(&stands(at), point);
                let axis = unit(&minus(&vector(at), &vector(toward)));
                let cosine = dot(&unit(&way), &axis);
                if cosine < sin_cos_degrees(half_angle_degrees).1 {
                    return None;
                }
                let strength = power(cosine.value(), concentration);
                Some((unit(&way), Some(dot(&way, &way).sqrt()), strength))
            }
        }
    }

    /// The share of a light that comes straight through what stands in the way.
    fn open(&self, mut ray: Ray, mut distance: Option<Dd>, mut filling: Option<usize>) -> Color {
        let mut share = [1.0; 3];
        while let Some(at) = crossing(&self.solids, &ray, distance) {
            if self.opaque(at.far) {
                return [0.0; 3];
            }
            let owner = &self.solids.bodies[at.owner];
            let fake = owner.clear.is_some_and(|clear| clear.index.is_none());
            let reflected = if fake {
                0.0
            } else {
                fresnel(self.index(at.near), self.index(at.far), at.cosine).0
            };
            let through = owner.shininess * (1.0 - reflected);
            share = each(share, self.left(at.near, at.t.value()), |s, l| s * l * through);
            if through <= 0.0 {
                return [0.0; 3];
            }
            distance = distance.map(|distance| distance - at.t);
            filling = at.far;
            ray = Ray { origin: at.point, direction: ray.direction, on: at.beyond() };
        }
        let last = distance.map_or([1.0; 3], |rest| self.left(filling, rest.value()));
        each(share, last, |s, l| s * l)
    }
}
