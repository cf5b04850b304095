//! Run-length coding of one row, and files of such rows.
//!
//! A row is coded alone by the rules of `PackBits`: a code 0 to 127 is followed by one to 128
//! bytes to copy, a code 129 to 255 by a byte to repeat 257 less the code times, and 128 is not
//! used. Equal bytes are a run from three on. A file is a table with the coded length of each row
//! (32 bits, little-endian) and then the rows, so rows are found without decoding others.

use std::error::Error;
use std::fmt;

use rayon::prelude::*;

/// Longest run and longest stretch of literal bytes.
const LONGEST: usize = 128;
/// Shorter runs stay literal.
const SHORTEST_RUN: usize = 3;
/// Bytes in a file from which rows are worked on by all threads.
const LARGE: usize = 1 << 16;
/// Bytes that are copied or filled at once.
const STEP: usize = 16;
/// Bytes to either end from which on whole steps are taken: a code and the longest stretch.
const FAR: usize = LONGEST + STEP;
/// The lowest bit of each of eight bytes.
const LOW_BITS: u64 = 0x0101_0101_0101_0101;

/// What is wrong with a coded row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RowError {
    /// The coded bytes end before the row is full.
    Underrun {
        /// Bytes the coded row gives.
        found: usize,
        /// Bytes of a row.
        expected: usize,
    },
    /// A run or a stretch of literals goes beyond the end of the row.
    Overrun {
        /// Bytes the coded row gives, up to and with the one that is too long.
        found: usize,
        /// Bytes of a row.
        expected: usize,
    },
    /// The code 128.
    Unused,
    /// Coded bytes are left when the row is full.
    Trailing {
        /// How many.
        found: usize,
    },
}

/// What is wrong with a file of coded rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CodeError {
    /// The file is shorter than its table of row lengths.
    Table {
        /// Bytes of the file.
        found: usize,
        /// Bytes of the table.
        expected: usize,
    },
    /// The table gives a row a length that no coded row has.
    RowLength {
        /// The row, from 0.
        row: usize,
        /// Length in the table.
        found: usize,
        /// Shortest possible.
        least: usize,
        /// Longest possible.
        most: usize,
    },
    /// The table does not add up to the file.
    Length {
        /// Bytes of the file.
        found: usize,
        /// Bytes of the table and of all rows in it.
        expected: usize,
    },
    /// A row is damaged.
    Row {
        /// The row, from 0.
        row: usize,
        /// How.
        error: RowError,
    },
}

/// Most bytes that a row of `length` bytes is coded in.
pub fn most_coded(length: usize) -> usize {
    length + length.div_ceil(LONGEST)
}

/// Fewest bytes that a row of `length` bytes is coded in: all of it runs, and a rest of one byte
/// is as long as a run.
pub fn least_coded(length: usize) -> usize {
    2 * length.div_ceil(LONGEST)
}

/// Appends `row`, coded, to `coded`.
pub fn encode_row(row: &[u8], coded: &mut Vec<u8>) {
    let mut literal = 0;
    while let Some(start) = next_run(row, literal) {
        encode_literals(&row[literal..start], coded);
        let run = run_length(&row[start..]);
        coded.extend([code(257 - run), row[start]]);
        literal = start + run;
    }
    encode_literals(&row[literal..], coded);
}

