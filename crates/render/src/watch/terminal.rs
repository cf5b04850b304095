//! Pictures in the terminal, by the program `ishow`.
//!
//! It is asked as a program: the tools are on the other side of the image that they read. While it asks the terminal what it
//! can, what is typed is not shown; so a signal that ends this program waits until it has put the terminal back.

use std::env;
use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use idf::exchange::write_stream;
use idf::{Image, Kind, Plane, Samples};
use live::{Board, Shot, Stage};
use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
use signal_hook::{flag, low_level};

/// The program, where the system looks for programs or else beside this one.
pub(super) fn program() -> Result<PathBuf, String> {
    let name = format!("ishow{}", env::consts::EXE_SUFFIX);
    let own = env::current_exe().ok().map(|own| own.with_file_name(&name));
    let path = env::var_os("PATH").unwrap_or_default();
    let mut places = env::split_paths(&path).map(|folder| folder.join(&name)).chain(own);
    places.find(|place| place.is_file()).ok_or_else(|| {
        "--terminal shows pictures by the program ishow, which is not found; install it, or leave --terminal out".into()
    })
}

/// Between two looks whether a signal has come.
const TICK: Duration = Duration::from_millis(10);

/// Held while the terminal is not as it was.
type Busy = Arc<Mutex<()>>;

/// Ends the program by the signals that end programs, but not while `busy` is held; a second one ends it at once. Tells
/// whether one came.
fn end_by_signals(busy: &Busy) -> std::io::Result<Arc<AtomicBool>> {
    let (last, came) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicBool::new(false)));
    for signal in [SIGHUP, SIGINT, SIGQUIT, SIGTERM] {
        flag::register_conditional_default(signal, Arc::clone(&came))?;
        flag::register(signal, Arc::clone(&came))?;
        let number = usize::try_from(signal).map_err(std::io::Error::other)?;
        flag::register_usize(signal, Arc::clone(&last), number)?;
    }
    let (busy, ending) = (Arc::clone(busy), Arc::clone(&came));
    let looking = move || loop {
        thread::park_timeout(TICK);
        let signal = i32::try_from(last.load(Ordering::Relaxed)).unwrap_or(0);
        if signal != 0 {
            let _idle = busy.lock().unwrap_or_else(PoisonError::into_inner);
            low_level::emulate_default_handler(signal).ok();
        }
    };
    thread::Builder::new().name("signals".into()).spawn(looking)?;
    Ok(ending)
}

/// Shows each finished picture of a board as it comes.
///
/// # Errors
///
/// When the program cannot be started, or fails.
pub(super) fn show_all(board: &Board, program: &Path) -> Result<(), Box<dyn Error + Send + Sync>> {
    let busy = Busy::default();
    let ending = end_by_signals(&busy)?;
    let (mut version, mut shown) = (0, 0);
    loop {
        let Some(seen) = board.after(version, Duration::from_secs(60)) else { continue };
        version = seen.version;
        if let Some(shot) = &seen.shot
            && seen.shown.stage == Stage::Finished
            && seen.picture > shown
        {
            shown = seen.picture;
            let held = busy.lock().unwrap_or_else(PoisonError::into_inner);
            let made = show(shot, program);
            drop(held);
            while ending.load(Ordering::Relaxed) {
                // The program is about to end; that `ishow` was ended, too, is no error.
                thread::park_timeout(TICK);
            }
            made?;
        }
    }
}

fn show(shot: &Shot, program: &Path) -> Result<(), Box<dyn Error + Send + Sync>> {
    let mut child = Command::new(program).arg("-").stdin(Stdio::piped()).spawn()?;
    if let Some(mut input) = child.stdin.take() {
        // One that ends before it has read all says why itself.
        input.write_all(&coded(shot)?).ok();
    }
    let status = child.wait()?;
    if status.success() { Ok(()) } else { Err(format!("ishow: {status}").into()) }
}

fn coded(shot: &Shot) -> Result<Vec<u8>, Box<dyn Error + Send + Sync>> {
    let plane = |(at, kind): (usize, Kind)| {
        let samples = shot.rgba.iter().skip(at).step_by(4).copied().collect();
        Plane { kind, samples: Samples::U8(samples) }
    };
    let planes = [Kind::Red, Kind::Grn, Kind::Blu].into_iter().enumerate().map(plane).collect();
    let image = Image::new(shot.columns, shot.rows, planes)?;
    let mut bytes = Vec::new();
    write_stream(Path::new("the picture"), &mut bytes, &image)?;
    Ok(bytes)
}
