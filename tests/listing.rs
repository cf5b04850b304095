//! The paper's listing, as a picture: clean, and the same at any size and in any place.

use std::ops::Range;

use glam::DVec3;
use render::Options;
use scene::{LightKind, Node, Scene};

use crate::support::{LISTING, Shown, scene, shown, square};

/// Farther than this from the median of its neighbourhood a pixel is a speck, unless an edge explains it.
const SPECK: u8 = 24;
/// A well sampled picture has an edge where a neighbourhood differs by more than this. The seam between the cone and
/// the cylinder of the foot is a quarter of a pixel wide: one sample shows it at full strength or not at all, the mean
/// of 64 by 6 to 9 steps.
const EDGE: u8 = 4;

/// Sizes and moves change at most one pixel of this many.
const SHARE: usize = 10_000;

/// Median and range of a channel in the 3 × 3 pixels about one.
fn neighbourhood(picture: &Shown, column: usize, row: usize, channel: usize) -> (u8, u8) {
    let mut values = [0; 9];
    for (i, value) in values.iter_mut().enumerate() {
        *value = picture.at(column + i % 3 - 1, row + i / 3 - 1)[channel];
    }
    values.sort_unstable();
    (values[4], values[8] - values[0])
}

/// Column and row of the pixels where `reference` has no edge; those at the rim are not looked at.
fn smooth(reference: &Shown) -> Vec<(usize, usize)> {
    let rows = reference.pixels.len() / reference.columns;
    let inner = (1..rows - 1).flat_map(|row| (1..reference.columns - 1).map(move |c| (c, row)));
    let flat = |&(column, row): &(usize, usize)| {
        (0..3).all(|channel| neighbourhood(reference, column, row, channel).1 <= EDGE)
    };
    inner.filter(flat).collect()
}

/// Those of `places` whose pixels stand out.
fn specks(picture: &Shown, places: &[(usize, usize)]) -> Vec<(usize, usize)> {
    let stands_out = |&(column, row): &(usize, usize)| {
        (0..3).any(|channel| {
            let (median, _) = neighbourhood(picture, column, row, channel);
            picture.at(column, row)[channel].abs_diff(median) > SPECK
        })
    };
    places.iter().copied().filter(stands_out).collect()
}

#[test]
fn the_glass_has_no_specks() {
    const SIDE: usize = 256;
    let listing = scene(LISTING);
    let picture = shown(&listing, &square(256, 1));
    let smooth = smooth(&shown(&listing, &square(256, 8)));
    let share = |columns: Range<usize>, rows: Range<usize>| {
        let inside =
            |&&(column, row): &&(usize, usize)| columns.contains(&column) && rows.contains(&row);
        smooth.iter().filter(inside).count() * 100 / (columns.len() * rows.len())
    };
    assert!(share(0..SIDE, 0..SIDE) > 85, "of the whole: {} %", share(0..SIDE, 0..SIDE));
    assert!(share(105..150, 75..105) > 60, "of the wine: {} %", share(105..150, 75..105));
    assert!(share(100..155, 178..198) > 50, "of the foot: {} %", share(100..155, 178..198));
    assert_eq!(specks(&picture, &smooth), [], "column and row");

    // The detector finds what it is for: single wrong pixels in the wine, on the foot and on the floor.
    let mut spoilt = picture;
    let places = [(128, 85), (128, 190), (40, 200)];
    for (column, row) in places {
        let pixel = &mut spoilt.pixels[row * SIDE + column];
        *pixel = pixel.map(|value| if value > 127 { value - 30 } else { value + 30 });
    }
    assert_eq!(specks(&spoilt, &smooth), places, "specks put in by hand");
}

/// A number of a listing that is a length, and what it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Length {
    /// A coordinate of a place: axis 0, 1 or 2.
    Place(usize),
    /// A factor of a solid's size, or a distance.
    Extent,
}

/// `text` with every number that is a length replaced.
fn rewritten(text: &str, replace: impl Fn(Length, &str) -> String) -> String {
    let mut out = String::new();
    let mut word = String::new();
    let mut argument = None;
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let take = |keep: fn(char) -> bool| rest.find(|c| !keep(c)).unwrap_or(rest.len());
        let length = if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if first.is_alphabetic() {
            take(|c| c.is_alphanumeric() || c == '_')
        } else if first.is_ascii_digit() || first == '-' {
            take(|c| c.is_ascii_digit() || c == '.' || c == '-')
        } else {
            first.len_utf8()
        };
        let (token, after) = rest.split_at(length);
        rest = after;
        argument = match (first, argument) {
            ('(', _) => Some(0),
            (')', _) => None,
            (',', Some(n)) => Some(n + 1),
            (_, same) => same,
        };
        if first.is_alphabetic() {
            word = token.to_ascii_lowercase();
        }
        let kind = match (word.as_str(), argument) {
            ("at" | "toward", Some(axis)) => Some(Length::Place(axis)),
            ("scale", Some(_)) | ("trans", Some(0)) => Some(Length::Extent),
            _ => None,
        };
        match kind.filter(|_| first.is_ascii_digit() || first == '-') {
            Some(kind) => out += &replace(kind, token),
            None => out += token,
        }
    }
    out
}

