//! The bar of pixels on a terminal.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use idf::command::Talk;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::RenderError;

/// Pictures that take less than this need no progress bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// Does some work on so many pixels; it tells how many are done.
pub(crate) fn with_progress<T>(
    total: u64,
    talk: Talk,
    work: impl FnOnce(&(dyn Fn(u64) + Sync)) -> Result<T, RenderError>,
) -> Result<T, RenderError> {
    let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} % {elapsed} left {eta}")
    {
        bar.set_style(style);
    }
    let (done, start) = (AtomicU64::new(0), Instant::now());
    let made = work(&|pixels| {
        let done = done.fetch_add(pixels, Ordering::Relaxed) + pixels;
        if start.elapsed() > PATIENCE && !talk.is_quiet() {
            if bar.is_hidden() {
                // Draws nothing unless standard error is a terminal.
                bar.set_draw_target(ProgressDrawTarget::stderr());
            }
            bar.set_position(done);
        }
    });
    bar.finish_and_clear();
    made
}
