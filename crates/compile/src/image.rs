//! Files of pictures that paint shows: where they are, whether they can be opened, and each once.

use std::collections::HashMap;
use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use scene::{ImageFile, ImageId, Scene};

use crate::diagnostic::Diagnostic;
use crate::shared::Shared;
use crate::source::{SourceMap, Span, shown};

/// Names of files as they are met, by the place that names them: a body that is read several times names them once.
#[derive(Debug, Default)]
pub(crate) struct ImageNames {
    by_span: HashMap<Span, ImageId>,
    names: Vec<(Span, String)>,
}

impl ImageNames {
    /// The number of the file that `name` at `span` means, for the time being.
    pub(crate) fn add(&mut self, name: &str, span: Span) -> ImageId {
        *self.by_span.entry(span).or_insert_with(|| {
            self.names.push((span, name.to_owned()));
            let number = u32::try_from(self.names.len() - 1);
            ImageId(number.expect("sources are shorter than 2³² bytes"))
        })
    }
}

/// Finds the files that were named, and gives each the number that it has in the scene.
pub(crate) fn resolve(sources: &SourceMap, shared: &mut Shared) {
    let names = std::mem::take(&mut shared.images.names);
    let mut used = vec![false; names.len()];
    let textures = |scene: &Scene| -> Vec<ImageId> {
        let coats = scene.attributes.iter().flat_map(|attributes| &attributes.paint);
        coats.filter_map(|coat| coat.texture.image()).collect()
    };
    for ImageId(image) in textures(&shared.scene) {
        used[image as usize] = true;
    }
    let mut by_identity: HashMap<PathBuf, ImageId> = HashMap::new();
    let mut seen: HashMap<PathBuf, Result<(), String>> = HashMap::new();
    let mut numbers = Vec::with_capacity(names.len());
    for ((span, name), used) in names.into_iter().zip(used) {
        let found = find(sources, span, &name).and_then(|(file, identity)| {
            let Some(look) = shared.look else { return Ok((file, identity)) };
            let seen = seen.entry(identity.clone()).or_insert_with(|| look(Path::new(&file.path)));
            match seen {
                Ok(()) => Ok((file, identity)),
                Err(reason) => Err(unshown(span, reason)),
            }
        });
        let number = match found {
            Ok((file, identity)) if used => *by_identity.entry(identity).or_insert_with(|| {
                shared.scene.images.push(file);
                let number = u32::try_from(shared.scene.images.len() - 1);
                ImageId(number.expect("sources are shorter than 2³² bytes"))
            }),
            Ok(_) => ImageId(0),
            Err(error) => {
                shared.diagnostics.push(error);
                ImageId(0)
            }
        };
        numbers.push(number);
    }
    for attributes in &mut shared.scene.attributes {
        for coat in &mut attributes.paint {
            coat.texture.renumber_image(|ImageId(image)| numbers[image as usize]);
        }
    }
}

/// What is said of a file that is there and shows nothing.
fn unshown(span: Span, reason: &str) -> Diagnostic {
    Diagnostic::error(span, format!("cannot show the picture: {reason}"))
}

/// That a picture of a scene from these sources cannot be shown, with the line that names it; nothing if it is none of
/// theirs.
#[must_use]
pub fn report(sources: &SourceMap, file: &ImageFile, reason: &str) -> Option<String> {
    let span = sources.quoted_at(Path::new(&file.source), file.line, file.column)?;
    Some(unshown(span, reason).human(sources))
}

/// The file that `name` at `span` means, and what it is told apart by.
fn find(sources: &SourceMap, span: Span, name: &str) -> Result<(ImageFile, PathBuf), Diagnostic> {
    let failed = |path: &Path, reason: String| {
        let hint = match Path::new(name).extension() {
            Some(_) => "the path of a picture begins at the file that names it",
            None => "a name without ending is that of an IDF image",
        };
        Diagnostic::error(span, format!("cannot read `{}`: {reason}", shown(path)))
            .hint(hint.to_owned())
    };
    let source = sources.locate(span).expect("a name is in a source");
    let path = source.path.parent().map_or_else(|| PathBuf::from(name), |folder| folder.join(name));
    // A name without ending is that of a description; `.` and `..` are no names.
    let named = matches!(Path::new(name).components().next_back(), Some(Component::Normal(_)));
    let whole = !named || path.extension().is_some();
    let file = if whole { path.clone() } else { path.with_extension("idf") };
    check(&file).map_err(|reason| failed(&file, reason))?;
    let identity = file.canonicalize().unwrap_or(file);
    let text = |path: &Path| path.to_str().map(str::to_owned);
    match (text(&path), text(source.path)) {
        (Some(path), Some(text)) => {
            let (source, line, column) = (text, source.line, source.column);
            Ok((ImageFile { path, source, line, column }, identity))
        }
        _ => Err(failed(&path, "expected a path in UTF-8".to_owned())),
    }
}

/// Whether there is something to read.
fn check(path: &Path) -> Result<(), String> {
    let said = |error: std::io::Error| error.to_string();
    // A device or a pipe could keep the compiler waiting for ever.
    if !std::fs::metadata(path).map_err(said)?.is_file() {
        return Err("expected a file".to_owned());
    }
    let mut file = File::open(path).map_err(said)?;
    match file.read(&mut [0]) {
        Ok(0) => Err("expected a picture, found an empty file".to_owned()),
        Ok(_) => Ok(()),
        Err(error) => Err(error.to_string()),
    }
}

/// Moves the paths of a scene to begin at `folder` instead of the working folder: what is done before it is written there.
#[cfg(feature = "command")]
pub fn rebase(scene: &mut Scene, folder: &Path) {
    for image in &mut scene.images {
        image.path = relative(&image.path, folder);
    }
}

#[cfg(feature = "command")]
/// `path` from `folder`, or as it is where there is no way.
fn relative(path: &str, folder: &Path) -> String {
    let way = || {
        let path = Path::new(path);
        let parent = path.parent().filter(|parent| *parent != Path::new(""));
        let parent = parent.unwrap_or(Path::new(".")).canonicalize().ok()?;
        let folder = folder.canonicalize().ok()?;
        let (mut up, mut base) = (PathBuf::new(), folder.as_path());
        while !parent.starts_with(base) {
            base = base.parent()?;
            up.push("..");
        }
        let down = parent.strip_prefix(base).ok()?;
        up.join(down).join(path.file_name()?).to_str().map(str::to_owned)
    };
    way().unwrap_or_else(|| path.to_owned())
}

#[cfg(all(test, feature = "command"))]
mod tests {
    use super::*;

    #[test]
    fn ways_lead_from_the_folder_of_the_output() {
        let root = tempfile::TempDir::new().unwrap();
        for folder in ["a/b", "c"] {
            std::fs::create_dir_all(root.path().join(folder)).unwrap();
        }
        let at = |path: &str| root.path().join(path).to_str().unwrap().to_owned();
        for (path, folder, expected) in [
            ("a/wall.png", "a", "wall.png"),
            ("a/b/../wall.png", "a", "wall.png"),
            ("a/b/wall.png", "a", "b/wall.png"),
            ("c/wall.png", "a/b", "../../c/wall.png"),
            ("wall.png", "a", "../wall.png"),
        ] {
            assert_eq!(relative(&at(path), &root.path().join(folder)), expected, "{path} {folder}");
        }
        assert_eq!(relative("no such folder/x.png", root.path()), "no such folder/x.png");
    }
}
