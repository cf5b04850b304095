//! Where in the picture a solid can be seen, on the plane one unit in front of the eye.
//!
//! A point (x, y, z) of camera space, which looks along −z, is seen at (x/−z, y/−z), whatever the size and the shape
//! of the picture. Where rays are parallel it is seen at (x, y).

use glam::{DVec2, DVec3};

use crate::bound::SceneBounds;
use crate::camera::{Camera, View};
use crate::class::Scene;
use crate::csg::{Node, Solid};
use crate::form::Form;
use crate::primitive::Primitive;
use crate::ray::Bounds;
use crate::transform::{Map, apply_transposed};

/// A rectangle on the plane one unit in front of the eye, x to the right and y up; never empty. Where rays are parallel
/// the plane is that of the eye, which is the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// The bottom left corner.
    pub low: DVec2,
    /// The top right corner.
    pub high: DVec2,
}

/// The part of all directions ahead in which a solid can be seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// The solid is empty or wholly behind the eye.
    None,
    /// Nowhere but here.
    Part(Rectangle),
    /// The solid reaches behind the eye, so it may be seen anywhere.
    Whole,
}

/// The eye and the axes of camera space, without the shape of the picture.
#[derive(Clone, Copy, Debug)]
pub struct Eye {
    position: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    parallel: bool,
}

/// What a solid is the hull of: an ellipsoid, an ellipse, or a point, by its half axes. Coordinates are to the right,
/// up, and ahead.
struct Round<'a> {
    center: DVec3,
    axes: &'a [DVec3],
}

impl Scene {
    /// Where each object can be seen; nothing without a camera.
    #[must_use]
    pub fn rectangles(&self) -> Option<Vec<Extent>> {
        let eye = Eye::new(&self.camera?);
        let SceneBounds { classes, .. } = self.bounds();
        let extent = |solid: &Solid| solid.extent(&solid.maps(), &classes, &eye);
        Some(self.objects.iter().map(|object| extent(&object.solid)).collect())
    }
}

impl Solid {
    /// Where the solid can be seen, if its space is that of the scene; `maps` as from [`Solid::maps`], `classes` holds
    /// the boxes of earlier classes.
    ///
    /// # Panics
    ///
    /// When the solid is not well formed (a reader has checked that).
    #[must_use]
    pub fn extent(&self, maps: &[Map], classes: &[Bounds], eye: &Eye) -> Extent {
        self.extent_with(&mut Vec::new(), maps, classes, eye)
    }

    /// [`Self::extent`] with room for the operands that are open.
    pub(crate) fn extent_with(
        &self,
        stack: &mut Vec<Extent>,
        maps: &[Map],
        classes: &[Bounds],
        eye: &Eye,
    ) -> Extent {
        stack.clear();
        for node in &self.nodes {
            let extent = match *node {
                Node::Primitive { kind, frame } => eye.primitive(kind, &maps[frame.0 as usize]),
                Node::Form { form, frame } => eye.form(self.form(form), &maps[frame.0 as usize]),
                Node::Instance { class, frame } => {
                    eye.moved(&classes[class.0 as usize], &maps[frame.0 as usize])
                }
                Node::Union(n) => fold(stack, n, Extent::hull),
                Node::Intersection(n) => fold(stack, n, Extent::overlap),
                Node::Complement => {
                    stack.pop();
                    Extent::Whole
                }
            };
            stack.push(extent);
        }
        stack.pop().unwrap_or(Extent::None)
    }
}

fn fold(stack: &mut Vec<Extent>, n: u32, join: fn(Extent, Extent) -> Extent) -> Extent {
    let start = stack.len() - n as usize;
    stack.drain(start..).reduce(join).expect("operators have operands")
}

