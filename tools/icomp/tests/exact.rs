//! Every operator against exact arithmetic of other makes: whole numbers, and 64 bits with the tables
//! of another crate.
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]
#![expect(clippy::cast_possible_truncation, reason = "values are in range by construction")]

use icomp::{OPERATORS, Operator, Options, Rule, Share, composed};
use idf::plane::COLOR;
use idf::transfer::{rounded_8, rounded_16};
use idf::{Image, Kind, Matte, Plane, Quantizer, Samples, Transfer};

/// Random numbers of a fixed seed.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u32 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as u32
    }

    fn bytes(&mut self, count: usize) -> Vec<u8> {
        (0..count).map(|_| self.next().to_le_bytes()[1]).collect()
    }

    fn words(&mut self, count: usize) -> Vec<u16> {
        (0..count).map(|_| (self.next() >> 8) as u16).collect()
    }
}

fn grey(columns: usize, light: Samples, coverage: Option<Samples>, transfer: Transfer) -> Image {
    let rows = light.len() / columns;
    let mut planes = vec![Plane { kind: Kind::Grg, samples: light }];
    planes.extend(coverage.map(|samples| Plane { kind: Kind::Cvg, samples }));
    let mut image = Image::new(columns as u32, rows as u32, planes).unwrap();
    image.properties.transfer = Some(transfer);
    image
}

fn bytes(image: &Image, kind: Kind) -> &[u8] {
    let Some(Samples::U8(samples)) = image.plane(kind) else { panic!("{kind}") };
    samples
}

fn words(image: &Image, kind: Kind) -> &[u16] {
    let Some(Samples::U16(samples)) = image.plane(kind) else { panic!("{kind}") };
    samples
}

fn operators() -> impl Iterator<Item = (&'static Operator, [Share; 2])> {
    OPERATORS.iter().filter_map(|row| match row.rule {
        Rule::Two { a, b } => Some((row, [a, b])),
        Rule::One { .. } => None,
    })
}

fn composite(operator: &Operator, a: &Image, b: &Image) -> Image {
    composed(operator, &[a, b], &Options::default()).unwrap()
}

/// A share of whole numbers.
fn share(share: Share, other: i128, full: i128) -> i128 {
    i128::from(share.constant) * full + i128::from(share.slope) * other
}

/// `n / d`, rounded, halves up, within 0 and `full`; 0 of 0 is 0.
fn rounded(n: i128, d: i128, full: i128) -> i128 {
    if d == 0 { 0 } else { ((2 * n + d) / (2 * d)).min(full) }
}

/// All pairs of coverage in rows and columns.
fn coverages() -> [Vec<u8>; 2] {
    let pairs = (0..=u16::MAX).map(u16::to_le_bytes);
    pairs.map(|[a, b]| (a, b)).unzip::<u8, u8, Vec<u8>, Vec<u8>>().into()
}

#[test]
fn linear_bytes_are_exact_for_all_pairs_of_coverage() {
    let [cvg_a, cvg_b] = coverages();
    let mut random = Random(1);
    for matte in [Matte::Premultiplied, Matte::Straight] {
        for (operator, [share_a, share_b]) in operators() {
            let [light_a, light_b] = [random.bytes(65_536), random.bytes(65_536)];
            let picture = |light: &[u8], cvg: &[u8]| {
                let [light, cvg] = [light, cvg].map(|samples| Samples::U8(samples.into()));
                let mut image = grey(256, light, Some(cvg), Transfer::Linear);
                image.properties.matte = matte;
                image
            };
            let [a, b] = [picture(&light_a, &cvg_a), picture(&light_b, &cvg_b)];
            let result = composite(operator, &a, &b);
            assert_eq!(result.properties.matte, matte);
            for at in 0..65_536 {
                let [ca, cb, aa, ab] =
                    [light_a[at], light_b[at], cvg_a[at], cvg_b[at]].map(i128::from);
                let [fa, fb] = [share(share_a, ab, 255), share(share_b, aa, 255)];
                let coverage = fa * aa + fb * ab;
                let light = match matte {
                    Matte::Premultiplied => rounded(fa * ca + fb * cb, 255, 255),
                    // Coverage beyond 1 is 1, and what it divides is the coverage that is stored.
                    Matte::Straight => {
                        rounded(fa * aa * ca + fb * ab * cb, coverage.min(255 * 255), 255)
                    }
                };
                let found = [bytes(&result, Kind::Grg)[at], bytes(&result, Kind::Cvg)[at]];
                let expected = [light, rounded(coverage, 255, 255)];
                assert_eq!(
                    found.map(i128::from),
                    expected,
                    "{} {ca} {cb} {aa} {ab}",
                    operator.name
                );
            }
        }
    }
}

