//! Opens an image: the description, and only the channels asked for.

use std::path::{Component, Path, PathBuf};

use crate::description::{Channel, Description, parse};
use crate::error::ReadError;
use crate::file;
use crate::image::Image;
use crate::plane::{COLOR, Kind};
use crate::rows::Reader;

/// Which channels to open.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Ask {
    /// All.
    #[default]
    All,
    /// What a picture needs: colour, else grey, else indices and their table; and coverage, which
    /// may be alone.
    Picture,
    /// These, and all of them must be there; one that is named twice is opened once.
    Only(Vec<Kind>),
}

/// How to read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Which channels to open.
    pub ask: Ask,
    /// Follow file names that lead out of the description's folder.
    pub outside: bool,
    /// Read the log too, into [`Properties::history`](crate::Properties::history).
    pub history: bool,
}

/// Most bytes of a description: over a thousand times what this version writes.
const MOST_DESCRIPTION: u64 = 1 << 20;
/// Most bytes of a log.
const MOST_LOG: u64 = 1 << 26;

/// The file of the description that `path` names, with or without its ending.
pub fn description_path(path: &Path) -> PathBuf {
    if path.extension().is_some() { path.into() } else { path.with_extension("idf") }
}

/// Reads the description alone.
///
/// # Errors
///
/// If the file cannot be read or is no description.
pub fn read_description(path: &Path) -> Result<Description, ReadError> {
    let path = description_path(path);
    let text = file::text(&path, MOST_DESCRIPTION)?;
    parse(&text).map_err(|error| ReadError::Syntax { path, error })
}

/// Reads an image in this crate's format.
///
/// # Errors
///
/// If the description or a data file is missing or damaged, a channel that was asked for is not
/// there, or channels that were asked for differ in size.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Image, ReadError> {
    Reader::open(path, options)?.whole()
}

/// Where a file of a description is.
///
/// # Errors
///
/// If it lies, by its name or by a link, outside the description's folder, and `outside` is not
/// given.
pub(crate) fn data_path(
    description: &Path,
    name: &str,
    outside: bool,
) -> Result<PathBuf, ReadError> {
    let folder = file::folder(description);
    let path = folder.join(name);
    if outside {
        return Ok(path);
    }
    let error = || ReadError::Outside { path: description.into(), file: name.into() };
    let stays = |part| matches!(part, Component::Normal(_) | Component::CurDir);
    if !Path::new(name).components().all(stays) {
        return Err(error());
    }
    let io = |source| ReadError::Io { path: path.clone(), source };
    let (real, real_folder) =
        (path.canonicalize().map_err(io)?, folder.canonicalize().map_err(io)?);
    if real.starts_with(real_folder) { Ok(path) } else { Err(error()) }
}

/// The lines of a log.
pub(crate) fn read_log(path: &Path) -> Result<Vec<String>, ReadError> {
    Ok(file::text(path, MOST_LOG)?.lines().map(str::to_owned).collect())
}

