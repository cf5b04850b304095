//! Warnings where double precision runs out: solids too small for the place they stand at.

use scene::{Bounds, Map, Node, Scene, Solid};

use crate::diagnostic::Diagnostic;
use crate::number_text;
use crate::shared::Shared;

/// Surfaces are known to this share of the largest number that went into their place (`ROUNDING` of the renderer).
const ROUNDING: f64 = 64.0 * 0.5 * f64::EPSILON;

/// Normals of a solid of fewer rounding bounds than this are off by more than half a display step is worth.
const SHOWN: f64 = 512.0;

/// Adds a warning for each object with a solid that its coordinates cannot hold, or hold so badly that it shows.
pub(crate) fn warn(shared: &mut Shared) {
    let scene = &shared.scene;
    let mut classes = Vec::with_capacity(scene.classes.len());
    for class in &scene.classes {
        let boxes = class.solid.node_bounds(&class.solid.maps(), &classes);
        classes.push(boxes.last().copied().unwrap_or(Bounds::EMPTY));
    }
    let eye = scene.camera.map_or(0.0, |camera| camera.position.abs().max_element());
    let mut found = Vec::new();
    for (object, &span) in scene.objects.iter().zip(&shared.object_spans) {
        let Some(worst) = worst(scene, &object.solid, &classes, eye) else { continue };
        let size = number_text(2.0 * worst.half_extent);
        let step = number_text(worst.rounding);
        let message = if worst.half_extent < worst.rounding {
            format!("a solid {size} wide is too small for its place, which is known to {step} only")
        } else if worst.is_vast {
            format!(
                "a solid {size} wide is known to {step} only: what is seen beside it will be wrong"
            )
        } else {
            format!(
                "a solid {size} wide stands where places are known to {step} only: it will look rough"
            )
        };
        let hint = if worst.is_vast {
            "make it smaller, or what is seen larger"
        } else {
            "move the scene, camera included, toward the origin"
        };
        found.push(Diagnostic::warning(span, message).hint(hint.to_owned()));
    }
    for warning in found {
        shared.diagnostics.push(warning);
    }
}

/// A solid and how well its place is known.
struct Placed {
    half_extent: f64,
    rounding: f64,
    /// Its own size leaves too little to what is looked at.
    is_vast: bool,
}

/// The solid, or class, of an object that is least of its rounding bound, if it is less than shows.
fn worst(scene: &Scene, solid: &Solid, classes: &[Bounds], eye: f64) -> Option<Placed> {
    let maps = solid.maps();
    let mut worst: Option<Placed> = None;
    let view = scene
        .camera
        .map_or(f64::INFINITY, |camera| (camera.target - camera.position).abs().max_element());
    for node in &solid.nodes {
        let (map, bounds): (&Map, Bounds) = match *node {
            Node::Primitive { kind, frame } => {
                let map = &maps[frame.0 as usize];
                (map, kind.bounds(&map.linear, map.place))
            }
            Node::Form { form, frame } => {
                let map = &maps[frame.0 as usize];
                (map, solid.form(form).bounds(&map.linear, map.place))
            }
            Node::Instance { class, frame } => {
                let map = &maps[frame.0 as usize];
                (map, scene::bound::moved(classes[class.0 as usize], map))
            }
            _ => continue,
        };
        let half_extent = bounds.half_extent();
        // The eye becomes the origin: its own coordinates enter every place. What is empty is warned of elsewhere.
        let distance =
            scene.camera.map_or(0.0, |camera| (map.place - camera.position).abs().max_element());
        let rounding = ROUNDING * (map.magnitude.max(eye).max(distance) + half_extent);
        let less = |other: &Placed| half_extent * other.rounding < other.half_extent * rounding;
        let is_vast = view < SHOWN * rounding && half_extent >= SHOWN * rounding;
        let is_small = half_extent < SHOWN * rounding;
        if half_extent > 0.0 && (is_small || is_vast) && worst.as_ref().is_none_or(less) {
            worst = Some(Placed { half_extent, rounding, is_vast });
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    /// What is said of a ball of a size at a place, seen from ten sizes away.
    fn said(size: f64, place: f64) -> String {
        let text = format!(
            "object is sphere scale {size} at ({place}, 0, 0)\nlight beam toward (0, -1, 0)\n\
             camera at ({place}, 0, {}) target at ({place}, 0, 0)",
            10.0 * size
        );
        crate::compile_text(&text).report()
    }

    #[test]
    fn solids_too_large_for_what_is_seen_are_named() {
        // 2⁻⁴⁷ of 1e13 is 0.07: a hundredth of the distance that is looked at.
        for (width, expected) in [(1e9, ""), (1e11, ""), (1e13, "beside it will be wrong")] {
            let text = format!(
                "object is block scale ({width}, 1, {width}) at (0, -1, 0)\nobject is sphere at (0, 1, 0)\n\
                 light point at (3, 5, 4)\ncamera at (0, 2, 7) target at (0, 0, 0)"
            );
            let report = crate::compile_text(&text).report();
            assert!(report.contains(expected), "{width}: {report}");
            assert_eq!(report.is_empty(), expected.is_empty(), "{width}: {report}");
        }
    }

    #[test]
    fn solids_too_small_for_their_place_are_named() {
        // 2⁻⁴⁷ of a million is 7.1·10⁻⁹: a two-thousandth of what is a hundred-thousandth in size.
        for (size, place, expected) in [
            (1.0, 0.0, ""),
            (1e-30, 0.0, ""),
            (1e-5, 1e6, ""),
            (3e-6, 1e6, "it will look rough"),
            (1e-8, 1e6, "it will look rough"),
            (5e-9, 1e6, "too small for its place"),
            (1.0, 1e12, "it will look rough"),
            (1.0, 1e11, ""),
        ] {
            let report = said(size, place);
            assert!(report.contains(expected), "{size} at {place}: {report}");
            assert_eq!(report.is_empty(), expected.is_empty(), "{size} at {place}: {report}");
        }
    }
}
