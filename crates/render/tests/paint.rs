//! Painted surfaces as they are rendered: pictures, reliefs, and what a pixel makes of patterns finer than itself.

#![expect(clippy::unwrap_used, reason = "functions that tests share")]

use std::path::Path;

use idf::{Image, Kind, Matte, Plane, Samples, WriteOptions};
use render::{Options, Sampling, World, render};
use tempfile::TempDir;

/// Linear colours of a picture of `columns` × `rows` of a scene in `folder`, row by row.
fn rendered(folder: &Path, text: &str, [columns, rows]: [u32; 2], grid: u32) -> Vec<[f64; 3]> {
    let path = folder.join("scene.sdl");
    std::fs::write(&path, text).unwrap();
    let compiled = compile::compile_path(&path);
    let scene = compiled.scene.as_ref().unwrap_or_else(|| panic!("{}", compiled.report()));
    let world = World::load(scene).unwrap();
    let sampling = Sampling::Grid(grid);
    let options = Options { columns, rows, sampling, clamp: false, ..Options::default() };
    let picture = render(&world, &options, &|_| ()).unwrap();
    picture.film.pixels().map(|pixel| pixel.color.map(f64::from)).collect()
}

fn write(folder: &Path, name: &str, [columns, rows]: [u32; 2], planes: &[(Kind, Vec<u8>)]) {
    let planes = planes
        .iter()
        .map(|(kind, bytes)| Plane { kind: *kind, samples: Samples::U8(bytes.clone()) })
        .collect();
    let mut image = Image::new(columns, rows, planes).unwrap();
    image.properties.matte = Matte::Straight;
    idf::exchange::write_image(&folder.join(name), &image, &WriteOptions::default()).unwrap();
}

fn linear(byte: u8) -> f64 {
    idf::Transfer::Srgb.decode(f64::from(byte) / 255.0)
}

/// The eye sees the front of a block from −1 to 1 in 12 × 12 pixels from afar: a pixel is a sixth of a unit.
const FRONT: &str = "ambient camera at (0, 0, 1001) focal length 12000 ";

fn assert_near(found: [f64; 3], expected: [f64; 3], what: &str) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((found - expected).abs() < 2e-3, "{what}: {found}, not {expected}");
    }
}

#[test]
fn pictures_are_shown_upright_in_their_colours() {
    let folder = TempDir::new().unwrap();
    // Red, green; blue, white.
    let [red, grn, blu] =
        [[200, 0, 0, 255], [0, 150, 0, 255], [0, 0, 100, 255]].map(|channel| channel.to_vec());
    let colors = [(Kind::Red, red), (Kind::Grn, grn), (Kind::Blu, blu)];
    write(folder.path(), "four.png", [2, 2], &colors);
    write(folder.path(), "four.idf", [2, 2], &colors);
    for (file, mapping) in
        [("four.png", "surface"), ("four", "planar"), ("four.idf", "box"), ("four.png", "planar")]
    {
        let text = format!("{FRONT} object is paint image (\"{file}\", {mapping}) block");
        let pixels = rendered(folder.path(), &text, [12, 12], 1);
        for (column, row, expected) in [
            (3, 3, [linear(200), 0.0, 0.0]),
            (8, 3, [0.0, linear(150), 0.0]),
            (3, 8, [0.0, 0.0, linear(100)]),
            (8, 8, [1.0; 3]),
        ] {
            // A sixth of the way to the next texel, at most, and of that from here: within a fifth.
            let found = pixels[row * 12 + column];
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 0.2, "{file} {mapping}: {found} for {expected}");
            }
        }
    }
}

#[test]
fn a_cylinder_and_a_sphere_are_wound_once() {
    let folder = TempDir::new().unwrap();
    // Grey that rises from left to right, of four texels; the eye sees the middle of what faces it.
    let gray = vec![(Kind::Grg, vec![10, 90, 170, 250])];
    write(folder.path(), "turn.png", [4, 1], &gray);
    // A quarter turn about the axis brings the next texel to the front.
    for (solid, mapping, about) in [
        ("sphere", "surface", "(0, A, 0)"),
        ("sphere", "spherical", "(0, A, 0)"),
        ("cylinder scale (2, 1, 1)", "surface", "(A, 0, 90)"),
        ("cylinder scale (2, 1, 1)", "cylindrical", "(A, 0, 90)"),
    ] {
        let mut found = Vec::new();
        for turn in 0..4 {
            let about = about.replace('A', &(45 + 90 * turn).to_string());
            let place = if solid == "sphere" { "0" } else { "-1" };
            let text = format!(
                "{FRONT} object is paint image (\"turn.png\", {mapping}) {solid} rotate {about} \
                 at (0, {place}, 0)"
            );
            let pixels = rendered(folder.path(), &text, [13, 13], 1);
            found.push((pixels[6 * 13 + 6][0] * 1e4).round());
        }
        let mut sorted = found.clone();
        sorted.sort_by(f64::total_cmp);
        let expected = [10, 90, 170, 250].map(|byte| (linear(byte) * 1e4).round());
        for (found, expected) in sorted.iter().zip(expected) {
            assert!((found - expected).abs() < 30.0, "{solid} {mapping}: {found} for {expected}");
        }
        // Around in the order of the texels, from wherever it begins.
        let start = found.iter().position(|value| value <= &sorted[0]).unwrap();
        let around: Vec<f64> = (0..4).map(|i| found[(start + i) % 4]).collect();
        let back: Vec<f64> = (0..4).map(|i| found[(start + 4 - i) % 4]).collect();
        assert!(around == sorted || back == sorted, "{solid} {mapping}: {found:?}");
    }
}