/// The listing's scene with every length multiplied. Its frames have no parents.
fn scaled(mut scene: Scene, factor: f64) -> Scene {
    map_places(&mut scene, |place| place * factor);
    for object in &mut scene.objects {
        for node in &object.solid.nodes {
            if let Node::Primitive { frame, .. } = node {
                object.solid.frames[frame.0 as usize].placement.scale *= factor;
            }
        }
    }
    for attributes in &mut scene.attributes {
        if let Some(transparency) = &mut attributes.transparency {
            transparency.half_distance *= factor;
        }
    }
    scene
}

fn map_places(scene: &mut Scene, map: impl Fn(DVec3) -> DVec3) {
    if let Some(camera) = &mut scene.camera {
        camera.position = map(camera.position);
        camera.target = map(camera.target);
    }
    for light in &mut scene.lights {
        match &mut light.kind {
            LightKind::Point { at } => *at = map(*at),
            LightKind::Beam { at, toward } | LightKind::Spot { at, toward, .. } => {
                *at = map(*at);
                *toward = map(*toward);
            }
        }
    }
    for object in &mut scene.objects {
        for frame in object.solid.frames.iter_mut().filter(|frame| frame.parent.is_none()) {
            frame.placement.place = map(frame.placement.place);
        }
    }
}

/// The listing with every length written with an exponent.
fn scaled_text(decade: i32) -> String {
    rewritten(LISTING, |_, number| format!("{number}e{decade}"))
}

fn moved_text(offset: DVec3) -> String {
    rewritten(LISTING, |length, number| match length {
        Length::Place(axis) => format!("{}", number.parse::<f64>().unwrap_or(0.0) + offset[axis]),
        Length::Extent => number.to_owned(),
    })
}

fn small() -> Options {
    square(200, 1)
}

fn assert_alike(base: &Shown, other: &Scene, what: &str) {
    let picture = shown(other, &small());
    let differing = picture.differing(base, 1).len();
    assert!(differing * SHARE <= base.pixels.len(), "{what}: {differing} pixels differ");
}

#[test]
fn lengths_are_told_from_other_numbers() {
    let text = "/* 7 */ Object is trans(1000,1.65) cone at (0,-1.5,0) scale (2,3,4) rotate (0,0,90)\n\
                Light spot (1,62) intensity 0.8 at (1,2,3) toward (4,5,6)";
    let expected = "/* 7 */ Object is trans(E,1.65) cone at (X,Y,Z) scale (E,E,E) rotate (0,0,90)\n\
                    Light spot (1,62) intensity 0.8 at (X,Y,Z) toward (X,Y,Z)";
    let found = rewritten(text, |length, _| match length {
        Length::Place(axis) => ["X", "Y", "Z"][axis].to_owned(),
        Length::Extent => "E".to_owned(),
    });
    assert_eq!(found, expected);
    let lengths = std::cell::Cell::new(0);
    rewritten(LISTING, |_, number| {
        lengths.set(lengths.get() + 1);
        number.to_owned()
    });
    // 8 solids with a place and a size, 6 half-distances; spot and camera with two places each.
    assert_eq!(lengths.get(), 8 * 6 + 6 + 4 * 3, "lengths of the listing");
    // Told apart from the picture: what is not scaled with the rest shows.
    let base = shown(&scene(LISTING), &small());
    let partly = rewritten(LISTING, |length, number| match length {
        Length::Extent if number == "1000" => number.to_owned(),
        _ => format!("{number}e3"),
    });
    let differing = shown(&scene(&partly), &small()).differing(&base, 1).len();
    assert!(differing > 100, "half-distances that stay behind show: {differing}");
}

#[test]
fn the_picture_is_the_same_at_sixteen_decades() {
    let listing = scene(LISTING);
    let base = shown(&listing, &small());
    for decade in -6..=9 {
        let factor: f64 = format!("1e{decade}").parse().expect("a number");
        assert_alike(&base, &scaled(listing.clone(), factor), &format!("times {factor}"));
        assert_alike(&base, &scene(&scaled_text(decade)), &format!("with e{decade}"));
    }
}

#[test]
fn the_picture_is_the_same_far_from_the_origin() {
    let listing = scene(LISTING);
    let base = shown(&listing, &small());
    for distance in [1.0 / 3.0, -1234.5, 1e6] {
        for direction in [DVec3::ONE, DVec3::X, DVec3::Y, DVec3::Z] {
            let offset = distance * direction;
            let mut moved = listing.clone();
            map_places(&mut moved, |place| place + offset);
            assert_alike(&base, &moved, &format!("moved by {offset}"));
            assert_alike(&base, &scene(&moved_text(offset)), &format!("moved text by {offset}"));
        }
    }
}

#[test]
fn powers_of_two_change_no_byte() {
    let listing = scene(LISTING);
    let base = shown(&listing, &small());
    for factor in [f64::from(1 << 20), 1.0 / f64::from(1 << 20)] {
        let picture = shown(&scaled(listing.clone(), factor), &small());
        assert!(picture == base, "times {factor}");
        let text = rewritten(LISTING, |_, number| {
            format!("{}", number.parse::<f64>().unwrap_or(0.0) * factor)
        });
        assert!(shown(&scene(&text), &small()) == base, "text times {factor}");
    }
}
