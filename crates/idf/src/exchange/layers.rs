//! What an `OpenEXR` file holds besides its picture: layers, and channels of other names.

use std::io::Read;
use std::path::Path;

use exr::image::FlatSamples;
use exr::prelude::f16;

use super::{
    Format, MOST_BYTES, chosen, exr as open_exr, read_stream, stream_bytes, too_long, undecoded,
    write_error,
};
use crate::error::{ReadError, WriteError};
use crate::file;
use crate::image::{Image, ImageError, Plane, Properties, checked_size};
use crate::plane::Kind;
use crate::read::ReadOptions;
use crate::samples::Samples;

/// Channels of an `OpenEXR` file that are no planes of its image, and the names of those that are.
/// Empty for all other images.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layers {
    /// Names in the file of the planes of the image.
    pub(super) names: Vec<(Kind, String)>,
    /// The name of the part that the image is from.
    pub(super) part: String,
    pub(super) channels: Vec<Channel>,
}

/// A channel as the file has it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Channel {
    /// The name of its part, as files of several have it.
    pub(super) part: String,
    pub(super) name: String,
    pub(super) size: [u32; 2],
    pub(super) origin: [i32; 2],
    pub(super) samples: FlatSamples,
}

impl Channel {
    /// Whether `word` names the channel, its layer (what is before the last dot), or its part.
    pub(super) fn is_of(&self, word: &str) -> bool {
        names_channel(word, &self.part, &self.name)
    }

    /// As an image whose pixels can be moved: the two halves of whole numbers apart, so that all
    /// are kept.
    fn to_image(&self) -> Option<Image> {
        let plane = |kind, samples| Plane { kind, samples };
        let planes = match &self.samples {
            FlatSamples::F32(values) => vec![plane(Kind::Dep, Samples::F32(values.clone()))],
            FlatSamples::F16(values) => {
                let values = values.iter().map(|value| value.to_f32()).collect();
                vec![plane(Kind::Dep, Samples::F32(values))]
            }
            FlatSamples::U32(numbers) => {
                let half = |shift: u32| {
                    Samples::U16(numbers.iter().map(|number| low_half(number >> shift)).collect())
                };
                vec![plane(Kind::Nrx, half(0)), plane(Kind::Nry, half(16))]
            }
        };
        let mut image = Image::new(self.size[0], self.size[1], planes).ok()?;
        image.properties = Properties { origin: self.origin, ..Properties::default() };
        Some(image)
    }

    /// The reverse of `to_image`.
    fn set_image(&mut self, image: &Image) -> Option<()> {
        self.samples = match &self.samples {
            FlatSamples::U32(_) => {
                let [Samples::U16(low), Samples::U16(high)] =
                    [image.plane(Kind::Nrx)?, image.plane(Kind::Nry)?]
                else {
                    return None;
                };
                let whole = low.iter().zip(high);
                FlatSamples::U32(whole.map(|(&l, &h)| u32::from(h) << 16 | u32::from(l)).collect())
            }
            other => {
                let Samples::F32(values) = image.plane(Kind::Dep)? else { return None };
                match other {
                    FlatSamples::F16(_) => {
                        FlatSamples::F16(values.iter().map(|&value| f16::from_f32(value)).collect())
                    }
                    _ => FlatSamples::F32(values.clone()),
                }
            }
        };
        (self.size, self.origin) = (image.size(), image.properties.origin);
        Some(())
    }
}

fn low_half(number: u32) -> u16 {
    let [a, b, ..] = number.to_le_bytes();
    u16::from_le_bytes([a, b])
}

/// Whether `word` names a channel, its layer or its part.
pub(super) fn names_channel(word: &str, part: &str, name: &str) -> bool {
    let layer = name.rsplit_once('.').map(|(layer, _)| layer);
    word == name || layer == Some(word) || word == part
}

impl Layers {
    /// Whether there is nothing besides the image.
    pub fn is_empty(&self) -> bool {
        self.channels.is_empty()
    }

