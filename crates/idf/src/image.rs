//! `Image`: planes in memory, all of one size.

use std::error::Error;
use std::fmt;
use std::ops::Range;

use crate::lut::Lut;
use crate::memory::MemoryError;
use crate::plane::{COLOR, Kind, Role};
use crate::samples::{Depth, Samples};
use crate::transfer::Transfer;

/// Most samples of a plane.
pub const MOST_SAMPLES: u64 = 1 << 31;
/// Most columns of a plane.
pub const MOST_COLUMNS: u32 = 1 << 24;

/// How colour and coverage go together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Matte {
    /// Light is multiplied by coverage, and then stored by the transfer.
    #[default]
    Premultiplied,
    /// Light is that of the covered part alone.
    Straight,
}

/// A rectangle on the canvas, in pixels from its top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Leftmost column.
    pub column: i32,
    /// Topmost row.
    pub row: i32,
    /// Width.
    pub columns: u32,
    /// Height.
    pub rows: u32,
}

/// One channel of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// What it holds.
    pub kind: Kind,
    /// Row by row from the top.
    pub samples: Samples,
}

/// What an image says besides its samples. Any value is valid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Properties {
    /// Column and row of the top left pixel on the canvas.
    pub origin: [i32; 2],
    /// How light is stored; without it, as is usual for the depth of each plane.
    pub transfer: Option<Transfer>,
    /// How colour and coverage go together.
    pub matte: Matte,
    /// Display values (sRGB, 0 to 1) of what to put behind where coverage is below 1.
    pub background: Option<[f64; 3]>,
    /// Lines of the description that this version does not know, and comments; kept.
    pub unknown: Vec<String>,
    /// Lines of the log, oldest first.
    pub history: Vec<String>,
}

/// Planes in memory, all of one size.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    columns: u32,
    rows: u32,
    planes: Vec<Plane>,
    /// The colour table, if there is one.
    pub lut: Option<Lut>,
    /// What the image says besides its samples.
    pub properties: Properties,
}

/// Why planes do not make an image, or an image not another.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ImageError {
    /// No pixels, or more than an image may have.
    Size {
        /// Width.
        columns: u32,
        /// Height.
        rows: u32,
    },
    /// A plane has another number of samples than its image pixels.
    Length {
        /// The plane.
        kind: Kind,
        /// Its samples.
        found: usize,
        /// The image's pixels.
        expected: u64,
    },
    /// Two planes of one kind.
    Twice(Kind),
    /// Not a kind that has pixels.
    NotPixels(Kind),
    /// Indices that are not 8 bits deep.
    IndexDepth(Depth),
    /// A plane that the work needs is not there.
    Missing {
        /// The plane.
        kind: Kind,
        /// What is there.
        present: Vec<Kind>,
    },
    /// An index beyond the end of the colour table.
    Index {
        /// The index.
        found: u8,
        /// Colours in the table.
        colors: usize,
    },
    /// A sample is not a number and cannot be stored as an integer.
    NotANumber {
        /// The plane.
        kind: Kind,
        /// Column of the sample.
        column: usize,
        /// Row of the sample.
        row: usize,
    },
    /// What is made of it does not fit into memory.
    Memory(MemoryError),
}

impl Image {
    /// An image of `planes`; the renderer's door.
    ///
    /// ```
    /// use idf::{Image, Kind, Plane, Samples};
    ///
    /// let planes = vec![Plane { kind: Kind::Grg, samples: Samples::U8(vec![0, 64, 128, 255]) }];
    /// let image = Image::new(2, 2, planes)?;
    /// assert_eq!(image.size(), [2, 2]);
    /// # Ok::<(), idf::ImageError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the size is 0 or beyond [`MOST_COLUMNS`] and [`MOST_SAMPLES`], a plane has another number
    /// of samples, a kind comes twice or has no pixels, or `enc` is not 8 bits deep.
    pub fn new(columns: u32, rows: u32, planes: Vec<Plane>) -> Result<Self, ImageError> {
        let expected = checked_size(columns, rows)?;
        for (position, plane) in planes.iter().enumerate() {
            let kind = plane.kind;
            if !kind.has_pixels() {
                return Err(ImageError::NotPixels(kind));
            }
            if planes[..position].iter().any(|other| other.kind == kind) {
                return Err(ImageError::Twice(kind));
            }
            if plane.samples.len() as u64 != expected {
                return Err(ImageError::Length { kind, found: plane.samples.len(), expected });
            }
            if kind.role() == Role::Index && plane.samples.depth() != Depth::U8 {
                return Err(ImageError::IndexDepth(plane.samples.depth()));
            }
        }
        Ok(Self { columns, rows, planes, lut: None, properties: Properties::default() })
    }

