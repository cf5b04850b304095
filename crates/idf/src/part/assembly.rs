//! Parts put together to the picture they are of.

use std::collections::BTreeSet;

use super::canvas::lines;
use super::{Canvas, Part, PartError, Share, Tiles, unmark};
use crate::image::{Image, Matte, Properties, Window};
use crate::memory::check;
use crate::plane::Kind;
use crate::samples::Depth;
use crate::transfer::Transfer;

/// A picture of which some parts are there.
#[derive(Debug)]
pub struct Assembly {
    part: Part,
    canvas: Canvas,
    /// Channels of the first part, in their order; coverage follows the light.
    kinds: Vec<Kind>,
    form: (Option<Transfer>, Matte),
    depth: Depth,
    properties: Properties,
    /// Parts without coverage, which are covered.
    covered: Vec<Share>,
    has_coverage: bool,
    seen: Vec<bool>,
    shares: Vec<Share>,
}

impl Assembly {
    /// Begins with one part.
    ///
    /// # Errors
    ///
    /// If the image is no part, or its checksum is wrong, or there is no memory for the picture.
    pub fn new(image: &Image) -> Result<Self, PartError> {
        let part = Part::of(image)?.ok_or(PartError::NoPart)?;
        let [columns, rows] = part.canvas;
        let pixels = u64::from(columns) * u64::from(rows);
        check(pixels).map_err(PartError::Memory)?;
        let mut properties = image.properties.clone();
        properties.origin = [0, 0];
        let mut assembly = Self {
            part,
            canvas: Canvas::new(Window { column: 0, row: 0, columns, rows })?,
            kinds: Vec::new(),
            form: (properties.transfer, properties.matte),
            depth: image.depth(),
            properties: Properties { history: Vec::new(), background: None, ..properties },
            covered: Vec::new(),
            has_coverage: false,
            seen: vec![false; columns as usize * rows as usize],
            shares: Vec::new(),
        };
        assembly.kinds = kinds(image);
        assembly.put(image, part)?;
        Ok(assembly)
    }

    /// Adds one part; after an error the picture is as it was before.
    ///
    /// # Errors
    ///
    /// If the image is no part, or its checksum is wrong, or it is of another picture, or has a pixel that
    /// another part has.
    pub fn add(&mut self, image: &Image) -> Result<(), PartError> {
        let part = Part::of(image)?.ok_or(PartError::NoPart)?;
        if (part.picture, part.canvas) != (self.part.picture, self.part.canvas) {
            return Err(PartError::Picture);
        }
        let other = kinds(image);
        if self.kinds != other {
            return Err(PartError::Channels { first: self.kinds.clone(), other });
        }
        if (image.properties.transfer, image.properties.matte) != self.form {
            return Err(PartError::Light);
        }
        let twice = part.share.windows(part.canvas).find_map(|window| self.first_seen(window));
        if let Some(pixel) = twice {
            return Err(PartError::Twice { other: self.holder(pixel), pixel });
        }
        self.put(image, part)
    }

    /// The picture, covered by its parts, each pixel once. Its channels, and what it says, are those of a
    /// picture made at once; the histories of the parts follow each other.
    ///
    /// # Errors
    ///
    /// [`PartError::Missing`] with the numbers of the parts that are missing.
    pub fn finish(self) -> Result<Image, PartError> {
        let missing = self.seen.iter().filter(|&&seen| !seen).count();
        if let Some(first) = self.seen.iter().position(|&seen| !seen) {
            let parts = self.missing();
            let pixel = place(first, self.part.canvas);
            return Err(PartError::Missing { parts, pixels: missing as u64, pixel });
        }
        let Self { part, mut canvas, mut kinds, covered, has_coverage, depth, properties, .. } =
            self;
        if has_coverage {
            for window in covered.iter().flat_map(|share| share.windows(part.canvas)) {
                canvas.cover(depth, window)?;
            }
            let light = [Kind::Red, Kind::Grn, Kind::Blu, Kind::Grg];
            let after = kinds.iter().rposition(|kind| light.contains(kind));
            kinds.insert(after.map_or(0, |at| at + 1), Kind::Cvg);
        }
        let mut image = canvas.into_image(&kinds)?;
        image.properties = properties;
        unmark(&mut image);
        Ok(image)
    }

