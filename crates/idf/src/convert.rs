//! One image from another: colours of indices, depth, transfer, matte, background.

use crate::image::{Image, ImageError, Matte, Plane};
use crate::memory::check;
use crate::plane::{COLOR, Kind, Role};
use crate::samples::{Depth, Samples};
use crate::transfer::Transfer;

/// How light and coverage are stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Form {
    /// Depth of light and coverage.
    pub depth: Depth,
    /// Transfer of light.
    pub transfer: Transfer,
    /// How light and coverage go together.
    pub matte: Matte,
}

/// Share of red, green and blue light in grey (ITU-R BT.709).
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

impl Image {
    /// The image with colour planes from `enc` and `lut`, where it has no light of its own.
    /// Light wins over indices when both are there. A table with coverage gives straight colours,
    /// and coverage too where the image has no plane of it.
    ///
    /// # Errors
    ///
    /// If there are indices without a table, or beyond it, or only a part of a colour.
    pub fn resolved(&self) -> Result<Self, ImageError> {
        let Some(Samples::U8(indices)) = self.plane(Kind::Enc) else {
            check(self.bytes())?;
            return Ok(self.clone());
        };
        // Colours and coverage in place of indices.
        check(self.bytes().saturating_add(3 * indices.len() as u64))?;
        if !self.light_kinds()?.is_empty() {
            return Ok(self.clone());
        }
        let missing = || ImageError::Missing { kind: Kind::Lut, present: self.kinds() };
        let lut = self.lut.as_ref().ok_or_else(missing)?;
        let colors = lut.colors();
        if let Some(&found) = indices.iter().find(|&&i| usize::from(i) >= colors.len()) {
            return Err(ImageError::Index { found, colors: colors.len() });
        }
        let channel = |(channel, kind)| {
            let samples = indices.iter().map(|&i| colors[usize::from(i)][channel]).collect();
            Plane { kind, samples: Samples::U8(samples) }
        };
        let mut planes: Vec<Plane> = COLOR.into_iter().enumerate().map(channel).collect();
        planes.extend(self.planes().iter().filter(|plane| plane.kind != Kind::Enc).cloned());
        if let Some(coverage) = lut.coverage().filter(|_| self.plane(Kind::Cvg).is_none()) {
            let samples = indices.iter().map(|&i| coverage[usize::from(i)]).collect();
            planes.insert(3, Plane { kind: Kind::Cvg, samples: Samples::U8(samples) });
        }
        let mut image = self.with_planes(self.columns(), self.rows(), planes)?;
        if lut.coverage().is_some() {
            image.properties.matte = Matte::Straight;
        }
        image.lut = None;
        Ok(image)
    }

    /// The image with light and coverage stored as `form` says. What is stored so already stays
    /// as it is, to the bit; indices and data stay in any case.
    ///
    /// # Errors
    ///
    /// If a sample is not a number and would become an integer.
    pub fn converted(&self, form: Form) -> Result<Self, ImageError> {
        let coverage = match self.plane(Kind::Cvg) {
            Some(_) if form.matte != self.properties.matte => Some(self.decoded(Kind::Cvg)?),
            _ => None,
        };
        check(self.conversion_bytes(form))?;
        let mut planes = Vec::with_capacity(self.planes().len());
        for Plane { kind, samples } in self.planes() {
            let (from, role) = (self.plane_transfer(*kind, samples.depth()), kind.role());
            let to = if role == Role::Light { form.transfer } else { Transfer::Linear };
            let coverage = coverage.as_deref().filter(|_| role == Role::Light);
            let stays = samples.depth() == form.depth && from == to && coverage.is_none();
            if stays || !matches!(role, Role::Light | Role::Coverage) {
                planes.push(Plane { kind: *kind, samples: samples.clone() });
                continue;
            }
            let mut values = samples.decoded(from);
            match (coverage, form.matte) {
                (None, _) => {}
                (Some(coverage), Matte::Premultiplied) => multiply(&mut values, coverage),
                (Some(coverage), Matte::Straight) => divide(&mut values, coverage),
            }
            planes.push(self.encoded(*kind, &values, form.depth, to)?);
        }
        let mut image = self.with_planes(self.columns(), self.rows(), planes)?;
        image.properties.matte = form.matte;
        image.properties.transfer =
            Some(form.transfer).filter(|&transfer| transfer != form.depth.usual_transfer());
        let (from, to) = (self.transfer(Depth::U8), image.transfer(Depth::U8));
        image.lut = self.lut.as_ref().map(|lut| lut.restored(from, to));
        Ok(image)
    }

    /// The image at another depth. Integers become linear light in floating point, and linear
    /// floating point becomes sRGB.
    ///
    /// # Errors
    ///
    /// If a sample is not a number and would become an integer.
    pub fn at_depth(&self, depth: Depth) -> Result<Self, ImageError> {
        let from = self.transfer(self.depth());
        let transfer = match (self.depth(), depth) {
            (Depth::F32, Depth::F32) => from,
            (_, Depth::F32) => Transfer::Linear,
            (Depth::F32, _) if from == Transfer::Linear => Transfer::Srgb,
            _ => from,
        };
        self.converted(Form { depth, transfer, matte: self.properties.matte })
    }

