//! `OpenEXR`: light as linear premultiplied floating point, measured channels as they are.

use std::io::Cursor;

use exr::compression::Compression;
use exr::image::write::WritableImage;
use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Layer};
use exr::math::Vec2;
use exr::meta::attribute::{IntegerBounds, LineOrder, Text};
use exr::meta::header::{ImageAttributes, LayerAttributes};
use exr::prelude::SmallVec;

use super::layers::{self, Layers};
use super::part::{CHANNELS, Channel, Choice, Part, Row};
use super::{EncodeError, picture_kinds};
use crate::convert::Form;
use crate::error::Cause;
use crate::image::{Image, ImageError, Matte, Plane};
use crate::memory;
use crate::plane::{Kind, Role};
use crate::samples::{Depth, Samples};
use crate::transfer::Transfer;

/// Largest whole number up to which floating point has them all.
const MOST_WHOLE: u32 = 1 << 24;

pub(super) fn decode(bytes: &[u8]) -> Result<Image, Cause> {
    decode_layered(bytes, None).map(|(image, _)| image)
}

/// The picture, or the one that `word` names, and all else.
pub(super) fn decode_layered(bytes: &[u8], word: Option<&str>) -> Result<(Image, Layers), Cause> {
    let parts = Part::all(bytes)?;
    let Some((at, choice)) = Part::picture(&parts, word) else {
        return Err(nothing(&parts, word).into());
    };
    let wanted = wanted(&parts, at, &choice);
    let mut planes = Vec::new();
    let mut layers = Layers { part: parts[at].name.clone(), ..Layers::default() };
    for &(part, row, channel) in &wanted {
        let channel = &parts[part].list[channel];
        planes.push(Plane { kind: row.kind, samples: samples(row.kind, channel)? });
        if part == at {
            layers.names.push((row.kind, channel.name.to_string()));
        }
    }
    let Part { size, origin, .. } = parts[at];
    let mut image = Image::new(size[0], size[1], planes)?;
    image.properties.origin = origin;
    for (part, Part { name, size, origin, list }) in parts.into_iter().enumerate() {
        for (channel, found) in list.into_iter().enumerate() {
            let is_used = wanted.iter().any(|&(p, _, c)| (p, c) == (part, channel));
            if is_used || found.sampling != Vec2(1, 1) {
                continue;
            }
            layers.channels.push(layers::Channel {
                part: name.clone(),
                name: found.name.to_string(),
                size,
                origin,
                samples: found.sample_data,
            });
        }
    }
    Ok((image, layers))
}

/// The channels that become planes: part, row, and place in the part.
fn wanted(parts: &[Part], at: usize, choice: &Choice) -> Vec<(usize, &'static Row, usize)> {
    let mut wanted: Vec<(usize, &Row, usize)> =
        parts[at].planes(choice).into_iter().map(|(row, channel)| (at, row, channel)).collect();
    // Measured values may be in a part of their own.
    for (other, part) in parts.iter().enumerate() {
        let lies_so = (part.size, part.origin) == (parts[at].size, parts[at].origin);
        let planes = if lies_so { part.planes(&Choice::of("")) } else { Vec::new() };
        for (row, channel) in planes {
            let is_new = wanted
                .iter()
                .all(|&(p, known, c)| known.kind != row.kind && (p, c) != (other, channel));
            if is_new && row.kind.role() == Role::Data {
                wanted.push((other, row, channel));
            }
        }
    }
    wanted
}

/// What to say where there is no picture.
fn nothing(parts: &[Part], word: Option<&str>) -> String {
    let list = parts.iter().flat_map(|part| part.list.iter().map(move |channel| (part, channel)));
    if let Some(word) = word {
        let mut words: Vec<String> = Vec::new();
        for (part, channel) in list {
            let word = layers::word(&part.name, &channel.name.to_string());
            if !words.contains(&word) {
                words.push(word);
            }
        }
        return format!("no layer or channel is called `{word}`, found {}", words.join(" "));
    }
    let names: Vec<String> = list.map(|(_, channel)| channel.name.to_string()).collect();
    let expected: Vec<&str> = CHANNELS.iter().map(|row| row.name).collect();
    format!("expected channels of {}, found {}", expected.join(" "), names.join(" "))
}

fn samples(kind: Kind, channel: &Channel) -> Result<Samples, Cause> {
    if channel.sampling != Vec2(1, 1) {
        let name = &channel.name;
        return Err(format!("expected a sample for each pixel in channel `{name}`").into());
    }
    let FlatSamples::U32(numbers) = &channel.sample_data else {
        return Ok(Samples::F32(channel.sample_data.values_as_f32().collect()));
    };
    let most = numbers.iter().copied().max().unwrap_or_default();
    if most > MOST_WHOLE {
        let name = &channel.name;
        return Err(format!("{most} in channel `{name}`, expected at most {MOST_WHOLE}").into());
    }
    if kind == Kind::Obj && u16::try_from(most).is_ok() {
        let word = |&number: &u32| u16::try_from(number).unwrap_or(u16::MAX);
        return Ok(Samples::U16(numbers.iter().map(word).collect()));
    }
    Ok(Samples::F32(channel.sample_data.values_as_f32().collect()))
}