impl Extent {
    /// The least extent that holds both.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        match (self, other) {
            (Self::None, extent) | (extent, Self::None) => extent,
            (Self::Whole, _) | (_, Self::Whole) => Self::Whole,
            (Self::Part(a), Self::Part(b)) => {
                Self::Part(Rectangle { low: a.low.min(b.low), high: a.high.max(b.high) })
            }
        }
    }

    /// What both share.
    #[must_use]
    pub fn overlap(self, other: Self) -> Self {
        match (self, other) {
            (Self::None, _) | (_, Self::None) => Self::None,
            (Self::Whole, extent) | (extent, Self::Whole) => extent,
            (Self::Part(a), Self::Part(b)) => {
                let (low, high) = (a.low.max(b.low), a.high.min(b.high));
                let shared = low.x <= high.x && low.y <= high.y;
                if shared { Self::Part(Rectangle { low, high }) } else { Self::None }
            }
        }
    }
}

impl Eye {
    /// The eye of a camera.
    #[must_use]
    pub fn new(camera: &Camera) -> Self {
        let view = camera.view(1, 1);
        let View { right, up, forward, parallel, .. } = view;
        Self { position: camera.position, right, up, forward, parallel }
    }

    /// Where a primitive can be seen; exact up to rounding, which widens it.
    #[must_use]
    #[allow(clippy::match_wildcard_for_single_variants, reason = "later rows have no closed form")]
    pub fn primitive(&self, kind: Primitive, map: &Map) -> Extent {
        let center = self.point(map.place);
        let [x, y, z] = [map.linear.x_axis, map.linear.y_axis, map.linear.z_axis]
            .map(|axis| self.direction(axis));
        let error = self.error(map, map.stretch());
        match kind {
            Primitive::Sphere => self.hull(&[Round { center, axes: &[x, y, z] }], error),
            Primitive::Cylinder => {
                let end = Round { center: center + x, axes: &[y, z] };
                self.hull(&[Round { center, axes: &[y, z] }, end], error)
            }
            Primitive::Cone => {
                let base = Round { center: center + x, axes: &[y, z] };
                self.hull(&[Round { center, axes: &[] }, base], error)
            }
            Primitive::Block => {
                let corners = Bounds::about(DVec3::ZERO, DVec3::ONE).corners();
                self.hull(&corners.map(|c| point(center + c.x * x + c.y * y + c.z * z)), error)
            }
            other => self.supported(map, error, |direction| other.support(direction)),
        }
    }

    /// Where a solid with arguments can be seen; exact up to rounding, which widens it.
    #[must_use]
    pub fn form(&self, form: &Form, map: &Map) -> Extent {
        let Bounds { low, high } = form.bounds(&Map::IDENTITY.linear, DVec3::ZERO);
        let reach = low.abs().max(high.abs()).max_element();
        let error = self.error(map, map.stretch() * reach);
        self.supported(map, error, |direction| form.support(direction))
    }

    /// Where a solid can be seen of which `support` tells the farthest point along a direction of its own space.
    ///
    /// The greatest slope side / ahead is sought from a point of the solid: that which lies farthest beyond the plane
    /// through the eye at this slope has a greater one, until there is none (Dinkelbach, "On Nonlinear Fractional
    /// Programming", 1967).
    fn supported(&self, map: &Map, error: f64, support: impl Fn(DVec3) -> DVec3) -> Extent {
        let camera = [self.right, self.up, self.forward];
        let rows = camera.map(|axis| apply_transposed(&map.linear, axis));
        let center = self.point(map.place);
        let farthest = |row: DVec3| {
            let size = row.abs().max_element();
            let local = support(if size > 0.0 { row / size } else { DVec3::ZERO });
            center + DVec3::from_array(rows.map(|row| row.dot(local)))
        };
        if farthest(rows[2]).z + error < 0.0 {
            return Extent::None;
        }
        if self.parallel {
            let side = |side: usize| (farthest(-rows[side])[side], farthest(rows[side])[side]);
            let (x, y) = (side(0), side(1));
            return padded(DVec2::new(x.0, y.0), DVec2::new(x.1, y.1), error);
        }
        let nearest = farthest(-rows[2]).z - error;
        if nearest.is_nan() || nearest <= 0.0 {
            return Extent::Whole;
        }
        let greatest = |side: usize, sign: f64| {
            let slope = |p: DVec3| sign * p[side] / p.z;
            let mut best = slope(farthest(sign * rows[side]));
            // Each step squares the share that is missing.
            for _ in 0..16 {
                let next = slope(farthest(sign * rows[side] - best * rows[2]));
                if next.is_nan() || next <= best {
                    break;
                }
                best = next;
            }
            sign * best
        };
        let low = DVec2::new(greatest(0, -1.0), greatest(1, -1.0));
        let high = DVec2::new(greatest(0, 1.0), greatest(1, 1.0));
        padded(low, high, error / nearest)
    }