    /// What there is besides the image, by names: layers, and channels that are in none.
    pub fn words(&self) -> Vec<String> {
        let mut words: Vec<String> = Vec::new();
        for channel in &self.channels {
            let word = word(&channel.part, &channel.name);
            if !words.contains(&word) {
                words.push(word);
            }
        }
        words
    }

    /// Adds a channel of floating point beside those of `image`, row by row from the top.
    ///
    /// # Errors
    ///
    /// If there are not as many values as pixels.
    pub fn add(&mut self, name: &str, image: &Image, values: Vec<f32>) -> Result<(), ImageError> {
        let (size, origin) = (image.size(), image.properties.origin);
        let (found, expected) = (values.len(), checked_size(size[0], size[1])?);
        if found as u64 != expected {
            return Err(ImageError::Length { kind: Kind::Dep, found, expected });
        }
        let (part, name) = (self.part.clone(), name.to_owned());
        self.channels.push(Channel { part, name, size, origin, samples: FlatSamples::F32(values) });
        Ok(())
    }

    /// Only the channels that one of `words` names: a channel, a layer or a part.
    pub fn retain(&mut self, words: &[String]) {
        self.channels.retain(|channel| words.iter().any(|word| channel.is_of(word)));
    }

    /// Whether `word` names something.
    pub fn has(&self, word: &str) -> bool {
        self.channels.iter().any(|channel| channel.is_of(word))
    }

    /// The image's channels are written by their usual names.
    pub fn forget_names(&mut self) {
        self.names.clear();
    }

    /// Changes the pixels of each channel as those of `image`, with which they came, are changed, by
    /// way of an image with measured values. Channels that lie elsewhere are left out, and whole
    /// numbers where the change `mixes` values; their names are given back.
    ///
    /// # Errors
    ///
    /// What `change` gives.
    pub fn change<E>(
        &mut self,
        image: &Image,
        mixes: bool,
        change: impl Fn(&Image) -> Result<Image, E>,
    ) -> Result<Vec<String>, E> {
        let mut elsewhere = Self::default();
        for mut channel in std::mem::take(&mut self.channels) {
            let place = (image.size(), image.properties.origin);
            let is_whole = matches!(channel.samples, FlatSamples::U32(_));
            let lies_so = (channel.size, channel.origin) == place;
            let can = lies_so && !(mixes && is_whole);
            if let Some(image) = can.then(|| channel.to_image()).flatten() {
                let changed = change(&image)?;
                if channel.set_image(&changed).is_some() {
                    self.channels.push(channel);
                    continue;
                }
            }
            elsewhere.channels.push(channel);
        }
        Ok(elsewhere.words())
    }
}

/// The layer of a channel, or its part where the name is a letter alone, else its own name.
pub(super) fn word(part: &str, name: &str) -> String {
    match name.rsplit_once('.') {
        Some((layer, _)) => layer.to_owned(),
        None if name.len() == 1 && !part.is_empty() => part.to_owned(),
        None => name.to_owned(),
    }
}

/// Reads an image in another format as [`read_image`](super::read_image) does, and of `OpenEXR` all
/// that is in the file besides. `picture` names the layer, part or channel that is to be the
/// picture; a channel that is neither light nor coverage by its name becomes grey.
///
/// # Errors
///
/// As [`read_image`](super::read_image), or if nothing is called `picture`.
pub fn read_layered(
    path: &Path,
    picture: Option<&str>,
    options: &ReadOptions,
) -> Result<(Image, Layers), ReadError> {
    let length = file::length(path)?;
    if length > MOST_BYTES {
        return Err(too_long(path, length));
    }
    let bytes = file::contents(path, length)?;
    let decoded = open_exr::decode_layered(&bytes, picture);
    let (image, layers) = decoded.map_err(|source| undecoded(path, source))?;
    Ok((chosen(path, image, &options.ask)?, layers))
}

