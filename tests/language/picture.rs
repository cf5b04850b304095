//! What a picture's file holds: colour, coverage, background.

use std::fs;
use std::path::Path;

use idf::exchange::read_image;
use idf::{Image, Kind, Matte, ReadOptions, Samples};
use tempfile::TempDir;

use super::HALF;
use crate::support::portray;

const COLOR: [Kind; 3] = [Kind::Red, Kind::Grn, Kind::Blu];
const ALL: [Kind; 4] = [Kind::Red, Kind::Grn, Kind::Blu, Kind::Cvg];

/// `portray` writes a 16 × 16 picture of `text`; then it is read.
fn written(folder: &Path, text: &str, words: &str) -> Image {
    let focal_length = 12.0 * 10_000.0 / HALF;
    let camera = format!("camera at (0, 0, 10000) focal length {focal_length}");
    fs::write(folder.join("a.sdl"), format!("{text} {camera}")).expect("a scene");
    portray(folder, &format!("@a.sdl -q --size 16x16 {words}")).expect("a picture");
    let output = words.split_whitespace().find_map(|word| word.strip_prefix('@'));
    let path = folder.join(output.expect("an output"));
    read_image(&path, &ReadOptions::default()).expect("an image")
}

fn bytes(image: &Image, kind: Kind) -> &[u8] {
    match image.plane(kind) {
        Some(Samples::U8(samples)) => samples,
        other => panic!("{kind}: {other:?}"),
    }
}

/// Display values of the pixels in the middle and in the upper left corner.
fn ends(image: &Image, kinds: &[Kind]) -> [Vec<u8>; 2] {
    [8 * 16 + 8, 0].map(|i| kinds.iter().map(|&kind| bytes(image, kind)[i]).collect())
}

const BALL: &str = "ambient background rgb (0.2, 0.4, 0.6) object is rgb (0.4, 0.6, 0.8) sphere";
const WALL: &str =
    "ambient background rgb (0.2, 0.4, 0.6) object is rgb (0.4, 0.6, 0.8) block scale 2";

#[test]
fn an_image_has_coverage_and_background_where_it_is_open() {
    let folder = TempDir::new().expect("a folder");
    let ball = written(folder.path(), BALL, "-o @ball.idf");
    assert_eq!(ball.kinds(), ALL, "open");
    assert_eq!(ends(&ball, &ALL), [vec![102, 153, 204, 255], vec![0; 4]], "without the background");
    let background = ball.properties.background.expect("a background");
    for (found, expected) in background.into_iter().zip([0.2, 0.4, 0.6]) {
        assert!((found - expected).abs() < 1e-6, "display values: {background:?}");
    }
    assert_eq!(ball.properties.matte, Matte::Premultiplied, "colour times coverage");

    let wall = written(folder.path(), WALL, "-o @wall");
    assert_eq!(wall.kinds(), COLOR, "all covered");
    assert_eq!(wall.properties.background, None, "nothing to put it behind");
    let asked = written(folder.path(), WALL, "-o @asked --channels rgb,cvg");
    assert_eq!(asked.kinds(), ALL, "asked for");
    assert!(bytes(&asked, Kind::Cvg).iter().all(|&share| share == 255), "covered");
    let alone = written(folder.path(), BALL, "-o @alone --channels cvg");
    assert_eq!(alone.kinds(), [Kind::Cvg], "coverage alone");
    assert_eq!(bytes(&alone, Kind::Cvg), bytes(&ball, Kind::Cvg), "the same");
    let color = written(folder.path(), BALL, "-o @color --channels rgb");
    assert_eq!(color.kinds(), COLOR, "colour alone");
    assert_eq!(ends(&color, &COLOR)[1], [51, 102, 153], "the background is in it");
}

#[test]
fn plain_pictures_are_opaque_unless_coverage_is_asked_for() {
    let folder = TempDir::new().expect("a folder");
    for output in ["ball.png", "ball.ppm"] {
        let plain = written(folder.path(), BALL, &format!("-o @{output}"));
        assert_eq!(plain.kinds(), COLOR, "{output}");
        assert_eq!(ends(&plain, &COLOR), [vec![102, 153, 204], vec![51, 102, 153]], "{output}");
    }
    let options = "-o @ball.png --channels rgb,cvg --samples 16";
    let alpha = written(folder.path(), BALL, options);
    assert_eq!(alpha.kinds(), ALL, "asked for");
    assert_eq!(ends(&alpha, &ALL)[0], [102, 153, 204, 255], "covered");
    assert_eq!(ends(&alpha, &[Kind::Cvg])[1], [0], "open");
    let premultiplied = written(folder.path(), BALL, "-o @ball --samples 16");
    assert_eq!(bytes(&alpha, Kind::Cvg), bytes(&premultiplied, Kind::Cvg), "the same coverage");
    assert!(bytes(&alpha, Kind::Cvg).iter().any(|share| (1..255).contains(share)), "rims");
}

/// Linear light of `image` over its own background, as display values.
fn flattened(image: &Image) -> [Vec<f64>; 3] {
    let background = image.properties.background.expect("a background");
    let (curve, cover) = (idf::Transfer::Srgb, bytes(image, Kind::Cvg));
    std::array::from_fn(|k| {
        let behind = curve.decode(background[k]);
        let over = |(&value, &share): (&u8, &u8)| {
            let open = 1.0 - f64::from(share) / 255.0;
            255.0 * curve.encode(curve.decode(f64::from(value) / 255.0) + open * behind)
        };
        bytes(image, COLOR[k]).iter().zip(cover).map(over).collect()
    })
}

#[test]
fn a_picture_over_its_background_is_the_opaque_picture() {
    // A rim, a neutral pane, a mirror, and fog: every way to be partly covered.
    let pane = "object is trans (2, fake) white block scale (0.4, 0.4, 1) at (-1, 1, 0)";
    let mirror = "object is smoothest shiniest sphere scale 0.5 at (1, 1, 0)";
    let text = format!("{BALL} scale 0.7 at (0, -0.5, 0) {pane} {mirror} fog 20000");
    let folder = TempDir::new().expect("a folder");
    let open = flattened(&written(folder.path(), &text, "-o @open --samples 16"));
    let opaque = written(folder.path(), &text, "-o @opaque.png --samples 16");
    for (kind, open) in COLOR.into_iter().zip(open) {
        for (i, (&expected, found)) in bytes(&opaque, kind).iter().zip(open).enumerate() {
            // Colour is rounded to half a step and coverage to 1/510, which is 2 steps of a dark colour.
            let apart = (f64::from(expected) - found).abs();
            assert!(apart < 1.5, "{kind} {i}: {found} over, {expected} opaque");
        }
    }
}