#[test]
fn linear_words_are_exact() {
    let mut random = Random(2);
    for matte in [Matte::Premultiplied, Matte::Straight] {
        for (operator, [share_a, share_b]) in operators() {
            let planes: [Vec<u16>; 4] = std::array::from_fn(|_| random.words(4000));
            let picture = |light: &Vec<u16>, cvg: &Vec<u16>| {
                let [light, cvg] = [light, cvg].map(|samples| Samples::U16(samples.clone()));
                let mut image = grey(400, light, Some(cvg), Transfer::Linear);
                image.properties.matte = matte;
                image
            };
            let [a, b] = [picture(&planes[0], &planes[1]), picture(&planes[2], &planes[3])];
            let result = composite(operator, &a, &b);
            let full = 65_535;
            (0..4000).for_each(|at: usize| {
                let [ca, aa, cb, ab] = [0, 1, 2, 3].map(|plane| i128::from(planes[plane][at]));
                let [fa, fb] = [share(share_a, ab, full), share(share_b, aa, full)];
                let coverage = fa * aa + fb * ab;
                let light = match matte {
                    Matte::Premultiplied => rounded(fa * ca + fb * cb, full, full),
                    Matte::Straight => {
                        rounded(fa * aa * ca + fb * ab * cb, coverage.min(full * full), full)
                    }
                };
                let found = [words(&result, Kind::Grg)[at], words(&result, Kind::Cvg)[at]];
                let expected = [light, rounded(coverage, full, full)];
                assert_eq!(
                    found.map(i128::from),
                    expected,
                    "{} {ca} {cb} {aa} {ab}",
                    operator.name
                );
            });
        }
    }
}

/// Decoded light of each byte.
fn light(transfer: Transfer) -> Vec<f64> {
    (0..=255_u8).map(|byte| transfer.decode(f64::from(byte) / 255.0)).collect()
}

#[test]
fn srgb_over_is_exact_for_all_lights_and_coverages() {
    let over = Operator::from_name("over").unwrap();
    let light = light(Transfer::Srgb);
    let quantizer = Quantizer::new(Transfer::Srgb);
    let [a, b] = coverages();
    let cvg_b = Samples::U8(vec![255; 65_536]);
    let behind = grey(256, Samples::U8(b.clone()), Some(cvg_b), Transfer::Srgb);
    for coverage in 0..=255_u8 {
        let cvg_a = Samples::U8(vec![coverage; 65_536]);
        let front = grey(256, Samples::U8(a.clone()), Some(cvg_a), Transfer::Srgb);
        let result = composite(over, &front, &behind);
        let left = f64::from(255 - coverage) / 255.0;
        for (at, &found) in bytes(&result, Kind::Grg).iter().enumerate() {
            let sum = light[usize::from(a[at])] + light[usize::from(b[at])] * left;
            assert_eq!(found, quantizer.byte(sum), "{} {} {coverage}", a[at], b[at]);
        }
        assert!(bytes(&result, Kind::Cvg).iter().all(|&cvg| cvg == 255), "{coverage}");
    }
}

#[test]
fn all_operators_are_exact_through_any_transfer() {
    let [cvg_a, cvg_b] = coverages();
    let mut random = Random(3);
    let pairs = [
        (Transfer::Srgb, Transfer::Srgb),
        (Transfer::Gamma(2.2), Transfer::Gamma(2.2)),
        (Transfer::Linear, Transfer::Gamma(1.8)),
    ];
    for (from_a, from_b) in pairs {
        // Different ones meet in the usual one.
        let to = if from_a == from_b { from_a } else { Transfer::Srgb };
        let lights = [light(from_a), light(from_b)];
        for (operator, shares) in operators() {
            let [light_a, light_b] = [random.bytes(65_536), random.bytes(65_536)];
            let picture = |light: &[u8], cvg: &[u8], transfer| {
                let [light, cvg] = [light, cvg].map(|samples| Samples::U8(samples.into()));
                grey(256, light, Some(cvg), transfer)
            };
            let a = picture(&light_a, &cvg_a, from_a);
            let b = picture(&light_b, &cvg_b, from_b);
            let result = composite(operator, &a, &b);
            assert_eq!(result.transfer(idf::Depth::U8), to);
            for at in (0..65_536).step_by(7) {
                let [aa, ab] = [cvg_a[at], cvg_b[at]].map(|cvg| f64::from(cvg) / 255.0);
                let [fa, fb] = [shares[0].of(ab, 1.0), shares[1].of(aa, 1.0)];
                let sum = lights[0][usize::from(light_a[at])] * fa
                    + lights[1][usize::from(light_b[at])] * fb;
                let expected = rounded_8(to, sum);
                assert_eq!(bytes(&result, Kind::Grg)[at], expected, "{} {at}", operator.name);
            }
        }
    }
}

