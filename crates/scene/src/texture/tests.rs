//! Textures: what holds for the whole table, and values by hand.

use glam::DVec3;

use super::*;

fn named(keyword: &str, arguments: &[f64]) -> Texture {
    let mut texture = Texture::named(keyword).unwrap();
    for (i, &argument) in arguments.iter().enumerate() {
        texture.set(i, argument).unwrap();
    }
    texture
}

fn formulas() -> impl Iterator<Item = &'static Function> {
    FUNCTIONS.iter().filter(|function| matches!(function.weight, Weight::Formula(_)))
}

fn sharp(texture: &Texture, p: DVec3) -> f64 {
    texture.weight(&Spot::sharp(p)).unwrap()
}

/// Weights of `texture` in the cube of −1…1, at `side`³ places that fill it evenly.
fn sampled(texture: &Texture, side: u32) -> impl Iterator<Item = f64> {
    let place = move |i: u32| f64::from(2 * i + 1) / f64::from(side) - 1.0;
    let places = move |i: u32| DVec3::new(place(i % side), place(i / side % side), 0.0);
    let along = move |i: u32| DVec3::Z * place(i / side / side);
    (0..side * side * side).map(move |i| sharp(texture, places(i) + along(i)))
}

fn mean(texture: &Texture, side: u32) -> f64 {
    sampled(texture, side).sum::<f64>() / f64::from(side * side * side)
}

/// Both ends of a range, or near them, and what lies far inside.
fn awkward(range: Range) -> Vec<f64> {
    match range {
        Range::Any | Range::Coordinate(_) => vec![-1e300, -1.0, 0.0, f64::MAX],
        Range::Word(words) => (0..words.len()).map(|i| i as f64).collect(),
        Range::Above(low) => vec![low + f64::EPSILON, low + 1.0, 1e12, f64::MAX],
        Range::Within(low, high) => vec![low, 0.5 * (low + high), high],
        Range::Whole(low, high) => vec![f64::from(low), f64::from(high)],
    }
}

#[test]
fn names_are_distinct_lower_case_and_files() {
    for (i, function) in FUNCTIONS.iter().enumerate() {
        assert_eq!(function.keyword, function.keyword.to_ascii_lowercase(), "case");
        assert!(FUNCTIONS[..i].iter().all(|f| f.keyword < function.keyword), "sorted");
        let file = format!("{}/src/texture/{}.rs", env!("CARGO_MANIFEST_DIR"), function.keyword);
        assert!(std::path::Path::new(&file).exists(), "{file}");
        for parameter in function.parameters {
            assert!(parameter.range.contains(parameter.default), "{}", parameter.name);
        }
    }
}

#[test]
fn weights_stay_in_range_over_many_decades_and_arguments() {
    for function in formulas() {
        let mut textures = vec![named(function.keyword, &[])];
        for (i, parameter) in function.parameters.iter().enumerate() {
            for value in awkward(parameter.range) {
                let mut texture = named(function.keyword, &[]);
                texture.set(i, value).unwrap();
                textures.push(texture);
            }
        }
        for texture in textures {
            for decade in (-12..=12).chain([100, 300]) {
                for i in 0..20 {
                    let f = f64::from(i);
                    let p = DVec3::new(f * 0.37 - 3.1, f * -0.11 + 0.7, f * 0.53)
                        * libm::exp10(f64::from(decade));
                    let weight = sharp(&texture, p);
                    assert!((0.0..=1.0).contains(&weight), "{texture:?} at {p}: {weight}");
                    let again = sharp(&texture.clone(), p);
                    assert_eq!(weight.to_bits(), again.to_bits(), "{texture:?} at {p}");
                    let width = DVec3::new(1.0, 0.0, 1e3) * libm::exp10(f * 0.5 - 5.0);
                    let spread = texture.weight(&Spot { point: p, width }).unwrap();
                    assert!((0.0..=1.0).contains(&spread), "{texture:?} over {width}: {spread}");
                }
            }
        }
    }
}

#[test]
fn functions_say_something() {
    for function in formulas() {
        let texture = named(function.keyword, &[]);
        let low = sampled(&texture, 20).fold(1.0, |low: f64, weight| low.min(weight));
        let high = sampled(&texture, 20).fold(0.0, |high: f64, weight| high.max(weight));
        assert!(low < 0.35 && high > 0.6, "{}: {low} to {high}", function.keyword);
    }
}

