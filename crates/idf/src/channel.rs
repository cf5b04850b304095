//! The data file of one channel, read and written in bands of rows.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use tempfile::NamedTempFile;

use crate::description::{Channel, Encoding};
use crate::error::{ReadError, WriteError};
use crate::file;
use crate::image::ImageError;
use crate::memory;
use crate::plane::Kind;
use crate::rle::{self, CodeError};
use crate::samples::{Depth, Sample, Samples};
use crate::write::{Staged, data_name};

/// Most bytes of samples that are decoded or coded at a time, if a row is not longer.
const BAND: usize = 1 << 24;
/// Most rows of a band; their lengths are in memory.
const BAND_ROWS: usize = 1 << 16;
/// Bytes of samples that one thread takes at a time.
const TASK: usize = 1 << 16;
/// Rows between two whose place in a coded file is remembered: a table is in memory at a 128th of
/// its length.
const ROWS_PER_START: usize = 256;

/// A data file that has the length of its samples, open for reading.
#[derive(Debug)]
pub(crate) struct ChannelReader {
    path: PathBuf,
    file: File,
    columns: usize,
    rows: usize,
    depth: Depth,
    layout: Layout,
}

/// Where the rows of a file are.
#[derive(Debug)]
enum Layout {
    /// One after the other.
    Raw,
    /// Coded, behind a table of their lengths. The place of every [`ROWS_PER_START`]th.
    Rle(Vec<u64>),
}

impl ChannelReader {
    /// Opens a data file; its length, and the table of a coded one, are checked before memory is
    /// taken for samples.
    pub(crate) fn open(path: &Path, channel: &Channel) -> Result<Self, ReadError> {
        let (columns, rows) = (channel.columns as usize, channel.rows as usize);
        let row_length = columns * channel.depth.bytes();
        let bytes = |per_row: usize| per_row as u64 * rows as u64;
        let found = file::length(path)?;
        let (least, most) = match channel.encoding {
            Encoding::Raw => (bytes(row_length), bytes(row_length)),
            Encoding::Rle => {
                (bytes(4 + rle::least_coded(row_length)), bytes(4 + rle::most_coded(row_length)))
            }
        };
        if !(least..=most).contains(&found) {
            let size = format!("for {columns} x {rows} samples of depth {}", channel.depth.word());
            let expected = if least == most {
                format!("{least} {size}")
            } else {
                format!("{least} to {most} {size}")
            };
            return Err(ReadError::Length { path: path.into(), found, expected });
        }
        let file =
            File::open(path).map_err(|source| ReadError::Io { path: path.into(), source })?;
        let (path, depth) = (path.to_path_buf(), channel.depth);
        let mut reader = Self { path, file, columns, rows, depth, layout: Layout::Raw };
        if channel.encoding == Encoding::Rle {
            reader.layout = Layout::Rle(reader.starts(found)?);
        }
        Ok(reader)
    }

    /// Bytes of all samples.
    pub(crate) fn bytes_in_all(&self) -> u64 {
        self.row_length() as u64 * self.rows as u64
    }

    /// The samples of some rows.
    pub(crate) fn read(&mut self, rows: Range<usize>) -> Result<Samples, ReadError> {
        let count = self.columns * rows.len();
        Ok(match self.depth {
            Depth::U8 => Samples::U8(self.read_as(rows, count)?),
            Depth::U16 => Samples::U16(self.read_as(rows, count)?),
            Depth::F32 => Samples::F32(self.read_as(rows, count)?),
        })
    }

    fn read_as<T: Sample>(
        &mut self,
        rows: Range<usize>,
        count: usize,
    ) -> Result<Vec<T>, ReadError> {
        let size = (count * size_of::<T>()) as u64;
        let error = |error| ReadError::Memory { path: self.path.clone(), error };
        memory::check(size).map_err(error)?;
        let mut samples = vec![T::default(); count];
        let band_rows = (BAND / self.row_length()).clamp(1, BAND_ROWS);
        for (band, target) in samples.chunks_mut(band_rows * self.columns).enumerate() {
            let first = rows.start + band * band_rows;
            match &self.layout {
                Layout::Raw => self.read_raw(first, target)?,
                Layout::Rle(_) => self.read_coded(first, target)?,
            }
        }
        Ok(samples)
    }

    fn read_raw<T: Sample>(&mut self, first: usize, target: &mut [T]) -> Result<(), ReadError> {
        let at = first as u64 * self.row_length() as u64;
        if let Some(bytes) = T::as_bytes(target) {
            return self.fill(at, bytes);
        }
        let bytes = self.bytes(at, size_of_val(target))?;
        T::from_raw(&bytes, target);
        Ok(())
    }

