//! Every pixel of every scene is a number, however far its numbers go.

use idf::Samples;
use render::{Options, World, measured, measured_kinds, render};

use crate::oracle::author::{Chance, Site};
use crate::radiance::look;
use crate::random_csg::Places;
use crate::support::square;

/// Scenes that are rendered; the variable `PORTRAY_FINITE` says another number.
const SCENES: u64 = 10_000;

fn count() -> u64 {
    std::env::var("PORTRAY_FINITE").ok().and_then(|n| n.parse().ok()).unwrap_or(SCENES)
}

#[test]
#[expect(clippy::print_stderr, reason = "the counts are the report")]
fn no_pixel_of_random_scenes_is_infinite_or_no_number() {
    let (mut pixels, mut wrong, mut lit) = (0_u64, Vec::new(), 0_u64);
    for seed in 0..count() {
        let mut chance = Chance::new(seed ^ 0x5eed_0000);
        let places = if chance.below(2) == 0 { Places::Free } else { Places::Lattice };
        let sites = [Site::ALL.as_slice(), &Site::INSTANCES[..3]].concat();
        let site = sites[chance.below(9) as usize];
        let mut scene = look::scene(40_000 + seed, places, site);
        if seed % 4 > 0 {
            look::go_far(&mut chance, &mut scene);
        }
        let world = match World::load(&scene) {
            Ok(world) => world,
            Err(error) => panic!("random {seed}: {error}"),
        };
        let clamp = chance.below(2) == 0;
        let options = Options { clamp, threads: 1, ..square(6, 2) };
        let picture = render(&world, &options, &|_| ()).expect("a thread");
        for plane in measured(&world, &options, &measured_kinds()).expect("a thread") {
            if let Samples::F32(values) = &plane.samples
                && !values.iter().all(|value| value.is_finite())
            {
                wrong.push(format!("random {seed}: {} {values:?}", plane.kind));
            }
        }
        for (number, pixel) in picture.film.pixels().enumerate() {
            pixels += 1;
            let finite = pixel.color.iter().all(|channel| channel.is_finite());
            if !finite || !(0.0..=1.000_001).contains(&pixel.coverage) {
                wrong.push(format!("random {seed} clamp {clamp} pixel {number}: {pixel:?}"));
            }
            lit += u64::from(pixel.color.iter().any(|&channel| channel > 0.0));
        }
    }
    eprintln!("{} scenes, {pixels} pixels, {lit} with light, {} wrong", count(), wrong.len());
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong[..wrong.len().min(8)].join("\n"));
    assert!(3 * lit > pixels, "{lit} of {pixels} pixels hold light");
}
