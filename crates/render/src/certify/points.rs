//! Which points of pixels are looked at when it is known what their parts show.
//!
//! A whole pixel of one surface is sampled as without proofs. In one that is divided, the parts that show one surface share
//! samples of their own, and so do those that nothing is known of, as many as they are; each sample counts for its
//! share of the area. A pixel of which nothing is known gets at least [`PLAIN`] samples.

use super::quadtree::{Part, Plan, Proof, Witness};
use super::verdict::Surface;
use crate::film::Piece;
use crate::options::{Rate, Sampling};
use crate::sampling::pattern::{Pattern, pixel_seed};
use crate::sampling::sequence::Draw;
use crate::tile::Shot;

/// Samples of a pixel of which nothing is proved, a square.
const PLAIN: u32 = 16;

/// Small things that are looked for in such a pixel, at most.
const MOST_WITNESSES: usize = 64;
/// Shares of a pixel are multiples of its inverse.
const FINEST_SHARE: f64 = 1_048_576.0;

/// A ray, and what it counts for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look {
    pub(crate) half: usize,
    /// Number in the piece.
    pub(crate) pixel: usize,
    pub(crate) weight: f32,
    pub(crate) shot: Shot,
}

/// Which points, for one picture.
#[derive(Clone, Debug)]
pub(crate) struct Points {
    whole: Pattern,
    /// For pixels of which nothing is known: alone among others edges run through them, which points drawn by lot
    /// measure best; wherever there are many of them, as without proofs.
    alone: Pattern,
    among_others: Pattern,
    drawn: bool,
    seed: u32,
    /// What the weights in the halves of a pixel add up to.
    counts: [u32; 2],
}

/// Parts of a pixel that show the same.
struct Group<'a> {
    proved: Option<Option<Surface>>,
    parts: Vec<&'a Part>,
    area: f64,
}

impl Points {
    /// None where the number of samples depends on what is seen.
    pub(crate) fn new(sampling: Sampling, seed: u32) -> Option<Self> {
        let whole = Pattern::new(sampling, seed)?;
        let [first, second] = whole.counts();
        let drawn = matches!(sampling, Sampling::Stochastic(_));
        let more = match sampling {
            _ if first + second >= PLAIN => sampling,
            _ => Sampling::Stochastic(Rate::Samples(PLAIN)),
        };
        let alone = Pattern::new(more, seed)?;
        let among_others = match more {
            Sampling::Stochastic(_) if !drawn => Pattern::new(Sampling::Grid(PLAIN.isqrt()), seed)?,
            _ => alone.clone(),
        };
        let counts = if drawn { [first, second] } else { [first + second, 0] };
        Some(Self { whole, alone, among_others, drawn, seed, counts })
    }

    /// What the weights in the halves of a pixel add up to.
    pub(crate) fn counts(&self) -> [u32; 2] {
        self.counts
    }

    /// The rays of all pixels of a piece.
    pub(crate) fn looks(&self, piece: &Piece, plan: &Plan, looks: &mut Vec<Look>) {
        looks.clear();
        let mut witnesses = plan.witnesses.as_slice();
        for (pixel, proof) in plan.proofs.iter().enumerate() {
            let own = witnesses.partition_point(|witness| witness.pixel as usize <= pixel);
            let (own, others) = witnesses.split_at(own);
            witnesses = others;
            let place = piece.pixel(pixel);
            match *proof {
                Proof::Whole(_) => self.pattern(&self.whole, pixel, place, 1.0, looks),
                Proof::Open { alone } => {
                    let own = &own[..own.len().min(MOST_WITNESSES)];
                    let left = self.witnesses(own, pixel, place, looks);
                    let pattern = if alone { &self.alone } else { &self.among_others };
                    self.pattern(pattern, pixel, place, left, looks);
                }
                Proof::Parts { first, count } => {
                    let parts = &plan.parts[first as usize..][..count as usize];
                    self.parts(parts, pixel, place, looks);
                }
            }
        }
    }

    /// Points all over a pixel, which count for a share of it.
    fn pattern(
        &self,
        pattern: &Pattern,
        pixel: usize,
        place: [i32; 2],
        share: f64,
        looks: &mut Vec<Look>,
    ) {
        let [first, second] = pattern.counts();
        let side = pattern.side();
        let corner = place.map(f64::from);
        looks.extend(pattern.samples(place.map(i32::cast_unsigned)).map(|sample| {
            let (half, count) = if self.drawn {
                (sample.half, [first, second][sample.half])
            } else {
                (0, first + second)
            };
            let weight = share * f64::from(self.counts[half]) / f64::from(count);
            let place = (corner[0] + sample.x, corner[1] + sample.y);
            let draw = if self.is_middle() { Draw::MIDDLE } else { sample.draw };
            look(half, pixel, weight, Shot { place, side, draw })
        }));
    }

