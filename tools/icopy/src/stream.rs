//! Copies band by band, where a row of the copy comes of one row: of pictures larger than memory.

use std::error::Error;
use std::path::Path;

use idf::command::{Job, Progress};
use idf::rows::{Reader, Writer};
use idf::{Depth, Image, ImageError, Kind, WriteOptions};

use crate::{Axis, CopyError, Options, Region, copied};

/// Pixels in a band: with its copy, some megabytes.
const BAND: usize = 1 << 20;

impl Options {
    /// Whether each row of the copy comes of one row of the picture.
    pub(crate) fn is_by_rows(&self) -> bool {
        let Self { extend, shift, tileable, resize, rotate, tile, fill, .. } = self;
        let moves = *shift != [0, 0] || *tile != [1, 1] || rotate.is_some() || extend.is_some();
        !(moves || *tileable || resize.is_some() || *fill)
    }
}

/// Rows of an image that is read band by band, copied in the order of the copy.
pub(crate) struct Bands<'a> {
    reader: Reader,
    options: &'a Options,
    region: Region,
    /// Rows of a band.
    height: u32,
    /// Rows of the copy that are done.
    done: u32,
}

impl<'a> Bands<'a> {
    /// # Errors
    ///
    /// If the part to keep is not in the picture.
    pub(crate) fn new(reader: Reader, options: &'a Options) -> Result<Self, CopyError> {
        let [columns, rows] = reader.size();
        let region = options.crop.unwrap_or(Region { column: 0, row: 0, columns, rows });
        region.check(reader.size())?;
        let height = u32::try_from(BAND / columns as usize).unwrap_or(u32::MAX).max(1);
        Ok(Self { reader, options, region, height, done: 0 })
    }

    fn next(&mut self) -> Result<Option<Image>, Box<dyn Error + Send + Sync>> {
        let Region { row, rows, .. } = self.region;
        let count = self.height.min(rows - self.done);
        if count == 0 {
            return Ok(None);
        }
        // Upside down, the last rows come first.
        let first = match self.options.flip {
            Some(Axis::Y) => row + rows - self.done - count,
            _ => row + self.done,
        };
        self.done += count;
        let band = self.reader.band(first..first + count)?;
        let options = Options {
            crop: Some(Region { row: 0, rows: count, ..self.region }),
            ..self.options.clone()
        };
        let whole = |error| match error {
            CopyError::Image(ImageError::NotANumber { kind, column, row }) => {
                let row = row + (first - self.region.row) as usize;
                CopyError::Image(ImageError::NotANumber { kind, column, row })
            }
            error => error,
        };
        Ok(Some(copied(&band, &options).map_err(whole)?))
    }

    /// Writes the copy at `output`, and says what it is.
    ///
    /// # Errors
    ///
    /// If the picture cannot be read or copied so, or the copy not be written.
    pub(crate) fn write(
        mut self,
        output: &Path,
        write: &WriteOptions,
        job: &Job,
        progress: &Progress,
    ) -> Result<(), Box<dyn Error + Send + Sync>> {
        let mut writer = None;
        while let Some(band) = self.next()? {
            let writer = match &mut writer {
                Some(writer) => writer,
                None => writer.insert(self.writer(&band, output, write)?),
            };
            writer.write(&band)?;
            progress.advance(band.rows().into());
        }
        let mut history = self.reader.properties().history.clone();
        history.push(job.entry().to_string());
        let writer = writer.ok_or("a part without rows")?;
        Ok(writer.finish(history)?)
    }