    /// Numbers of the parts that are not there: where the first is one of tiles, of those that have any.
    pub fn missing(&self) -> Vec<u32> {
        let Share::Tiles(Tiles { count, side, .. }) = self.part.share else { return Vec::new() };
        let numbers = self.shares.iter().filter_map(|share| match share {
            Share::Tiles(tiles) if (tiles.count, tiles.side) == (count, side) => Some(tiles.number),
            _ => None,
        });
        let there: BTreeSet<u32> = numbers.collect();
        let is_missing = |&number: &u32| {
            !there.contains(&number)
                && Tiles { number, count, side }
                    .windows(self.part.canvas)
                    .any(|window| self.first_unseen(window))
        };
        (0..count).filter(is_missing).collect()
    }

    fn put(&mut self, image: &Image, part: Part) -> Result<(), PartError> {
        let windows = || part.share.windows(part.canvas);
        for plane in image.planes() {
            for window in windows() {
                self.canvas.put(plane.kind, &plane.samples, image.window(), window)?;
            }
        }
        if image.plane(Kind::Cvg).is_some() {
            self.has_coverage = true;
        } else {
            self.covered.push(part.share);
        }
        let frame = self.frame();
        for line in windows().flat_map(|window| lines(frame, window)) {
            self.seen[line].fill(true);
        }
        if self.properties.background.is_none() {
            self.properties.background = image.properties.background;
        }
        self.properties.history.extend(image.properties.history.iter().cloned());
        self.shares.push(part.share);
        Ok(())
    }

    fn frame(&self) -> Window {
        let [columns, rows] = self.part.canvas;
        Window { column: 0, row: 0, columns, rows }
    }

    fn first_seen(&self, window: Window) -> Option<[u32; 2]> {
        let mut places = lines(self.frame(), window).flatten();
        places.find(|&at| self.seen[at]).map(|at| place(at, self.part.canvas))
    }

    fn first_unseen(&self, window: Window) -> bool {
        lines(self.frame(), window).flatten().any(|at| !self.seen[at])
    }

    /// The part that has a pixel.
    fn holder(&self, [column, row]: [u32; 2]) -> String {
        let inside = |window: &Window| {
            let within = |at: u32, from: i32, length: u32| {
                (0..i64::from(length)).contains(&(i64::from(at) - i64::from(from)))
            };
            within(column, window.column, window.columns) && within(row, window.row, window.rows)
        };
        let has = |share: &&Share| share.windows(self.part.canvas).any(|window| inside(&window));
        self.shares.iter().find(has).map_or_else(String::new, ToString::to_string)
    }
}

/// Column and row of a pixel by its number.
fn place(number: usize, canvas: [u32; 2]) -> [u32; 2] {
    let number = u32::try_from(number).expect("at most 2³¹");
    [number % canvas[0], number / canvas[0]]
}