#[test]
fn srgb_words_are_exact() {
    let mut random = Random(4);
    for (operator, shares) in operators() {
        let planes: [Vec<u16>; 4] = std::array::from_fn(|_| random.words(3000));
        let picture = |light: usize, cvg: usize| {
            let [light, cvg] = [light, cvg].map(|plane| Samples::U16(planes[plane].clone()));
            grey(300, light, Some(cvg), Transfer::Srgb)
        };
        let result = composite(operator, &picture(0, 1), &picture(2, 3));
        (0..3000).for_each(|at: usize| {
            let unit = |plane: usize| f64::from(planes[plane][at]) / 65_535.0;
            let light = |plane| Transfer::Srgb.decode(unit(plane));
            let sum = light(0) * shares[0].of(unit(3), 1.0) + light(2) * shares[1].of(unit(1), 1.0);
            let expected = rounded_16(Transfer::Srgb, sum);
            assert_eq!(words(&result, Kind::Grg)[at], expected, "{} {at}", operator.name);
        });
    }
}

/// A pixel of linear floating point: red, green, blue, coverage.
fn pixel(values: [f32; 4]) -> Image {
    let kinds = COLOR.into_iter().chain([Kind::Cvg]);
    let plane = |(kind, value)| Plane { kind, samples: Samples::F32(vec![value]) };
    Image::new(1, 1, kinds.zip(values).map(plane).collect()).unwrap()
}

fn values(image: &Image) -> [f32; 4] {
    let kinds = COLOR.into_iter().chain([Kind::Cvg]);
    let values: Vec<f32> = kinds
        .map(|kind| match image.plane(kind) {
            Some(Samples::F32(samples)) => samples[0],
            None => 1.0,
            other => panic!("{kind} {other:?}"),
        })
        .collect();
    values.try_into().unwrap()
}

#[test]
fn operators_have_the_values_of_the_paper() {
    let (a, b) = (pixel([0.6, 0.3, 0.1, 0.75]), pixel([0.1, 0.2, 0.4, 0.5]));
    for (name, expected) in [
        ("clear", [0.0, 0.0, 0.0, 0.0]),
        ("a", [0.6, 0.3, 0.1, 0.75]),
        ("b", [0.1, 0.2, 0.4, 0.5]),
        ("over", [0.625, 0.35, 0.2, 0.875]),
        ("rover", [0.4, 0.35, 0.45, 0.875]),
        ("in", [0.3, 0.15, 0.05, 0.375]),
        ("rin", [0.075, 0.15, 0.3, 0.375]),
        ("out", [0.3, 0.15, 0.05, 0.375]),
        ("rout", [0.025, 0.05, 0.1, 0.125]),
        ("atop", [0.325, 0.2, 0.15, 0.5]),
        ("ratop", [0.375, 0.3, 0.35, 0.75]),
        ("xor", [0.325, 0.2, 0.15, 0.5]),
        ("plus", [0.7, 0.5, 0.5, 1.0]),
    ] {
        let operator = Operator::from_name(name).unwrap();
        let found = values(&composite(operator, &a, &b));
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-7, "{name}: {found} {expected}");
        }
    }
    for (name, expected) in [
        ("darken", [0.3, 0.15, 0.05, 0.75]),
        ("dissolve", [0.3, 0.15, 0.05, 0.375]),
        ("opaque", [0.6, 0.3, 0.1, 0.375]),
    ] {
        let options = Options { factor: 0.5, ..Options::default() };
        let operator = Operator::from_name(name).unwrap();
        let found = values(&composed(operator, &[&a], &options).unwrap());
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-7, "{name}: {found} {expected}");
        }
    }
}

/// The largest difference between two ways of bracketing three random pixels.
fn gap(operator: &Operator) -> f32 {
    let mut random = Random(5);
    let mut largest = 0.0_f32;
    for _ in 0..300 {
        let mut next = || {
            let mut unit = || f64::from(random.next() >> 8) / f64::from(1 << 23);
            let coverage = unit();
            let light = [unit() * coverage, unit() * coverage, unit() * coverage];
            pixel([light[0], light[1], light[2], coverage].map(|value| value as f32))
        };
        let [a, b, c] = [next(), next(), next()];
        let left = composite(operator, &composite(operator, &a, &b), &c);
        let right = composite(operator, &a, &composite(operator, &b, &c));
        for (left, right) in values(&left).iter().zip(values(&right)) {
            largest = largest.max((left - right).abs());
        }
        // Folding rounds once, so it is as near to the one as that is rounded.
        let folded = composed(operator, &[&a, &b, &c], &Options::default()).unwrap();
        for (folded, left) in values(&folded).iter().zip(values(&left)) {
            assert!((folded - left).abs() <= 2e-7, "{}", operator.name);
        }
    }
    largest
}

#[test]
fn brackets_matter_only_where_they_should() {
    for (operator, _) in operators() {
        let gap = gap(operator);
        let not_associative = ["out", "rout", "atop", "ratop", "xor"];
        if not_associative.contains(&operator.name) {
            assert!(gap > 0.3, "{}: {gap}", operator.name);
        } else {
            // Two roundings of values below 1.
            assert!(gap <= 2.4e-7, "{}: {gap}", operator.name);
        }
    }
}
