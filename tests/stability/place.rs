//! Scenes in other sizes and places, and in a mirror.

use glam::DVec3;
use render::Options;
use scene::{LightKind, Scene};

use super::case::{Found, Written};
use crate::support::{Shown, root, shown};

impl Written {
    pub(crate) fn new(file: &'static str, definitions: &[(&'static str, f64)]) -> Self {
        Self { file, definitions: definitions.to_vec() }
    }

    /// What the compiler makes of the file.
    pub(crate) fn compiled(&self) -> compile::Compiled {
        let name = |&(name, value): &(&str, f64)| (name.to_owned(), value);
        let options = compile::Options {
            definitions: self.definitions.iter().map(name).collect(),
            ..compile::Options::default()
        };
        compile::compile_path_with(&root().join("scenes/extreme").join(self.file), &options)
    }

    /// The scene.
    pub(crate) fn scene(&self) -> Scene {
        let compiled = self.compiled();
        let report = compiled.error_report();
        compiled.scene.unwrap_or_else(|| panic!("{}: {report}", self.file))
    }
}

/// Does something to every place of a scene and to the sizes of what stands in it.
fn changed(
    mut scene: Scene,
    place: impl Fn(DVec3) -> DVec3,
    frame: impl Fn(&mut scene::Placement),
) -> Scene {
    if let Some(camera) = &mut scene.camera {
        camera.position = place(camera.position);
        camera.target = place(camera.target);
    }
    if let Some(lens) = &mut scene.lens {
        lens.focus = place(lens.focus);
    }
    for light in &mut scene.lights {
        match &mut light.kind {
            LightKind::Point { at } => *at = place(*at),
            LightKind::Beam { at, toward } | LightKind::Spot { at, toward, .. } => {
                *at = place(*at);
                *toward = place(*toward);
            }
        }
    }
    for object in &mut scene.objects {
        // What is in a frame follows it.
        for outer in object.solid.frames.iter_mut().filter(|frame| frame.parent.is_none()) {
            outer.placement.place = place(outer.placement.place);
            frame(&mut outer.placement);
        }
    }
    scene
}

/// Everything `factor` times as large.
pub(crate) fn scaled(scene: Scene, factor: f64) -> Scene {
    let mut scene = changed(scene, |place| place * factor, |placement| placement.scale *= factor);
    for transparency in scene.attributes.iter_mut().filter_map(|set| set.transparency.as_mut()) {
        transparency.half_distance *= factor;
    }
    scene.fog_half_distance = scene.fog_half_distance.map(|distance| distance * factor);
    scene.lights.iter_mut().for_each(|light| light.radius *= factor);
    if let Some(lens) = &mut scene.lens {
        // A unit of the scene is a millimetre to the lens, whose focal length stays.
        lens.aperture /= factor;
    }
    scene
}

/// Everything in another place.
pub(crate) fn moved(scene: Scene, by: DVec3) -> Scene {
    changed(scene, |place| place + by, |_| ())
}

/// Everything as a mirror across x shows it.
pub(crate) fn mirrored(scene: Scene) -> Scene {
    let mirror = DVec3::new(-1.0, 1.0, 1.0);
    changed(
        scene,
        |place| place * mirror,
        |placement| {
            placement.scale *= mirror;
            placement.rotation_degrees *= -mirror;
        },
    )
}

/// The picture as a mirror shows it.
pub(crate) fn turned_over(picture: &Shown) -> Shown {
    let columns = picture.columns;
    let place = |i: usize| i - i % columns + (columns - 1 - i % columns);
    let all = 0..picture.pixels.len();
    Shown {
        columns,
        pixels: all.clone().map(|i| picture.pixels[place(i)]).collect(),
        coverage: all.map(|i| picture.coverage[place(i)]).collect(),
    }
}

/// Size of the pictures that are compared.
pub(crate) fn options() -> Options {
    Options { columns: 160, rows: 120, ..Options::default() }
}

/// Pixels that differ by more than `steps`.
pub(crate) fn differing(a: &Shown, b: &Shown, steps: u8) -> Found {
    Found::differing(a.differing(b, steps).len(), a.pixels.len())
}

/// How a scene differs from another.
pub(crate) fn against(scene: &Scene, base: &Shown, options: &Options, steps: u8) -> Found {
    differing(&shown(scene, options), base, steps)
}
