//! What a scene does not need is left out when it is loaded: one pass a file, one row a pass.
//!
//! A pass counts as one only if every ray that is left finds the same numbers without what it takes away: rounding
//! bounds, ranks, numbers of leaves and objects stay those of the source, and boxes have to lie apart by more than any
//! rounding bound near them, not only not to touch. So the picture is the same to the byte with and without all of them.

mod apart;
#[cfg(feature = "command")]
pub(crate) mod command;
mod dark;
mod empty;
mod hidden_paint;
mod inside;
mod left;
mod outside;
mod repeated;
mod stages;
mod unreached;
mod unstopped;

pub(super) use apart::is_apart;
pub(super) use dark::dark_lights;
pub(super) use empty::is_empty;
pub(super) use hidden_paint::hide_paint;
pub(super) use inside::leave_out_what_is_inside;
pub(super) use outside::outside_terms;
pub(super) use repeated::{Twins, coinciding};
pub(super) use stages::{fog_half_distance, paints_are_looked_up};
pub(super) use unreached::{leave_out_what_is_unreached, sends_rays_elsewhere};
pub(super) use unstopped::stop_shadows;

use scene::Bounds;

use super::ROUNDING;

/// What a scene is loaded for, and what is left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoadOptions {
    /// Nothing is left out.
    pub keep_all: bool,
    /// The pass of this name alone leaves nothing out: so it is measured what it brings.
    pub keep_pass: Option<&'static str>,
    /// Columns and rows of the one picture that the scene is loaded for: what no ray of it can reach is left out, too.
    pub picture: Option<(u32, u32)>,
    /// Rough surfaces of some shininess mirror what is around them, each ray by a facet of its own that is drawn by lot, in place
    /// of ambient light. One sample a pixel shows them as mirrors.
    pub glossy: bool,
}

/// What one pass did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Omission {
    /// The pass.
    pub name: &'static str,
    /// What it looks at.
    pub what: &'static str,
    /// Why it may go.
    pub reason: &'static str,
    /// How many there are.
    pub before: u64,
    /// How many are left.
    pub after: u64,
}

/// A row of the table.
#[derive(Debug)]
pub(super) struct Pass {
    name: &'static str,
    what: &'static str,
    reason: &'static str,
}

/// All passes. A new one is a new file and a new row.
static PASSES: [&Pass; 11] = [
    &empty::PASS,
    &apart::PASS,
    &outside::PASS,
    &repeated::PASS,
    &inside::PASS,
    &unreached::PASS,
    &dark::PASS,
    &unstopped::PASS,
    &hidden_paint::PASS,
    &stages::FOG,
    &stages::PAINT,
];

/// Counts of what the passes saw and took away.
#[derive(Debug, Default)]
pub(super) struct Ledger {
    keep_all: bool,
    keep_pass: Option<&'static str>,
    /// Seen and taken away, by row.
    counts: [(u64, u64); PASSES.len()],
}

impl Ledger {
    pub(super) fn new(options: &LoadOptions) -> Self {
        let LoadOptions { keep_all, keep_pass, .. } = *options;
        Self { keep_all, keep_pass, ..Self::default() }
    }

    /// True if a pass only counts what it could take away.
    fn keeps(&self, pass: &Pass) -> bool {
        self.keep_all || self.keep_pass == Some(pass.name)
    }

    /// Adds what a pass saw and took away.
    fn note(&mut self, pass: &'static Pass, seen: usize, taken: usize) {
        let row = PASSES.iter().position(|row| std::ptr::eq(*row, pass));
        let count = &mut self.counts[row.expect("every pass has a row")];
        count.0 += seen as u64;
        count.1 += taken as u64;
    }

    pub(super) fn omissions(&self) -> Vec<Omission> {
        let row = |(pass, &(seen, taken)): (&&Pass, &(u64, u64))| {
            let Pass { name, what, reason } = **pass;
            Omission { name, what, reason, before: seen, after: seen - taken }
        };
        PASSES.iter().zip(&self.counts).map(row).collect()
    }
}

/// A gap between boxes that rounding cannot close: points on one are asked for up to a rounding bound off, and the
/// bound of another surface matters up to twice its own away.
fn gap(a: f64, b: f64) -> f64 {
    4.0 * ROUNDING * if a > b { a } else { b }
}

/// True if boxes lie further apart than `gap` along some axis.
fn parted(a: &Bounds, b: &Bounds, gap: f64) -> bool {
    (a.low - b.high).max_element() > gap || (b.low - a.high).max_element() > gap
}
