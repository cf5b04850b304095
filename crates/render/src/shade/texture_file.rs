//! Pictures that paint shows, as they come from their files: each read once, in linear light.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use idf::{Image, Kind, Matte};
use scene::{ImageFile, Scene};

use super::pyramid::Pyramid;

/// A picture as paint shows it.
#[derive(Debug, Default)]
pub(crate) struct Picture {
    /// Linear red, green and blue times coverage, and coverage; only if some paint shows colours.
    pub(crate) colors: Option<Pyramid<4>>,
    /// Weight times coverage; only if some paint takes it for a weight.
    pub(crate) weights: Option<Pyramid<1>>,
}

/// Most texels of all pictures of a scene, in 1.4 GB of levels.
pub(crate) const TEXELS_LIMIT: u64 = 1 << 26;

/// Why a picture cannot be shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImageFailure {
    /// The name in the description.
    pub file: ImageFile,
    /// What is wrong, with the path of the file.
    pub reason: String,
}

impl std::fmt::Display for ImageFailure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ImageFile { source, line, column, .. } = &self.file;
        write!(f, "{source}:{line}:{column}: {}", self.reason)
    }
}

/// What paint asks of each picture: its colours, its weights.
fn asked(scene: &Scene) -> Vec<[bool; 2]> {
    let mut asked = vec![[false; 2]; scene.images.len()];
    for coat in scene.attributes.iter().flat_map(|attributes| &attributes.paint) {
        let Some(image) = coat.texture.image() else { continue };
        let relief = coat.texture.inner().is_some();
        let [colors, weights] = &mut asked[image.0 as usize];
        *colors |= !relief && coat.color.is_none();
        *weights |= relief || coat.color.is_some();
    }
    asked
}

/// Pictures that were read for a scene and are kept for the next one, or for the same from elsewhere.
#[derive(Clone, Debug, Default)]
pub struct PictureCache {
    /// By the path in the scene and what is asked. A copy shares them.
    known: BTreeMap<(String, [bool; 2]), Kept>,
}

#[derive(Clone, Debug)]
struct Kept {
    picture: Arc<Picture>,
    texels: u64,
}

impl PictureCache {
    /// Has the picture of a file read again, by the path of the file that it is read from.
    pub fn forget(&mut self, changed: &Path) {
        self.known.retain(|(path, _), _| idf::description_path(Path::new(path)) != changed);
    }

    /// The pictures of a scene: those that are known, and the others read, each once. What the scene does not show is
    /// forgotten.
    pub(crate) fn read_all(&mut self, scene: &Scene) -> Result<Vec<Arc<Picture>>, ImageFailure> {
        let mut before = std::mem::take(&mut self.known);
        let mut texels = 0;
        let mut shown = Vec::with_capacity(scene.images.len());
        for (file, asked) in scene.images.iter().zip(asked(scene)) {
            let key = (file.path.clone(), asked);
            let kept = match before.remove(&key).or_else(|| self.known.get(&key).cloned()) {
                Some(kept) => kept,
                None => {
                    let begun = texels;
                    let picture = Arc::new(picture(file, asked, &mut texels)?);
                    let read = texels - begun;
                    texels = begun;
                    Kept { picture, texels: read }
                }
            };
            texels += kept.texels;
            shown.push(Arc::clone(&kept.picture));
            self.known.insert(key, kept);
        }
        Ok(shown)
    }
}

/// Reads a file for what is asked of it; `texels` counts those of all.
fn picture(
    file: &ImageFile,
    [colors, weights]: [bool; 2],
    texels: &mut u64,
) -> Result<Picture, ImageFailure> {
    if !colors && !weights {
        return Ok(Picture::default());
    }
    let failed = |reason| ImageFailure { file: file.clone(), reason };
    let path = Path::new(&file.path);
    let image = idf::exchange::read_picture(path).map_err(|error| failed(error.to_string()))?;
    let [columns, rows] = image.size();
    *texels += u64::from(columns) * u64::from(rows) * (u64::from(colors) + u64::from(weights));
    if *texels > TEXELS_LIMIT {
        return Err(failed(format!(
            "{}: {columns} x {rows} pixels, expected at most {TEXELS_LIMIT} in all pictures of a \
             scene; make it smaller with icopy --resize",
            path.display()
        )));
    }
    let said = |error: idf::ImageError| failed(format!("{}: {error}", path.display()));
    Ok(Picture {
        colors: colors.then(|| color_pyramid(&image)).transpose().map_err(said)?,
        weights: weights.then(|| weight_pyramid(&image)).transpose().map_err(said)?,
    })
}

/// A number as a colour or a share: what floating point has beyond is cut.
fn share(value: f32) -> f32 {
    // Also what is not a number.
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

fn size(image: &Image) -> (usize, usize) {
    (image.columns() as usize, image.rows() as usize)
}

fn coverage(image: &Image) -> Result<Option<Vec<f32>>, idf::ImageError> {
    image.plane(Kind::Cvg).map(|_| image.decoded(Kind::Cvg)).transpose()
}

/// Colours as they are seen: of grey, and of coverage alone, the same in all channels.
fn color_pyramid(image: &Image) -> Result<Pyramid<4>, idf::ImageError> {
    let image = image.with_matte(Matte::Premultiplied)?;
    let kinds = image.light_kinds()?;
    let planes: Vec<Vec<f32>> =
        kinds.iter().map(|&kind| image.decoded(kind)).collect::<Result<_, _>>()?;
    let coverage = coverage(&image)?;
    let (columns, rows) = size(&image);
    let texels = (0..columns * rows)
        .map(|i| {
            let covered = coverage.as_ref().map_or(1.0, |coverage| share(coverage[i]));
            let channel = |k: usize| match planes.len() {
                0 => covered,
                1 => share(planes[0][i]),
                _ => share(planes[k][i]),
            };
            [channel(0), channel(1), channel(2), covered]
        })
        .collect();
    Ok(Pyramid::new(columns, rows, texels))
}

/// Share of the channels of a colour, as it is displayed, in its grey (ITU-R BT.709).
const LUMA: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Grey as it is stored, not decoded; of a picture in colour without grey its brightness as it is displayed; of coverage
/// alone, that.
fn weight_pyramid(image: &Image) -> Result<Pyramid<1>, idf::ImageError> {
    let mut straight = image.with_matte(Matte::Straight)?;
    // Stored values are taken as they are.
    straight.properties.transfer = Some(idf::Transfer::Linear);
    let kinds = if straight.plane(Kind::Grg).is_some() {
        vec![Kind::Grg]
    } else {
        straight.light_kinds()?
    };
    let planes: Vec<Vec<f32>> =
        kinds.iter().map(|&kind| straight.decoded(kind)).collect::<Result<_, _>>()?;
    let coverage = coverage(&straight)?;
    let (columns, rows) = size(&straight);
    let texels = (0..columns * rows)
        .map(|i| {
            let covered = coverage.as_ref().map_or(1.0, |coverage| share(coverage[i]));
            let weight = match planes.as_slice() {
                [] => 1.0,
                [grey] => share(grey[i]),
                colors => LUMA.iter().zip(colors).map(|(luma, plane)| luma * share(plane[i])).sum(),
            };
            [weight * covered]
        })
        .collect();
    Ok(Pyramid::new(columns, rows, texels))
}