/// Fills `row` from `coded`.
///
/// Far from both ends runs and stretches are written in steps of 16 bytes, of which the next code
/// overwrites what is too much.
///
/// # Errors
///
/// If the coded bytes do not give exactly the row. What `row` holds then is not defined.
pub fn decode_row(coded: &[u8], row: &mut [u8]) -> Result<(), RowError> {
    let expected = row.len();
    let (mut from, mut at) = (0, 0);
    // One step beyond the longest stretch may be read and written.
    while let (Some(source), Some(target)) =
        (coded[from..].first_chunk::<FAR>(), row[at..].first_chunk_mut::<FAR>())
    {
        let count = match usize::from(source[0]) {
            128 => return Err(RowError::Unused),
            literal @ ..128 => {
                copy_steps(source, target, literal + 1);
                from += literal + 2;
                literal + 1
            }
            run => {
                fill_steps(source[1], target, 257 - run);
                from += 2;
                257 - run
            }
        };
        at += count;
    }
    let mut coded = &coded[from..];
    while at < expected {
        let Some((&code, rest)) = coded.split_first() else {
            return Err(RowError::Underrun { found: at, expected });
        };
        let (count, taken) = match usize::from(code) {
            128 => return Err(RowError::Unused),
            literal @ ..128 => (literal + 1, literal + 1),
            run => (257 - run, 1),
        };
        let Some((bytes, rest)) = rest.split_at_checked(taken) else {
            return Err(RowError::Underrun { found: at, expected });
        };
        let Some(target) = row.get_mut(at..at + count) else {
            return Err(RowError::Overrun { found: at + count, expected });
        };
        if taken == count {
            target.copy_from_slice(bytes);
        } else {
            target.fill(bytes[0]);
        }
        at += count;
        coded = rest;
    }
    if coded.is_empty() { Ok(()) } else { Err(RowError::Trailing { found: coded.len() }) }
}

/// Coded rows, one after the other, and the coded length of each.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CodedRows {
    /// Bytes of each row.
    pub lengths: Vec<u32>,
    /// The rows.
    pub bytes: Vec<u8>,
}

/// Codes `rows`, which are `row_length` bytes each, with all threads where they are many.
///
/// # Panics
///
/// If a coded row has 2^32 bytes or more; a row of an image has at most 2^26.
pub fn encode_rows(rows: &[u8], row_length: usize) -> CodedRows {
    let group = row_length * (LARGE / row_length).max(1);
    let encode_group = |rows: &[u8]| {
        let mut coded = CodedRows::default();
        for row in rows.chunks(row_length) {
            let start = coded.bytes.len();
            encode_row(row, &mut coded.bytes);
            let length = u32::try_from(coded.bytes.len() - start);
            coded.lengths.push(length.expect("a row of an image has at most 2^26 bytes"));
        }
        coded
    };
    let groups: Vec<CodedRows> = if rows.len() <= group {
        return encode_group(rows);
    } else {
        rows.par_chunks(group).map(encode_group).collect()
    };
    let mut coded = CodedRows {
        lengths: Vec::with_capacity(rows.len() / row_length),
        bytes: Vec::with_capacity(groups.iter().map(|group| group.bytes.len()).sum()),
    };
    for group in groups {
        coded.lengths.extend(group.lengths);
        coded.bytes.extend(group.bytes);
    }
    coded
}

/// The file of `rows`, which are `row_length` bytes each.
///
/// # Panics
///
/// As [`encode_rows`].
pub fn encode(rows: &[u8], row_length: usize) -> Vec<u8> {
    let coded = encode_rows(rows, row_length);
    let mut file = Vec::with_capacity(4 * coded.lengths.len() + coded.bytes.len());
    file.extend(coded.lengths.iter().flat_map(|length| length.to_le_bytes()));
    file.extend(coded.bytes);
    file
}

/// The `rows` rows of a file, `row_length` bytes each. Memory is taken only when the table agrees
/// with the file, so at most 64 times the file's size.
///
/// # Errors
///
/// If the table does not fit the file, or a row does not decode to exactly its length.
pub fn decode(file: &[u8], row_length: usize, rows: usize) -> Result<Vec<u8>, CodeError> {
    let coded_rows = coded_rows(file, row_length, rows)?;
    let mut decoded = vec![0; row_length * rows];
    let decode_one = |(row, (target, coded)): (usize, (&mut [u8], &&[u8]))| {
        decode_row(coded, target).map_err(|error| CodeError::Row { row, error })
    };
    if decoded.len() < LARGE {
        decoded.chunks_mut(row_length).zip(&coded_rows).enumerate().try_for_each(decode_one)?;
    } else {
        // The first damaged row by position, not by which thread came to it first.
        let error = decoded
            .par_chunks_mut(row_length)
            .zip(&coded_rows)
            .enumerate()
            .find_map_first(|row| decode_one(row).err());
        if let Some(error) = error {
            return Err(error);
        }
    }
    Ok(decoded)
}