    /// Where anything inside a box of the map's inner space can be seen.
    #[must_use]
    pub fn moved(&self, bounds: &Bounds, map: &Map) -> Extent {
        if bounds.is_empty() {
            return Extent::None;
        }
        let reach = bounds.low.abs().max(bounds.high.abs()).max_element();
        let corners = bounds.corners().map(|corner| point(self.point(map.outward(corner))));
        self.hull(&corners, self.error(map, map.stretch() * reach))
    }

    /// The extent of the convex hull of `rounds`, each up to `error` away from where it should be.
    fn hull(&self, rounds: &[Round<'_>], error: f64) -> Extent {
        if self.parallel { parallel_hull(rounds, error) } else { hull(rounds, error) }
    }

    fn direction(&self, v: DVec3) -> DVec3 {
        DVec3::new(self.right.dot(v), self.up.dot(v), self.forward.dot(v))
    }

    fn point(&self, p: DVec3) -> DVec3 {
        self.direction(p - self.position)
    }

    /// How far rounding moves a point of a solid that reaches `reach` about the map's place: each of some ten steps
    /// costs half a unit in the last place of the largest coordinate in play.
    fn error(&self, map: &Map, reach: f64) -> f64 {
        let size = map.magnitude + self.position.abs().max_element() + reach;
        16.0 * f64::EPSILON * size
    }
}

fn point(center: DVec3) -> Round<'static> {
    Round { center, axes: &[] }
}

/// [`hull`] where rays are parallel.
fn parallel_hull(rounds: &[Round<'_>], error: f64) -> Extent {
    let reach = |round: &Round<'_>| {
        let square = |sum: DVec3, axis: &DVec3| sum + *axis * *axis;
        let squares = round.axes.iter().fold(DVec3::ZERO, square);
        DVec3::new(squares.x.sqrt(), squares.y.sqrt(), squares.z.sqrt())
    };
    if rounds.iter().all(|round| round.center.z + reach(round).z + error < 0.0) {
        return Extent::None;
    }
    let side = |round: &Round<'_>| {
        let (low, high) = (round.center - reach(round), round.center + reach(round));
        padded(low.truncate(), high.truncate(), error)
    };
    rounds.iter().map(side).fold(Extent::None, Extent::hull)
}