/// The channels to open.
pub(crate) fn asked<'a>(
    path: &Path,
    description: &'a Description,
    ask: &Ask,
) -> Result<Vec<&'a Channel>, ReadError> {
    let has = |kind| description.channel(kind).is_some();
    let kinds = match ask {
        Ask::All => return Ok(description.channels.iter().collect()),
        Ask::Only(kinds) => kinds.clone(),
        Ask::Picture => {
            let mut kinds = if COLOR.into_iter().any(has) {
                COLOR.to_vec()
            } else if has(Kind::Enc) && !has(Kind::Grg) {
                vec![Kind::Enc, Kind::Lut]
            } else if has(Kind::Grg) || !has(Kind::Cvg) {
                vec![Kind::Grg]
            } else {
                Vec::new()
            };
            kinds.extend(has(Kind::Cvg).then_some(Kind::Cvg));
            kinds
        }
    };
    let find = |&kind: &Kind| {
        description.channel(kind).ok_or_else(|| ReadError::Missing {
            path: path.into(),
            kind,
            present: description.channels.iter().map(|channel| channel.kind).collect(),
        })
    };
    let first = |&(at, kind): &(usize, &Kind)| !kinds[..at].contains(kind);
    kinds.iter().enumerate().filter(first).map(|(_, kind)| find(kind)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::Samples;
    use std::fs;

    /// A folder with a description `x.idf` of the given lines, and files.
    fn folder(lines: &str, files: &[(&str, &[u8])]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("x.idf"), format!("idf 1\nsize 2 2\n{lines}")).unwrap();
        for (name, bytes) in files {
            fs::write(folder.path().join(name), bytes).unwrap();
        }
        folder
    }

    fn read_in(folder: &tempfile::TempDir, ask: Ask) -> Result<Image, ReadError> {
        read(&folder.path().join("x"), &ReadOptions { ask, ..ReadOptions::default() })
    }

    fn message(folder: &tempfile::TempDir, ask: Ask) -> String {
        let prefix = format!("{}/", folder.path().display());
        read_in(folder, ask).unwrap_err().to_string().replace(&prefix, "")
    }

    #[test]
    fn only_what_is_asked_for_is_opened() {
        let folder = folder("red gone 2 2 8 raw\ncvg x.cvg 2 2 8 raw", &[("x.cvg", &[1, 2, 3, 4])]);
        let image = read_in(&folder, Ask::Only(vec![Kind::Cvg])).unwrap();
        assert_eq!(image.plane(Kind::Cvg), Some(&Samples::U8(vec![1, 2, 3, 4])));
        assert_eq!(message(&folder, Ask::All), "cannot read `gone`");
        assert_eq!(
            message(&folder, Ask::Only(vec![Kind::Blu])),
            "x.idf: no channel `blu`, found red cvg"
        );
    }

    #[test]
    fn a_picture_is_color_then_grey_then_indices() {
        let files: [(&str, &[u8]); 2] = [("p", &[0, 1, 2, 3]), ("l", &[7; 12])];
        let plane = |kinds: &str| {
            kinds.split(' ').map(|k| format!("{k} p 2 2 8 raw\n")).collect::<String>()
        };
        let lut = "lut l 4 3 8 raw\n";
        let kinds = |lines: &str| read_in(&folder(lines, &files), Ask::Picture).unwrap().kinds();
        let all = plane("enc grg red grn blu cvg") + lut;
        assert_eq!(kinds(&all), [Kind::Red, Kind::Grn, Kind::Blu, Kind::Cvg]);
        assert_eq!(kinds(&(plane("enc grg") + lut)), [Kind::Grg]);
        assert_eq!(kinds(&(plane("enc") + lut)), [Kind::Enc, Kind::Lut]);
        let half = folder(&plane("red blu enc"), &files);
        assert_eq!(message(&half, Ask::Picture), "x.idf: no channel `grn`, found red blu enc");
    }

    #[test]
    fn channels_of_two_sizes_open_one_at_a_time() {
        let lines = "red r 2 2 8 raw\ncvg c 1 1 8 raw";
        let folder = folder(lines, &[("r", &[1, 2, 3, 4]), ("c", &[9])]);
        let image = read_in(&folder, Ask::Only(vec![Kind::Cvg])).unwrap();
        assert_eq!(image.size(), [1, 1]);
        assert_eq!(
            message(&folder, Ask::All),
            "x.idf: expected channels of one size, found `red` with 2 x 2 and `cvg` with 1 x 1; \
             copy one alone with icopy --channels cvg --resize 2x2"
        );
    }

    #[test]
    fn files_have_the_length_of_their_samples() {
        let files: [(&str, &[u8]); 1] = [("r", &[1, 2, 3])];
        let raw = folder("red r 2 2 8 raw", &files);
        assert_eq!(message(&raw, Ask::All), "r: 3 bytes, expected 4 for 2 x 2 samples of depth 8");
        // Huge by its text: refused by the file's length, before memory is taken.
        let huge = folder("red r 16777216 128 32f rle", &files);
        assert_eq!(
            message(&huge, Ask::All),
            "r: 3 bytes, expected 134218240 to 8657043968 for 16777216 x 128 samples of depth 32f"
        );
    }

    #[test]
    fn names_stay_in_the_folder_unless_they_may_leave() {
        let other = tempfile::tempdir().unwrap();
        let away = other.path().join("away");
        fs::write(&away, [1, 2, 3, 4]).unwrap();
        let outside = ReadOptions { outside: true, ..ReadOptions::default() };
        let up = format!("../{}/away", other.path().file_name().unwrap().to_str().unwrap());
        for name in [away.to_str().unwrap(), &up] {
            let folder = folder(&format!("red {name} 2 2 8 raw"), &[]);
            assert_eq!(
                message(&folder, Ask::All),
                format!(
                    "x.idf: expected files in its own folder, found `{name}`; if you trust it, \
                     say --outside"
                )
            );
            assert!(read(&folder.path().join("x.idf"), &outside).is_ok(), "{name}");
        }
    }

    #[test]
    fn a_name_does_not_tell_what_is_outside() {
        for name in ["../gone", "/gone", "a/../../gone"] {
            let error = read_in(&folder(&format!("red {name} 2 2 8 raw"), &[]), Ask::All);
            assert!(matches!(error, Err(ReadError::Outside { .. })), "{error:?}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_and_devices_are_no_way_out() {
        let other = tempfile::tempdir().unwrap();
        fs::write(other.path().join("away"), [1, 2, 3, 4]).unwrap();
        let folder = folder("red r 2 2 8 raw\ngrn . 2 2 8 raw", &[]);
        std::os::unix::fs::symlink(other.path().join("away"), folder.path().join("r")).unwrap();
        let error = read_in(&folder, Ask::Only(vec![Kind::Red]));
        assert!(matches!(error, Err(ReadError::Outside { .. })), "{error:?}");
        let error = read_in(&folder, Ask::Only(vec![Kind::Grn]));
        assert!(matches!(error, Err(ReadError::NotAFile { .. })), "{error:?}");
    }
}
