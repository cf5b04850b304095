//! The order of work for a sequence of pictures.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use idf::command::{Job, UsageError, is_stream};
use idf::part::{Share, Sum};

use super::{Frames, Ledger};
use crate::command::{Arguments, make, plan, read_scene};
use crate::identity::Identities;

/// The name of the number of a picture in a scene.
pub(crate) const NAME: &str = "frame";

/// Renders the pictures of a sequence that are not finished.
pub(crate) fn run(arguments: &Arguments, frames: Frames) -> Result<(), Box<dyn Error>> {
    let output = plan(arguments)?.output;
    if is_stream(&output) {
        return Err(
            UsageError("--frames writes several files, expected a name for them".into()).into()
        );
    }
    let mut ledger = Ledger::of(&output)?;
    let mut identities = Identities::default();
    let mut finished = 0;
    for number in frames.numbers() {
        let begun = Instant::now();
        let job = Job::start("portray", env!("CARGO_PKG_VERSION"));
        let arguments = arguments.of_frame(&output, number);
        let plan = plan(&arguments)?;
        // All pictures have about the same warnings.
        let scene = read_scene(&arguments, number == frames.first)?;
        let identity = with_share(plan.identity(&scene.0, &mut identities), plan.share);
        let name = plan.output.clone();
        if ledger.has(number, identity, &name) {
            finished += 1;
            continue;
        }
        arguments.talk.note(format_args!("{}", name.display()));
        make(&arguments, plan, scene, job, begun)?;
        ledger.add(number, identity, &name)?;
    }
    if finished > 0 {
        let all = frames.last - frames.first + 1;
        arguments.talk.note(format_args!("{finished} of {all} pictures were finished before"));
    }
    Ok(())
}

/// The identity of what is written: of a part, of its place as well.
fn with_share(picture: u128, share: Option<Share>) -> u128 {
    let Some(share) = share else { return picture };
    let mut sum = Sum::default();
    sum.add(format!("{picture:032x} {share:?}").as_bytes());
    sum.value()
}

impl Arguments {
    /// The numbers of a sequence, if one is asked for.
    #[must_use]
    pub fn frames(&self) -> Option<Frames> {
        self.frames
    }

    /// The arguments of one picture of the sequence `output`.
    #[must_use]
    pub fn of_frame(&self, output: &Path, number: u32) -> Self {
        let mut arguments = self.clone();
        arguments.frames = None;
        arguments.output = Some(Frames::name(output, number));
        arguments.definitions.push((NAME.into(), f64::from(number)));
        arguments
    }
}

/// What makes no sense for a sequence.
pub(crate) fn check(arguments: &Arguments) -> Result<(), UsageError> {
    if arguments.frames.is_none() {
        return Ok(());
    }
    let error = |message: &str| Err(UsageError(message.into()));
    let is_compiled =
        arguments.scene.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("prc"));
    if is_stream(&arguments.scene) || is_compiled {
        return error(
            "--frames: the scene is compiled for each picture, expected a scene description in a file",
        );
    }
    if arguments.definitions.iter().any(|(name, _)| name == NAME) {
        return error("--frames gives `frame` its numbers; leave -D frame out");
    }
    if arguments.stats.is_some() {
        return error(
            "--stats tells of one picture, and --frames makes several; the log of each has its figures",
        );
    }
    Ok(())
}