    /// The same image with other planes, and with all else as it is.
    ///
    /// # Errors
    ///
    /// As [`Image::new`].
    pub fn with_planes(
        &self,
        columns: u32,
        rows: u32,
        planes: Vec<Plane>,
    ) -> Result<Self, ImageError> {
        let image = Self::new(columns, rows, planes)?;
        Ok(Self { lut: self.lut.clone(), properties: self.properties.clone(), ..image })
    }

    /// Some of the rows, with all else as it is.
    pub(crate) fn band(&self, rows: Range<u32>) -> Result<Self, ImageError> {
        let columns = self.columns as usize;
        let part = rows.start as usize * columns..rows.end as usize * columns;
        let band =
            |plane: &Plane| Plane { kind: plane.kind, samples: plane.samples.part(part.clone()) };
        let planes = self.planes.iter().map(band).collect();
        self.with_planes(self.columns, rows.end - rows.start, planes)
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        [self.columns, self.rows]
    }

    /// Width.
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// Height.
    pub fn rows(&self) -> u32 {
        self.rows
    }

    /// Where the picture lies on a larger one.
    pub fn window(&self) -> Window {
        let [column, row] = self.properties.origin;
        Window { column, row, columns: self.columns, rows: self.rows }
    }

    /// All planes, in the order they were given.
    pub fn planes(&self) -> &[Plane] {
        &self.planes
    }

    /// All planes, in the order they were given, without the image.
    pub fn into_planes(self) -> Vec<Plane> {
        self.planes
    }

    /// The samples of one plane.
    pub fn plane(&self, kind: Kind) -> Option<&Samples> {
        self.planes.iter().find(|plane| plane.kind == kind).map(|plane| &plane.samples)
    }

    /// The samples of a plane that the work needs.
    ///
    /// # Errors
    ///
    /// If it is not there; the error lists what is.
    pub fn needed(&self, kind: Kind) -> Result<&Samples, ImageError> {
        self.plane(kind).ok_or_else(|| ImageError::Missing { kind, present: self.kinds() })
    }

    /// The kinds that are there, the colour table among them.
    pub fn kinds(&self) -> Vec<Kind> {
        let lut = self.lut.is_some().then_some(Kind::Lut);
        self.planes.iter().map(|plane| plane.kind).chain(lut).collect()
    }

    /// Planes of the picture's light: colour if any of it is there, else grey, else none.
    ///
    /// # Errors
    ///
    /// If one or two of red, green and blue are there without the others.
    pub fn light_kinds(&self) -> Result<Vec<Kind>, ImageError> {
        if COLOR.iter().any(|&kind| self.plane(kind).is_some()) {
            for kind in COLOR {
                self.needed(kind)?;
            }
            return Ok(COLOR.to_vec());
        }
        Ok(self.plane(Kind::Grg).map(|_| Kind::Grg).into_iter().collect())
    }

    /// The deepest light or coverage, or 8 bits where there is none.
    pub fn depth(&self) -> Depth {
        let depths = self
            .planes
            .iter()
            .filter(|plane| matches!(plane.kind.role(), Role::Light | Role::Coverage));
        depths.map(|plane| plane.samples.depth()).max().unwrap_or(Depth::U8)
    }

    /// Bytes of all planes.
    pub fn bytes(&self) -> u64 {
        let bytes =
            |plane: &Plane| plane.samples.len() as u64 * plane.samples.depth().bytes() as u64;
        self.planes.iter().map(bytes).sum()
    }

    /// How the light of `depth` is stored here.
    pub fn transfer(&self, depth: Depth) -> Transfer {
        self.properties.transfer.unwrap_or_else(|| depth.usual_transfer())
    }

    /// Linear values of a plane, premultiplied or not as they are stored; coverage and data are
    /// scaled but not decoded.
    ///
    /// # Errors
    ///
    /// If the plane is not there.
    pub fn decoded(&self, kind: Kind) -> Result<Vec<f32>, ImageError> {
        let samples = self.needed(kind)?;
        Ok(samples.decoded(self.plane_transfer(kind, samples.depth())))
    }