    fn read_coded<T: Sample>(&mut self, first: usize, target: &mut [T]) -> Result<(), ReadError> {
        let (start, lengths) = self.lengths(first, target.len() / self.columns)?;
        let coded = self.bytes(start, lengths.iter().map(|&length| length as usize).sum())?;
        let mut rest = &coded[..];
        let mut take = |length: &u32| {
            let (row, after) = rest.split_at(*length as usize);
            rest = after;
            row
        };
        let rows: Vec<&[u8]> = lengths.iter().map(&mut take).collect();
        let (columns, row_length) = (self.columns, self.row_length());
        let decode_task = |(at, (target, rows)): (usize, (&mut [T], &[&[u8]]))| {
            let mut planar = Vec::new();
            for (row, (target, coded)) in target.chunks_mut(columns).zip(rows).enumerate() {
                let decoded = match T::as_bytes(target) {
                    Some(bytes) => rle::decode_row(coded, bytes),
                    None => {
                        planar.resize(row_length, 0);
                        rle::decode_row(coded, &mut planar)
                            .map(|()| T::from_planar(&planar, target))
                    }
                };
                if let Err(error) = decoded {
                    return Some(CodeError::Row { row: first + at + row, error });
                }
            }
            None
        };
        let task_rows = (TASK / row_length).max(1);
        let error = if rows.len() <= task_rows {
            decode_task((0, (target, &rows)))
        } else {
            // The first damaged row by position, not by which thread came to it first.
            let tasks = target.par_chunks_mut(task_rows * columns).zip(rows.par_chunks(task_rows));
            tasks.enumerate().find_map_first(|(task, rows)| decode_task((task * task_rows, rows)))
        };
        error.map_or(Ok(()), |error| Err(self.code_error(error)))
    }

    /// Checks the table of a coded file of `length` bytes.
    fn starts(&mut self, length: u64) -> Result<Vec<u64>, ReadError> {
        let row_length = self.row_length();
        let (least, most) = (rle::least_coded(row_length), rle::most_coded(row_length));
        let mut starts = Vec::with_capacity(self.rows.div_ceil(ROWS_PER_START));
        let table = 4 * self.rows as u64;
        let mut end = table;
        for band in (0..self.rows).step_by(BAND_ROWS) {
            let rows = BAND_ROWS.min(self.rows - band);
            for (index, found) in self.table(band, rows)?.into_iter().enumerate() {
                let (row, found) = (band + index, found as usize);
                if !(least..=most).contains(&found) {
                    return Err(self.code_error(CodeError::RowLength { row, found, least, most }));
                }
                if row.is_multiple_of(ROWS_PER_START) {
                    starts.push(end);
                }
                end += found as u64;
            }
        }
        if end == length {
            return Ok(starts);
        }
        let narrow = |bytes| usize::try_from(bytes).unwrap_or(usize::MAX);
        let (found, expected) = (narrow(length), narrow(end));
        Err(self.code_error(CodeError::Length { found, expected }))
    }

    /// Where a coded row starts, and the lengths of it and those after it.
    fn lengths(&mut self, first: usize, rows: usize) -> Result<(u64, Vec<u32>), ReadError> {
        let known = first - first % ROWS_PER_START;
        let mut lengths = self.table(known, first - known + rows)?;
        let before: u64 = lengths.drain(..first - known).map(u64::from).sum();
        let start = match &self.layout {
            Layout::Raw => 0,
            Layout::Rle(starts) => starts[known / ROWS_PER_START],
        };
        Ok((start + before, lengths))
    }

    /// Entries of the table.
    fn table(&mut self, first: usize, rows: usize) -> Result<Vec<u32>, ReadError> {
        let bytes = self.bytes(4 * first as u64, 4 * rows)?;
        Ok(bytes.as_chunks().0.iter().map(|&entry| u32::from_le_bytes(entry)).collect())
    }

    fn bytes(&mut self, at: u64, count: usize) -> Result<Vec<u8>, ReadError> {
        let mut bytes = vec![0; count];
        self.fill(at, &mut bytes)?;
        Ok(bytes)
    }

    fn fill(&mut self, at: u64, bytes: &mut [u8]) -> Result<(), ReadError> {
        let found = self.file.seek(SeekFrom::Start(at));
        let read = found.and_then(|_| self.file.read_exact(bytes));
        read.map_err(|source| ReadError::Io { path: self.path.clone(), source })
    }

    fn row_length(&self) -> usize {
        self.columns * self.depth.bytes()
    }

    fn code_error(&self, error: CodeError) -> ReadError {
        ReadError::Code { path: self.path.clone(), error }
    }
}