#[test]
fn smooth_functions_have_bounded_slopes() {
    // Along an axis noise changes by at most 1 + 3 · 15/8 a unit: a corner's slope, and what fading between corners
    // adds. A ball of radius r fades by at most 15/8 over its outer share. A sine wave of length k changes by 2πk.
    let noise = 1.0 + 3.0 * 1.875;
    let waves: f64 = 2.0 * std::f64::consts::PI * 5.8;
    for (keyword, arguments, bound) in [
        ("noise", vec![1.0, 1.0], 0.5 * noise),
        ("noise", vec![3.0, 4.0], 0.5 * noise * 3.0 * 4.0),
        ("turbulence", vec![1.0, 6.0], noise * 6.0),
        ("spots", vec![2.0, 0.4, 0.5], 2.0 * 1.875 / (0.4 * 0.5)),
        ("granite", vec![4.0, 1.0], 8.0 * 4.0 * 1.875 / (0.5 * 0.3)),
        ("fourier", vec![1.0, 12.0], 0.5 * waves),
        ("gradient", vec![2.0], 0.5),
    ] {
        let texture = named(keyword, &arguments);
        // Far away the step is what rounding leaves of it.
        for (far, step) in [(0.0, 1e-6), (1e9, 1.0 / 65536.0)] {
            for i in 0..3000 {
                let f = f64::from(i);
                let p = DVec3::new(f * 0.618, f * 0.0377, f * 0.271) + far;
                for axis in DVec3::AXES {
                    let change = sharp(&texture, p + axis * step) - sharp(&texture, p);
                    let slope = change.abs() / step;
                    assert!(slope < bound * 1.001 + 1e-6, "{keyword} at {p}: {slope} > {bound}");
                }
            }
        }
    }
}

#[test]
fn means_are_those_that_are_known() {
    // Gradients are as often one way as the other; so are shades of grains; waves have no mean over a cube.
    for (keyword, arguments, side, expected, tolerance) in [
        ("noise", vec![20.0, 1.0], 60, 0.5, 0.01),
        ("granite", vec![20.0, 3.0], 40, 0.5, 0.02),
        ("fourier", vec![1.0, 12.0], 32, 0.5, 1e-12),
        // Of the reference implementation of noise, 2002.
        ("turbulence", vec![20.0, 6.0], 60, 0.434, 0.015),
        // Half of the fields; 0.6 · 0.6 without lines; bricks of 1 − 0.4 · 5 / 10 by 0.6.
        ("checker", vec![8.0, 8.0], 32, 0.5, 1e-12),
        ("grid", vec![5.0, 10.0, 0.4], 100, 0.64, 1e-12),
        ("brick", vec![5.0, 10.0, 0.4], 100, 0.48, 1e-12),
    ] {
        let found = mean(&named(keyword, &arguments), side);
        assert!((found - expected).abs() <= tolerance, "{keyword}: {found}, not {expected}");
    }
    // Balls anywhere in their cells cover their volume V, less what they share: at least 1 − e⁻ⱽ.
    let volume = 4.0 / 3.0 * std::f64::consts::PI * 0.3 * 0.3 * 0.3;
    let found = mean(&named("spots", &[20.0, 0.3, 0.0]), 100);
    let (least, most) = (1.0 - libm::exp(-volume), volume);
    assert!(found > least - 0.004 && found < most + 0.004, "{least} < {found} < {most}");
}

#[test]
fn periods_are_kept() {
    for (keyword, arguments, period) in [
        ("fourier", vec![2.0, 12.0], DVec3::new(0.5, -1.0, 1.5)),
        ("brick", vec![4.0, 8.0, 0.15], DVec3::new(1.0, 0.25, 0.0)),
        ("grid", vec![8.0, 4.0, 0.1], DVec3::new(0.125, 0.25, 0.0)),
        ("checker3d", vec![1.0], DVec3::new(2.0, 2.0, -4.0)),
    ] {
        let texture = named(keyword, &arguments);
        for i in 0..2000 {
            let f = f64::from(i);
            // Multiples of 2⁻¹⁰: sums with the period are exact.
            let p = DVec3::new(f * 37.0 % 1024.0, f * 101.0 % 1024.0, f * 59.0 % 1024.0) / 1024.0;
            let change = sharp(&texture, p + period) - sharp(&texture, p);
            assert!(change.abs() < 1e-12, "{keyword} at {p}: {change}");
        }
    }
}

