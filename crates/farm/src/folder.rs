//! The work folder: what workers read, and the parts they made.

use std::error::Error;
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

use idf::part::{Part, Share, Tiles};
use idf::{Ask, Image, ReadOptions, read};
use serde::{Deserialize, Serialize};

/// The folder `x.farm` of the output `x`.
#[derive(Clone, Debug)]
pub(crate) struct Folder {
    pub(crate) path: PathBuf,
}

/// What all workers of a render have to know.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Job {
    /// Words of the command line of `prfarm`, from `render` on.
    pub(crate) words: Vec<String>,
    /// Parts of each picture.
    pub(crate) parts: u32,
    /// Side of their tiles.
    pub(crate) side: u32,
}

/// One part of one picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Unit {
    /// The number of the picture in the sequence, if there is one.
    pub(crate) frame: Option<u32>,
    /// The number of the part.
    pub(crate) part: u32,
}

impl Unit {
    /// The unit of a number that counts the parts of all pictures, from `first` on.
    pub(crate) fn numbered(number: usize, parts: u32, first: Option<u32>) -> Option<Self> {
        let number = u64::try_from(number).ok()?;
        let picture = u32::try_from(number / u64::from(parts)).ok()?;
        let part = u32::try_from(number % u64::from(parts)).ok()?;
        let frame = match first {
            Some(first) => Some(first.checked_add(picture)?),
            None if picture == 0 => None,
            None => return None,
        };
        Some(Self { frame, part })
    }

    /// The number that counts the parts of all pictures.
    pub(crate) fn number(self, parts: u32, first: Option<u32>) -> usize {
        let picture = self.frame.zip(first).map_or(0, |(frame, first)| frame - first);
        picture as usize * parts as usize + self.part as usize
    }
}

impl Job {
    /// Which pixels a part of a picture has.
    pub(crate) fn tiles(&self, part: u32) -> Tiles {
        Tiles { number: part, count: self.parts, side: self.side }
    }
}

impl Folder {
    pub(crate) fn of(output: &Path) -> Self {
        Self { path: output.with_extension("farm") }
    }

    /// Makes the folder, and keeps other drivers out of it for as long as the file is open.
    pub(crate) fn lock(&self) -> Result<File, Box<dyn Error>> {
        let said = |error: std::io::Error| format!("{}: {error}", self.path.display());
        fs::create_dir_all(&self.path).map_err(said)?;
        let file = File::create(self.path.join("lock")).map_err(said)?;
        match file.try_lock() {
            Ok(()) => Ok(file),
            Err(TryLockError::WouldBlock) => {
                let path = self.path.display();
                Err(format!("{path}: another prfarm is at work on this output").into())
            }
            // A file system without locks: two drivers would do the work twice, and no harm.
            Err(TryLockError::Error(_)) => Ok(file),
        }
    }

    fn job_path(&self) -> PathBuf {
        self.path.join("job.json")
    }

    /// The job whose folder this is.
    pub(crate) fn job(&self) -> Result<Job, Box<dyn Error>> {
        let path = self.job_path();
        let said = |error: String| format!("{}: {error}", path.display());
        let text = fs::read_to_string(&path).map_err(|error| said(error.to_string()))?;
        Ok(serde_json::from_str(&text).map_err(|error| said(error.to_string()))?)
    }

    pub(crate) fn write_job(&self, job: &Job) -> Result<(), Box<dyn Error>> {
        Ok(idf::command::write_text(&self.job_path(), &serde_json::to_string_pretty(job)?)?)
    }

    /// The compiled scene of a picture.
    pub(crate) fn scene(&self, frame: Option<u32>) -> PathBuf {
        self.path.join(format!("{}.prc", label(frame)))
    }

    /// The image of a part, without its ending.
    pub(crate) fn part(&self, unit: Unit) -> PathBuf {
        self.path.join(format!("{}-{:04}", label(unit.frame), unit.part))
    }

    /// What a worker had to say.
    pub(crate) fn errors(&self, number: usize) -> PathBuf {
        self.path.join(format!("{number}.err"))
    }

    /// Numbers of jobs that were submitted to a queue.
    pub(crate) fn submitted(&self) -> PathBuf {
        self.path.join("submitted")
    }

    /// A part, if it is there, whole, and of the picture.
    pub(crate) fn finished(&self, unit: Unit, job: &Job, expected: &Part) -> Option<Image> {
        let options = ReadOptions { ask: Ask::All, outside: false, history: true };
        let image = read(&self.part(unit), &options).ok()?;
        let part = Part { share: Share::Tiles(job.tiles(unit.part)), ..*expected };
        (Part::of(&image) == Ok(Some(part))).then_some(image)
    }

    /// Removes the scene of a picture and its parts.
    pub(crate) fn clear(&self, frame: Option<u32>) {
        let prefix = format!("{}-", label(frame));
        let scene = format!("{}.prc", label(frame));
        for entry in fs::read_dir(&self.path).into_iter().flatten().flatten() {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            // Files that killed workers left begin with a dot.
            if name.trim_start_matches('.').starts_with(&prefix) || *name == scene {
                // What stays is only in the way of nothing.
                fs::remove_file(entry.path()).ok();
            }
        }
    }
}

/// What names of files about a picture begin with.
fn label(frame: Option<u32>) -> String {
    frame.map_or_else(|| "scene".to_owned(), |number| format!("{number:04}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_numbered_over_all_pictures() {
        for (number, first, expected) in [
            (0, None, Some(Unit { frame: None, part: 0 })),
            (7, None, Some(Unit { frame: None, part: 7 })),
            (8, None, None),
            (0, Some(3), Some(Unit { frame: Some(3), part: 0 })),
            (17, Some(3), Some(Unit { frame: Some(5), part: 1 })),
        ] {
            let unit = Unit::numbered(number, 8, first);
            assert_eq!(unit, expected);
            assert!(unit.is_none_or(|unit| unit.number(8, first) == number), "{number}");
        }
    }

    #[test]
    fn one_driver_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let work = Folder::of(&folder.path().join("x.png"));
        assert_eq!(work.path, folder.path().join("x.farm"));
        let held = work.lock().unwrap();
        let error = work.lock().unwrap_err().to_string();
        assert!(error.ends_with("another prfarm is at work on this output"), "{error}");
        drop(held);
        work.lock().unwrap();
    }

    #[test]
    fn only_what_is_of_a_picture_is_cleared() {
        let folder = tempfile::tempdir().unwrap();
        let work = Folder { path: folder.path().to_owned() };
        let names = ["0001-0000.idf", "0001-0000.red", "0001.prc", ".0001-0003.red.77.abcdef"];
        let others = ["0011-0000.idf", "0011.prc", "1.err", "job.json"];
        for name in names.iter().chain(&others) {
            fs::write(folder.path().join(name), "").unwrap();
        }
        work.clear(Some(1));
        let mut left: Vec<String> = fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        left.sort();
        assert_eq!(left, others);
    }
}