/// Reads an image from a stream as [`read_stream`](super::read_stream) does, and of `OpenEXR` all that is in it
/// besides, as [`read_layered`].
///
/// # Errors
///
/// As [`read_layered`]; other formats have nothing that could be called `picture`.
pub fn read_stream_layered(
    name: &Path,
    stream: impl Read,
    picture: Option<&str>,
    options: &ReadOptions,
) -> Result<(Image, Layers), ReadError> {
    let bytes = stream_bytes(name, stream)?;
    if Format::of_bytes(&bytes) != Some(Format::Exr) {
        if let Some(picture) = picture {
            let source = format!("no layer or channel is called `{picture}`").into();
            return Err(undecoded(name, source));
        }
        return Ok((read_stream(name, &bytes[..], options)?, Layers::default()));
    }
    let decoded = open_exr::decode_layered(&bytes, picture);
    let (image, layers) = decoded.map_err(|source| undecoded(name, source))?;
    Ok((chosen(name, image, &options.ask)?, layers))
}

/// Writes an image as `OpenEXR`, with the layers of another such file.
///
/// # Errors
///
/// If the file cannot be written; the old one is then whole.
pub fn write_layered(path: &Path, image: &Image, layers: &Layers) -> Result<(), WriteError> {
    debug_assert_eq!(Format::of(path), Some(Format::Exr), "the one format that has layers");
    let bytes = open_exr::encode_layered(image, layers);
    file::replace(path, &bytes.map_err(|error| write_error(path, error))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(name: &str, samples: FlatSamples) -> Channel {
        Channel { part: String::new(), name: name.into(), size: [2, 1], origin: [3, 4], samples }
    }

    #[test]
    fn words_are_layers_and_channels_of_none() {
        let channels = ["diffuse.R", "diffuse.G", "mask", "a.b.X"]
            .map(|name| channel(name, FlatSamples::F32(vec![0.0; 2])));
        let mut layers = Layers { channels: channels.into(), ..Layers::default() };
        assert_eq!(layers.words(), ["diffuse", "mask", "a.b"]);
        layers.retain(&["diffuse.G".into(), "a.b".into()]);
        assert_eq!(layers.words(), ["diffuse", "a.b"]);
        assert_eq!(layers.channels.len(), 2);
        assert!(layers.has("a.b.X") && !layers.has("mask"));
    }

    #[test]
    fn samples_of_all_types_move_to_the_bit() {
        let types = [
            FlatSamples::F32(vec![f32::from_bits(0x7fc0_1234), 1.5]),
            FlatSamples::F16(vec![f16::from_f32(0.1), f16::from_f32(-7.0)]),
            FlatSamples::U32(vec![0xfedc_ba98, 7]),
        ];
        for samples in types {
            let mut layers =
                Layers { channels: vec![channel("x", samples.clone())], ..Layers::default() };
            let reversed = |image: &Image| {
                let plane = |plane: &Plane| Plane {
                    kind: plane.kind,
                    samples: plane.samples.gathered([1, 0].into_iter()),
                };
                image.with_planes(2, 1, image.planes().iter().map(plane).collect())
            };
            let image = layers.channels[0].to_image().unwrap();
            assert_eq!(layers.change(&image, false, reversed), Ok(Vec::new()));
            assert!(layers.channels[0].samples != samples);
            assert_eq!(layers.change(&image, false, reversed), Ok(Vec::new()));
            let bits = |samples: &FlatSamples| -> Vec<u32> {
                match samples {
                    FlatSamples::F32(values) => values.iter().map(|v| v.to_bits()).collect(),
                    FlatSamples::F16(values) => values.iter().map(|v| v.to_bits().into()).collect(),
                    FlatSamples::U32(values) => values.clone(),
                }
            };
            assert_eq!(bits(&layers.channels[0].samples), bits(&samples));
            let mut elsewhere = image.clone();
            elsewhere.properties.origin = [0, 0];
            assert_eq!(layers.change(&elsewhere, false, reversed), Ok(vec!["x".to_owned()]));
            assert!(layers.is_empty(), "what lies elsewhere is left out");
        }
    }
}