    /// The image with light and coverage in another relation.
    ///
    /// # Errors
    ///
    /// If a sample is not a number and would become an integer.
    pub fn with_matte(&self, matte: Matte) -> Result<Self, ImageError> {
        let depth = self.depth();
        if matte == self.properties.matte {
            check(self.bytes())?;
            return Ok(self.clone());
        }
        self.converted(Form { depth, transfer: self.transfer(depth), matte })
    }

    /// The image over a background: without coverage, opaque. `background` holds display values
    /// (sRGB); without it, the image's own is taken, and black where it has none.
    ///
    /// # Errors
    ///
    /// If the light cannot be found (see [`Image::resolved`]) or is not a number.
    pub fn flattened(&self, background: Option<[f64; 3]>) -> Result<Self, ImageError> {
        let image = self.resolved()?.with_matte(Matte::Premultiplied)?;
        check(image.bytes())?;
        let background = background.or(self.properties.background).unwrap_or_default();
        let behind = background.map(|value| Transfer::Srgb.decode(value));
        let grey = behind.iter().zip(LUMINANCE).map(|(light, share)| light * share).sum();
        let mut planes: Vec<Plane> =
            image.planes().iter().filter(|plane| plane.kind != Kind::Cvg).cloned().collect();
        if image.plane(Kind::Cvg).is_some() {
            let coverage = image.decoded(Kind::Cvg)?;
            for plane in planes.iter_mut().filter(|plane| plane.kind.role() == Role::Light) {
                let channel = COLOR.iter().position(|&kind| kind == plane.kind);
                let light = channel.map_or(grey, |channel| behind[channel]);
                let depth = plane.samples.depth();
                let transfer = image.transfer(depth);
                let mut values = plane.samples.decoded(transfer);
                put_behind(&mut values, &coverage, light);
                *plane = image.encoded(plane.kind, &values, depth, transfer)?;
            }
        }
        let mut flat = image.with_planes(image.columns(), image.rows(), planes)?;
        flat.properties.background = None;
        Ok(flat)
    }

    /// Bytes that a conversion takes: its result, and values of one plane on the way.
    fn conversion_bytes(&self, form: Form) -> u64 {
        let pixels = u64::from(self.columns()) * u64::from(self.rows());
        let stays = |plane: &Plane| {
            let depth = plane.samples.depth();
            depth == form.depth && self.plane_transfer(plane.kind, depth) == form.transfer
        };
        let light = || self.planes().iter().filter(|plane| plane.kind.role() == Role::Light);
        let is_all_kept = form.matte == self.properties.matte && light().all(stays);
        let values = if is_all_kept { 0 } else { size_of::<f32>() as u64 };
        let depth = |plane: &Plane| match plane.kind.role() {
            Role::Light | Role::Coverage => form.depth.bytes(),
            _ => plane.samples.depth().bytes(),
        };
        let result: usize = self.planes().iter().map(depth).sum();
        pixels.saturating_mul(result as u64 + values)
    }

    fn encoded(
        &self,
        kind: Kind,
        values: &[f32],
        depth: Depth,
        transfer: Transfer,
    ) -> Result<Plane, ImageError> {
        let samples = Samples::encoded(values, depth, transfer).map_err(|position| {
            let columns = self.columns() as usize;
            ImageError::NotANumber { kind, column: position % columns, row: position / columns }
        })?;
        Ok(Plane { kind, samples })
    }
}

fn multiply(values: &mut [f32], coverage: &[f32]) {
    for (value, share) in values.iter_mut().zip(coverage) {
        *value *= share;
    }
}

/// Light of the covered part alone; black where nothing is covered.
fn divide(values: &mut [f32], coverage: &[f32]) {
    for (value, &share) in values.iter_mut().zip(coverage) {
        *value = if share > 0.0 { *value / share } else { 0.0 };
    }
}

