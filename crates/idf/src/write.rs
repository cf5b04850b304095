//! Writes an image so that a crash leaves the old one or the new one.
//!
//! All files are first written beside their names. A new image then gets its data files renamed,
//! and the description last. Where there is an image already, a reader must never find the new
//! file of one channel with the old file of another, so the description changes twice, each time
//! by one rename: first it names the new files where they are, then, when they have their own
//! names too, it names these.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::channel::ChannelWriter;
use crate::description::{Channel, Description, Encoding};
use crate::error::WriteError;
use crate::file;
use crate::image::{Image, Matte, Plane, Properties};
use crate::lut::Lut;
use crate::plane::{Kind, Role};
use crate::read::{
    Ask, ReadOptions, data_path, description_path, read, read_description, read_log,
};
use crate::samples::Depth;

/// How to write.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WriteOptions {
    /// How data files are coded. With `Rle`, a file that would not shrink is written raw.
    pub encoding: Encoding,
    /// Follow the name of an older log out of the description's folder.
    pub outside: bool,
}

/// Writes an image in this crate's format: `path`, which may lack its ending, and beside it one
/// file for each channel, named after it.
///
/// Files of channels that an older image of this name had and the new one has not stay on disk,
/// as another description may borrow them.
///
/// # Errors
///
/// If a file cannot be written; the old image is then whole.
pub fn write(path: &Path, image: &Image, options: &WriteOptions) -> Result<(), WriteError> {
    let path = &description_path(path);
    let mut description = Description::default();
    description.size = image.size();
    set_properties(&mut description, &image.properties, image.plane(Kind::Cvg).is_some());
    put(path, image, options, description)
}

/// Adds the channels of `image` to the image at `path`, in place of those of the same kind; its
/// other channels, and what it says besides, stay as they are. Lines of history are appended.
///
/// Indices mean the colours of their table: where another table comes without indices, those of the
/// image at `path` go, unless they are all of its light. Gives the kinds of channels that went.
///
/// # Errors
///
/// If the image at `path` cannot be read or has another size, or a file cannot be written; the
/// old image is then whole.
pub fn add(path: &Path, image: &Image, options: &WriteOptions) -> Result<Vec<Kind>, WriteError> {
    let path = &description_path(path);
    let mut description = read_description(path).map_err(WriteError::Read)?;
    if !image.planes().is_empty() && description.size != image.size() {
        let (found, expected) = (image.size(), description.size);
        return Err(WriteError::Size { path: path.clone(), found, expected });
    }
    let mut image = image.clone();
    if let Some(log) = description.log.as_ref().filter(|_| !image.properties.history.is_empty()) {
        let log = data_path(path, log, options.outside).map_err(WriteError::Read)?;
        let older = read_log(&log).map_err(WriteError::Read)?;
        image.properties.history.splice(0..0, older);
    }
    let stale = has_stale_indices(path, &description, &image, options);
    let gone: Vec<Channel> =
        description.channels.extract_if(.., |channel| stale && channel.kind == Kind::Enc).collect();
    put(path, &image, options, description)?;
    for channel in &gone {
        // Under another name it is the file of another image. What stays is only a stray file.
        if channel.file == data_name(path, channel.kind.word())? {
            fs::remove_file(file::folder(path).join(&channel.file)).ok();
        }
    }
    Ok(gone.into_iter().map(|channel| channel.kind).collect())
}

/// Whether the table of `image` gives the indices of the image at `path` other colours, and these
/// have light besides.
fn has_stale_indices(
    path: &Path,
    description: &Description,
    image: &Image,
    options: &WriteOptions,
) -> bool {
    let Some(table) = image.lut.as_ref().filter(|_| image.plane(Kind::Enc).is_none()) else {
        return false;
    };
    let mut kinds = description.channels.iter().map(|channel| channel.kind);
    if !kinds.any(|kind| kind != Kind::Enc && kind.role() == Role::Light) {
        return false;
    }
    let ask = Ask::Only(vec![Kind::Lut]);
    let present = read(path, &ReadOptions { ask, outside: options.outside, ..Default::default() });
    // A damaged table is another.
    present.ok().and_then(|present| present.lut).as_ref() != Some(table)
}

