//! What the log and `--stats` say of a render.

use crate::{Certificates, Options, RayStats, World};

/// Names and JSON numbers.
pub(crate) type Figures = Vec<(&'static str, String)>;

/// What is known of a picture, or of a part of one, when it is done.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Done {
    pub(crate) stats: RayStats,
    /// In a pixel.
    pub(crate) samples: f64,
    /// In display steps, where it is known.
    pub(crate) error: Option<f64>,
    /// Bounds of the light that is cut by depth and by weight.
    pub(crate) cut: [f64; 2],
    pub(crate) certificates: Option<Certificates>,
    /// To trace.
    pub(crate) seconds: f64,
}

impl Done {
    pub(crate) fn figures(&self, options: &Options, world: &World) -> Figures {
        let Self { stats, samples, error, cut: [depth, weight], certificates, seconds } = self;
        let bound = |bound: f64| format!("{bound:.3e}");
        let mut figures = vec![
            ("columns", options.columns.to_string()),
            ("rows", options.rows.to_string()),
            ("samples", shortest(*samples)),
            ("primitives", world.leaf_count().to_string()),
            ("rays", stats.rays().to_string()),
            ("primary", stats.primary.to_string()),
            ("secondary", stats.secondary.to_string()),
            ("shadow", stats.shadow.to_string()),
            ("cut_by_depth", stats.cut_by_depth.to_string()),
            ("cut_by_weight", stats.cut_by_weight.to_string()),
            ("depth_cut_bound", bound(*depth)),
            ("weight_cut_bound", bound(*weight)),
        ];
        if let Some(error) = error {
            figures.push(("estimated_error", format!("{error:.4}")));
            // Rounding to 8 bits adds a step's variance.
            let rounded = (error * error + 1.0 / 12.0).sqrt();
            figures.push(("estimated_error_in_8_bits", format!("{rounded:.4}")));
        }
        if let Some(Certificates { certain, undecided, bound, given_up, seconds }) = certificates {
            figures.push(("certain_share", format!("{certain:.5}")));
            figures.push(("undecided_share", format!("{undecided:.5}")));
            figures.push(("undecided_bound", format!("{bound:.4}")));
            figures.push(("tiles_given_up_share", format!("{given_up:.5}")));
            figures.push(("certify_seconds", format!("{seconds:.4}")));
        }
        figures.push(("trace_seconds", format!("{seconds:.4}")));
        figures
    }
}

/// A number in at most three decimals.
fn shortest(number: f64) -> String {
    let text = format!("{number:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
