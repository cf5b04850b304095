//! What is decided once for a composite: canvas, channels, depth, tables, and the way to work.

use std::ops::Range;
use std::sync::Arc;

use idf::part::is_part;
use idf::{
    Depth, Image, ImageError, Kind, Matte, Plane, Properties, Samples, Transfer, Window,
    checked_size,
};
use rayon::prelude::*;

use crate::Options;
use crate::canvas::{fitted, shared_rows, union, zeros};
use crate::kernel::{Target, bytes, coded, float, plain, straight, weighted};
use crate::operator::{NONE, Operator, Rule, Share};
use crate::store::{Curve, Decoder, Encoder, full};

/// A composite of certain layers, ready to be worked out for any rows.
#[derive(Debug)]
pub struct Plan {
    pub(crate) rule: Rule,
    pub(crate) factor: f64,
    pub(crate) stored: bool,
    pub(crate) depth: Depth,
    pub(crate) transfer: Transfer,
    pub(crate) matte: Matte,
    pub(crate) layers: Vec<Layer>,
    pub(crate) light: Encoder,
    pub(crate) coverage: Encoder,
    pub(crate) way: Way,
    window: Window,
    kinds: Vec<Kind>,
    properties: Properties,
}

/// One picture of a composite.
#[derive(Debug)]
pub(crate) struct Layer {
    pub(crate) window: Window,
    pub(crate) matte: Matte,
    /// The plane for each plane of light in the result, none where the layer is black.
    pub(crate) light: Vec<Option<(Kind, Arc<Decoder>)>>,
    /// The plane of coverage, once the layer fills the canvas; none where it covers all.
    pub(crate) coverage: Option<(Kind, Decoder)>,
    /// How light of the layer's depth is stored.
    transfer: Transfer,
}

/// How pixels are worked out.
#[derive(Debug)]
pub(crate) enum Way {
    /// Any pictures; see [`crate::kernel::plain`].
    Plain,
    /// Two of linear bytes; see [`crate::kernel::bytes`].
    Bytes,
    /// Two of bytes; see [`crate::kernel::coded`].
    Coded(Box<coded::Tables>),
    /// Two of bytes of any matte; see [`crate::kernel::straight`].
    Straight(Box<straight::Tables>),
    /// Two of integers of any matte and transfer, with the curve of the result's if it is not
    /// linear; see [`crate::kernel::weighted`].
    Weighted(Option<weighted::Curve>),
    /// Two of linear floating point; see [`crate::kernel::float`].
    Float,
}

/// Pixels that one thread works out at a time; the planes of two layers stay in the cache for it.
fn task(depth: Depth) -> usize {
    match depth {
        Depth::U8 | Depth::U16 => 1 << 14,
        // Limited by memory, which gives long runs of one plane faster.
        Depth::F32 => 1 << 16,
    }
}

/// A layer before its plan: an image of the same channels, and where all of it lies.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// Any rows of the layer, with colours in place of indices.
    pub sample: &'a Image,
    /// The whole of the layer on the canvas.
    pub window: Window,
}

impl Plan {
    /// Plans a composite of `sources`, first to last: one for an operator of one picture, else any
    /// number, folded from the left.
    ///
    /// # Errors
    ///
    /// If the union of the windows is larger than an image, or a layer has only a part of a colour.
    pub fn new(
        operator: &Operator,
        sources: &[Source<'_>],
        options: &Options,
    ) -> Result<Self, ImageError> {
        let window = union(sources.iter().map(|source| source.window))?;
        checked_size(window.columns, window.rows)?;
        let depth = sources.iter().map(|s| s.sample.depth()).max().unwrap_or(Depth::U8);
        let transfers: Vec<Transfer> =
            sources.iter().map(|s| s.sample.transfer(s.sample.depth())).collect();
        let common = transfers.first().filter(|&first| transfers.iter().all(|t| t == first));
        let transfer = common.copied().unwrap_or(depth.usual_transfer());
        let mut kinds = Vec::new();
        for source in sources {
            let light = source.sample.light_kinds()?;
            if light.len() > kinds.len() {
                kinds = light;
            }
        }
        let fills = |source: &Source<'_>| {
            source.window == window && source.sample.plane(Kind::Cvg).is_none()
        };
        let opaque: Vec<bool> = sources.iter().map(fills).collect();
        let mut decoders = Vec::new();
        let layers = sources.iter().map(|source| {
            let fills = fills(source);
            Layer::new(source, &kinds, fills, depth, transfer, options.stored, &mut decoders)
        });
        let layers = layers.collect::<Result<Vec<_>, ImageError>>()?;
        let matte = matte(operator, sources, options);
        // What was stored straight is stored as it is.
        let as_it_is = options.stored && matte == Matte::Straight;
        let light = Encoder::new(depth, if as_it_is { Transfer::Linear } else { transfer });
        let mut plan = Self {
            rule: operator.rule,
            factor: options.factor,
            stored: options.stored,
            depth,
            transfer,
            matte,
            layers,
            light,
            coverage: Encoder::new(depth, Transfer::Linear),
            way: Way::Plain,
            window,
            kinds,
            properties: Properties::default(),
        };
        if !covers_all(operator.rule, options.factor, &opaque) || plan.kinds.is_empty() {
            plan.kinds.push(Kind::Cvg);
        }
        plan.properties = plan.described(sources);
        plan.way = plan.fastest(sources);
        Ok(plan)
    }

