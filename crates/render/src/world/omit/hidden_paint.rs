//! Paint on what is so clear that its colour does not show.

use scene::Optics;
use scene::texture::Weight;

use super::{Ledger, Pass};
use crate::world::{Leaf, PaintFrame, PaintId};

pub(super) static PASS: Pass = Pass {
    name: "hidden paint",
    what: "painted primitives",
    reason: "all light goes through them, so no paint on them shows",
};

/// Takes paint off leaves where it does not show. With instances about, what is said on a leaf hides what they say, so it
/// stays; so it does where an opaque body may be cut by a clear one, whose looks its face then has.
pub(in crate::world) fn hide_paint(
    ledger: &mut Ledger,
    leaves: &mut [Leaf],
    surfaces: &[Optics],
    paints: &[PaintFrame],
    is_kept: bool,
) {
    let shows = |leaf: &Leaf, paint: PaintId| {
        let optics = &surfaces[leaf.surface as usize];
        let coats = &paints[paint.index()].coats;
        let relief = |weight: &Weight| matches!(weight, Weight::Relief);
        is_kept
            || optics.transparency.is_none()
            || optics.shininess < 1.0
            || coats.iter().any(|coat| relief(&coat.texture.function().weight))
    };
    let (mut seen, mut taken) = (0, 0);
    for leaf in leaves {
        let Some(paint) = leaf.paint else { continue };
        seen += 1;
        if !shows(leaf, paint) {
            taken += 1;
            if !ledger.keeps(&PASS) {
                leaf.paint = None;
            }
        }
    }
    ledger.note(&PASS, seen, taken);
}
