//! Random scenes with every attribute, light and statement.

use glam::DVec3;
use scene::texture::Texture;
use scene::{Attributes, Index, Light, LightKind, Paint, Rgb, Scene, Transparency};

use crate::oracle::author::{Author, Chance, Shape, Site, block, sphere};
use crate::random_csg::{Places, random};

fn of<T: Copy>(chance: &mut Chance, choices: &[T]) -> T {
    let count = u32::try_from(choices.len()).expect("few");
    choices[chance.below(count) as usize]
}

/// Once in `times`.
fn once_in(chance: &mut Chance, times: u32) -> bool {
    chance.below(times) == 0
}

/// A linear colour; black, white and full colours are more frequent than by chance.
fn color(chance: &mut Chance) -> Rgb {
    if once_in(chance, 3) {
        return Rgb::from_array([(); 3].map(|()| f64::from(chance.below(2))));
    }
    Rgb::from_array([(); 3].map(|()| chance.between(0.0, 1.0)))
}

/// A coat of paint by a function that the oracle has, too.
fn coat(chance: &mut Chance) -> Paint {
    let name = of(chance, &["checker", "stripes", "rings", "grid", "checker3d", "gradient"]);
    let mut texture = Texture::named(name).expect("a function");
    for index in 0..texture.function().parameters.len() {
        let value = match texture.function().parameters[index].name {
            "u" | "v" if name == "rings" => chance.between(0.0, 1.0),
            "width" => chance.between(0.0, 1.0),
            _ => chance.between(0.7, 5.3),
        };
        texture.set(index, value).expect("in its range");
    }
    Paint { texture, color: Some(color(chance)) }
}

/// Any attributes, most of them left open at times.
pub(crate) fn attributes(chance: &mut Chance, hue: [f64; 3]) -> Attributes {
    let body = if once_in(chance, 4) { color(chance) } else { Rgb::from_array(hue) };
    let any = chance.between(0.0, 1.0);
    let shininess = of(chance, &[None, Some(0.05), Some(0.2), Some(0.5), Some(1.0), Some(any)]);
    let slope = chance.between(0.02, 1.0);
    let smoothness = of(
        chance,
        &[None, Some(0.0), Some(0.0), Some(0.05), Some(0.12), Some(0.4), Some(0.6), Some(slope)],
    );
    let index = chance.between(0.7, 2.4);
    let indices = [
        Index::Refractive(1.0),
        Index::Refractive(1.33),
        Index::Refractive(1.5),
        Index::Refractive(index),
        Index::Fake,
        Index::Fake,
    ];
    let transparency = Transparency {
        half_distance: of(chance, &[0.5, 3.0, 20.0, 1e3]),
        index: of(chance, &indices),
    };
    let coats = [0, 0, 0, 1, 2][chance.below(5) as usize];
    Attributes {
        color: (!once_in(chance, 8)).then_some(body),
        shininess,
        smoothness,
        pure: of(chance, &[None, Some(true), Some(false)]),
        transparency: (!once_in(chance, 2)).then_some(transparency),
        priority: of(chance, &[None, None, Some(-1), Some(2)]),
        paint: (0..coats).map(|_| coat(chance)).collect(),
    }
}

/// A place in front of the scene.
fn place(chance: &mut Chance, far: f64) -> DVec3 {
    let across = chance.between(-far, far);
    DVec3::new(across, chance.between(-0.2 * far, far), chance.between(-0.3 * far, far))
}

fn light(chance: &mut Chance) -> LightKind {
    let at = place(chance, 9.0);
    let toward = place(chance, 2.0);
    match chance.below(4) {
        0 => LightKind::Beam { at, toward },
        1 => LightKind::Spot {
            at,
            toward,
            concentration: of(chance, &[0.0, 1.0, 2.5, 16.0]),
            half_angle_degrees: of(chance, &[12.0, 40.0, 75.0, 180.0]),
        },
        // In the middle of things, too.
        2 => LightKind::Point { at: toward },
        _ => LightKind::Point { at },
    }
}

