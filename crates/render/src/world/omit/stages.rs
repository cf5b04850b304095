//! Stages of the work on a tile that a scene gives nothing to do.

use super::{Ledger, Pass};

pub(super) static FOG: Pass =
    Pass { name: "fog", what: "stage of the tile", reason: "the scene has no fog" };
pub(super) static PAINT: Pass =
    Pass { name: "paint", what: "stage of the tile", reason: "nothing that shows is painted" };

/// The fog of the scene; fog that never takes anything where the stage is kept for nothing.
pub(in crate::world) fn fog_half_distance(ledger: &mut Ledger, fog: Option<f64>) -> Option<f64> {
    ledger.note(&FOG, 1, usize::from(fog.is_none()));
    fog.or(ledger.keeps(&FOG).then_some(f64::INFINITY))
}

/// Whether paint is looked for where rays end.
pub(in crate::world) fn paints_are_looked_up(ledger: &mut Ledger, is_painted: bool) -> bool {
    ledger.note(&PAINT, 1, usize::from(!is_painted));
    is_painted || ledger.keeps(&PAINT)
}
