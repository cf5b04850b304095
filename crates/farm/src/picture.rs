//! The pictures of a render: compiled once, for all workers.

use std::error::Error;
use std::path::PathBuf;

use idf::part::{Part, Share};
use render::command::{Plan, check_shown, plan, read_scene};
use render::identity::Identities;
use render::sequence::{Frames, Ledger};

use crate::command::RenderArguments;
use crate::folder::{Folder, Job, Unit};

/// A picture that is to be made.
#[derive(Clone, Debug)]
pub(crate) struct Picture {
    /// Its number in a sequence.
    pub(crate) frame: Option<u32>,
    /// The file it will be in.
    pub(crate) name: PathBuf,
    /// What all its parts say, but which they are.
    pub(crate) part: Part,
}

/// All that is to be made, and what is known of it.
#[derive(Debug)]
pub(crate) struct Work {
    pub(crate) plan: Plan,
    pub(crate) job: Job,
    pub(crate) frames: Option<Frames>,
    /// Those that were not finished before.
    pub(crate) pictures: Vec<Picture>,
    /// How many were.
    pub(crate) finished: usize,
    /// The list of finished pictures of a sequence.
    pub(crate) ledger: Option<Ledger>,
}

impl Work {
    /// Compiles what has to be rendered, and writes it into the folder.
    pub(crate) fn new(
        arguments: &RenderArguments,
        plan: Plan,
        job: Job,
        folder: &Folder,
    ) -> Result<Self, Box<dyn Error>> {
        let frames = arguments.picture.frames();
        let ledger = frames.map(|_| Ledger::of(&plan.output)).transpose()?;
        let mut work = Self { plan, job, frames, pictures: Vec::new(), finished: 0, ledger };
        let mut identities = Identities::default();
        match frames {
            None => work.compile(arguments, folder, &mut identities, None)?,
            Some(frames) => {
                for number in frames.numbers() {
                    work.compile(arguments, folder, &mut identities, Some(number))?;
                }
            }
        }
        Ok(work)
    }

    fn compile(
        &mut self,
        arguments: &RenderArguments,
        folder: &Folder,
        identities: &mut Identities,
        frame: Option<u32>,
    ) -> Result<(), Box<dyn Error>> {
        let output = &self.plan.output;
        let own = match frame {
            Some(number) => arguments.picture.of_frame(output, number),
            None => arguments.picture.clone(),
        };
        let plan = plan(&own)?;
        // Of a sequence, warnings are those of the first picture.
        let is_first = self.finished + self.pictures.len() == 0;
        let (mut scene, _) = read_scene(&own, is_first)?;
        let picture = plan.identity(&scene, identities);
        let canvas = plan.canvas();
        let Plan { output: name, .. } = plan;
        check_shown(&scene, &[&name])?;
        if let Some((ledger, number)) = self.ledger.as_ref().zip(frame)
            && ledger.has(number, picture, &name)
        {
            self.finished += 1;
            folder.clear(frame);
            return Ok(());
        }
        compile::image::rebase(&mut scene, &folder.path);
        let mut text = Vec::new();
        scene::format::write(&scene, &mut text)?;
        idf::command::write_text(&folder.scene(frame), &String::from_utf8(text)?)?;
        let share = Share::Tiles(self.job.tiles(0));
        let part = Part { share, canvas, picture };
        self.pictures.push(Picture { frame, name, part });
        Ok(())
    }

    /// The number of the first picture of a sequence.
    pub(crate) fn first(&self) -> Option<u32> {
        self.frames.map(|frames| frames.first)
    }

    /// The units of a picture: parts that have pixels.
    pub(crate) fn units(&self, picture: &Picture) -> Vec<usize> {
        let has_pixels =
            |part: &u32| self.job.tiles(*part).windows(picture.part.canvas).next().is_some();
        let number =
            |part| Unit { frame: picture.frame, part }.number(self.job.parts, self.first());
        (0..self.job.parts).filter(has_pixels).map(number).collect()
    }

    /// The unit of a number.
    pub(crate) fn unit(&self, number: usize) -> Option<Unit> {
        Unit::numbered(number, self.job.parts, self.first())
    }
}
