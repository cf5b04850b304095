//! Files that are looked at again and again: whether what is in them has changed.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, SystemTime};

use idf::part::Sum;

/// Between two looks.
const TICK: Duration = Duration::from_millis(5);
/// Clocks of file systems are this coarse at most: a file that was just written may be written again at the same time.
const YOUNG: Duration = Duration::from_millis(100);
/// Looks until a file counts as gone: editors that write another file and rename it leave none for a moment.
const PATIENCE: u32 = 60;

/// Files, with what is known of each.
#[derive(Debug)]
pub(super) struct Watched {
    main: PathBuf,
    stamps: BTreeMap<PathBuf, Stamp>,
    changed: BTreeSet<PathBuf>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Stamp {
    /// None where there is no file.
    modified: Option<(SystemTime, u64)>,
    /// May have been written again since.
    young: bool,
    /// Of what is in it; 0 in folders and where nothing can be read.
    content: u128,
}

impl Stamp {
    fn of(path: &Path) -> Self {
        let modified = modified(path);
        let age = modified.and_then(|(time, _)| SystemTime::now().duration_since(time).ok());
        let young = modified.is_some() && age.is_none_or(|age| age < YOUNG);
        let content = fs::read(path).map_or(0, |bytes| {
            let mut sum = Sum::default();
            sum.add(&bytes);
            sum.value()
        });
        Self { modified, young, content }
    }
}

/// When a file was written, and its length. What changes in a folder changes its time.
fn modified(path: &Path) -> Option<(SystemTime, u64)> {
    let found = fs::metadata(path).ok()?;
    Some((found.modified().ok()?, found.len()))
}

impl Watched {
    /// The file of a scene alone.
    pub(super) fn new(main: &Path) -> Self {
        let stamps = BTreeMap::from([(main.to_owned(), Stamp::of(main))]);
        Self { main: main.to_owned(), stamps, changed: BTreeSet::new() }
    }

    /// Looks after these from now on, and after the main one. What is known of a file is not forgotten, so that a change
    /// while it was read is seen.
    pub(super) fn replace(&mut self, files: impl IntoIterator<Item = PathBuf>) {
        let mut before = std::mem::take(&mut self.stamps);
        for path in files.into_iter().chain([self.main.clone()]) {
            let stamp = before.remove(&path);
            self.stamps
                .entry(path)
                .or_insert_with_key(|path| stamp.unwrap_or_else(|| Stamp::of(path)));
        }
    }

    /// The files.
    pub(super) fn paths(&self) -> impl Iterator<Item = &Path> {
        self.stamps.keys().map(PathBuf::as_path)
    }

    /// Looks once, and tells whether anything is other than it was.
    pub(super) fn has_changed(&mut self) -> bool {
        let mut changed = false;
        for (path, stamp) in &mut self.stamps {
            if modified(path) == stamp.modified && !stamp.young {
                continue;
            }
            let now = Stamp::of(path);
            // What is in the planes of an image does not show in its description.
            let stands_for_more =
                path.is_dir() || path.extension().is_some_and(|ending| ending == "idf");
            if now.content != stamp.content
                || now.modified.is_some() != stamp.modified.is_some()
                || stands_for_more && now.modified != stamp.modified
            {
                self.changed.insert(path.clone());
                changed = true;
            }
            *stamp = now;
        }
        changed
    }

    /// Those that have changed since this was asked last.
    pub(super) fn take_changed(&mut self) -> BTreeSet<PathBuf> {
        std::mem::take(&mut self.changed)
    }

    /// Waits for a change, and calls `at_once` when it comes; then until nothing changes, so that no file is read that is
    /// half written.
    pub(super) fn wait(&mut self, at_once: impl FnOnce()) {
        while !self.has_changed() {
            thread::park_timeout(TICK);
        }
        at_once();
        for _ in 0..PATIENCE {
            thread::park_timeout(TICK);
            if !self.has_changed() && self.main.exists() {
                break;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_in_files_counts() {
        let folder = tempfile::TempDir::new().unwrap();
        let [main, other] = ["a.sdl", "b.sdl"].map(|name| folder.path().join(name));
        fs::write(&main, "one").unwrap();
        let mut watched = Watched::new(&main);
        assert!(!watched.has_changed(), "nothing");
        fs::write(&main, "one").unwrap();
        assert!(!watched.has_changed(), "written again as it was");
        fs::write(&main, "two").unwrap();
        assert!(watched.has_changed(), "as long as before, at about the same time");
        assert!(!watched.has_changed(), "told once");
        fs::write(&other, "x").unwrap();
        watched.replace([other.clone()]);
        assert!(!watched.has_changed() && watched.paths().count() == 2);
        fs::remove_file(&other).unwrap();
        assert!(watched.has_changed(), "one is gone");
        fs::write(&other, "x").unwrap();
        assert!(watched.has_changed(), "and back");
        watched.replace([]);
        fs::write(&other, "y").unwrap();
        assert!(!watched.has_changed(), "it is looked after no more");
    }

    #[test]
    fn a_change_while_a_scene_is_read_is_seen() {
        let folder = tempfile::TempDir::new().unwrap();
        let main = folder.path().join("a.sdl");
        fs::write(&main, "one").unwrap();
        let mut watched = Watched::new(&main);
        fs::write(&main, "two").unwrap();
        watched.replace([main]);
        assert!(watched.has_changed());
    }

    #[test]
    fn a_folder_changes_when_a_file_comes() {
        let folder = tempfile::TempDir::new().unwrap();
        let main = folder.path().join("a.sdl");
        fs::write(&main, "include \"b.sdl\"").unwrap();
        let mut watched = Watched::new(&main);
        watched.replace([folder.path().join("sub")]);
        assert!(!watched.has_changed());
        fs::create_dir(folder.path().join("sub")).unwrap();
        assert!(watched.has_changed());
    }
}
