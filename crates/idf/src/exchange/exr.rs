//! `OpenEXR`: light as linear premultiplied floating point, measured channels as they are.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use exr::compression::Compression;
use exr::image::write::WritableImage;
use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Layer};
use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::attribute::{LineOrder, Text};
use exr::meta::header::LayerAttributes;
use exr::prelude::{ReadChannels, ReadLayers, SmallVec, read};

use super::{EncodeError, Format, picture_kinds};
use crate::convert::Form;
use crate::error::Cause;
use crate::image::{Image, ImageError, Matte, Plane};
use crate::plane::{COLOR, Kind, Role};
use crate::samples::{Depth, Samples};
use crate::transfer::Transfer;

/// A channel of a file.
struct Row {
    kind: Kind,
    /// The name here, and in most files.
    name: &'static str,
    /// Names elsewhere, in small letters, alone or after a layer's name and a dot.
    others: &'static [&'static str],
}

/// All channels. Light and coverage go by their name alone; colour is preferred to grey.
const CHANNELS: [Row; 10] = [
    Row { kind: Kind::Red, name: "R", others: &[] },
    Row { kind: Kind::Grn, name: "G", others: &[] },
    Row { kind: Kind::Blu, name: "B", others: &[] },
    Row { kind: Kind::Grg, name: "Y", others: &[] },
    Row { kind: Kind::Cvg, name: "A", others: &[] },
    Row { kind: Kind::Dep, name: "Z", others: &["depth", "depth.z", "depth.v", "dep"] },
    Row { kind: Kind::Nrx, name: "N.X", others: &["n.x", "normal.x", "normals.x", "nx", "nrx"] },
    Row { kind: Kind::Nry, name: "N.Y", others: &["n.y", "normal.y", "normals.y", "ny", "nry"] },
    Row { kind: Kind::Nrz, name: "N.Z", others: &["n.z", "normal.z", "normals.z", "nz", "nrz"] },
    Row { kind: Kind::Obj, name: "id", others: &["objectid", "object.id", "indexob.x", "obj"] },
];

/// Largest whole number up to which floating point has them all.
const MOST_WHOLE: u32 = 1 << 24;

type Channel = AnyChannel<FlatSamples>;

pub(super) fn decode(bytes: &[u8]) -> Result<Image, Cause> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false)?;
    for header in &meta.headers {
        let size = [header.layer_size.width() as u64, header.layer_size.height() as u64];
        let channels = (meta.headers.len() * header.channels.list.len()) as u64;
        Format::Exr.check_samples(size, channels, bytes.len())?;
    }
    let reader = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        // A panic in one of the library's own threads would end the process.
        .non_parallel();
    // Damaged B44 blocks overflow in builds that check for it (exr 1.74, b44/mod.rs, unpack14).
    let file = catch_unwind(AssertUnwindSafe(|| reader.from_buffered(Cursor::new(bytes))))
        .map_err(|_| "the samples are damaged")??;
    let found = |layer: &Layer<AnyChannels<FlatSamples>>, needs_light: bool| {
        let list = &layer.channel_data.list;
        let prefix = prefix(list);
        if needs_light && prefix.is_none() {
            return Ok(None);
        }
        let planes = planes(list, &prefix.unwrap_or_default())?;
        if planes.is_empty() {
            return Ok(None);
        }
        let columns = u32::try_from(layer.size.width())?;
        let mut image = Image::new(columns, u32::try_from(layer.size.height())?, planes)?;
        let position = layer.attributes.layer_position;
        image.properties.origin = [position.x(), position.y()];
        Ok::<_, Cause>(Some(image))
    };
    for needs_light in [true, false] {
        for layer in &file.layer_data {
            if let Some(image) = found(layer, needs_light)? {
                return Ok(image);
            }
        }
    }
    let list = file.layer_data.iter().flat_map(|layer| &layer.channel_data.list);
    let names: Vec<String> = list.map(|channel| channel.name.to_string()).collect();
    let expected: Vec<&str> = CHANNELS.iter().map(|row| row.name).collect();
    let (expected, names) = (expected.join(" "), names.join(" "));
    Err(format!("expected channels of {expected}, found {names}").into())
}