/// The extent of the convex hull of `rounds`, each up to `error` away from where it should be.
fn hull(rounds: &[Round<'_>], error: f64) -> Extent {
    let (mut seen, mut behind) = (Extent::None, 0);
    for round in rounds {
        match round.extent(error) {
            Extent::None => behind += 1,
            Extent::Whole => return Extent::Whole,
            part @ Extent::Part(_) => seen = seen.hull(part),
        }
    }
    // Between a point ahead and one behind lies one beside the eye.
    if behind == 0 || behind == rounds.len() { seen } else { Extent::Whole }
}

/// The rectangle between two corners, each side seen `off` away from where it should be.
fn padded(low: DVec2, high: DVec2, off: f64) -> Extent {
    let pad = |value: DVec2| off * (1.0 + value.abs()) + 4.0 * f64::EPSILON * value.abs();
    let (low, high) = (low - pad(low), high + pad(high));
    if low.is_finite() && high.is_finite() {
        Extent::Part(Rectangle { low, high })
    } else {
        Extent::Whole
    }
}

impl Round<'_> {
    fn extent(&self, error: f64) -> Extent {
        let ahead = self.center.z;
        let reach = self.axes.iter().map(|axis| axis.z * axis.z).sum::<f64>().sqrt();
        if ahead + reach + error < 0.0 {
            return Extent::None;
        }
        let nearest = ahead - reach - error;
        if nearest.is_nan() || nearest <= 0.0 {
            return Extent::Whole;
        }
        let (x_low, x_high) = self.sides(|v| v.x);
        let (y_low, y_high) = self.sides(|v| v.y);
        // A point `nearest` ahead that is `error` off, sideways and in depth, is seen this much off.
        padded(DVec2::new(x_low, y_low), DVec2::new(x_high, y_high), error / nearest)
    }

    /// The two slopes u at which the plane `side = u · ahead` through the eye touches: roots of D u² − 2 B u + A, the
    /// dual conic of the outline.
    ///
    /// B² − A D is written as a difference of sums of squared minors (Lagrange's identity), so the square of the
    /// distance, which is common to both products, does not enter and a small solid far off keeps its size.
    fn sides(&self, side: impl Fn(DVec3) -> f64) -> (f64, f64) {
        // Slopes do not depend on the unit; with the greatest coordinate as unit, no product overflows.
        let unit = self.axes.iter().fold(self.center.abs(), |size, axis| size.max(axis.abs()));
        let unit = unit.max_element();
        let scaled = |v: DVec3| (side(v) / unit, v.z / unit);
        let (c, ahead) = scaled(self.center);
        let (mut b, mut reach, mut minors) = (c * ahead, 0.0, 0.0);
        if self.axes.is_empty() {
            let slope = b / (ahead * ahead);
            return (slope, slope);
        }
        for (i, axis) in self.axes.iter().enumerate() {
            let (a, d) = scaled(*axis);
            b -= a * d;
            reach += d * d;
            let minor = c * d - ahead * a;
            minors += minor * minor;
            for other in &self.axes[..i] {
                let (e, f) = scaled(*other);
                let minor = a * f - e * d;
                minors -= minor * minor;
            }
        }
        let reach = reach.sqrt();
        let d = (ahead - reach) * (ahead + reach);
        let root = if minors > 0.0 { minors.sqrt() } else { 0.0 };
        ((b - root) / d, (b + root) / d)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csg::{Frame, FrameId};
    use crate::transform::Placement;
    use crate::{AttributesId, ClassId};

    const STRAIGHT: Camera = Camera {
        position: DVec3::ZERO,
        target: DVec3::new(0.0, 0.0, -1.0),
        focal_length_mm: 50.0,
        parallel: false,
    };

    fn placed() -> Placement {
        Placement {
            scale: DVec3::new(2.0, 1.0, 0.5),
            rotation_degrees: DVec3::new(20.0, 30.0, 10.0),
            place: DVec3::new(1.0, 0.5, -6.0),
        }
    }

    fn part(extent: Extent) -> Rectangle {
        match extent {
            Extent::Part(rectangle) => rectangle,
            Extent::None | Extent::Whole => panic!("{extent:?}"),
        }
    }

    fn assert_near(found: Rectangle, expected: [f64; 4], tolerance: f64) {
        let found = [found.low.x, found.high.x, found.low.y, found.high.y];
        for (f, e) in found.iter().zip(expected) {
            assert!((f - e).abs() <= tolerance, "{found:?} instead of {expected:?}");
        }
    }

    /// The slopes of points all over the surface: a rectangle found the slow way.
    fn sampled(kind: Primitive, map: &Map) -> Rectangle {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let steps = 400;
        for i in 0..=steps {
            for j in 0..=steps {
                let s = f64::from(i) / f64::from(steps) * std::f64::consts::TAU;
                let t = f64::from(j) / f64::from(steps);
                let (sine, cosine) = (libm::sin(s), libm::cos(s));
                let local = match kind {
                    Primitive::Sphere => {
                        let r = libm::sin(t * std::f64::consts::PI);
                        DVec3::new(libm::cos(t * std::f64::consts::PI), r * cosine, r * sine)
                    }
                    Primitive::Cylinder => DVec3::new(t, cosine, sine),
                    Primitive::Cone => DVec3::new(t, t * cosine, t * sine),
                    Primitive::Paraboloid => DVec3::new(t * t, t * cosine, t * sine),
                    Primitive::Block => {
                        let sign = |n: i32| if n % 2 == 0 { -1.0 } else { 1.0 };
                        DVec3::new(sign(i), sign(i / 2), sign(j))
                    }
                };
                let p = map.outward(local);
                let seen = DVec2::new(p.x / -p.z, p.y / -p.z);
                (low, high) = (low.min(seen), high.max(seen));
            }
        }
        Rectangle { low, high }
    }

    #[test]
    fn the_vectors_of_the_reference() {
        let eye = Eye::new(&STRAIGHT);
        let map = placed().map();
        let sphere = part(eye.primitive(Primitive::Sphere, &map));
        assert_near(sphere, [-0.143_436_97, 0.396_815_54, -0.086_674_89, 0.255_335_94], 5e-9);
        // The base disc, with the apex at (1/6, 1/12), which is left of it.
        let cone = part(eye.primitive(Primitive::Cone, &map));
        assert_near(cone, [0.166_666_67, 0.453_218_03, -0.022_498_81, 0.261_954_90], 5e-9);
    }

    #[test]
    fn every_solid_agrees_with_points_of_its_surface() {
        let eye = Eye::new(&STRAIGHT);
        for kind in Primitive::ALL {
            for turn in 0..12 {
                let mut placement = placed();
                placement.rotation_degrees.y += 30.0 * f64::from(turn);
                let map = placement.map();
                let exact = part(eye.primitive(*kind, &map));
                let slow = sampled(*kind, &map);
                let inside = slow.low.cmpge(exact.low).all() && slow.high.cmple(exact.high).all();
                assert!(inside, "{kind:?} is covered: {exact:?} {slow:?}");
                let [l, h] = [slow.low, slow.high];
                assert_near(exact, [l.x, h.x, l.y, h.y], 2e-4);
            }
        }
    }

    #[test]
    fn a_small_solid_far_off_keeps_its_size() {
        let eye = Eye::new(&STRAIGHT);
        for decade in 0..9 {
            let distance = libm::exp10(f64::from(decade));
            let place = DVec3::new(0.0, 0.0, -3.0 * distance);
            let map = Placement { place, ..Placement::default() }.map();
            let rectangle = part(eye.primitive(Primitive::Sphere, &map));
            // The tangent of a sphere's half angle is r / √(d² − r²).
            let half = 1.0 / ((3.0 * distance - 1.0) * (3.0 * distance + 1.0)).sqrt();
            let slack = 1e-15 * (1.0 + half);
            assert!(
                rectangle.high.x >= half && rectangle.high.x <= half + 20.0 * slack,
                "{decade}"
            );
            assert!(
                rectangle.low.y <= -half && rectangle.low.y >= -half - 20.0 * slack,
                "{decade}"
            );
        }
    }

    #[test]
    fn slopes_do_not_depend_on_the_unit() {
        let eye = Eye::new(&STRAIGHT);
        let expected = part(eye.primitive(Primitive::Sphere, &placed().map()));
        for unit in [1e-100, 1e-12, 1e12, 1e100] {
            let mut placement = placed();
            placement.scale *= unit;
            placement.place *= unit;
            let e = expected;
            let found = part(eye.primitive(Primitive::Sphere, &placement.map()));
            assert_near(found, [e.low.x, e.high.x, e.low.y, e.high.y], 1e-14);
        }
    }

    #[test]
    fn around_and_behind_the_eye() {
        let eye = Eye::new(&STRAIGHT);
        let at = |kind, z| {
            let place = DVec3::new(0.0, 0.0, z);
            eye.primitive(kind, &Placement { place, ..Placement::default() }.map())
        };
        for kind in Primitive::ALL {
            assert_eq!(at(*kind, 0.5), Extent::Whole, "{kind:?} about the eye");
            assert_eq!(at(*kind, 3.0), Extent::None, "{kind:?} behind it");
            assert_eq!(at(*kind, f64::NAN), Extent::Whole, "{kind:?} nowhere");
        }
        assert_eq!(at(Primitive::Block, -1.0), Extent::Whole, "in the plane of the eye");
        assert_eq!(at(Primitive::Block, 1.0), Extent::Whole, "in it from behind");
    }

    fn two(operator: &[Node], other: DVec3) -> Scene {
        let frame = |place| Frame {
            parent: None,
            placement: Placement { place, ..Placement::default() },
            attributes: AttributesId::NONE,
        };
        let leaf = |frame| Node::Primitive { kind: Primitive::Sphere, frame: FrameId(frame) };
        let mut nodes = vec![leaf(0), leaf(1)];
        nodes.extend_from_slice(operator);
        let frames = vec![frame(DVec3::new(0.0, 0.0, -5.0)), frame(other)];
        let mut scene = Scene { camera: Some(STRAIGHT), ..Scene::default() };
        scene.add_object(None, Solid { frames, nodes, ..Solid::default() });
        scene
    }

    #[test]
    fn operators_join_extents() {
        let of = |operator: &[Node], other| two(operator, other).rectangles().unwrap()[0];
        let beside = DVec3::new(1.0, 0.0, -5.0);
        let half = 1.0 / 24.0_f64.sqrt();
        let union = part(of(&[Node::Union(2)], beside));
        assert!((union.low.x + half).abs() < 1e-14 && union.high.x > 0.4, "{union:?}");
        let common = part(of(&[Node::Intersection(2)], beside));
        assert!((common.high.x - half).abs() < 1e-14 && common.low.x > -0.1, "{common:?}");
        let cut = [Node::Complement, Node::Intersection(2)];
        let rest = part(of(&cut, beside));
        assert!(
            (rest.low.x + half).abs() < 1e-14 && (rest.high.x - half).abs() < 1e-14,
            "{rest:?}"
        );
        assert_eq!(of(&[Node::Intersection(2)], DVec3::new(9.0, 0.0, -5.0)), Extent::None, "apart");
        assert_eq!(of(&[Node::Union(2)], DVec3::ZERO), Extent::Whole, "one about the eye");
        assert_eq!(of(&[Node::Union(2)], DVec3::Z * 5.0), of(&cut, beside), "one behind it");
    }

    #[test]
    fn an_instance_is_seen_within_its_box() {
        let mut scene = two(&[Node::Union(2)], DVec3::new(2.0, 0.0, -5.0));
        let solid = scene.objects[0].solid.clone();
        let class = scene.add_class("pair".to_owned(), solid);
        let frames = vec![Frame {
            parent: None,
            placement: Placement::default(),
            attributes: AttributesId::NONE,
        }];
        let nodes = vec![Node::Instance { class, frame: FrameId(0) }];
        scene.add_object(None, Solid { frames, nodes, ..Solid::default() });
        assert_eq!(class, ClassId(0), "the first");
        let seen = scene.rectangles().unwrap();
        let (exact, boxed) = (part(seen[0]), part(seen[1]));
        assert!(boxed.low.cmple(exact.low).all() && boxed.high.cmpge(exact.high).all(), "covers");
        // The front corners of the box: x from −1 to 3, 4 units ahead.
        assert_near(boxed, [-0.25, 0.75, -0.25, 0.25], 1e-13);
        scene.camera = None;
        assert!(scene.rectangles().is_none(), "no camera, no picture");
    }
}