#[expect(clippy::cast_possible_truncation, reason = "planes hold 32-bit values by definition")]
fn put_behind(values: &mut [f32], coverage: &[f32], light: f64) {
    for (value, &share) in values.iter_mut().zip(coverage) {
        *value = (f64::from(*value) + (1.0 - f64::from(share)) * light) as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lut::Lut;

    fn image(planes: &[(Kind, &[u8])]) -> Image {
        let plane = |&(kind, samples): &(Kind, &[u8])| Plane {
            kind,
            samples: Samples::U8(samples.to_vec()),
        };
        let columns = u32::try_from(planes[0].1.len()).unwrap();
        Image::new(columns, 1, planes.iter().map(plane).collect()).unwrap()
    }

    #[test]
    fn indices_become_colors() {
        let mut indexed = image(&[(Kind::Enc, &[1, 0]), (Kind::Cvg, &[255, 7])]);
        let missing = ImageError::Missing { kind: Kind::Lut, present: vec![Kind::Enc, Kind::Cvg] };
        assert_eq!(indexed.resolved(), Err(missing));
        indexed.lut = Lut::new(vec![[1, 2, 3], [4, 5, 6]]);
        let expected = image(&[
            (Kind::Red, &[4, 1]),
            (Kind::Grn, &[5, 2]),
            (Kind::Blu, &[6, 3]),
            (Kind::Cvg, &[255, 7]),
        ]);
        assert_eq!(indexed.resolved(), Ok(expected));
        indexed.lut = Lut::new(vec![[1, 2, 3]]);
        assert_eq!(indexed.resolved(), Err(ImageError::Index { found: 1, colors: 1 }));
    }

    #[test]
    fn a_table_with_coverage_gives_straight_colors() {
        let mut indexed = image(&[(Kind::Enc, &[1, 0])]);
        indexed.lut = Lut::with_coverage(vec![[1, 2, 3, 255], [4, 5, 6, 9]]);
        let mut expected = image(&[
            (Kind::Red, &[4, 1]),
            (Kind::Grn, &[5, 2]),
            (Kind::Blu, &[6, 3]),
            (Kind::Cvg, &[9, 255]),
        ]);
        expected.properties.matte = Matte::Straight;
        assert_eq!(indexed.resolved(), Ok(expected));
        // A plane of coverage is finer than the table's.
        let mut both = image(&[(Kind::Enc, &[1, 0]), (Kind::Cvg, &[10, 250])]);
        both.lut.clone_from(&indexed.lut);
        let resolved = both.resolved().unwrap();
        assert_eq!(resolved.plane(Kind::Cvg), both.plane(Kind::Cvg));
        assert_eq!(resolved.properties.matte, Matte::Straight);
    }

    #[test]
    fn light_wins_over_indices() {
        let both = image(&[(Kind::Enc, &[1]), (Kind::Grg, &[9])]);
        assert_eq!(both.resolved(), Ok(both));
    }

    #[test]
    fn the_background_is_seen_where_nothing_covers() {
        // Half light over half white: 0.5 of linear white stored is 188, plus 0.5 gives 255.
        let mut picture = image(&[(Kind::Grg, &[0, 188, 200]), (Kind::Cvg, &[0, 128, 255])]);
        picture.properties.background = Some([1.0; 3]);
        let flat = picture.flattened(None).unwrap();
        assert_eq!(flat, image(&[(Kind::Grg, &[255, 255, 200])]));
        // Black behind leaves what is stored, as it is premultiplied.
        let flat = picture.flattened(Some([0.0; 3])).unwrap();
        assert_eq!(flat, image(&[(Kind::Grg, &[0, 188, 200])]));
        // A display value of 0.5 comes out as the byte for 0.5.
        let flat = picture.flattened(Some([0.5; 3])).unwrap();
        assert_eq!(flat.plane(Kind::Grg).map(|s| s.gathered(0..1)), Some(Samples::U8(vec![128])));
    }

    #[test]
    fn straight_light_and_back_gives_the_same_bytes() {
        // Every premultiplied byte that a colour in range has at every coverage.
        let mut light = Vec::new();
        let mut coverage = Vec::new();
        for cvg in 1..=255_u8 {
            let most = crate::transfer::srgb8(f64::from(cvg) / 255.0);
            light.extend(0..=most);
            coverage.extend((0..=most).map(|_| cvg));
        }
        let picture = image(&[(Kind::Grg, &light), (Kind::Cvg, &coverage)]);
        let straight = picture.with_matte(Matte::Straight).unwrap();
        assert_ne!(straight.plane(Kind::Grg), picture.plane(Kind::Grg));
        assert_eq!(straight.with_matte(Matte::Premultiplied), Ok(picture));
    }

    #[test]
    fn depth_changes_keep_what_is_seen() {
        let bytes: Vec<u8> = (0..=255).collect();
        let picture = image(&[(Kind::Grg, &bytes)]);
        let words = bytes.iter().map(|&b| u16::from(b) * 257).collect();
        let deep = picture.at_depth(Depth::U16).unwrap();
        assert_eq!(deep.plane(Kind::Grg), Some(&Samples::U16(words)));
        let float = deep.at_depth(Depth::F32).unwrap();
        assert_eq!(float.transfer(Depth::F32), Transfer::Linear);
        let Some(Samples::F32(light)) = float.plane(Kind::Grg) else { panic!("not float") };
        assert!((light[188] - 0.502_886_5).abs() < 1e-6, "{}", light[188]);
        assert_eq!(float.at_depth(Depth::U8), Ok(picture));
    }

    #[test]
    fn what_is_not_a_number_does_not_become_an_integer() {
        let samples = Samples::F32(vec![0.0, 0.0, 0.0, f32::NAN]);
        let float = Image::new(2, 2, vec![Plane { kind: Kind::Grg, samples }]).unwrap();
        let expected = ImageError::NotANumber { kind: Kind::Grg, column: 1, row: 1 };
        assert_eq!(float.at_depth(Depth::U8), Err(expected));
    }
}