#[test]
fn coverage_is_a_mask_and_grey_a_weight() {
    let folder = TempDir::new().unwrap();
    let sixteen = |byte: u8| vec![byte; 16];
    let red = [(Kind::Red, sixteen(255)), (Kind::Grn, sixteen(0)), (Kind::Blu, sixteen(0))];
    let half = [red.to_vec(), vec![(Kind::Cvg, sixteen(102))]].concat();
    write(folder.path(), "half.png", [4, 4], &half);
    write(folder.path(), "weight.png", [4, 4], &[(Kind::Grg, sixteen(102))]);
    let both = [red.to_vec(), vec![(Kind::Grg, sixteen(102))]].concat();
    write(folder.path(), "both.idf", [4, 4], &both);
    let masked = vec![(Kind::Grg, sixteen(204)), (Kind::Cvg, sixteen(128))];
    write(folder.path(), "masked.png", [4, 4], &masked);
    for (paint, middle, corner) in [
        // 102/255 of red over white.
        ("decal (\"half.png\")", [1.0, 0.6, 0.6], [1.0; 3]),
        ("decal (\"half.png\", width = 2, height = 2)", [1.0, 0.6, 0.6], [1.0, 0.6, 0.6]),
        // Grey as it is stored is the weight of the colour; without a colour it is a picture.
        ("decal (\"weight.png\") black", [0.6; 3], [1.0; 3]),
        ("decal (\"weight.png\")", [linear(102); 3], [1.0; 3]),
        ("image (\"both\") black", [0.6; 3], [0.6; 3]),
        ("image (\"both\")", [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
        // Red is 0.2126 of a brightness.
        ("decal (\"half.png\") black", [1.0 - 0.2126 * 0.4; 3], [1.0; 3]),
        ("decal (\"masked.png\") black", [1.0 - 0.8 * 128.0 / 255.0; 3], [1.0; 3]),
        // From 1 before the front at 55° to either side it fills it; at 15° its middle.
        (
            "projection (\"half.png\", at = (0, 0, 2), angle = 110)",
            [1.0, 0.6, 0.6],
            [1.0, 0.6, 0.6],
        ),
        ("projection (\"half.png\", at = (0, 0, 2), angle = 30)", [1.0, 0.6, 0.6], [1.0; 3]),
        ("projection (\"half.png\", at = (0, 0, -3))", [1.0, 0.6, 0.6], [1.0, 0.6, 0.6]),
        ("projection (\"half.png\", (0, 0, 2), (0, 0, 3), 90)", [1.0; 3], [1.0; 3]),
    ] {
        let text = format!("{FRONT} object is paint {paint} block");
        let pixels = rendered(folder.path(), &text, [13, 13], 1);
        assert_near(pixels[6 * 13 + 6], middle, paint);
        assert_near(pixels[14], corner, paint);
    }
}

#[test]
fn a_relief_tilts_by_the_slope_of_its_function() {
    let folder = TempDir::new().unwrap();
    // Light along the view: what comes back is the cosine of the tilt. The weight rises by 1 from y = 0 to y = 1.
    let light = "light beam at (0, 0, 1) camera at (0, 0, 1001) focal length 12000 object is";
    for (solid, slope) in [
        ("paint bump (gradient, height = 0.5) block", 0.5),
        ("paint bump (gradient, height = -0.5) block", 0.5),
        ("paint bump (gradient (height = 2), height = 0.5) block", 0.25),
        // Stretched with the block: raised by z, over y.
        ("paint bump (gradient, height = 0.5) block scale (1, 1, 3) at (0, 0, -2)", 1.5),
        ("paint bump (gradient, height = 0.5) block scale (1, 2, 1)", 0.25),
        ("paint bump (gradient, height = 0.5) block scale (-1, 1, 1) rotate (0, 0, 77)", 0.5),
        // Painted on the group, that is before the block is stretched.
        ("paint bump (gradient, height = 0.5) (block scale (1, 1, 3) at (0, 0, -2))", 0.5),
        // Two reliefs add up; one with a colour paints too.
        ("paint bump (gradient, 0.2) paint bump (gradient, 0.3) block", 0.5),
    ] {
        let pixels = rendered(folder.path(), &format!("{light} {solid}"), [13, 13], 1);
        let expected = 1.0 / f64::sqrt(1.0 + slope * slope);
        let found = pixels[4 * 13 + 6];
        assert_near(found, [expected; 3], solid);
    }
    let text = format!("{light} paint bump (gradient, 0.0) black block");
    let pixels = rendered(folder.path(), &text, [13, 13], 1);
    // The middle of the fourth of 13 rows is 6/13 up from the middle.
    assert_near(pixels[3 * 13 + 6], [7.0 / 13.0; 3], "the way from white to black");
}

/// Root of the mean square between a picture of one ray a pixel and one of 256, and between the latter and its mean.
fn errors(folder: &Path, text: &str) -> (f64, f64) {
    let size = [64, 48];
    let found = rendered(folder, text, size, 1);
    let reference = rendered(folder, text, size, 16);
    let square = |f: &dyn Fn(usize) -> f64| {
        ((0..found.len()).map(|i| f(i) * f(i)).sum::<f64>() / found.len() as f64).sqrt()
    };
    let mean = reference.iter().map(|pixel| pixel[0]).sum::<f64>() / reference.len() as f64;
    (square(&|i| found[i][0] - reference[i][0]), square(&|i| reference[i][0] - mean))
}

#[test]
fn far_pictures_do_not_shimmer() {
    let folder = TempDir::new().unwrap();
    // Fields of four texels, black and white, finer than a pixel from the middle of the picture on.
    let field = |i: u32| if (i % 64 / 4 + i / 64 / 4).is_multiple_of(2) { 255 } else { 0 };
    write(folder.path(), "fields.png", [64, 64], &[(Kind::Grg, (0..4096).map(field).collect())]);
    // Floors to the horizon: upright, turned by 30°, and in a mirror that bulges.
    let floor = "ambient background white camera at (0, 2, 0) target at (0, 1, -10) object is ";
    for (scene, bound) in [
        ("paint image (\"fields.png\", box, 12, 12) block scale (60, 0.1, 60)", 0.06),
        (
            "(paint image (\"fields.png\", box, 12, 12) block scale (60, 0.1, 60)) rotate (0, 30, 0)",
            0.06,
        ),
        (
            "paint image (\"fields.png\", box, 12, 12) block scale (60, 0.1, 60) \
             object is shiniest smoothest pure sphere scale 2 at (0, 1.5, -7)",
            0.08,
        ),
        ("paint image (\"fields.png\", surface, 4, 4) sphere scale 3 at (0, 1, -9)", 0.06),
    ] {
        let (error, contrast) = errors(folder.path(), &format!("{floor}{scene}"));
        assert!(error < bound, "{scene}: {error} of {contrast}");
    }
}

#[test]
fn far_noise_does_not_shimmer() {
    let folder = TempDir::new().unwrap();
    let floor = "ambient background white camera at (0, 2, 0) target at (0, 1, -10) object is ";
    for (paint, bound) in [
        ("noise (octaves = 5)", 0.02),
        ("turbulence", 0.02),
        ("marble", 0.035),
        ("granite", 0.03),
        ("spots", 0.035),
        ("fourier", 0.02),
        ("wood", 0.025),
        ("checker3d", 0.025),
    ] {
        let text =
            format!("{floor} paint {paint} black (block scale (60, 0.1, 60) at (0, 0.03, 0))");
        let (error, contrast) = errors(folder.path(), &text);
        assert!(error < bound, "{paint}: {error} of {contrast}");
    }
}

#[test]
fn far_reliefs_do_not_sparkle() {
    let folder = TempDir::new().unwrap();
    let floor = "light point at (3, 9, -22) ambient intensity 0.1 camera at (0, 2, 0) target at (0, 1, -10) object is";
    // Highlights are up to ten times white.
    for (bump, bound) in [
        ("bump (noise (3), height = 0.1)", 0.02),
        ("bump (brick (40, 80), height = 0.02)", 0.2),
        ("bump (spots (2, 0.45, 0.9), height = 0.1)", 0.2),
    ] {
        let text = format!("{floor} smooth shiny paint {bump} block scale (60, 0.1, 60)");
        let (error, contrast) = errors(folder.path(), &text);
        assert!(error < bound, "{bump}: {error} of {contrast}");
    }
}

#[test]
fn pictures_that_cannot_be_shown_are_named() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("text.png"), "no picture").unwrap();
    std::fs::write(folder.path().join("text.txt"), "no picture").unwrap();
    for (file, reason) in
        [("text.png", "cannot decode `F/text.png`: "), ("text.txt", "F/text.txt: unknown format, ")]
    {
        let path = folder.path().join("scene.sdl");
        let text = format!("camera at (0, 0, 9)\nobject is\n paint image (\"{file}\") sphere");
        std::fs::write(&path, text).unwrap();
        let scene = compile::compile_path(&path).scene.unwrap();
        let error = World::load(&scene).unwrap_err().to_string();
        let error = error.replace(folder.path().to_str().unwrap(), "F");
        let expected = format!("F/scene.sdl:3:15: {reason}");
        assert!(error.starts_with(&expected), "{error}");
    }
}