    /// The transfer of a plane: that of light for light, linear for all else.
    pub(crate) fn plane_transfer(&self, kind: Kind, depth: Depth) -> Transfer {
        match kind.role() {
            Role::Light => self.transfer(depth),
            _ => Transfer::Linear,
        }
    }
}

/// Pixels of an image of this size.
///
/// # Errors
///
/// If it is 0 or beyond [`MOST_COLUMNS`] and [`MOST_SAMPLES`].
pub fn checked_size(columns: u32, rows: u32) -> Result<u64, ImageError> {
    let pixels = u64::from(columns) * u64::from(rows);
    if pixels == 0 || pixels > MOST_SAMPLES || columns > MOST_COLUMNS {
        return Err(ImageError::Size { columns, rows });
    }
    Ok(pixels)
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size { columns, rows } => write!(
                f,
                "{columns} x {rows} pixels, expected 1 to {MOST_SAMPLES} in at most \
                 {MOST_COLUMNS} columns"
            ),
            Self::Length { kind, found, expected } => {
                write!(f, "`{kind}` has {found} samples, expected {expected}")
            }
            Self::Twice(kind) => write!(f, "`{kind}` comes twice"),
            Self::NotPixels(kind) => write!(f, "`{kind}` has no pixels"),
            Self::IndexDepth(depth) => {
                write!(f, "indices have a depth of {}, expected 8", depth.word())
            }
            Self::Missing { kind, present } => {
                write!(f, "no `{kind}`, found {}", words(present))
            }
            Self::Index { found, colors } => {
                write!(f, "index {found}, expected one of {colors} colours")
            }
            Self::NotANumber { kind, column, row } => {
                write!(f, "`{kind}` is not a number at column {column}, row {row}")
            }
            Self::Memory(error) => write!(f, "the work {error}"),
        }
    }
}

impl Error for ImageError {}

impl From<MemoryError> for ImageError {
    fn from(error: MemoryError) -> Self {
        Self::Memory(error)
    }
}

/// Words of `kinds`, for a message.
pub(crate) fn words(kinds: &[Kind]) -> String {
    if kinds.is_empty() {
        return "no channels".into();
    }
    kinds.iter().map(|kind| kind.word()).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(kind: Kind, length: usize) -> Plane {
        Plane { kind, samples: Samples::U8(vec![0; length]) }
    }

    #[test]
    fn planes_have_one_size() {
        let error = Image::new(2, 3, vec![plane(Kind::Red, 6), plane(Kind::Grn, 5)]);
        let expected = ImageError::Length { kind: Kind::Grn, found: 5, expected: 6 };
        assert_eq!(error, Err(expected));
    }

    #[test]
    fn impossible_images_are_refused() {
        for (columns, rows) in [(0, 1), (1, 0), (1 << 24, 129), ((1 << 24) + 1, 1)] {
            let error = Image::new(columns, rows, Vec::new());
            assert_eq!(error, Err(ImageError::Size { columns, rows }));
        }
        let twice = vec![plane(Kind::Cvg, 1), plane(Kind::Cvg, 1)];
        assert_eq!(Image::new(1, 1, twice), Err(ImageError::Twice(Kind::Cvg)));
        for kind in [Kind::Lut, Kind::Log] {
            let error = Image::new(1, 1, vec![plane(kind, 1)]);
            assert_eq!(error, Err(ImageError::NotPixels(kind)));
        }
        let deep = Plane { kind: Kind::Enc, samples: Samples::U16(vec![0]) };
        assert_eq!(Image::new(1, 1, vec![deep]), Err(ImageError::IndexDepth(Depth::U16)));
    }

    #[test]
    fn half_a_color_is_refused() {
        let image = Image::new(1, 1, vec![plane(Kind::Red, 1), plane(Kind::Blu, 1)]).unwrap();
        let missing = ImageError::Missing { kind: Kind::Grn, present: vec![Kind::Red, Kind::Blu] };
        assert_eq!(image.light_kinds(), Err(missing.clone()));
        assert_eq!(missing.to_string(), "no `grn`, found red blu");
    }

    #[test]
    fn floating_point_is_linear_unless_it_says_otherwise() {
        let red = Plane { kind: Kind::Red, samples: Samples::F32(vec![0.5]) };
        let mut image = Image::new(1, 1, vec![red]).unwrap();
        assert_eq!(image.decoded(Kind::Red), Ok(vec![0.5]));
        image.properties.transfer = Some(Transfer::Srgb);
        assert_eq!(image.decoded(Kind::Red), Ok(vec![0.214_041_14]));
    }
}