/// What the names of a layer's channels begin with: nothing, or the first `group.` with a colour.
fn prefix(list: &[Channel]) -> Option<String> {
    let names: Vec<String> = list.iter().map(|channel| channel.name.to_string()).collect();
    let holds = |prefix: &str, channel: &str| names.contains(&format!("{prefix}{channel}"));
    let is_light = |prefix: &str| {
        // With X and Z beside it, Y is one of three coordinates.
        let is_vector = holds(prefix, "X") && holds(prefix, "Z");
        holds(prefix, "Y") && !is_vector || ["R", "G", "B"].iter().all(|c| holds(prefix, c))
    };
    let prefixes = names.iter().map(|name| name.rfind('.').map_or("", |dot| &name[..=dot]));
    std::iter::once("").chain(prefixes).find(|prefix| is_light(prefix)).map(str::to_owned)
}

/// The known channels of a layer, in the order of the table.
fn planes(list: &[Channel], prefix: &str) -> Result<Vec<Plane>, Cause> {
    let named = |name: &str| {
        list.iter().find(|channel| channel.name.to_string() == format!("{prefix}{name}"))
    };
    let also = |row: &Row| {
        list.iter().find(|channel| {
            let name = channel.name.to_string().to_ascii_lowercase();
            row.others.iter().any(|&other| {
                name.strip_suffix(other).is_some_and(|head| head.is_empty() || head.ends_with('.'))
            })
        })
    };
    let has_color = ["R", "G", "B"].into_iter().all(|name| named(name).is_some());
    let mut planes = Vec::new();
    for row in &CHANNELS {
        let wanted = match row.kind.role() {
            Role::Light => COLOR.contains(&row.kind) == has_color,
            _ => true,
        };
        let Some(channel) = named(row.name).or_else(|| also(row)).filter(|_| wanted) else {
            continue;
        };
        if channel.sampling != Vec2(1, 1) {
            let name = &channel.name;
            return Err(format!("expected a sample for each pixel in channel `{name}`").into());
        }
        planes.push(Plane { kind: row.kind, samples: samples(row.kind, channel)? });
    }
    Ok(planes)
}

fn samples(kind: Kind, channel: &Channel) -> Result<Samples, Cause> {
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
    let image = image.resolved()?;
    let measured = |row: &&Row| row.kind.role() == Role::Data && image.plane(row.kind).is_some();
    let data: Vec<Kind> = CHANNELS.iter().filter(measured).map(|row| row.kind).collect();
    let light = match picture_kinds(&image) {
        Err(ImageError::Missing { kind: Kind::Grg, .. }) if !data.is_empty() => Vec::new(),
        kinds => kinds?,
    };
    let form = Form { depth: Depth::F32, transfer: Transfer::Linear, matte: Matte::Premultiplied };
    let image = image.converted(form)?;
    let mut channels = SmallVec::new();
    for row in &CHANNELS {
        // Coverage alone is grey.
        let name = if light == [Kind::Cvg] && row.kind == Kind::Cvg { "Y" } else { row.name };
        let samples = if light.contains(&row.kind) {
            FlatSamples::F32(image.decoded(row.kind)?)
        } else if data.contains(&row.kind) {
            measurements(&image, row.kind)?
        } else {
            continue;
        };
        channels.push(AnyChannel::new(Text::from(name), samples));
    }
    let [column, row] = image.properties.origin;
    let attributes =
        LayerAttributes { layer_position: Vec2(column, row), ..LayerAttributes::default() };
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let size = Vec2(image.columns() as usize, image.rows() as usize);
    let layer = Layer::new(size, attributes, encoding, AnyChannels::sort(channels));
    let mut file = Cursor::new(Vec::new());
    let result = exr::image::Image::from_layer(layer).write().to_buffered(&mut file);
    result.map_err(|error| EncodeError::Library(error.into()))?;
    Ok(file.into_inner())
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
