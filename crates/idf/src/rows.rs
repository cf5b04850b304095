//! Bands of rows, in and out, for pictures larger than memory.
//!
//! ```
//! use idf::rows::{Reader, Writer};
//! use idf::{Depth, Image, Kind, Plane, ReadOptions, Samples, WriteOptions};
//!
//! let folder = tempfile::tempdir()?;
//! let [old, new] = ["old", "new"].map(|name| folder.path().join(name));
//! let grey = Plane { kind: Kind::Grg, samples: Samples::U8(vec![1, 2, 3, 4, 5, 6]) };
//! idf::write(&old, &Image::new(2, 3, vec![grey])?, &WriteOptions::default())?;
//!
//! let mut reader = Reader::open(&old, &ReadOptions::default())?;
//! let channels = [(Kind::Grg, Depth::U8)];
//! let properties = reader.properties().clone();
//! let mut writer = Writer::create(&new, [2, 2], &channels, properties, &WriteOptions::default())?;
//! writer.write(&reader.band(1..2)?)?;
//! writer.write(&reader.band(0..1)?)?;
//! writer.finish(Vec::new())?;
//! let image = idf::read(&new, &ReadOptions::default())?;
//! assert_eq!(image.plane(Kind::Grg), Some(&Samples::U8(vec![3, 4, 1, 2])));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::channel::{ChannelReader, ChannelWriter};
use crate::description::{Channel, Description};
use crate::error::{ReadError, WriteError};
#[cfg(feature = "exchange")]
use crate::exchange::AnymapReader;
use crate::image::{Image, ImageError, Plane, Properties, Window};
use crate::lut::Lut;
use crate::memory;
use crate::plane::{Kind, Role};
use crate::read::{ReadOptions, asked, data_path, description_path, read_description, read_log};
use crate::samples::Depth;
use crate::write::{WriteOptions, complete, set_properties};

/// An image whose rows are read when they are asked for, in any order.
#[derive(Debug)]
pub struct Reader {
    path: PathBuf,
    size: [u32; 2],
    source: Source,
    lut: Option<Lut>,
    properties: Properties,
}

#[derive(Debug)]
enum Source {
    Files(Vec<(Kind, ChannelReader)>),
    #[cfg(feature = "exchange")]
    Anymap(AnymapReader),
    Memory(Image),
}

impl Reader {
    /// Opens an image in this crate's format: the data files of the channels that are asked for are
    /// open and have the right length, and no sample is in memory.
    ///
    /// # Errors
    ///
    /// As [`crate::read`], but for damaged rows.
    pub fn open(path: &Path, options: &ReadOptions) -> Result<Self, ReadError> {
        let path = &description_path(path);
        let description = read_description(path)?;
        let mut files = Vec::new();
        let mut lut = None;
        let mut first: Option<&Channel> = None;
        for channel in asked(path, &description, &options.ask)? {
            let file = data_path(path, &channel.file, options.outside)?;
            if channel.kind.role() == Role::Table {
                lut = read_lut(&file, channel)?;
                continue;
            }
            let size = |channel: &Channel| (channel.kind, [channel.columns, channel.rows]);
            let expected = *first.get_or_insert(channel);
            if size(expected).1 != size(channel).1 {
                let path = path.clone();
                return Err(ReadError::Sizes {
                    path,
                    first: size(expected),
                    second: size(channel),
                });
            }
            files.push((channel.kind, ChannelReader::open(&file, channel)?));
        }
        let history = match &description.log {
            Some(log) if options.history => read_log(&data_path(path, log, options.outside)?)?,
            _ => Vec::new(),
        };
        let size = first.map_or(description.size, |c| [c.columns, c.rows]);
        let properties = Properties {
            origin: description.origin,
            transfer: description.transfer,
            matte: description.matte.unwrap_or_default(),
            background: description.background,
            unknown: description.unknown,
            history,
        };
        Ok(Self { path: path.clone(), size, source: Source::Files(files), lut, properties })
    }