/// The name of the file for a channel: that of the description with another ending.
pub(crate) fn data_name(description: &Path, ending: &str) -> Result<String, WriteError> {
    let name = description.with_extension(ending);
    let name = name.file_name().and_then(|name| name.to_str());
    name.filter(|name| !name.contains(char::is_control))
        .map(str::to_owned)
        .ok_or_else(|| WriteError::Name { path: description.into() })
}

/// What an image says besides its samples; `covered` where it has coverage.
pub(crate) fn set_properties(
    description: &mut Description,
    properties: &Properties,
    covered: bool,
) {
    description.origin = properties.origin;
    description.transfer = properties.transfer;
    description.matte = Some(properties.matte).filter(|&m| covered || m != Matte::default());
    description.background = properties.background;
    description.unknown.clone_from(&properties.unknown);
}

/// Writes the channels of `image` and the description, where they take the place of others.
fn put(
    path: &Path,
    image: &Image,
    options: &WriteOptions,
    description: Description,
) -> Result<(), WriteError> {
    let mut files = Vec::new();
    for Plane { kind, samples } in image.planes() {
        let (size, depth) = (image.size(), samples.depth());
        let mut file = ChannelWriter::create(path, *kind, size, depth, options.encoding)?;
        file.write(samples)?;
        files.push(file.finish()?);
    }
    complete(path, files, image.lut.as_ref(), &image.properties.history, description)
}

/// Puts finished data files, a table and the log in their places, and a description that names
/// them.
pub(crate) fn complete(
    path: &Path,
    files: Vec<(Channel, Staged)>,
    lut: Option<&Lut>,
    history: &[String],
    mut description: Description,
) -> Result<(), WriteError> {
    let mut files = files;
    if let Some(lut) = lut {
        let channel = Channel {
            kind: Kind::Lut,
            file: data_name(path, Kind::Lut.word())?,
            columns: lut.columns(),
            rows: lut.rows(),
            depth: Depth::U8,
            encoding: Encoding::Raw,
        };
        let staged = Staged::new(path, &channel.file, &lut.to_rows())?;
        files.push((channel, staged));
    }
    let mut staged = Vec::new();
    for (channel, file) in files {
        staged.push(file);
        match description.channels.iter_mut().find(|other| other.kind == channel.kind) {
            Some(line) => *line = channel,
            None => description.channels.push(channel),
        }
    }
    if !history.is_empty() {
        let log = data_name(path, Kind::Log.word())?;
        let text = history.join("\n") + "\n";
        staged.push(Staged::new(path, &log, text.as_bytes())?);
        description.log = Some(log);
    }
    let Commit { steps, locks } = commit(path, staged, &description)?;
    run(steps)?;
    drop(locks);
    sweep(path, &description)
}

/// Removes what killed writers of this image left beside it.
fn sweep(path: &Path, description: &Description) -> Result<(), WriteError> {
    let stem = data_name(path, "")?;
    let used: BTreeSet<&str> = names(description).collect();
    file::sweep(file::folder(path), |name, target| {
        let ending = target.strip_prefix(&stem).and_then(|rest| rest.strip_prefix('.'));
        let is_ours = |word| word == "idf" || Kind::from_word(word).is_some();
        ending.is_some_and(is_ours) && !used.contains(name)
    });
    Ok(())
}

/// A new data file: where it is, and the name it will have.
#[derive(Debug)]
pub(crate) struct Staged {
    /// Where it is; removed with this value unless it gets its name.
    pub(crate) temporary: NamedTempFile,
    /// The name it will have.
    pub(crate) name: String,
}

impl Staged {
    fn new(description: &Path, name: &str, bytes: &[u8]) -> Result<Self, WriteError> {
        let target = file::folder(description).join(name);
        file::check_target(&target)?;
        Ok(Self { temporary: file::stage(&target, bytes, description)?, name: name.into() })
    }
}

/// One change to the folder. After any number of them the image is the old or the new one.
enum Step {
    /// Gives a staged file its name.
    Rename(NamedTempFile, PathBuf),
    /// Gives a file a second name.
    Link(PathBuf, PathBuf),
    /// Removes what is no longer named.
    Remove(PathBuf),
}

/// Changes, and what keeps other writers from taking the staged files for left over meanwhile.
struct Commit {
    steps: Vec<Step>,
    locks: Vec<File>,
}