/// The coded bytes of each row.
fn coded_rows(file: &[u8], row_length: usize, rows: usize) -> Result<Vec<&[u8]>, CodeError> {
    let table_length = 4 * rows;
    let Some((table, mut rest)) = file.split_at_checked(table_length) else {
        return Err(CodeError::Table { found: file.len(), expected: table_length });
    };
    let lengths = table.as_chunks::<4>().0.iter().map(|&bytes| u32::from_le_bytes(bytes) as usize);
    let (least, most) = (least_coded(row_length), most_coded(row_length));
    for (row, found) in lengths.clone().enumerate() {
        if !(least..=most).contains(&found) {
            return Err(CodeError::RowLength { row, found, least, most });
        }
    }
    let expected = table_length + lengths.clone().sum::<usize>();
    if expected != file.len() {
        return Err(CodeError::Length { found: file.len(), expected });
    }
    Ok(lengths
        .map(|length| {
            let (row, after) = rest.split_at(length);
            rest = after;
            row
        })
        .collect())
}

/// Where the next three equal bytes are, from `start` on.
///
/// Eight places at a time: a byte of `differ` is 0 where it equals both bytes after it, and the
/// lowest such byte is found exactly (Warren, "Hacker's Delight", section 6-1).
fn next_run(row: &[u8], start: usize) -> Option<usize> {
    let mut at = start;
    while let Some(window) = row.get(at..).and_then(|rest| rest.first_chunk::<10>()) {
        let word = |skip: usize| {
            window[skip..].first_chunk().map_or(0, |&eight| u64::from_le_bytes(eight))
        };
        let differ = (word(0) ^ word(1)) | (word(0) ^ word(2));
        let zero = differ.wrapping_sub(LOW_BITS) & !differ & (LOW_BITS << 7);
        if zero != 0 {
            return Some(at + zero.trailing_zeros() as usize / 8);
        }
        at += 8;
    }
    let rest = row[at..].windows(SHORTEST_RUN);
    rest.enumerate().find(|(_, three)| three.iter().all(|&b| b == three[0])).map(|(i, _)| at + i)
}

/// How often the first byte comes at the start of `row`, at most [`LONGEST`].
fn run_length(row: &[u8]) -> usize {
    let row = &row[..row.len().min(LONGEST)];
    let pattern = u64::from(row[0]) * LOW_BITS;
    let mut run = 0;
    for &eight in row.as_chunks().0 {
        let differ = u64::from_le_bytes(eight) ^ pattern;
        if differ != 0 {
            return run + differ.trailing_zeros() as usize / 8;
        }
        run += 8;
    }
    run + row[run..].iter().take_while(|&&byte| byte == row[0]).count()
}

/// Copies `count` bytes after the code, and up to a step more.
#[inline]
fn copy_steps(source: &[u8; FAR], target: &mut [u8; FAR], count: usize) {
    let steps = source[1..].as_chunks::<STEP>().0.iter().zip(target.as_chunks_mut().0);
    for (from, to) in steps.take(count.div_ceil(STEP)) {
        *to = *from;
    }
}

/// Writes `byte` `count` times, and up to a step more.
#[inline]
fn fill_steps(byte: u8, target: &mut [u8; FAR], count: usize) {
    for to in target.as_chunks_mut::<STEP>().0.iter_mut().take(count.div_ceil(STEP)) {
        *to = [byte; STEP];
    }
}

fn encode_literals(literals: &[u8], coded: &mut Vec<u8>) {
    for stretch in literals.chunks(LONGEST) {
        coded.push(code(stretch.len() - 1));
        coded.extend_from_slice(stretch);
    }
}

fn code(value: usize) -> u8 {
    u8::try_from(value).expect("runs and stretches have at most 128 bytes")
}