    /// Rays to small things in a pixel; the share of it that is left to others.
    fn witnesses(
        &self,
        witnesses: &[Witness],
        pixel: usize,
        place: [i32; 2],
        looks: &mut Vec<Look>,
    ) -> f64 {
        let all: f64 = witnesses.iter().map(|witness| witness.share).sum();
        let scale = if all > 0.5 { 0.5 / all } else { 1.0 };
        let mut left = 1.0;
        for witness in witnesses {
            // No rounding, as above.
            let share = libm::ceil(scale * witness.share * FINEST_SHARE) / FINEST_SHARE;
            left -= share;
            for half in self.halves() {
                let shot = Shot {
                    place: witness.place.into(),
                    side: share.sqrt(),
                    draw: self.draw(place, half, 0),
                };
                looks.push(look(half, pixel, share * f64::from(self.counts[half]), shot));
            }
        }
        left
    }

    fn parts(&self, parts: &[Part], pixel: usize, place: [i32; 2], looks: &mut Vec<Look>) {
        let mut groups: Vec<Group<'_>> = Vec::new();
        for part in parts {
            let area = 4.0 * part.cell.half * part.cell.half;
            if let Some(at) = part.witness {
                for half in self.halves() {
                    let draw = self.draw(place, half, 0);
                    let shot = Shot { place: at.into(), side: area.sqrt(), draw };
                    looks.push(look(half, pixel, area * f64::from(self.counts[half]), shot));
                }
                continue;
            }
            match groups.iter_mut().find(|group| group.proved == part.proved) {
                Some(group) => {
                    group.parts.push(part);
                    group.area += area;
                }
                None => groups.push(Group { proved: part.proved, parts: vec![part], area }),
            }
        }
        let halves = self.halves().count();
        for group in &groups {
            for half in self.halves() {
                let open = group.proved.is_none();
                // As many as a pixel of which nothing is proved has in the same area.
                let least = if open { PLAIN } else { 0 }.div_ceil(u32::from(halves == 2) + 1);
                let rate = self.counts[half].max(least);
                let by_area = libm::ceil(f64::from(rate) * group.area);
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "few")]
                let mut count = by_area as u32;
                if open {
                    let each = u32::try_from(group.parts.len().div_ceil(halves));
                    count = count.max(each.expect("a pixel has few parts"));
                }
                // Areas are powers of two: so shares have no rounding, and add up to the whole.
                let count = count.max(1).next_power_of_two();
                let share = group.area / f64::from(count);
                for number in 0..count {
                    let draw = self.draw(place, half, number);
                    let [x, y] = if self.drawn {
                        let [x, y, ..] = draw.start();
                        [x, y]
                    } else if open {
                        let seed = pixel_seed(place.map(i32::cast_unsigned), 0, self.seed);
                        let [x, y, ..] = Draw::new(number, seed).start();
                        [x, y]
                    } else {
                        [(f64::from(number) + 0.5) / f64::from(count), 0.5]
                    };
                    let shot = Shot { place: group.point(x, y).into(), side: share.sqrt(), draw };
                    looks.push(look(half, pixel, share * f64::from(self.counts[half]), shot));
                }
            }
        }
    }

    fn halves(&self) -> impl Iterator<Item = usize> + use<> {
        let counts = self.counts;
        (0..2).filter(move |&half| counts[half] > 0)
    }

    /// One sample a pixel chooses the middle of everything.
    fn is_middle(&self) -> bool {
        !self.drawn && self.counts == [1, 0]
    }

    /// What a sample of a pixel that is not sampled as others are chooses.
    fn draw(&self, place: [i32; 2], half: usize, number: u32) -> Draw {
        if self.is_middle() {
            return Draw::MIDDLE;
        }
        let half = u32::from(half == 1);
        Draw::new(number, pixel_seed(place.map(i32::cast_unsigned), half, self.seed))
    }
}

impl Group<'_> {
    /// A point of the parts from one of a square: evenly over their area, first by its left side.
    fn point(&self, x: f64, y: f64) -> [f64; 2] {
        let mut before = x * self.area;
        let last = self.parts.len() - 1;
        for (number, part) in self.parts.iter().enumerate() {
            let side = 2.0 * part.cell.half;
            if before < side * side || number == last {
                let across = (before / (side * side)).clamp(0.0, 1.0);
                let [left, top] = part.cell.middle.map(|at| at - part.cell.half);
                return [left + across * side, top + y * side];
            }
            before -= side * side;
        }
        unreachable!("the last part takes what is left")
    }
}

fn look(half: usize, pixel: usize, weight: f64, shot: Shot) -> Look {
    #[expect(clippy::cast_possible_truncation, reason = "sums on film are f32")]
    let weight = weight as f32;
    Look { half, pixel, weight, shot }
}
