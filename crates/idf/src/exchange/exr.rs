//! `OpenEXR`: channels R G B A, or Y A, as linear premultiplied floating point.

use std::io::Cursor;

use exr::compression::Compression;
use exr::image::write::WritableImage;
use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Layer};
use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::attribute::{LineOrder, Text};
use exr::meta::header::LayerAttributes;
use exr::prelude::{ReadChannels, ReadLayers, SmallVec, read};

use super::{EncodeError, check_samples, picture_kinds};
use crate::convert::Form;
use crate::error::Cause;
use crate::image::{Image, Matte, Plane};
use crate::plane::{COLOR, Kind};
use crate::samples::{Depth, Samples};
use crate::transfer::Transfer;

/// Channel names with their kinds; colour is preferred to grey.
const CHANNELS: [(&str, Kind); 5] =
    [("R", Kind::Red), ("G", Kind::Grn), ("B", Kind::Blu), ("Y", Kind::Grg), ("A", Kind::Cvg)];

pub(super) fn decode(bytes: &[u8]) -> Result<Image, Cause> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false)?;
    for header in &meta.headers {
        let (columns, rows) = (header.layer_size.width() as u64, header.layer_size.height() as u64);
        let layers = meta.headers.len() as u64;
        check_samples(columns, rows, layers * header.channels.list.len() as u64, bytes)?;
    }
    let file = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))?;
    for layer in &file.layer_data {
        let list = &layer.channel_data.list;
        let Some(prefix) = prefix(list) else { continue };
        let find = |name: &str| {
            list.iter().find(|channel| channel.name.to_string() == format!("{prefix}{name}"))
        };
        let has_color = find("R").is_some() && find("G").is_some() && find("B").is_some();
        let mut planes = Vec::new();
        for (name, kind) in CHANNELS {
            let wanted = kind == Kind::Cvg || COLOR.contains(&kind) == has_color;
            let Some(channel) = find(name).filter(|_| wanted) else { continue };
            if channel.sampling != Vec2(1, 1) {
                let message = format!("expected a sample for each pixel in channel `{name}`");
                return Err(message.into());
            }
            let samples = Samples::F32(channel.sample_data.values_as_f32().collect());
            planes.push(Plane { kind, samples });
        }
        let columns = u32::try_from(layer.size.width())?;
        let mut image = Image::new(columns, u32::try_from(layer.size.height())?, planes)?;
        let position = layer.attributes.layer_position;
        image.properties.origin = [position.x(), position.y()];
        return Ok(image);
    }
    Err("expected channels R G B or Y".into())
}

/// What the names of a layer's channels begin with: nothing, or the first `group.` with a colour.
fn prefix(list: &[AnyChannel<FlatSamples>]) -> Option<String> {
    let names: Vec<String> = list.iter().map(|channel| channel.name.to_string()).collect();
    let holds = |prefix: &str, channel: &str| names.contains(&format!("{prefix}{channel}"));
    let prefixes = names.iter().map(|name| name.rfind('.').map_or("", |dot| &name[..=dot]));
    std::iter::once("")
        .chain(prefixes)
        .find(|p| holds(p, "Y") || ["R", "G", "B"].iter().all(|channel| holds(p, channel)))
        .map(str::to_owned)
}

pub(super) fn encode(image: &Image) -> Result<Vec<u8>, EncodeError> {
    let image = image.resolved()?;
    let kinds = picture_kinds(&image)?;
    let form = Form { depth: Depth::F32, transfer: Transfer::Linear, matte: Matte::Premultiplied };
    let image = image.converted(form)?;
    let mut channels = SmallVec::new();
    for (name, kind) in CHANNELS {
        // Coverage alone is grey.
        let name = if kinds == [Kind::Cvg] { "Y" } else { name };
        if kinds.contains(&kind) {
            let samples = FlatSamples::F32(image.decoded(kind)?);
            channels.push(AnyChannel::new(Text::from(name), samples));
        }
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