/// Kinds of an image but coverage, which may be there in some parts alone.
fn kinds(image: &Image) -> Vec<Kind> {
    image.kinds().into_iter().filter(|&kind| kind != Kind::Cvg).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Plane;
    use crate::samples::Samples;

    const CANVAS: [u32; 2] = [20, 12];

    fn pixels(window: Window, value: impl Fn(u32, u32) -> u8) -> Samples {
        let mut samples = Vec::new();
        for row in 0..window.rows {
            for column in 0..window.columns {
                samples.push(value(
                    window.column.unsigned_abs() + column,
                    window.row.unsigned_abs() + row,
                ));
            }
        }
        Samples::U8(samples)
    }

    fn grey(column: u32, row: u32) -> u8 {
        u8::try_from(column * 12 + row).unwrap()
    }

    /// A part of a picture whose pixels count up; `cvg` is 7, where it is there.
    fn part(share: Share, covers: bool) -> Image {
        let frame = share.frame(CANVAS);
        let mut planes = vec![Plane { kind: Kind::Grg, samples: pixels(frame, grey) }];
        if covers {
            planes.push(Plane { kind: Kind::Cvg, samples: pixels(frame, |_, _| 7) });
        }
        let mut image = Image::new(frame.columns, frame.rows, planes).unwrap();
        image.properties.origin = [frame.column, frame.row];
        image.properties.background = covers.then_some([0.5; 3]);
        image.properties.history = vec![share.to_string()];
        Part { share, canvas: CANVAS, picture: 5 }.mark(&mut image);
        image
    }

    fn tiles(number: u32, count: u32) -> Share {
        Share::Tiles(Tiles { number, count, side: 4 })
    }

    fn window(column: i32, row: i32, columns: u32, rows: u32) -> Share {
        Share::Window(Window { column, row, columns, rows })
    }

    fn assembled(parts: &[Image]) -> Result<Image, PartError> {
        let mut assembly = Assembly::new(&parts[0])?;
        parts[1..].iter().try_for_each(|part| assembly.add(part))?;
        assembly.finish()
    }

    #[test]
    fn parts_in_any_order_make_the_picture() {
        let whole = Window { column: 0, row: 0, columns: 20, rows: 12 };
        for shares in [
            vec![tiles(2, 3), tiles(0, 3), tiles(1, 3)],
            vec![window(0, 5, 20, 7), window(7, 0, 13, 5), window(0, 0, 7, 5)],
        ] {
            for covering in [0, 1, 3] {
                let parts: Vec<Image> = shares
                    .iter()
                    .enumerate()
                    .map(|(number, &share)| part(share, number < covering))
                    .collect();
                let image = assembled(&parts).unwrap();
                assert_eq!(image.plane(Kind::Grg), Some(&pixels(whole, grey)));
                assert_eq!(image.window(), whole);
                assert!(image.properties.unknown.is_empty(), "no part: {:?}", image.properties);
                assert_eq!(image.properties.background, (covering > 0).then_some([0.5; 3]));
                assert_eq!(image.properties.history.len(), 3);
                let coverage = image.plane(Kind::Cvg);
                assert_eq!(coverage.is_some(), covering > 0, "only if a part has it");
                if let Some(Samples::U8(coverage)) = coverage {
                    let of = shares[..covering].iter().flat_map(|share| share.windows(CANVAS));
                    let area: u32 = of.map(|w| w.columns * w.rows).sum();
                    let found = coverage.iter().filter(|&&c| c == 7).count();
                    assert_eq!(found, area as usize);
                    assert!(coverage.iter().all(|&c| c == 7 || c == 255), "else covered");
                    assert_eq!(image.kinds(), [Kind::Grg, Kind::Cvg]);
                }
            }
        }
    }

    #[test]
    fn what_is_missing_or_doubled_is_named() {
        let four = [0, 1, 2, 3].map(|number| part(tiles(number, 4), false));
        let message = |parts: &[Image]| assembled(parts).unwrap_err().to_string();
        assert_eq!(
            message(&[four[2].clone(), four[0].clone()]),
            "parts 1, 3 are missing: 112 pixels are not covered, the first at column 4, row 0"
        );
        assert_eq!(
            message(&[four[2].clone(), four[0].clone(), four[3].clone(), four[0].clone()]),
            "column 0, row 0 is in part 0 of 4, too"
        );
        assert_eq!(
            message(&[four[2].clone(), part(tiles(0, 2), false)]),
            "column 8, row 0 is in part 2 of 4, too"
        );
        assert_eq!(
            message(&[part(window(0, 0, 20, 11), false), part(window(0, 11, 19, 1), false)]),
            "1 pixel is not covered, the first at column 19, row 11"
        );
        assert_eq!(
            message(&[part(window(0, 0, 20, 11), false), part(window(3, 10, 5, 2), false)]),
            "column 3, row 10 is in window 0,0,20,11, too"
        );
    }

    #[test]
    fn parts_of_other_pictures_are_refused() {
        let first = part(tiles(0, 2), false);
        let mut assembly = Assembly::new(&first).unwrap();
        let second = part(tiles(1, 2), false);
        let mark = |image: &Image, part: Part| {
            let mut image = image.clone();
            part.mark(&mut image);
            image
        };
        let own = Part { share: tiles(1, 2), canvas: CANVAS, picture: 5 };
        let other = mark(&second, Part { picture: 6, ..own });
        assert_eq!(assembly.add(&other), Err(PartError::Picture));
        let mut plain = second.clone();
        unmark(&mut plain);
        assert_eq!(assembly.add(&plain), Err(PartError::NoPart));
        assert!(matches!(Assembly::new(&plain), Err(PartError::NoPart)));
        let deep = Plane { kind: Kind::Grg, samples: Samples::U16(vec![9; 240]) };
        let deep = mark(&second.with_planes(20, 12, vec![deep]).unwrap(), own);
        assert!(matches!(assembly.add(&deep), Err(PartError::Depth { .. })));
        let red = Plane { kind: Kind::Red, samples: pixels(own.share.frame(CANVAS), grey) };
        let red = mark(&second.with_planes(20, 12, vec![red]).unwrap(), own);
        assert!(matches!(assembly.add(&red), Err(PartError::Channels { .. })));
        let mut linear = second.clone();
        linear.properties.transfer = Some(Transfer::Linear);
        assert_eq!(assembly.add(&mark(&linear, own)), Err(PartError::Light));
        assert_eq!(assembly.missing(), [1]);
        assembly.add(&second).unwrap();
        assert!(assembly.finish().is_ok(), "nothing of the others was taken");
    }
}
