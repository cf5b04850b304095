//! What is known of a branch of the tree of rays before the rays that spring from it are followed, and how their light
//! is put together afterwards.

use scene::Rgb;

use super::shadow::{Lamps, Lit};
use crate::world::World;

/// What a ray sees. Where it sees the background straight, `color` lacks it and `coverage` says so:
/// `color + (1 − coverage) · background` is the whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Seen {
    pub(crate) color: Rgb,
    pub(crate) coverage: f64,
}

impl Seen {
    const BACKGROUND: Self = Self { color: Rgb::ZERO, coverage: 0.0 };
    const DARK: Self = Self { color: Rgb::ZERO, coverage: 1.0 };

    fn over(&self, background: Rgb) -> Rgb {
        self.color + (1.0 - self.coverage) * background
    }

    /// Seen through a filter. Coverage takes the mean; what tints the background beyond that goes into the colour.
    fn filtered(self, share: Rgb, background: Rgb) -> Self {
        let mean = (share.x + share.y + share.z) / 3.0;
        let open = 1.0 - self.coverage;
        Self {
            color: share * self.color + open * (share - mean) * background,
            coverage: 1.0 - mean * open,
        }
    }

    fn plus(self, light: Rgb) -> Self {
        Self { color: self.color + light, ..self }
    }
}

/// What light meets between a surface and where the ray that sees it starts.
#[derive(Clone, Copy, Debug)]
pub(super) enum Between {
    Nothing,
    /// The share that is not fogged.
    Fog(f64),
    /// The share of each channel that a body lets through.
    Body(Rgb),
}

/// A ray that springs from a surface.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sprung {
    /// Place among the mirrored rays of the next generation.
    Mirrored(u32),
    /// Place among the rays of the next generation that go through surfaces.
    Through(u32),
    /// Too deep: the background stands for it.
    Background,
    /// Too faint.
    Dark,
}

/// What the rays of the next generation see.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beyond<'a> {
    pub(super) mirrored: &'a [Seen],
    pub(super) through: &'a [Seen],
}

impl Beyond<'_> {
    fn seen(&self, ray: Sprung) -> Seen {
        match ray {
            Sprung::Mirrored(number) => self.mirrored[number as usize],
            Sprung::Through(number) => self.through[number as usize],
            Sprung::Background => Seen::BACKGROUND,
            Sprung::Dark => Seen::DARK,
        }
    }
}

/// The light a surface throws back as a mirror does.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mirrored {
    pub(super) share: Rgb,
    pub(super) ray: Sprung,
}

/// The share of a surface that is clear.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clear {
    /// 0…1; the rest is matte.
    pub(super) share: f64,
    /// Highlights and what is mirrored; none where nothing is reflected.
    pub(super) gloss: Option<Gloss>,
    pub(super) behind: Option<Behind>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Gloss {
    pub(super) highlights: Lit,
    /// Ambient light; zero where all that is reflected is traced.
    pub(super) ambient: Rgb,
    pub(super) mirrored: Option<Mirrored>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Behind {
    pub(super) share: f64,
    /// Not bent: the background is seen through it.
    pub(super) straight: bool,
    pub(super) ray: Sprung,
}

/// One branch.
#[derive(Clone, Copy, Debug)]
pub(super) enum Record {
    /// Met nothing.
    Missed,
    Met(Met),
}

/// A surface that a branch ended at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Met {
    pub(super) between: Between,
    pub(super) ambient: Rgb,
    /// Light thrown back by the body of the surface.
    pub(super) direct: Lit,
    pub(super) mirrored: Option<Mirrored>,
    /// Place among the clear surfaces of the batch.
    pub(super) clear: Option<u32>,
}

impl Record {
    /// What the branch sees, when `sprung` says what the next generation sees.
    pub(super) fn seen(
        &self,
        world: &World,
        lamps: &Lamps,
        clears: &[Clear],
        beyond: Beyond<'_>,
    ) -> Seen {
        let Self::Met(met) = self else { return Seen::BACKGROUND };
        let seen = met.surface(world, lamps, clears, beyond);
        match met.between {
            Between::Nothing => seen,
            Between::Fog(clear) => {
                Seen { color: clear * seen.color, coverage: clear * seen.coverage }
            }
            Between::Body(share) => seen.filtered(share, world.background),
        }
    }
}

impl Met {
    /// What leaves the surface.
    fn surface(&self, world: &World, lamps: &Lamps, clears: &[Clear], beyond: Beyond<'_>) -> Seen {
        let background = world.background;
        let mut light = self.ambient;
        light += lamps.sum(self.direct);
        if let Some(mirrored) = &self.mirrored {
            light += mirrored.share * beyond.seen(mirrored.ray).over(background);
        }
        let opaque = |color| Seen { color, coverage: 1.0 };
        let Some(clear) = self.clear else { return opaque(light) };
        let clear = &clears[clear as usize];
        if let Some(gloss) = &clear.gloss {
            let mut reflection = lamps.sum(gloss.highlights) + gloss.ambient;
            if let Some(mirrored) = &gloss.mirrored {
                reflection += mirrored.share * beyond.seen(mirrored.ray).over(background);
            }
            light += clear.share * reflection;
        }
        let Some(behind) = &clear.behind else { return opaque(light) };
        let seen = beyond.seen(behind.ray);
        if behind.straight {
            seen.filtered(Rgb::splat(behind.share), background).plus(light)
        } else {
            opaque(light + behind.share * seen.over(background))
        }
    }
}
