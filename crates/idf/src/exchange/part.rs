//! One part of an `OpenEXR` file: its channels, and which of them are a picture.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use exr::image::{AnyChannel, AnyChannels, FlatSamples, Layer};
use exr::meta::MetaData;
use exr::prelude::{ReadChannels, ReadLayers, read};

use super::{Format, layers};
use crate::error::Cause;
use crate::memory;
use crate::plane::{COLOR, Kind, Role};

/// A channel of a file, and what it is here.
pub(super) struct Row {
    pub(super) kind: Kind,
    /// The name here, and in most files.
    pub(super) name: &'static str,
    /// Names elsewhere, in small letters, alone or after a layer's name and a dot.
    others: &'static [&'static str],
}

/// All channels. Light and coverage go by their name alone; colour is preferred to grey.
pub(super) const CHANNELS: [Row; 10] = [
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

pub(super) type Channel = AnyChannel<FlatSamples>;

/// One part of a file.
pub(super) struct Part {
    pub(super) name: String,
    pub(super) size: [u32; 2],
    pub(super) origin: [i32; 2],
    pub(super) list: Vec<Channel>,
}

/// Which channels of a part are the picture.
pub(super) struct Choice {
    /// What the names of light and coverage begin with.
    prefix: String,
    /// A channel that is the grey of the picture by itself.
    grey: Option<usize>,
}

impl Choice {
    /// Light and coverage whose names begin with `prefix`.
    pub(super) fn of(prefix: &str) -> Self {
        Self { prefix: prefix.into(), grey: None }
    }
}

impl Part {
    /// All parts of a file, with their samples.
    pub(super) fn all(file: &[u8]) -> Result<Vec<Self>, Cause> {
        let meta = MetaData::read_from_buffered(Cursor::new(file), false)?;
        let channels: usize = meta.headers.iter().map(|header| header.channels.list.len()).sum();
        let mut bytes = 0_u64;
        for header in &meta.headers {
            let size = [header.layer_size.width() as u64, header.layer_size.height() as u64];
            Format::Exr.check_samples(size, channels as u64, file.len())?;
            let pixels = size[0].saturating_mul(size[1]);
            bytes =
                bytes.saturating_add(pixels.saturating_mul(4 * header.channels.list.len() as u64));
        }
        // As the library gives them, and as planes.
        memory::check(bytes.saturating_mul(2))?;
        let reader = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            // A panic in one of the library's own threads would end the process.
            .non_parallel();
        // Damaged B44 blocks overflow in builds that check for it (exr 1.74, b44/mod.rs, unpack14).
        let found = catch_unwind(AssertUnwindSafe(|| reader.from_buffered(Cursor::new(file))))
            .map_err(|_| "the samples are damaged")??;
        found.layer_data.into_iter().map(Self::of).collect()
    }

    fn of(layer: Layer<AnyChannels<FlatSamples>>) -> Result<Self, Cause> {
        let position = layer.attributes.layer_position;
        Ok(Self {
            name: layer.attributes.layer_name.map(|name| name.to_string()).unwrap_or_default(),
            size: [u32::try_from(layer.size.width())?, u32::try_from(layer.size.height())?],
            origin: [position.x(), position.y()],
            list: layer.channel_data.list.into_vec(),
        })
    }

    /// The part that has the picture, or the one that `word` names: the first with light, else the
    /// first with anything that is known.
    pub(super) fn picture(parts: &[Self], word: Option<&str>) -> Option<(usize, Choice)> {
        let find = |choice: &dyn Fn(&Self) -> Option<Choice>| {
            parts.iter().enumerate().find_map(|(at, part)| Some((at, choice(part)?)))
        };
        if let Some(word) = word {
            return find(&|part| part.named(word));
        }
        find(&|part| Some(Choice::of(&part.prefix()?))).or_else(|| {
            find(&|part| Some(Choice::of("")).filter(|choice| !part.planes(choice).is_empty()))
        })
    }

    /// What the names of a picture's channels begin with: nothing, or the first `group.` with light.
    fn prefix(&self) -> Option<String> {
        let names = self.names();
        let prefixes = names.iter().map(|name| name.rfind('.').map_or("", |dot| &name[..=dot]));
        let mut all = std::iter::once("").chain(prefixes);
        all.find(|prefix| is_light(&names, prefix)).map(str::to_owned)
    }

    /// The picture that a word names: a layer or this part, or one channel.
    fn named(&self, word: &str) -> Option<Choice> {
        let names = self.names();
        if let Some(grey) = names.iter().position(|name| name == word) {
            let prefix = word.rfind('.').map_or("", |dot| &word[..=dot]).to_owned();
            return Some(Choice { prefix, grey: Some(grey) });
        }
        let layer = format!("{word}.");
        if is_light(&names, &layer) {
            return Some(Choice::of(&layer));
        }
        if word == self.name && is_light(&names, "") {
            return Some(Choice::of(""));
        }
        let grey = names.iter().position(|name| layers::names_channel(word, &self.name, name))?;
        Some(Choice { prefix: layer, grey: Some(grey) })
    }

    /// The known channels, in the order of the table, and where they are.
    pub(super) fn planes(&self, choice: &Choice) -> Vec<(&'static Row, usize)> {
        let names = self.names();
        let find = |name: &str| names.iter().position(|other| other == name);
        let named = |name: &str| find(&format!("{}{name}", choice.prefix));
        let also = |row: &Row| {
            names.iter().position(|name| {
                let name = name.to_ascii_lowercase();
                row.others.iter().any(|&other| {
                    let head = name.strip_suffix(other);
                    head.is_some_and(|head| head.is_empty() || head.ends_with('.'))
                })
            })
        };
        let has_color =
            choice.grey.is_none() && ["R", "G", "B"].iter().all(|name| named(name).is_some());
        let place = |row: &Row| match row.kind.role() {
            Role::Light if choice.grey.is_some() => choice.grey.filter(|_| row.kind == Kind::Grg),
            Role::Light if COLOR.contains(&row.kind) != has_color => None,
            Role::Light | Role::Coverage => named(row.name),
            // Beside a layer, or with a name of its own.
            _ => named(row.name).or_else(|| find(row.name)).or_else(|| also(row)),
        };
        let is_free = |kind, place| kind == Kind::Grg || choice.grey != Some(place);
        let found = CHANNELS.iter().filter_map(|row| Some((row, place(row)?)));
        found.filter(|(row, place)| is_free(row.kind, *place)).collect()
    }

    fn names(&self) -> Vec<String> {
        self.list.iter().map(|channel| channel.name.to_string()).collect()
    }
}

/// Whether the channels after `prefix` are colour or grey.
fn is_light(names: &[String], prefix: &str) -> bool {
    let holds = |channel: &str| names.iter().any(|name| *name == format!("{prefix}{channel}"));
    // With X and Z beside it, Y is one of three coordinates.
    let is_vector = holds("X") && holds("Z");
    holds("Y") && !is_vector || ["R", "G", "B"].into_iter().all(holds)
}
