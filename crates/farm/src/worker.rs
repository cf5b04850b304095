//! One part of one picture, in a process of its own.

use std::error::Error;

#[cfg(target_os = "linux")]
use rustix::process::{Pid, Signal, getppid, set_parent_process_death_signal};

use crate::command::{PartArguments, parsed};
use crate::folder::{Folder, Unit};

/// Renders the part, unless it is there already.
pub(crate) fn run(arguments: &PartArguments) -> Result<(), Box<dyn Error>> {
    if let Some(parent) = arguments.parent {
        end_with(parent)?;
    }
    let folder = Folder { path: arguments.folder.clone() };
    let job = folder.job()?;
    let render = parsed(&job.words)?;
    let first = render.picture.frames().map(|frames| frames.first);
    let unit = Unit::numbered(arguments.number, job.parts, first)
        .ok_or_else(|| format!("no part has the number {}", arguments.number))?;
    let picture =
        render.picture.of_part(&folder.scene(unit.frame), job.tiles(unit.part), &folder.part(unit));
    render::command::run(&picture)
}

/// Lets the system kill this process when its parent ends: what it would render, the next driver renders again.
#[cfg(target_os = "linux")]
fn end_with(parent: u32) -> Result<(), Box<dyn Error>> {
    set_parent_process_death_signal(Some(Signal::KILL))?;
    let found = getppid().map(Pid::as_raw_nonzero).and_then(|pid| u32::try_from(pid.get()).ok());
    // It may have ended before.
    if found == Some(parent) { Ok(()) } else { Err("the driver has ended".into()) }
}

/// Other systems do not do that: the part is finished, and the next driver finds it.
#[cfg(not(target_os = "linux"))]
fn end_with(_: u32) -> Result<(), Box<dyn Error>> {
    Ok(())
}