#[test]
fn values_by_hand() {
    // sin(2π · 3/8), and the sum of the lengths of the waves (1, 1, 0) and (1, −1, 1).
    let (sine, first, second) = (0.5_f64.sqrt(), 0.5_f64.sqrt(), (1.0_f64 / 3.0).sqrt());
    for (keyword, arguments, place, expected) in [
        // 8 × 8 fields; the first is unpainted.
        ("checker", vec![], [0.01, 0.01, 0.0], 0.0),
        ("checker", vec![], [0.13, 0.01, 0.0], 1.0),
        ("checker", vec![], [0.13, 0.13, 0.0], 0.0),
        ("checker3d", vec![], [0.5, 0.5, 0.5], 0.0),
        ("checker3d", vec![], [-0.5, 0.5, 0.5], 1.0),
        ("stripes", vec![], [0.0, 0.01, 0.0], 0.0),
        ("stripes", vec![], [0.0, 0.13, 0.0], 1.0),
        ("gradient", vec![], [9.0, 0.25, 9.0], 0.25),
        // Rings are 1/16 wide: (0.06, 0.08) is 0.1 away, in the second.
        ("rings", vec![], [0.5, 0.5, 0.0], 0.0),
        ("rings", vec![], [0.56, 0.58, 0.0], 1.0),
        ("rings", vec![4.0], [0.56, 0.58, 0.0], 0.0),
        ("rings", vec![4.0, 0.0, 0.0], [0.03, 0.14, 0.0], 1.0),
        // Lines are 1/80 wide, half of it on either side.
        ("grid", vec![], [0.125, 0.06, 0.0], 1.0),
        ("grid", vec![], [0.131, 0.06, 0.0], 1.0),
        ("grid", vec![], [0.119, 0.06, 0.0], 1.0),
        ("grid", vec![], [0.132, 0.06, 0.0], 0.0),
        ("grid", vec![], [0.06, 0.375, 0.0], 1.0),
        ("grid", vec![8.0, 8.0, 0.0], [0.125, 0.06, 0.0], 0.0),
        ("grid", vec![8.0, 8.0, 1.0], [0.0625, 0.0625, 0.0], 1.0),
        // The first course has a joint at u = 1/4, the second one at u = 1/8; courses are 1/8 high.
        ("brick", vec![], [0.25, 0.06, 0.0], 0.0),
        ("brick", vec![], [0.125, 0.06, 0.0], 1.0),
        ("brick", vec![], [0.25, 0.19, 0.0], 1.0),
        ("brick", vec![], [0.125, 0.19, 0.0], 0.0),
        ("brick", vec![], [0.1, 0.125, 0.0], 0.0),
        ("brick", vec![4.0, 8.0, 0.0], [0.25, 0.125, 0.0], 1.0),
        // Noise is 0 on the lattice.
        ("noise", vec![1.0, 5.0], [3.0, -2.0, 7.0], 0.5),
        ("turbulence", vec![1.0, 5.0], [3.0, -2.0, 7.0], 0.0),
        // One wave across (1, 1, 0): its crest at a quarter, its trough at three.
        ("fourier", vec![1.0, 1.0], [0.0, 0.0, 0.9], 0.5),
        ("fourier", vec![1.0, 1.0], [0.125, 0.125, 0.9], 1.0),
        ("fourier", vec![1.0, 1.0], [0.5, 0.25, 0.9], 0.0),
        ("fourier", vec![1.0, 2.0], [0.0; 3], 0.5 + 0.5 * sine * second / (first + second)),
        ("spots", vec![1.0, 0.0], [0.3, 0.4, 0.5], 0.0),
    ] {
        let found = sharp(&named(keyword, &arguments), DVec3::from_array(place));
        assert!(
            (found - expected).abs() < 1e-12,
            "{keyword} {arguments:?} at {place:?}: {found}, not {expected}"
        );
    }
}

#[test]
fn arguments_out_of_range_are_refused() {
    let refused = |keyword: &str, index: usize, value: f64| {
        Texture::named(keyword).unwrap().set(index, value).unwrap_err().map(|parameter| {
            let range = parameter.range.to_string();
            (parameter.name, range)
        })
    };
    let because = |name, range: &str| Some((name, range.to_owned()));
    assert_eq!(refused("wood", 0, 0.0), because("scale", "above 0"));
    assert_eq!(refused("wood", 0, f64::NAN), because("scale", "above 0"));
    assert_eq!(refused("wood", 0, f64::INFINITY), because("scale", "above 0"));
    assert_eq!(refused("noise", 1, 0.0), because("octaves", "a whole number from 1 to 16"));
    assert_eq!(refused("noise", 1, 17.0), because("octaves", "a whole number from 1 to 16"));
    assert_eq!(refused("noise", 1, 1.5), because("octaves", "a whole number from 1 to 16"));
    assert_eq!(refused("spots", 1, 0.51), because("radius", "from 0 to 0.5"));
    assert_eq!(refused("spots", 1, -0.01), because("radius", "from 0 to 0.5"));
    assert_eq!(refused("wood", 9, 1.0), None, "no such parameter");
    for function in FUNCTIONS {
        for (i, parameter) in function.parameters.iter().enumerate() {
            for value in awkward(parameter.range) {
                named(function.keyword, &[]).set(i, value).unwrap();
            }
        }
    }
}