    /// The rows of a PNM or PAM file.
    #[cfg(feature = "exchange")]
    pub(crate) fn of_anymap(
        path: &Path,
        size: [u32; 2],
        rows: AnymapReader,
        properties: Properties,
    ) -> Self {
        Self { path: path.into(), size, source: Source::Anymap(rows), lut: None, properties }
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Where the picture lies on a larger one.
    pub fn window(&self) -> Window {
        let ([column, row], [columns, rows]) = (self.properties.origin, self.size);
        Window { column, row, columns, rows }
    }

    /// What the image says besides its samples.
    pub fn properties(&self) -> &Properties {
        &self.properties
    }

    /// Some rows, counted from 0 at the top, as an image of their own with its place on the canvas;
    /// history stays with the whole.
    ///
    /// # Errors
    ///
    /// If a data file cannot be read or a row in it is damaged.
    ///
    /// # Panics
    ///
    /// If the rows are none or not all in the image.
    pub fn band(&mut self, rows: Range<u32>) -> Result<Image, ReadError> {
        assert!(!rows.is_empty() && rows.end <= self.size[1], "{rows:?} of {} rows", self.size[1]);
        let mut image = self.part(&rows)?;
        let [column, row] = self.properties.origin;
        image.properties = Properties {
            origin: [column, row.saturating_add_unsigned(rows.start)],
            history: Vec::new(),
            ..self.properties.clone()
        };
        Ok(image)
    }

    /// All rows, with the history.
    pub(crate) fn whole(mut self) -> Result<Image, ReadError> {
        let bytes = match &self.source {
            Source::Files(files) => files.iter().map(|(_, file)| file.bytes_in_all()).sum::<u64>(),
            #[cfg(feature = "exchange")]
            Source::Anymap(file) => file.bytes_in_all(self.size[1]),
            Source::Memory(_) => 0,
        };
        // For what is done with it, too: nothing is done in less.
        let error = |error| ReadError::Memory { path: self.path.clone(), error };
        memory::check(bytes.saturating_mul(2)).map_err(error)?;
        let mut image = self.part(&(0..self.size[1]))?;
        image.properties = self.properties;
        Ok(image)
    }

    fn part(&mut self, rows: &Range<u32>) -> Result<Image, ReadError> {
        let [columns, _] = self.size;
        let range = rows.start as usize..rows.end as usize;
        let error = |error: ImageError| ReadError::Image { path: self.path.clone(), error };
        let planes = match &mut self.source {
            Source::Files(files) => files
                .iter_mut()
                .map(|(kind, file)| Ok(Plane { kind: *kind, samples: file.read(range.clone())? }))
                .collect::<Result<_, ReadError>>()?,
            #[cfg(feature = "exchange")]
            Source::Anymap(file) => file.read(range)?,
            Source::Memory(image) => return image.band(rows.clone()).map_err(error),
        };
        let mut image = Image::new(columns, rows.end - rows.start, planes).map_err(error)?;
        image.lut.clone_from(&self.lut);
        Ok(image)
    }
}

/// Rows of an image that is in memory, as formats are that give no rows.
impl From<Image> for Reader {
    fn from(image: Image) -> Self {
        let (size, lut, properties) = (image.size(), image.lut.clone(), image.properties.clone());
        Self { path: PathBuf::new(), size, source: Source::Memory(image), lut, properties }
    }
}

fn read_lut(file: &Path, channel: &Channel) -> Result<Option<Lut>, ReadError> {
    let samples = ChannelReader::open(file, channel)?.read(0..channel.rows as usize)?;
    let rows = samples.raw_bytes(0..samples.len());
    Ok(if channel.rows == 4 { Lut::from_four_rows(&rows) } else { Lut::from_rows(&rows) })
}

/// An image that is written band by band, in this crate's format. Until [`Writer::finish`] the image
/// of this name is as it was; without it nothing stays on disk.
#[derive(Debug)]
pub struct Writer {
    path: PathBuf,
    size: [u32; 2],
    channels: Vec<ChannelWriter>,
    properties: Properties,
    /// The colour table, if there is one.
    pub lut: Option<Lut>,
}

impl Writer {
    /// Starts an image of `size`, columns and rows, at `path`, which may lack its ending.
    ///
    /// # Errors
    ///
    /// If the size is no image's, a channel has no pixels, or a file cannot be made.
    pub fn create(
        path: &Path,
        size: [u32; 2],
        channels: &[(Kind, Depth)],
        properties: Properties,
        options: &WriteOptions,
    ) -> Result<Self, WriteError> {
        let path = description_path(path);
        let error = |error| WriteError::Image { path: path.clone(), error };
        crate::image::checked_size(size[0], size[1]).map_err(error)?;
        if let Some(row) = channels.iter().find(|(kind, _)| !kind.has_pixels()) {
            return Err(error(ImageError::NotPixels(row.0)));
        }
        let create =
            |&(kind, depth)| ChannelWriter::create(&path, kind, size, depth, options.encoding);
        let channels = channels.iter().map(create).collect::<Result<_, _>>()?;
        Ok(Self { path, size, channels, properties, lut: None })
    }

