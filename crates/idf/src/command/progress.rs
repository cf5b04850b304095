//! The progress bar of all programs: on a terminal, for work that takes longer than a second.

use std::borrow::Cow;
use std::sync::Mutex;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::Talk;

/// Work that takes less than this needs no bar.
const PATIENCE: Duration = Duration::from_secs(1);
/// How often the time is drawn anew.
const TICK: Duration = Duration::from_millis(200);

/// The bar that is on the terminal, so that messages go beside it.
static SHOWN: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// How far a work is, on standard error. It is cleared when this value goes.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    timer: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Talk {
    /// Starts the bar of a work of `total` parts, of rows, pictures or pixels: it is seen from a
    /// second on, where standard error is a terminal, and not with `-q`.
    pub fn progress(self, total: u64) -> Progress {
        let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
        if !self.is_quiet() {
            if let Ok(style) =
                ProgressStyle::with_template("{bar:40} {percent:>3} % {elapsed} {msg}")
            {
                bar.set_style(style);
            }
            // Draws nothing unless standard error is a terminal.
            return Progress::shown_after(PATIENCE, bar, ProgressDrawTarget::stderr());
        }
        Progress { bar, timer: None }
    }
}

impl Progress {
    fn shown_after(patience: Duration, bar: ProgressBar, target: ProgressDrawTarget) -> Self {
        let (end, ended) = channel();
        let later = bar.clone();
        let show = move || {
            if let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(patience) {
                later.set_draw_target(target);
                later.tick();
                later.enable_steady_tick(TICK);
                set_shown(Some(later));
            }
        };
        // Without a thread there is no bar, and the work goes on.
        let thread = thread::Builder::new().name("progress".into()).spawn(show);
        Self { bar, timer: thread.ok().map(|thread| (end, thread)) }
    }

    /// Adds to the parts that are done; any thread may.
    pub fn advance(&self, parts: u64) {
        self.bar.inc(parts);
    }

    /// Names what is done now.
    pub fn stage(&self, name: impl Into<Cow<'static, str>>) {
        self.bar.set_message(name);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some((end, thread)) = self.timer.take() {
            drop(end);
            // It ends at once; a bar that could not be drawn is no failure of the work.
            thread.join().ok();
            set_shown(None);
        }
        self.bar.finish_and_clear();
    }
}

fn set_shown(bar: Option<ProgressBar>) {
    if let Ok(mut shown) = SHOWN.lock() {
        *shown = bar;
    }
}

/// Writes a message with the bar, if there is one, out of the way.
pub(super) fn aside(message: impl FnOnce()) {
    let bar = SHOWN.lock().ok().and_then(|shown| shown.clone());
    match bar {
        Some(bar) => bar.suspend(message),
        None => message(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;
    use std::sync::Arc;

    use indicatif::TermLike;

    /// A terminal that keeps what it gets.
    #[derive(Clone, Debug, Default)]
    struct Screen(Arc<Mutex<String>>);

    impl Screen {
        fn text(&self) -> String {
            self.0.lock().unwrap().clone()
        }

        fn put(&self, text: &str) -> io::Result<()> {
            self.0.lock().unwrap().push_str(text);
            Ok(())
        }
    }

    impl TermLike for Screen {
        fn width(&self) -> u16 {
            80
        }

        fn move_cursor_up(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_down(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_right(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_left(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn write_line(&self, line: &str) -> io::Result<()> {
            self.put(&format!("{line}\n"))
        }

        fn write_str(&self, text: &str) -> io::Result<()> {
            self.put(text)
        }

        fn clear_line(&self) -> io::Result<()> {
            self.put("<clear>")
        }

        fn flush(&self) -> io::Result<()> {
            Ok(())
        }
    }

    /// A bar of 4 parts, of which one is done.
    fn progress(patience: Duration, screen: &Screen) -> Progress {
        let bar = ProgressBar::with_draw_target(Some(4), ProgressDrawTarget::hidden());
        bar.set_style(ProgressStyle::with_template("{percent} % {msg}").unwrap());
        bar.inc(1);
        bar.set_message("reads");
        let target = ProgressDrawTarget::term_like(Box::new(screen.clone()));
        Progress::shown_after(patience, bar, target)
    }

    #[test]
    fn short_work_has_no_bar() {
        let screen = Screen::default();
        let progress = progress(Duration::from_secs(3600), &screen);
        progress.stage("reads");
        progress.advance(3);
        drop(progress);
        assert_eq!(screen.text(), "");
    }

    #[test]
    fn long_work_shows_how_far_it_is_and_leaves_nothing() {
        let screen = Screen::default();
        let mut progress = progress(Duration::ZERO, &screen);
        // The second is over when the thread ends.
        let (_end, thread) = progress.timer.take().unwrap();
        thread.join().unwrap();
        assert!(screen.text().contains("25 % reads"), "{}", screen.text());
        aside(|| screen.put("a message").unwrap());
        drop(progress);
        set_shown(None);
        assert!(screen.text().contains("<clear>"), "{}", screen.text());
        let left = screen.text();
        assert!(!left.rsplit("<clear>").next().unwrap_or_default().contains('%'), "{left:?}");
    }
}
