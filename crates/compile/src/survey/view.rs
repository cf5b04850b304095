//! Objects that the picture does not show, whatever its shape.

use glam::DVec3;
use scene::rectangle::{Extent, Eye};
use scene::{Bounds, Camera, Light, LightKind, Optics, Scene};

/// The longer side of the frame of a picture is 36 mm; twice as much is left for what is out of focus.
const HALF_SIDES_MM: f64 = 2.0 * 18.0;

/// The objects that are out of view for certain, and neither mirrored, looked at through a body, nor between what is
/// seen and a light. `bounds` are the boxes of the objects, `classes` those of the classes.
pub(super) fn unseen(scene: &Scene, bounds: &[Bounds], classes: &[Bounds]) -> Vec<usize> {
    let Some(camera) = scene.camera.filter(|_| !bends_light(scene)) else { return Vec::new() };
    let eye = Eye::new(&camera);
    let reach = HALF_SIDES_MM / camera.focal_length_mm * side(&camera);
    let mut seen = Bounds::EMPTY;
    let mut unseen = Vec::new();
    for (number, (object, own)) in scene.objects.iter().zip(bounds).enumerate() {
        if own.is_empty() {
            continue;
        }
        if shows(&camera, reach, 0.5 * (own.low + own.high)) {
            seen = seen.hull(*own);
            continue;
        }
        let extent = object.solid.extent(&object.solid.maps(), classes, &eye);
        if is_beside(&extent, reach) {
            unseen.push(number);
        } else {
            seen = seen.hull(*own);
        }
    }
    let lit: Vec<Bounds> = scene
        .lights
        .iter()
        .filter(|light| light.shadows)
        .map(|light| toward(light, seen))
        .collect();
    unseen.retain(|&object| lit.iter().all(|lit| lit.overlap(bounds[object]).is_empty()));
    unseen
}

/// True if the point is well in view; most objects are told by this alone.
fn shows(camera: &Camera, reach: f64, point: DVec3) -> bool {
    let forward = scene::transform::unit(camera.target - camera.position);
    let way = point - camera.position;
    let ahead = way.dot(forward);
    let aside = (way - ahead * forward).length();
    ahead > 0.0 && aside < reach * if camera.parallel { 1.0 } else { ahead }
}

/// What is one wide in the picture at a focal length of one: at distance 1, or where rays are parallel at the target.
fn side(camera: &Camera) -> f64 {
    if camera.parallel { (camera.target - camera.position).length() } else { 1.0 }
}

fn is_beside(extent: &Extent, reach: f64) -> bool {
    match extent {
        Extent::None => true,
        Extent::Whole => false,
        Extent::Part(part) => {
            part.low.x > reach || part.high.x < -reach || part.low.y > reach || part.high.y < -reach
        }
    }
}

/// True if some surface may show what is not in front of the camera.
fn bends_light(scene: &Scene) -> bool {
    let mirror = |x: &Option<f64>| x.is_some_and(|slope| slope <= 0.0);
    let default = Optics::DEFAULT.smoothness <= 0.0;
    let sets = &scene.attributes;
    default || sets.iter().any(|set| mirror(&set.smoothness) || set.transparency.is_some())
}

/// A box about every way from a box to a light.
fn toward(light: &Light, seen: Bounds) -> Bounds {
    match light.kind {
        LightKind::Point { at, .. } | LightKind::Spot { at, .. } => {
            seen.hull(Bounds { low: at, high: at })
        }
        LightKind::Beam { at, toward, .. } => {
            let back = at - toward;
            let far = |sign: f64| {
                DVec3::from_array(
                    back.to_array()
                        .map(|x| if sign * x > 0.0 { sign * f64::INFINITY } else { 0.0 }),
                )
            };
            Bounds { low: seen.low + far(-1.0), high: seen.high + far(1.0) }
        }
    }
}
