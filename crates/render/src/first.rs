//! Channels of what the ray through the centre of each pixel meets first: not light, and never averaged.

use glam::DVec3;
use idf::{Kind, Plane, Samples, Window};
use rayon::prelude::*;

use crate::options::Options;
use crate::sampling::place::sight;
use crate::trace::event::{Event, Events, Finder, Quest};
use crate::world::World;
use crate::{RenderError, pool};

/// The first surface along a ray, clear ones too.
#[derive(Clone, Copy, Debug)]
struct First {
    distance: f64,
    /// Unit, in the scene, toward the eye.
    normal: DVec3,
    /// Counted from 1 in the order of the scene.
    object: usize,
}

/// A channel of measured values.
struct Channel {
    kind: Kind,
    value: fn(&First) -> f64,
    /// Where the ray meets nothing.
    nothing: f64,
}

/// All of them. A new channel is a new row.
const CHANNELS: [Channel; 5] = [
    // Farther than everything, and a number.
    Channel { kind: Kind::Dep, value: |first| first.distance, nothing: f32::MAX as f64 },
    Channel { kind: Kind::Nrx, value: |first| first.normal.x, nothing: 0.0 },
    Channel { kind: Kind::Nry, value: |first| first.normal.y, nothing: 0.0 },
    Channel { kind: Kind::Nrz, value: |first| first.normal.z, nothing: 0.0 },
    Channel { kind: Kind::Obj, value: |first| first.object as f64, nothing: 0.0 },
];

/// The kinds that [`measured`] knows.
#[must_use]
pub fn measured_kinds() -> Vec<Kind> {
    CHANNELS.iter().map(|channel| channel.kind).collect()
}

/// Planes of those of `kinds` that are measured at the first surface behind the centre of each pixel: `dep` is its
/// distance along the ray from the eye in scene units, and the largest `f32` where there is none; `nrx`, `nry` and `nrz` its unit
/// normal in scene coordinates, toward the eye; `obj` the number of its object, from 1 in the order of the scene, and 0
/// where there is none.
///
/// # Errors
///
/// [`RenderError::Threads`] when there are no threads to be had.
pub fn measured(
    world: &World,
    options: &Options,
    kinds: &[Kind],
) -> Result<Vec<Plane>, RenderError> {
    let Options { columns, rows, .. } = *options;
    measured_in(world, options, kinds, &[Window { column: 0, row: 0, columns, rows }])
}

/// The same in windows of the picture alone: the samples of each window follow those of the one before.
///
/// # Errors
///
/// As [`measured`].
pub fn measured_in(
    world: &World,
    options: &Options,
    kinds: &[Kind],
    windows: &[Window],
) -> Result<Vec<Plane>, RenderError> {
    let wanted: Vec<&Channel> =
        CHANNELS.iter().filter(|channel| kinds.contains(&channel.kind)).collect();
    if wanted.is_empty() {
        return Ok(Vec::new());
    }
    let view = world.view_from.view(options.columns, options.rows);
    let lines: Vec<(i32, Window)> = windows
        .iter()
        .flat_map(|&window| (window.row..).take(window.rows as usize).map(move |row| (row, window)))
        .collect();
    let line =
        |finder: &mut Finder<'_>, &(row, window): &(i32, Window)| {
            let medium = finder.medium_at(world.eye);
            let quests: Vec<Quest> = (window.column..)
                .take(window.columns as usize)
                .map(|column| {
                    let place = (f64::from(column) + 0.5, f64::from(row) + 0.5);
                    finder.quest(sight(&view, place, (options.columns, options.rows)), medium)
                })
                .collect();
            let width = finder.width();
            let mut events = Events::new();
            let mut values = Vec::with_capacity(quests.len() * wanted.len());
            for quests in quests.chunks(width) {
                finder.events(&world.whole, quests.len(), |number| &quests[number], &mut events);
                for number in 0..quests.len() {
                    let first = events.get(number).map(|event| First::new(world, finder, event));
                    values.extend(wanted.iter().map(|channel| {
                        single(first.as_ref().map_or(channel.nothing, channel.value))
                    }));
                }
            }
            values
        };
    let rows: Vec<Vec<f32>> = pool(world, options, options.threads)?.install(|| {
        let finder = || Finder::new(world, options.accel);
        lines.par_iter().with_max_len(8).map_init(finder, line).collect()
    });
    let samples = |at: usize| {
        rows.iter().flat_map(|row| row.iter().skip(at).step_by(wanted.len()).copied()).collect()
    };
    let plane = |(at, channel): (usize, &&Channel)| {
        let values: Vec<f32> = samples(at);
        let whole = channel.kind == Kind::Obj && world.object_count() <= usize::from(u16::MAX);
        let samples = if whole { words(&values) } else { Samples::F32(values) };
        Plane { kind: channel.kind, samples }
    };
    Ok(wanted.iter().enumerate().map(plane).collect())
}

impl First {
    fn new(world: &World, finder: &Finder<'_>, event: &Event) -> Self {
        let leaf = &world.leaves[event.owner.leaf as usize];
        let rank = finder.scopes().get(event.owner.scope).rank + leaf.rank;
        Self { distance: event.t, normal: event.normal, object: world.object_of(rank) }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "planes in memory are f32")]
fn single(value: f64) -> f32 {
    let most = f64::from(f32::MAX);
    (if value < most { value } else { most }) as f32
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counted to 65 535")]
fn words(values: &[f32]) -> Samples {
    Samples::U16(values.iter().map(|&value| value as u16).collect())
}
