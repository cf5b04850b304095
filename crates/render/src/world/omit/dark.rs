//! Lights that light nothing.

use scene::{Bounds, LightKind};

use super::{Ledger, Pass};
use crate::world::{LoadedLight, Node};

pub(super) static PASS: Pass = Pass {
    name: "dark",
    what: "lights",
    reason: "they have no strength, or no solid stands in their cone",
};

/// Which lights can be left out where nothing stands but `solids`.
pub(in crate::world) fn dark_lights(
    ledger: &mut Ledger,
    lights: &[LoadedLight],
    solids: &[&Node],
) -> Vec<bool> {
    let dark = |light: &LoadedLight| {
        light.color.max_element() <= 0.0
            || solids.iter().all(|solid| misses(light, &solid.bounds()))
    };
    let mut found: Vec<bool> = lights.iter().map(dark).collect();
    ledger.note(&PASS, found.len(), found.iter().filter(|&&dark| dark).count());
    if ledger.keeps(&PASS) {
        found.fill(false);
    }
    found
}

/// True if the ball about a box lies outside the cone of a light, with something to spare for rounding.
fn misses(light: &LoadedLight, bounds: &Bounds) -> bool {
    const SLACK: f64 = 1e-6;
    let LightKind::Spot { at, half_angle_degrees, .. } = light.kind else { return false };
    if light.radius > 0.0 {
        return false;
    }
    let away = 0.5 * bounds.low + 0.5 * bounds.high - at;
    let (distance, radius) = (away.length(), 0.5 * (bounds.high - bounds.low).length());
    // Not so for numbers out of range either.
    if !(radius < distance && distance.is_finite()) {
        return false;
    }
    let off_axis = libm::acos((away.dot(light.axis) / distance).clamp(-1.0, 1.0));
    off_axis - libm::asin(radius / distance) > half_angle_degrees.to_radians() + SLACK
}