/// The changes that put staged files in place, in their order.
fn commit(
    path: &Path,
    staged: Vec<Staged>,
    description: &Description,
) -> Result<Commit, WriteError> {
    file::check_target(path)?;
    let folder = file::folder(path);
    let text = file::stage(path, description.to_string().as_bytes(), path)?;
    if fs::symlink_metadata(path).is_err() {
        let mut steps: Vec<Step> = staged
            .into_iter()
            .map(|file| Step::Rename(file.temporary, folder.join(file.name)))
            .collect();
        steps.push(Step::Rename(text, path.into()));
        return Ok(Commit { steps, locks: Vec::new() });
    }
    let mut interim = description.clone();
    let files = interim.channels.iter_mut().map(|channel| &mut channel.file);
    for name in files.chain(&mut interim.log) {
        if let Some(file) = staged.iter().find(|file| file.name == *name) {
            *name = temporary_name(file.temporary.path())?;
        }
    }
    let interim = file::stage(path, interim.to_string().as_bytes(), path)?;
    let left = interrupted(path, description)?;
    let (mut kept, mut locks) = (Vec::new(), Vec::new());
    for file in staged {
        let (lock, temporary) = file.temporary.keep().map_err(|e| file::io_error(path, e.error))?;
        locks.push(lock);
        kept.push((temporary, folder.join(file.name)));
    }
    let mut steps = vec![Step::Rename(interim, path.into())];
    steps.extend(kept.iter().map(|(from, to)| Step::Link(from.clone(), to.clone())));
    steps.push(Step::Rename(text, path.into()));
    steps.extend(kept.into_iter().map(|(from, _)| Step::Remove(from)));
    steps.extend(left.into_iter().map(Step::Remove));
    Ok(Commit { steps, locks })
}

/// Files that the present description still names where an interrupted write left them, and the
/// next one does not.
fn interrupted(path: &Path, next: &Description) -> Result<BTreeSet<PathBuf>, WriteError> {
    // A damaged description is replaced without a look at what it names.
    let Ok(present) = read_description(path) else { return Ok(BTreeSet::new()) };
    let prefix = format!(".{}.", data_name(path, "")?);
    let next: BTreeSet<&str> = names(next).collect();
    let left = names(&present)
        .filter(|name| name.starts_with(&prefix) && !name.contains('/') && !next.contains(name));
    let folder = file::folder(path);
    Ok(left.map(|name| folder.join(name)).filter(|path| path.is_file()).collect())
}

fn names(description: &Description) -> impl Iterator<Item = &str> {
    let files = description.channels.iter().map(|channel| &channel.file);
    files.chain(&description.log).map(String::as_str)
}

fn temporary_name(path: &Path) -> Result<String, WriteError> {
    let name = path.file_name().and_then(|name| name.to_str()).map(str::to_owned);
    name.ok_or_else(|| WriteError::Name { path: path.into() })
}

/// Makes the changes. If the first fails, staged files that were kept for it are removed.
fn run(steps: Vec<Step>) -> Result<(), WriteError> {
    let mut left: Vec<PathBuf> = steps
        .iter()
        .filter_map(|step| match step {
            Step::Link(from, _) => Some(from.clone()),
            Step::Rename(..) | Step::Remove(_) => None,
        })
        .collect();
    for step in steps {
        match step_result(step) {
            Ok(()) => left.clear(),
            Err(error) => {
                for path in left {
                    // The first error is the one to tell; what stays is only a stray file.
                    fs::remove_file(path).ok();
                }
                return Err(error);
            }
        }
    }
    Ok(())
}

fn step_result(step: Step) -> Result<(), WriteError> {
    match step {
        Step::Rename(from, to) => file::rename(from, &to),
        Step::Link(from, to) => link(&from, &to).map_err(|source| file::io_error(&to, source)),
        Step::Remove(path) => {
            fs::remove_file(&path).map_err(|source| file::io_error(&path, source))
        }
    }
}

/// Makes `to` name the file `from`, in place of what it named, with no moment without a file.
fn link(from: &Path, to: &Path) -> io::Result<()> {
    let mut second = from.to_path_buf().into_os_string();
    second.push("+");
    if fs::hard_link(from, &second).is_err() {
        // A file system without links; as safe, but the bytes are written twice.
        fs::copy(from, &second)?;
    }
    fs::rename(&second, to)
}

#[cfg(test)]
mod tests;