    /// Columns and rows of the result.
    pub fn size(&self) -> [u32; 2] {
        [self.window.columns, self.window.rows]
    }

    /// Where the result lies: the union of the layers' windows.
    pub fn window(&self) -> Window {
        self.window
    }

    /// The channels of the result: light, and coverage unless it is 1 wherever the layers have
    /// what coverage.
    pub fn kinds(&self) -> &[Kind] {
        &self.kinds
    }

    /// The depth of all channels: that of the deepest layer.
    pub fn depth(&self) -> Depth {
        self.depth
    }

    /// What the result says besides its samples, but for its history.
    pub fn properties(&self) -> &Properties {
        &self.properties
    }

    /// What the result says of itself. The background is what lies behind all: that of the last
    /// layer that has one, among those of which something can be left.
    fn described(&self, sources: &[Source<'_>]) -> Properties {
        let shown = match self.rule {
            Rule::Two { b: NONE, .. } => &sources[..1],
            Rule::Two { a: NONE, .. } => &sources[sources.len() - 1..],
            Rule::Two { .. } | Rule::One { .. } => sources,
        };
        let covered = self.kinds.contains(&Kind::Cvg);
        let mut unknown = Vec::new();
        for line in sources.iter().flat_map(|source| &source.sample.properties.unknown) {
            // What is composited of a part is none.
            if !unknown.contains(line) && !is_part(line) {
                unknown.push(line.clone());
            }
        }
        Properties {
            origin: [self.window.column, self.window.row],
            transfer: Some(self.transfer).filter(|&t| t != self.depth.usual_transfer()),
            matte: if covered { self.matte } else { Matte::Premultiplied },
            background: shown
                .iter()
                .rev()
                .find_map(|source| source.sample.properties.background)
                .filter(|_| covered),
            unknown,
            history: Vec::new(),
        }
    }

    /// The fast way for two pictures of one depth, where there is one.
    fn fastest(&self, sources: &[Source<'_>]) -> Way {
        let premultiplied =
            |layer: &Layer| layer.coverage.is_none() || layer.matte == Matte::Premultiplied;
        let alike = |source: &Source<'_>| {
            let mut planes = source.sample.planes().iter();
            planes.all(|p| !self.uses(p.kind) || p.samples.depth() == self.depth)
        };
        let black = |layer: &Layer| layer.light.iter().any(Option::is_none);
        let [a, b] = self.layers.as_slice() else { return Way::Plain };
        if self.stored || !sources.iter().all(alike) || self.layers.iter().any(black) {
            return Way::Plain;
        }
        let transfers = [a.transfer, b.transfer, self.transfer];
        let linear = transfers.iter().all(|&transfer| transfer == Transfer::Linear);
        let premultiplied =
            self.matte == Matte::Premultiplied && self.layers.iter().all(premultiplied);
        let coded = || coded::Tables::new([a.transfer, b.transfer], self.transfer);
        match self.depth {
            Depth::U8 if linear && premultiplied => return Way::Bytes,
            Depth::U8 if premultiplied => {
                if let Some(tables) = coded() {
                    return Way::Coded(Box::new(tables));
                }
            }
            Depth::U8 => {
                let transfers = [a.transfer, b.transfer];
                if let Some(tables) = straight::Tables::new(transfers, self.transfer) {
                    return Way::Straight(Box::new(tables));
                }
            }
            Depth::F32 if linear && premultiplied => return Way::Float,
            Depth::F32 => return Way::Plain,
            Depth::U16 => {}
        }
        let curve = || weighted::Curve::new(self.transfer, &self.light, full(self.depth));
        match self.transfer {
            Transfer::Linear if linear => Way::Weighted(None),
            // Different transfers meet in the usual one, which is not linear for integers.
            Transfer::Linear => Way::Plain,
            Transfer::Srgb | Transfer::Gamma(_) => Way::Weighted(Some(curve())),
        }
    }

    /// Whether the light of all layers is stored as that of the result.
    pub(crate) fn stored_alike(&self) -> bool {
        self.layers.iter().all(|layer| layer.transfer == self.transfer)
    }

    /// One integer sample of two layers, rounded once: `light` and `coverage` of the layers, in units
    /// of which `full` make 1, and coverage of the result, of which the square of that make 1.
    pub(crate) fn weighted(
        &self,
        shares: [Share; 2],
        light: [f64; 2],
        coverage: [f64; 2],
        covered: f64,
    ) -> u16 {
        let full = full(self.depth);
        let term = |layer: usize| {
            let by = if self.layers[layer].is_straight() { coverage[layer] } else { full };
            light[layer] * by * shares[layer].of(coverage[1 - layer], full)
        };
        let weight = if self.matte == Matte::Straight { covered } else { full * full };
        self.light.sample(term(0) + term(1), weight)
    }

    /// Whether a layer's channel counts.
    fn uses(&self, kind: Kind) -> bool {
        let light = self.layers.iter().flat_map(|layer| layer.light.iter().flatten());
        kind == Kind::Cvg || light.into_iter().any(|(used, _)| *used == kind)
    }

    /// Rows of a layer that lie among `rows` of the result, counted from the top of the layer; empty
    /// where none do.
    pub fn rows_of(&self, layer: usize, rows: Range<u32>) -> Range<u32> {
        shared_rows(self.layers[layer].window, self.window, rows)
    }

    /// Some rows of the result, counted from its top. `images` has for each layer the rows that
    /// [`Plan::rows_of`] names, with colours in place of indices, or nothing where there are none.
    ///
    /// # Errors
    ///
    /// If an image has not the rows or the channels of its layer.
    pub fn band(&self, images: &[Option<&Image>], rows: Range<u32>) -> Result<Image, ImageError> {
        let pixels = self.window.columns as usize * rows.len();
        let mut planes: Vec<Samples> =
            self.kinds.iter().map(|_| zeros(pixels, self.depth)).collect();
        self.fill(images, rows.clone(), &mut planes)?;
        let planes = self.kinds.iter().zip(planes);
        let planes = planes.map(|(&kind, samples)| Plane { kind, samples }).collect();
        let mut image = Image::new(self.window.columns, rows.end - rows.start, planes)?;
        let [column, row] = self.properties.origin;
        let origin = [column, row.saturating_add_unsigned(rows.start)];
        image.properties = Properties { origin, ..self.properties.clone() };
        Ok(image)
    }

    /// As [`Plan::band`], into planes that are there: one for each of [`Plan::kinds`], of
    /// [`Plan::depth`].
    ///
    /// # Errors
    ///
    /// As [`Plan::band`], and if a plane has another length.
    pub fn fill(
        &self,
        images: &[Option<&Image>],
        rows: Range<u32>,
        planes: &mut [Samples],
    ) -> Result<(), ImageError> {
        let expected = self.window.columns as usize * rows.len();
        for (&kind, plane) in self.kinds.iter().zip(&*planes) {
            if plane.len() != expected {
                let (found, expected) = (plane.len(), expected as u64);
                return Err(ImageError::Length { kind, found, expected });
            }
        }
        let layers = self.layers.iter().enumerate().map(|(position, layer)| {
            let image = images.get(position).copied().flatten();
            let own = self.rows_of(position, rows.clone());
            if let Some(image) = image {
                let (found, expected) = (image.size(), [layer.window.columns, own.end - own.start]);
                if found != expected {
                    return Err(ImageError::Size { columns: found[0], rows: found[1] });
                }
            }
            fitted(layer, image.filter(|_| !own.is_empty()), self.window, rows.clone(), self.depth)
        });
        let layers = layers.collect::<Result<Vec<_>, _>>()?;
        let layers: Vec<&Image> = layers.iter().map(AsRef::as_ref).collect();
        let length = task(self.depth);
        let mut tasks: Vec<(usize, Vec<Target<'_>>)> =
            (0..expected.div_ceil(length)).map(|task| (task * length, Vec::new())).collect();
        for plane in planes {
            let stretches = Target::stretches(plane, length);
            tasks.iter_mut().zip(stretches).for_each(|(task, stretch)| task.1.push(stretch));
        }
        if tasks.len() == 1 {
            return tasks.into_iter().try_for_each(|task| self.stretch(&layers, task));
        }
        tasks.into_par_iter().try_for_each(|task| self.stretch(&layers, task))
    }

    /// Works out a stretch of pixels.
    fn stretch(
        &self,
        layers: &[&Image],
        (start, mut targets): (usize, Vec<Target<'_>>),
    ) -> Result<(), ImageError> {
        match (&self.way, self.rule) {
            (Way::Bytes, Rule::Two { a, b }) => {
                bytes::planes(self, [a, b], layers, start, &mut targets)
            }
            (Way::Coded(tables), Rule::Two { a, b }) => {
                coded::planes(self, tables, [a, b], layers, start, &mut targets)
            }
            (Way::Straight(tables), Rule::Two { a, b }) => {
                straight::planes(self, tables, [a, b], layers, start, &mut targets)
            }
            (Way::Weighted(curve), Rule::Two { a, b }) => {
                weighted::planes(self, curve.as_ref(), [a, b], layers, start, &mut targets)
            }
            (Way::Float, Rule::Two { a, b }) => {
                float::planes(self, [a, b], layers, start, &mut targets)
            }
            _ => plain::composite(self, layers, start, &mut targets),
        }
    }
}

impl Layer {
    /// Whether its light is that of the covered part.
    pub(crate) fn is_straight(&self) -> bool {
        self.coverage.is_some() && self.matte == Matte::Straight
    }

    fn new(
        source: &Source<'_>,
        kinds: &[Kind],
        fills: bool,
        depth: Depth,
        transfer: Transfer,
        stored: bool,
        decoders: &mut Vec<Arc<Decoder>>,
    ) -> Result<Self, ImageError> {
        let image = source.sample;
        let matte = match image.plane(Kind::Cvg) {
            Some(_) => image.properties.matte,
            // Where there is nothing, light is none too, so both hold; this is the shorter way.
            None if stored => Matte::Straight,
            None => Matte::Premultiplied,
        };
        let own = image.light_kinds()?;
        let mut decoder = |kind: Kind| {
            let plane_depth = image.needed(kind)?.depth();
            let to = match (stored, matte) {
                (true, Matte::Straight) => transfer,
                (true, Matte::Premultiplied) | (false, _) => Transfer::Linear,
            };
            let curve = Curve { from: image.transfer(plane_depth), to };
            let known = decoders.iter().find(|known| known.is_for(plane_depth, curve)).cloned();
            let new = || Arc::new(Decoder::new(plane_depth, curve, full(depth)));
            let decoder = known.unwrap_or_else(new);
            decoders.push(Arc::clone(&decoder));
            Ok((kind, decoder))
        };
        let light = kinds.iter().map(|kind| {
            let grey = own.iter().find(|own| **own == Kind::Grg);
            own.iter().find(|own| *own == kind).or(grey).copied().map(&mut decoder).transpose()
        });
        let coverage = (!fills).then(|| {
            let plane_depth = image.plane(Kind::Cvg).map_or(depth, |samples| samples.depth());
            let curve = Curve { from: Transfer::Linear, to: Transfer::Linear };
            (Kind::Cvg, Decoder::new(plane_depth, curve, full(depth)))
        });
        Ok(Self {
            window: source.window,
            matte,
            light: light.collect::<Result<_, ImageError>>()?,
            coverage,
            transfer: image.transfer(image.depth()),
        })
    }

    /// The depth that a plane of the layer has or, for coverage that is filled in, gets.
    pub(crate) fn depth_of(&self, kind: Kind) -> Option<Depth> {
        let light = self.light.iter().flatten().map(|plane| (plane.0, plane.1.depth()));
        let coverage = self.coverage.iter().map(|plane| (plane.0, plane.1.depth()));
        light.chain(coverage).find(|plane| plane.0 == kind).map(|plane| plane.1)
    }
}

/// How light and coverage go together in the result. What is opaque has no relation, and counts as
/// any; light that covers nothing cannot be straight.
fn matte(operator: &Operator, sources: &[Source<'_>], options: &Options) -> Matte {
    let luminous = operator.rule == Rule::One { light: false, coverage: true };
    let mut covered = sources.iter().map(|source| source.sample);
    let mut any = false;
    let straight = covered.all(|image| {
        let has = image.plane(Kind::Cvg).is_some();
        any |= has;
        !has || image.properties.matte == Matte::Straight
    });
    let own = if any && straight { Matte::Straight } else { Matte::Premultiplied };
    if luminous { Matte::Premultiplied } else { options.matte.unwrap_or(own) }
}

/// Whether the result's coverage is 1 whatever that of the layers is which are not `opaque`. It is
/// linear in each of them, so the corners tell.
fn covers_all(rule: Rule, factor: f64, opaque: &[bool]) -> bool {
    match rule {
        Rule::One { coverage, .. } => opaque.iter().all(|&o| o) && (!coverage || factor >= 1.0),
        Rule::Two { a, b } => {
            let corners = |opaque: bool| if opaque { vec![1.0] } else { vec![0.0, 1.0] };
            let mut results = corners(opaque[0]);
            for &next in &opaque[1..] {
                let next = corners(next);
                let pairs = results.iter().flat_map(|&x| next.iter().map(move |&y| (x, y)));
                let coverage = |(x, y)| f64::min(1.0, a.of(y, 1.0) * x + b.of(x, 1.0) * y);
                results = pairs.map(coverage).collect();
                results.sort_by(f64::total_cmp);
                results.dedup();
            }
            results.iter().all(|&result| result >= 1.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operator::OPERATORS;

    #[test]
    fn only_what_is_always_covered_needs_no_coverage() {
        let always = |opaque: &[bool]| -> Vec<&str> {
            let two = OPERATORS.iter().filter(|row| matches!(row.rule, Rule::Two { .. }));
            two.filter(|row| covers_all(row.rule, 1.0, opaque)).map(|row| row.name).collect()
        };
        let both = ["a", "b", "over", "rover", "in", "rin", "atop", "ratop", "plus"];
        assert_eq!(always(&[true, true]), both);
        assert_eq!(always(&[false, true]), ["b", "over", "rover", "atop", "plus"]);
        assert_eq!(always(&[true, false]), ["a", "over", "rover", "ratop", "plus"]);
        assert!(always(&[false, false]).is_empty());
    }

    /// A picture of random integers.
    fn noise(seed: u32, depth: Depth, transfer: Transfer, matte: Matte) -> Image {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // Stretches of nothing and all among the rest.
            match state >> 29 {
                0 => 0,
                1 => u16::MAX,
                _ => u16::from_le_bytes([state.to_le_bytes()[1], state.to_le_bytes()[2]]),
            }
        };
        let mut plane = |kind| {
            let words = (0..40_000).map(|at: u32| match at / 100 % 5 {
                // Blocks that are alike.
                0 if kind == Kind::Cvg => u16::MAX * u16::from(seed == 1),
                1 if kind == Kind::Cvg => u16::MAX * u16::from(seed != 1),
                _ => next(),
            });
            let words: Vec<u16> = words.collect();
            let samples = match depth {
                Depth::U8 => Samples::U8(words.iter().map(|word| word.to_le_bytes()[1]).collect()),
                _ => Samples::U16(words),
            };
            Plane { kind, samples }
        };
        let planes = [Kind::Red, Kind::Grn, Kind::Blu, Kind::Cvg].map(&mut plane);
        let mut image = Image::new(200, 200, planes.into()).unwrap();
        image.properties.transfer = Some(transfer);
        image.properties.matte = matte;
        image
    }

    #[test]
    fn the_fast_ways_are_the_plain_one() {
        let mattes = [Matte::Straight, Matte::Premultiplied];
        let mattes = mattes.into_iter().flat_map(|a| mattes.map(|b| [a, b]));
        let transfers =
            [Transfer::Linear, Transfer::Srgb, Transfer::Gamma(2.2)].map(|transfer| [transfer; 2]);
        let transfers = transfers.into_iter().chain([[Transfer::Linear, Transfer::Gamma(0.5)]]);
        for (transfers, mattes) in transfers.flat_map(|t| mattes.clone().map(move |m| (t, m))) {
            for depth in [Depth::U8, Depth::U16] {
                let images = [(1, 0), (2, 1)]
                    .map(|(seed, which)| noise(seed, depth, transfers[which], mattes[which]));
                let sources =
                    images.each_ref().map(|image| Source { sample: image, window: image.window() });
                let rows = images.each_ref().map(Some);
                for row in OPERATORS.iter().filter(|row| matches!(row.rule, Rule::Two { .. })) {
                    let mut plan = Plan::new(row, &sources, &Options::default()).unwrap();
                    assert!(!matches!(plan.way, Way::Plain), "{}", row.name);
                    let fast = plan.band(&rows, 0..200).unwrap();
                    plan.way = Way::Plain;
                    let what = format!("{} {transfers:?} {mattes:?} {depth:?}", row.name);
                    assert!(fast == plan.band(&rows, 0..200).unwrap(), "{what}");
                }
            }
        }
    }
}