impl fmt::Display for RowError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Underrun { found, expected } => {
                write!(f, "ends after {found} bytes, expected {expected}")
            }
            Self::Overrun { found, expected } => {
                write!(f, "runs to {found} bytes, expected {expected}")
            }
            Self::Unused => f.write_str("has the code 128, which is not used"),
            Self::Trailing { found } => write!(f, "is followed by {found} bytes, expected none"),
        }
    }
}

impl fmt::Display for CodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Table { found, expected } => {
                write!(f, "{found} bytes, expected a table of {expected} bytes")
            }
            Self::RowLength { row, found, least, most } => {
                write!(f, "row {row} has {found} coded bytes, expected {least} to {most}")
            }
            Self::Length { found, expected } => {
                write!(f, "{found} bytes, expected {expected} by its table")
            }
            Self::Row { row, error } => write!(f, "row {row} {error}"),
        }
    }
}

impl Error for RowError {}
impl Error for CodeError {}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn coded(row: &[u8]) -> Vec<u8> {
        let mut coded = Vec::new();
        encode_row(row, &mut coded);
        coded
    }

    fn decoded(coded: &[u8], length: usize) -> Result<Vec<u8>, RowError> {
        let mut row = vec![0; length];
        decode_row(coded, &mut row).map(|()| row)
    }

    /// The coder byte by byte.
    fn plainly_coded(row: &[u8]) -> Vec<u8> {
        let (mut coded, mut literal, mut at) = (Vec::new(), 0, 0);
        while at < row.len() {
            let run = row[at..].iter().take(LONGEST).take_while(|&&byte| byte == row[at]).count();
            if run >= SHORTEST_RUN {
                encode_literals(&row[literal..at], &mut coded);
                coded.extend([code(257 - run), row[at]]);
                literal = at + run;
            }
            at += run;
        }
        encode_literals(&row[literal..], &mut coded);
        coded
    }

    /// The decoder code by code; nothing where the row is damaged.
    fn plainly_decoded(coded: &[u8], length: usize) -> Option<Vec<u8>> {
        let (mut row, mut at) = (Vec::new(), 0);
        while at < coded.len() {
            let count = usize::from(coded[at]);
            if count < 128 {
                row.extend(coded.get(at + 1..at + count + 2)?);
                at += count + 2;
            } else {
                row.extend(vec![*coded.get(at + 1)?; 257 - count]);
                at += 2;
                if count == 128 {
                    return None;
                }
            }
            if row.len() >= length {
                break;
            }
        }
        (row.len() == length && at == coded.len()).then_some(row)
    }

    #[test]
    fn rows_are_coded_as_published() {
        assert_eq!(coded(&[0; 512]), [0x81, 0].repeat(4));
        assert_eq!(
            coded(&[1, 2, 2, 3, 3, 3, 3, 4]),
            [0x02, 0x01, 0x02, 0x02, 0xfd, 0x03, 0x00, 0x04]
        );
        // Apple, Technical Note TN1023.
        let sample = [
            0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0xaa, 0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0x22,
            0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa,
        ];
        let packed = [
            0xfe, 0xaa, 0x02, 0x80, 0x00, 0x2a, 0xfd, 0xaa, 0x03, 0x80, 0x00, 0x2a, 0x22, 0xf7,
            0xaa,
        ];
        assert_eq!(coded(&sample), packed);
        assert_eq!(decoded(&packed, 24), Ok(sample.to_vec()));
        let noise: Vec<u8> = (0..512_u16).map(|i| (i * 37 % 251).to_le_bytes()[0]).collect();
        assert_eq!(coded(&noise).len(), 516);
    }

    #[test]
    fn damaged_rows_are_refused() {
        assert_eq!(decoded(&[0xfe, 7], 4), Err(RowError::Underrun { found: 3, expected: 4 }));
        assert_eq!(decoded(&[0x03, 7, 7], 4), Err(RowError::Underrun { found: 0, expected: 4 }));
        assert_eq!(decoded(&[0xfe], 3), Err(RowError::Underrun { found: 0, expected: 3 }));
        assert_eq!(decoded(&[0xfd, 7], 3), Err(RowError::Overrun { found: 4, expected: 3 }));
        assert_eq!(decoded(&[0x80, 0xfe, 7], 3), Err(RowError::Unused));
        assert_eq!(decoded(&[0xfe, 7, 0x80], 3), Err(RowError::Trailing { found: 1 }));
    }

    #[test]
    fn a_file_is_a_table_and_rows() {
        let file = encode(&[5, 5, 5, 5, 1, 2, 3, 4], 4);
        assert_eq!(file, [2, 0, 0, 0, 5, 0, 0, 0, 0xfd, 5, 3, 1, 2, 3, 4]);
        assert_eq!(decode(&file, 4, 2), Ok(vec![5, 5, 5, 5, 1, 2, 3, 4]));
        assert_eq!(decode(&file[..7], 4, 2), Err(CodeError::Table { found: 7, expected: 8 }));
        assert_eq!(decode(&file[..14], 4, 2), Err(CodeError::Length { found: 14, expected: 15 }));
        assert_eq!(
            decode(&[6, 0, 0, 0], 4, 1),
            Err(CodeError::RowLength { row: 0, found: 6, least: 2, most: 5 })
        );
        let row = CodeError::Row { row: 1, error: RowError::Unused };
        let mut damaged = file;
        damaged[10] = 0x80;
        assert_eq!(decode(&damaged, 4, 2), Err(row));
    }

    #[test]
    fn a_large_file_names_the_first_damaged_row() {
        let mut file = encode(&vec![9; 1024 * 128], 128);
        for row in [300, 700] {
            file[4 * 1024 + 2 * row] = 0x80;
        }
        let error = CodeError::Row { row: 300, error: RowError::Unused };
        assert_eq!(decode(&file, 128, 1024), Err(error));
    }

    fn rows() -> impl Strategy<Value = Vec<u8>> {
        prop::sample::select(vec![0_u8, 1, 2, 255])
            .prop_flat_map(|largest| prop::collection::vec(0..=largest, 1..1500))
    }

    proptest! {
        #[test]
        fn rows_come_back(row in rows()) {
            let coded = coded(&row);
            prop_assert_eq!(&coded, &plainly_coded(&row));
            prop_assert!(coded.len() <= most_coded(row.len()));
            prop_assert!(coded.len() >= least_coded(row.len()));
            prop_assert_eq!(decoded(&coded, row.len()), Ok(row.clone()));
            // No shorter or longer code gives the same row.
            prop_assert!(decoded(&coded[..coded.len() - 1], row.len()).is_err());
            prop_assert!(decoded(&[&coded[..], &[0]].concat(), row.len()).is_err());
        }

        #[test]
        fn any_bytes_decode_or_fail(
            bytes in prop::collection::vec(any::<u8>(), 1..600),
            length in 1_usize..3000,
        ) {
            prop_assert_eq!(decoded(&bytes, length).ok(), plainly_decoded(&bytes, length));
            // The same bytes for a row as long as they give, and a byte longer and shorter.
            let whole = (1..bytes.len()).find_map(|end| {
                let length = decoded_length(&bytes[..end])?;
                (end > 400).then_some((end, length))
            });
            if let Some((end, length)) = whole {
                for length in length - 1..=length + 1 {
                    let plain = plainly_decoded(&bytes[..end], length);
                    prop_assert_eq!(decoded(&bytes[..end], length).ok(), plain);
                }
            }
        }
    }

    /// Bytes that whole codes give.
    fn decoded_length(coded: &[u8]) -> Option<usize> {
        let (mut length, mut at) = (0, 0);
        while at < coded.len() {
            let code = usize::from(coded[at]);
            let (count, taken) = if code < 128 { (code + 1, code + 2) } else { (257 - code, 2) };
            if code == 128 {
                return None;
            }
            (length, at) = (length + count, at + taken);
        }
        (at == coded.len()).then_some(length)
    }
}