/// A data file in the making, beside its name.
#[derive(Debug)]
pub(crate) struct ChannelWriter {
    description: PathBuf,
    target: PathBuf,
    channel: Channel,
    file: NamedTempFile,
    /// Rows written so far.
    done: usize,
    /// Where the next coded row goes.
    end: u64,
}

impl ChannelWriter {
    /// A file for a channel of the image at `description`. Coded, it becomes raw where it would not
    /// be shorter.
    pub(crate) fn create(
        description: &Path,
        kind: Kind,
        [columns, rows]: [u32; 2],
        depth: Depth,
        encoding: Encoding,
    ) -> Result<Self, WriteError> {
        let name = data_name(description, kind.word())?;
        let target = file::folder(description).join(&name);
        file::check_target(&target)?;
        let file = file::create_beside(&target)?;
        let channel = Channel { kind, file: name, columns, rows, depth, encoding };
        let (description, end) = (description.to_path_buf(), 4 * u64::from(rows));
        Ok(Self { description, target, channel, file, done: 0, end })
    }

    /// What is written.
    pub(crate) fn kind(&self) -> Kind {
        self.channel.kind
    }

    /// How it is written.
    pub(crate) fn depth(&self) -> Depth {
        self.channel.depth
    }

    /// Writes the next rows, which have the depth and the columns of the channel.
    pub(crate) fn write(&mut self, samples: &Samples) -> Result<(), WriteError> {
        self.put(samples).map_err(|source| file::io_error(&self.target, source))
    }

    fn put(&mut self, samples: &Samples) -> io::Result<()> {
        let columns = self.channel.columns as usize;
        let (row_length, all) = (self.row_length(), self.channel.rows as usize);
        let band_rows = (BAND / row_length).clamp(1, BAND_ROWS);
        for at in (0..samples.len()).step_by(band_rows * columns) {
            let part = at..samples.len().min(at + band_rows * columns);
            let rows = part.len() / columns;
            if self.channel.encoding == Encoding::Rle {
                let coded =
                    rle::encode_rows(&samples.planar_bytes(columns, part.clone()), row_length);
                // Known at once where all rows are in one band; else `finish` sees to it.
                if rows == all && 4 * rows + coded.bytes.len() >= rows * row_length {
                    self.channel.encoding = Encoding::Raw;
                } else {
                    self.put_coded(&coded)?;
                }
            }
            if self.channel.encoding == Encoding::Raw {
                self.file.write_all(&samples.raw_bytes(part))?;
            }
            self.done += rows;
        }
        Ok(())
    }

    fn put_coded(&mut self, coded: &rle::CodedRows) -> io::Result<()> {
        let table: Vec<u8> = coded.lengths.iter().flat_map(|length| length.to_le_bytes()).collect();
        self.file.seek(SeekFrom::Start(4 * self.done as u64))?;
        self.file.write_all(&table)?;
        self.file.seek(SeekFrom::Start(self.end))?;
        self.file.write_all(&coded.bytes)?;
        self.end += coded.bytes.len() as u64;
        Ok(())
    }

    /// The line of the description and the finished file.
    pub(crate) fn finish(mut self) -> Result<(Channel, Staged), WriteError> {
        let Channel { kind, columns, rows, .. } = self.channel;
        let expected = u64::from(columns) * u64::from(rows);
        let found = self.done * columns as usize;
        if found as u64 != expected {
            let error = ImageError::Length { kind, found, expected };
            return Err(WriteError::Image { path: self.target, error });
        }
        let raw_length = self.row_length() as u64 * u64::from(rows);
        if self.channel.encoding == Encoding::Rle && self.end >= raw_length {
            self.decode()?;
        }
        let temporary = file::seal(self.file, &self.target, &self.description)?;
        let name = self.channel.file.clone();
        Ok((self.channel, Staged { temporary, name }))
    }

    /// Writes what was coded again as it is.
    fn decode(&mut self) -> Result<(), WriteError> {
        let mut coded =
            ChannelReader::open(self.file.path(), &self.channel).map_err(WriteError::Read)?;
        let mut file = file::create_beside(&self.target)?;
        let rows = self.channel.rows as usize;
        let band_rows = (BAND / self.row_length()).clamp(1, BAND_ROWS);
        for first in (0..rows).step_by(band_rows) {
            let samples =
                coded.read(first..rows.min(first + band_rows)).map_err(WriteError::Read)?;
            let written = file.write_all(&samples.raw_bytes(0..samples.len()));
            written.map_err(|source| file::io_error(&self.target, source))?;
        }
        self.file = file;
        self.channel.encoding = Encoding::Raw;
        Ok(())
    }

    fn row_length(&self) -> usize {
        self.channel.columns as usize * self.channel.depth.bytes()
    }
}