pub(super) fn encode(image: &Image) -> Result<Vec<u8>, EncodeError> {
    encode_layered(image, &Layers::default())
}

/// The image and, beside it and in parts of their own, what came with another.
pub(super) fn encode_layered(image: &Image, layers: &Layers) -> Result<Vec<u8>, EncodeError> {
    let pixels = u64::from(image.columns()) * u64::from(image.rows());
    // A plane as it is converted, as a channel, and as blocks of the file.
    let planes = image.planes().len() as u64;
    memory::check(pixels.saturating_mul(3 * planes * size_of::<f32>() as u64))
        .map_err(ImageError::from)?;
    let image = image.resolved()?;
    let measured = |row: &&Row| row.kind.role() == Role::Data && image.plane(row.kind).is_some();
    let data: Vec<Kind> = CHANNELS.iter().filter(measured).map(|row| row.kind).collect();
    let light = match picture_kinds(&image) {
        Err(ImageError::Missing { kind: Kind::Grg, .. }) if !data.is_empty() => Vec::new(),
        kinds => kinds?,
    };
    let form = Form { depth: Depth::F32, transfer: Transfer::Linear, matte: Matte::Premultiplied };
    let image = image.converted(form)?;
    let mut list: Vec<Channel> = Vec::new();
    for row in &CHANNELS {
        let samples = if light.contains(&row.kind) {
            FlatSamples::F32(image.decoded(row.kind)?)
        } else if data.contains(&row.kind) {
            measurements(&image, row.kind)?
        } else {
            continue;
        };
        let own = layers.names.iter().find(|(kind, _)| *kind == row.kind);
        // Coverage alone is grey.
        let usual = if light == [Kind::Cvg] && row.kind == Kind::Cvg { "Y" } else { row.name };
        let name = own.map_or(usual, |(_, name)| name);
        list.push(AnyChannel::new(Text::from(name), samples));
    }
    let (name, size) = (layers.part.clone(), image.size());
    let mut parts = vec![Part { name, size, origin: image.properties.origin, list }];
    for layers::Channel { part, name, size, origin, samples } in &layers.channels {
        let channel = AnyChannel::new(Text::from(name.as_str()), samples.clone());
        let is_own =
            |found: &&mut Part| (&found.name, found.size, found.origin) == (part, *size, *origin);
        match parts.iter_mut().find(is_own) {
            // The image has a channel of this name anew.
            Some(found) if found.list.iter().any(|other| other.name == channel.name) => {}
            Some(found) => found.list.push(channel),
            None => parts.push(Part {
                name: part.clone(),
                size: *size,
                origin: *origin,
                list: vec![channel],
            }),
        }
    }
    written(parts)
}

fn written(parts: Vec<Part>) -> Result<Vec<u8>, EncodeError> {
    let is_one = parts.len() == 1;
    let bounds = bounds(&parts);
    let layer = |(at, part): (usize, Part)| {
        let encoding = Encoding {
            compression: Compression::ZIP16,
            blocks: Blocks::ScanLines,
            line_order: LineOrder::Increasing,
        };
        // Files of several parts need a name for each.
        let layer_name = match part.name.as_str() {
            "" if is_one => None,
            "" => Some(Text::from(format!("part{at}").as_str())),
            name => Some(Text::from(name)),
        };
        let [column, row] = part.origin;
        let layer_position = Vec2(column, row);
        let attributes =
            LayerAttributes { layer_name, layer_position, ..LayerAttributes::default() };
        let size = Vec2(part.size[0] as usize, part.size[1] as usize);
        let channels = AnyChannels::sort(SmallVec::from_vec(part.list));
        Layer::new(size, attributes, encoding, channels)
    };
    let layers: Vec<_> = parts.into_iter().enumerate().map(layer).collect();
    let mut file = Cursor::new(Vec::new());
    let image = exr::image::Image::from_layers(ImageAttributes::new(bounds), layers);
    let result = image.write().to_buffered(&mut file);
    result.map_err(|error| EncodeError::Library(error.into()))?;
    Ok(file.into_inner())
}

/// The window that holds all parts.
fn bounds(parts: &[Part]) -> IntegerBounds {
    let axis = |axis: usize| {
        let start = parts.iter().map(|part| part.origin[axis]).min().unwrap_or_default();
        let end =
            parts.iter().map(|part| i64::from(part.origin[axis]) + i64::from(part.size[axis]));
        let length = end.max().unwrap_or_default() - i64::from(start);
        // Beyond what the format has, the library says so.
        (start, usize::try_from(length).unwrap_or(usize::MAX))
    };
    let (column, columns) = axis(0);
    let (row, rows) = axis(1);
    IntegerBounds::new(Vec2(column, row), Vec2(columns, rows))
}

/// Numbers of objects as whole numbers where they are stored so, all else as floating point.
fn measurements(image: &Image, kind: Kind) -> Result<FlatSamples, ImageError> {
    Ok(match (kind, image.needed(kind)?) {
        (Kind::Obj, Samples::U8(numbers)) => {
            FlatSamples::U32(numbers.iter().map(|&number| number.into()).collect())
        }
        (Kind::Obj, Samples::U16(numbers)) => {
            FlatSamples::U32(numbers.iter().map(|&number| number.into()).collect())
        }
        _ => FlatSamples::F32(image.decoded(kind)?),
    })
}