    /// Writes the next rows: the channels of the image, which `band` has with their depths.
    ///
    /// # Errors
    ///
    /// If `band` has other columns or lacks a channel, or a file cannot be written.
    pub fn write(&mut self, band: &Image) -> Result<(), WriteError> {
        for channel in &mut self.channels {
            let error = |error| WriteError::Image { path: self.path.clone(), error };
            let samples = band.needed(channel.kind()).map_err(error)?;
            if band.columns() != self.size[0] || samples.depth() != channel.depth() {
                let depth = channel.depth().word();
                let expected = format!("rows of {} samples of depth {depth}", self.size[0]);
                return Err(WriteError::Format { path: self.path.clone(), expected });
            }
            channel.write(samples)?;
        }
        Ok(())
    }

    /// Puts the image in its place, with the lines of its history.
    ///
    /// # Errors
    ///
    /// If the rows are not as many as they should be, or a file cannot be written; the old image is
    /// then whole.
    pub fn finish(self, history: Vec<String>) -> Result<(), WriteError> {
        let mut description = Description::default();
        description.size = self.size;
        let covered = self.channels.iter().any(|channel| channel.kind() == Kind::Cvg);
        set_properties(&mut description, &self.properties, covered);
        let files = self.channels.into_iter().map(ChannelWriter::finish);
        let files = files.collect::<Result<_, _>>()?;
        complete(&self.path, files, self.lut.as_ref(), &history, description)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::Encoding;
    use crate::read::{Ask, read};
    use crate::samples::Samples;
    use crate::write::write;
    use std::fs;

    /// A picture of every depth whose rows are noise in the middle and flat elsewhere; `enc` is all
    /// noise, so that it does not shrink.
    fn picture(columns: u32, rows: u32) -> Image {
        let mut seed = 1_u32;
        let mut noise = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            seed >> 16
        };
        let pixels = columns * rows;
        let middle = pixels / 3..pixels / 2;
        let mut value = |at: u32| if middle.contains(&at) { noise() } else { at / 700 };
        let word = |value: u32| u16::try_from(value & 0xffff).unwrap();
        let deep = (0..pixels).map(|at| word(value(at))).collect();
        let float = (0..pixels).map(|at| f32::from(word(value(at))) - 9.0).collect();
        let bytes = (0..pixels).map(|_| noise().to_le_bytes()[0]).collect();
        let planes = vec![
            Plane { kind: Kind::Grg, samples: Samples::U16(deep) },
            Plane { kind: Kind::Dep, samples: Samples::F32(float) },
            Plane { kind: Kind::Enc, samples: Samples::U8(bytes) },
        ];
        let mut image = Image::new(columns, rows, planes).unwrap();
        image.properties.origin = [5, -7];
        image.lut = Lut::new(vec![[1, 2, 3]; 256]);
        image
    }

    fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
        let mut files: Vec<(String, Vec<u8>)> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap())
            .map(|entry| {
                (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap())
            })
            .collect();
        files.sort();
        files
    }

    /// Writes `image` in bands of these many rows.
    fn write_in_bands(path: &Path, image: &Image, heights: &[u32], options: &WriteOptions) {
        let channels: Vec<(Kind, Depth)> =
            image.planes().iter().map(|plane| (plane.kind, plane.samples.depth())).collect();
        let properties = image.properties.clone();
        let mut writer =
            Writer::create(path, image.size(), &channels, properties, options).unwrap();
        writer.lut.clone_from(&image.lut);
        let mut reader = Reader::from(image.clone());
        let mut row = 0;
        for height in heights.iter().cycle() {
            if row == image.rows() {
                break;
            }
            let end = image.rows().min(row + height);
            writer.write(&reader.band(row..end).unwrap()).unwrap();
            row = end;
        }
        writer.finish(vec!["line".into()]).unwrap();
    }

    #[test]
    fn bands_make_the_same_files_as_the_whole() {
        let mut image = picture(70, 300);
        image.properties.history = vec!["line".into()];
        for encoding in [Encoding::Rle, Encoding::Raw] {
            let options = WriteOptions { encoding, outside: false };
            let [whole, banded] = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
            write(&whole.path().join("x"), &image, &options).unwrap();
            write_in_bands(&banded.path().join("x"), &image, &[1, 64, 7], &options);
            let (whole, banded) = (files(whole.path()), files(banded.path()));
            assert_eq!(
                whole.iter().map(|f| &f.0).collect::<Vec<_>>(),
                ["x.dep", "x.enc", "x.grg", "x.idf", "x.log", "x.lut"]
            );
            assert!(whole == banded, "{encoding:?}");
            let text = String::from_utf8(whole[3].1.clone()).unwrap();
            let word = encoding.word();
            assert!(text.contains(&format!("dep x.dep 70 300 32f {word}\n")), "{text}");
            assert!(text.contains("enc x.enc 70 300 8 raw\n"), "{text}");
        }
    }

    #[test]
    fn rows_come_in_any_order_and_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        let image = picture(3, 1000);
        for encoding in [Encoding::Rle, Encoding::Raw] {
            write(&path, &image, &WriteOptions { encoding, outside: false }).unwrap();
            let mut reader = Reader::open(&path, &ReadOptions::default()).unwrap();
            assert_eq!((reader.window(), reader.size()), (image.window(), [3, 1000]));
            for rows in [999..1000, 0..1, 255..257, 512..513, 300..900, 0..1000] {
                let band = reader.band(rows.clone()).unwrap();
                let mut expected = Reader::from(image.clone());
                assert_eq!(band, expected.band(rows.clone()).unwrap());
                let row = i32::try_from(rows.start).unwrap() - 7;
                assert_eq!(band.properties.origin, [5, row]);
                let Some(Samples::U8(indices)) = image.plane(Kind::Enc) else { unreachable!() };
                let part = &indices[3 * rows.start as usize..3 * rows.end as usize];
                assert_eq!(band.plane(Kind::Enc), Some(&Samples::U8(part.to_vec())));
            }
        }
    }

    #[test]
    fn a_damaged_row_is_named_and_the_others_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        let flat = Plane { kind: Kind::Grg, samples: Samples::U8(vec![9; 100 * 900]) };
        let image = Image::new(100, 900, vec![flat]).unwrap();
        write(&path, &image, &WriteOptions::default()).unwrap();
        let file = folder.path().join("x.grg");
        let mut bytes = fs::read(&file).unwrap();
        bytes[4 * 900 + 2 * 700] = 0x80;
        fs::write(&file, bytes).unwrap();
        let mut reader = Reader::open(&path, &ReadOptions::default()).unwrap();
        assert_eq!(reader.band(0..700).unwrap().rows(), 700);
        assert_eq!(reader.band(701..900).unwrap().rows(), 199);
        for rows in [700..701, 0..900] {
            let message = reader.band(rows).unwrap_err().to_string();
            assert!(message.contains("row 700 has the code 128"), "{message}");
        }
        assert!(read(&path, &ReadOptions::default()).is_err());
    }

    #[test]
    fn only_the_channels_asked_for_are_opened() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        write(&path, &picture(5, 4), &WriteOptions::default()).unwrap();
        fs::remove_file(folder.path().join("x.dep")).unwrap();
        let options = ReadOptions { ask: Ask::Only(vec![Kind::Grg]), ..ReadOptions::default() };
        assert_eq!(Reader::open(&path, &options).unwrap().band(2..3).unwrap().kinds(), [Kind::Grg]);
        assert!(Reader::open(&path, &ReadOptions::default()).is_err());
    }

    #[test]
    fn what_is_not_finished_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        let channels = [(Kind::Grg, Depth::U8)];
        let create = || {
            let (properties, options) = (Properties::default(), WriteOptions::default());
            Writer::create(&path, [2, 2], &channels, properties, &options).unwrap()
        };
        let band = |columns, samples: Samples| {
            Image::new(columns, 1, vec![Plane { kind: Kind::Grg, samples }]).unwrap()
        };
        let mut writer = create();
        writer.write(&band(2, Samples::U8(vec![1, 2]))).unwrap();
        for wrong in [band(3, Samples::U8(vec![0; 3])), band(2, Samples::U16(vec![0; 2]))] {
            let message = writer.write(&wrong).unwrap_err().to_string();
            assert!(message.ends_with("expected rows of 2 samples of depth 8"), "{message}");
        }
        let message = writer.finish(Vec::new()).unwrap_err().to_string();
        assert!(message.ends_with("`grg` has 2 samples, expected 4"), "{message}");
        drop(create());
        assert_eq!(files(folder.path()), []);
    }
}