    fn writer(
        &self,
        first: &Image,
        output: &Path,
        write: &WriteOptions,
    ) -> Result<Writer, Box<dyn Error + Send + Sync>> {
        let channels: Vec<(Kind, Depth)> =
            first.planes().iter().map(|plane| (plane.kind, plane.samples.depth())).collect();
        let mut properties = first.properties.clone();
        let place = self.reader.properties().origin;
        let Region { column, row, columns, rows } = self.region;
        properties.origin =
            [place[0].saturating_add_unsigned(column), place[1].saturating_add_unsigned(row)];
        let mut writer = Writer::create(output, [columns, rows], &channels, properties, write)?;
        writer.lut.clone_from(&first.lut);
        Ok(writer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Behind, Pick, Source};
    use idf::command::Talk;
    use idf::{Matte, Plane, ReadOptions, Samples, read, write};

    /// 5 x 7 pixels of straight colour, 16 bits deep, on a canvas.
    fn picture() -> Image {
        let plane = |(kind, factor): (Kind, u16)| {
            let samples = (0..35).map(|at: u16| (at + 1).wrapping_mul(factor)).collect();
            Plane { kind, samples: Samples::U16(samples) }
        };
        let planes = [(Kind::Red, 1801), (Kind::Grn, 977), (Kind::Blu, 3001), (Kind::Cvg, 1801)];
        let mut image = Image::new(5, 7, planes.map(plane).into()).unwrap();
        image.properties.matte = Matte::Straight;
        image.properties.origin = [10, -4];
        image.properties.background = Some([0.2, 0.4, 0.6]);
        image.properties.history = vec!["before".into()];
        image
    }

    #[test]
    fn bands_make_the_same_copy() {
        let folder = tempfile::tempdir().unwrap();
        let [old, new] = ["old", "new"].map(|name| folder.path().join(name));
        write(&old, &picture(), &WriteOptions::default()).unwrap();
        let usual = Options::default;
        let crop = Some(Region { column: 1, row: 2, columns: 3, rows: 4 });
        let luma = vec![Pick { to: Kind::Grg, from: Source::Luminance }];
        let ways = [
            usual(),
            Options { crop, ..usual() },
            Options { flip: Some(Axis::X), crop, ..usual() },
            Options { flip: Some(Axis::Y), crop, ..usual() },
            Options { flip: Some(Axis::Y), depth: Some(Depth::U8), ..usual() },
            Options { flatten: Some(Behind::Own), depth: Some(Depth::F32), ..usual() },
            Options { matte: Some(Matte::Premultiplied), channels: Some(luma), crop, ..usual() },
        ];
        let whole = ReadOptions { history: true, ..ReadOptions::default() };
        let job = Job::start("test", "1");
        for options in ways {
            assert!(options.is_by_rows());
            let expected = copied(&read(&old, &whole).unwrap(), &options).unwrap();
            for height in [1, 2, 3, 100] {
                let reader = Reader::open(&old, &whole).unwrap();
                let bands = Bands { height, ..Bands::new(reader, &options).unwrap() };
                let progress = Talk::default().progress(7);
                bands.write(&new, &WriteOptions::default(), &job, &progress).unwrap();
                let mut found = read(&new, &whole).unwrap();
                assert_eq!(found.properties.history.len(), 2, "{options:?}");
                found.properties.history.truncate(1);
                assert_eq!(found, expected, "{options:?}, bands of {height}");
            }
        }
    }

    #[test]
    fn only_rows_that_are_kept_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let [old, new] = ["old", "new"].map(|name| folder.path().join(name));
        write(&old, &picture(), &WriteOptions::default()).unwrap();
        // A damaged row, which only a reader of all finds.
        let path = old.with_extension("red");
        let mut bytes = std::fs::read(&path).unwrap();
        if idf::read_description(&old).unwrap().channels[0].encoding == idf::Encoding::Rle {
            *bytes.last_mut().unwrap() ^= 0x80;
        }
        std::fs::write(&path, &bytes).unwrap();
        let options = Options {
            crop: Some(Region { column: 0, row: 0, columns: 5, rows: 2 }),
            ..Options::default()
        };
        let reader = Reader::open(&old, &ReadOptions::default()).unwrap();
        let (job, progress) = (Job::start("test", "1"), Talk::default().progress(2));
        let bands = Bands::new(reader, &options).unwrap();
        bands.write(&new, &WriteOptions::default(), &job, &progress).unwrap();
        assert_eq!(read(&new, &ReadOptions::default()).unwrap().size(), [5, 2]);
    }
}