/// The scene with this number.
pub(crate) fn scene(seed: u64, places: Places, site: Site) -> Scene {
    let mut chance = Chance::new(seed + 7_000_000);
    let chance = &mut chance;
    let eye = DVec3::new(chance.between(-5.0, 5.0), chance.between(-1.0, 6.0), 7.7);
    let mut author = Author::new(site, eye, DVec3::ZERO);
    let group = attributes(chance, [0.5; 3]);
    for number in 0..2 {
        let shape = random(chance, 3, places, &mut 0, &mut attributes);
        let within = number == 1 && once_in(chance, 2);
        let shape = if within {
            Shape::Group(Box::new(shape), scene::Placement::default(), group.clone())
        } else {
            shape
        };
        author.object(&shape);
    }
    let floor = Attributes { transparency: None, ..attributes(chance, [0.8; 3]) };
    author.object(&block([-8.0, -4.0, -8.0], [8.0, -3.0, 8.0], &floor));
    if once_in(chance, 6) {
        // All of it, the eye too, in a clear body.
        let transparency = Transparency { half_distance: 30.0, index: Index::Refractive(1.33) };
        let water = Attributes {
            transparency: Some(transparency),
            priority: Some(-2),
            ..attributes(chance, [0.8, 0.9, 1.0])
        };
        author.object(&sphere([0.0; 3], 12.0, &water));
    }
    for _ in 0..chance.below(4) {
        let strength = chance.between(0.1, 2.0);
        let (kind, color) = (light(chance), strength * color(chance));
        author.light(kind, color);
        let shadows = !once_in(chance, 4);
        if let Some(Light { shadows: last, .. }) = author.scene.lights.last_mut() {
            *last = shadows;
        }
    }
    let mut scene = author.finish();
    scene.ambient = chance.between(0.0, 1.0) * color(chance);
    scene.background = color(chance);
    scene.fog_half_distance = once_in(chance, 3).then(|| chance.between(3.0, 30.0) * site.scale);
    scene
}

/// A number of any size: from 10⁻`most` to 10^`most`.
#[expect(clippy::disallowed_methods, reason = "a test's own number, the same on one machine")]
fn any_size(chance: &mut Chance, most: f64) -> f64 {
    10_f64.powf(chance.between(-most, most))
}

/// Gives some of a scene's numbers the ends of their ranges, and others any size that is allowed.
pub(crate) fn go_far(chance: &mut Chance, scene: &mut Scene) {
    let share = |chance: &mut Chance| match chance.below(4) {
        0 => 0.0,
        1 => 1.0,
        2 => any_size(chance, 300.0).min(1.0),
        _ => 1.0 - f64::EPSILON,
    };
    for attributes in scene.attributes.iter_mut().skip(1) {
        if once_in(chance, 4) {
            attributes.shininess = Some(share(chance));
        }
        if once_in(chance, 4) {
            attributes.smoothness = Some(share(chance));
        }
        if let Some(transparency) = &mut attributes.transparency
            && once_in(chance, 3)
        {
            transparency.half_distance = any_size(chance, 305.0);
            let near_one = 1.0 + chance.between(-1e-9, 1e-9);
            let index = of(chance, &[1e-3, 1e3, near_one, 1.0 + f64::EPSILON, 1.0]);
            let wild = any_size(chance, 150.0);
            let index = if once_in(chance, 4) { wild } else { index };
            transparency.index = Index::Refractive(index);
        }
    }
    let camera = scene.camera.expect("a camera");
    for light in &mut scene.lights {
        if once_in(chance, 3) {
            light.color *= any_size(chance, 300.0);
        }
        match &mut light.kind {
            LightKind::Point { at } if once_in(chance, 4) => *at = camera.position,
            LightKind::Point { at } if once_in(chance, 4) => *at = camera.target,
            LightKind::Spot { concentration, half_angle_degrees, .. } => {
                if once_in(chance, 2) {
                    *concentration = any_size(chance, 300.0);
                }
                if once_in(chance, 2) {
                    *half_angle_degrees = of(chance, &[180.0, 1e-300, 90.0, 1e-7]);
                }
            }
            _ => (),
        }
    }
    if once_in(chance, 3) {
        scene.ambient *= any_size(chance, 300.0);
    }
    if once_in(chance, 3) {
        scene.fog_half_distance = Some(any_size(chance, 300.0));
    }
    if once_in(chance, 4)
        && let Some(camera) = &mut scene.camera
    {
        camera.focal_length_mm = any_size(chance, 6.0);
    }
}