#[test]
fn every_function_is_on_the_page_with_its_picture() {
    let docs = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs");
    let read = |path: &str| std::fs::read(format!("{docs}/{path}")).expect(path);
    let page = String::from_utf8(read("textures.md")).unwrap();
    for function in FUNCTIONS {
        let name = function.keyword;
        let (_, section) = page.split_once(&format!("\n## {name}\n")).expect(name);
        let section = section.split("\n## ").next().unwrap();
        assert!(section.contains(&format!("](textures/{name}.png)")), "{name} is shown");
        let rows: Vec<String> = function
            .settings()
            .map(|setting| {
                let (name, default) = (setting.name(), setting.default());
                format!("| `{name}` | {default} | {} |", setting.range())
            })
            .collect();
        for row in &rows {
            assert!(section.contains(row), "{name}: {row}");
        }
        let given = usize::from(function.subject().is_some());
        assert_eq!(section.matches("\n| `").count(), rows.len() + given, "rows of {name}");
        let scene = String::from_utf8(read(&format!("textures/{name}.sdl"))).unwrap();
        assert!(scene.contains(&format!("paint {name} ")), "the scene of {name}");
        let picture = read(&format!("textures/{name}.png"));
        assert!(picture.len() < 12 * 1024, "{name}: {} bytes", picture.len());
        // Width and height stand after the signature, a length and `IHDR`.
        assert_eq!(picture[16..24], [0, 0, 0, 128, 0, 0, 0, 128], "size of {name}");
    }
    assert_eq!(page.matches("\n## ").count(), FUNCTIONS.len(), "no other sections");
}

/// Mean of a texture over a spot, at 17³ places.
fn averaged(texture: &Texture, spot: &Spot) -> f64 {
    let place = |i: u32| (f64::from(i) + 0.5) / 17.0 - 0.5;
    let places =
        (0..17_u32.pow(3)).map(|i| DVec3::new(place(i % 17), place(i / 17 % 17), place(i / 289)));
    places.map(|away| sharp(texture, spot.point + away * spot.width)).sum::<f64>() / 4_913.0
}

#[test]
fn what_a_pixel_takes_in_is_near_the_mean() {
    // Bounds on the root of the mean square of the error. Patterns along the axes are exact but for the mean that they are
    // compared with; noise is what can be said from one point.
    for (keyword, arguments, bound) in [
        ("checker", vec![8.0, 8.0], 0.03),
        ("checker3d", vec![8.0], 0.02),
        ("stripes", vec![8.0], 0.06),
        ("grid", vec![8.0, 8.0, 0.3], 0.08),
        ("brick", vec![8.0, 8.0, 0.3], 0.08),
        ("rings", vec![4.0, 0.1, 0.2], 0.06),
        ("fourier", vec![1.0, 12.0], 0.04),
        ("noise", vec![8.0, 4.0], 0.06),
        ("turbulence", vec![8.0, 4.0], 0.07),
        ("marble", vec![4.0, 5.0], 0.13),
        ("wood", vec![8.0, 0.3], 0.1),
        ("granite", vec![4.0, 3.0], 0.08),
        ("spots", vec![8.0, 0.4, 0.2], 0.13),
    ] {
        let texture = named(keyword, &arguments);
        for width in [0.02, 0.06, 0.15, 0.3, 0.8, 2.9] {
            let (mut error, mut point, mut count) = (0.0, 0.0, 0.0);
            for i in 0..60 {
                let f = f64::from(i);
                let place = DVec3::new(f * 0.618 % 1.0, f * 0.377 % 1.0, f * 0.271 % 1.0);
                let flat =
                    if i % 2 == 0 { DVec3::new(1.0, 1.0, 0.0) } else { DVec3::new(0.3, 1.0, 1.0) };
                let spot = Spot { point: place, width: width * flat };
                let mean = averaged(&texture, &spot);
                let (found, alone) = (texture.weight(&spot).unwrap(), sharp(&texture, place));
                error += (found - mean) * (found - mean);
                point += (alone - mean) * (alone - mean);
                count += 1.0;
            }
            let (error, point) = ((error / count).sqrt(), (point / count).sqrt());
            assert!(error < bound, "{keyword} over {width}: {error}, alone {point}");
            let better = 0.55 * point + 0.03;
            assert!(error < better, "{keyword} over {width}: {error}, alone {point}");
        }
    }
}
