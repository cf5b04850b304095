//! The image tools at the ends of their ranges.

use icomp::{Operator, composed};
use idf::plane::COLOR;
use idf::{Image, Kind, Matte, Plane, Samples, Transfer};
use ieq::{Operation, histogram, toned};
use ilut::{Method, Metric, Nearest, Pixels, oklab, quantize};

use super::case::{Case, Found, Promise};

const TABLES: &str =
    "Tables of few colours; pixels that are not the nearest entry's or entries too many";
const COVER: &str = "1000 images over each other; error of light and coverage";
const TONES: &str = "Tones; error in steps of 65 535";

/// The colour of a pixel by its number.
type Color = fn(u32) -> [u8; 4];

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = tables();
    cases.extend(covers());
    cases.extend(tones());
    cases
}

/// The square of how far two colours are apart.
fn distance(metric: Metric, a: [u8; 4], b: [u8; 4]) -> f64 {
    let at = |[r, g, b, _]: [u8; 4]| match metric {
        Metric::Rgb => [r, g, b].map(f64::from),
        Metric::Oklab => oklab::from_srgb([r, g, b]).map(f64::from),
    };
    at(a).into_iter().zip(at(b)).map(|(a, b)| (a - b) * (a - b)).sum()
}

fn tables() -> Vec<Case> {
    let mut cases = Vec::new();
    let pictures: [(&str, Color); 2] = [
        ("one colour", |_| [201, 100, 3, 255]),
        ("a gradient", |k| {
            let [low, high, ..] = k.to_le_bytes();
            [low, low ^ (high << 6), high << 6, 255]
        }),
    ];
    for (what, color) in pictures {
        for colors in [1, 2, 256] {
            let name = format!("{colors} entries for {what}");
            cases.push(Case::new(TABLES, name, Promise::Right, move || {
                let side = 32;
                let pixels = Pixels::new(side, side, (0..side * side).map(color).collect())
                    .expect("as many as it says");
                let mut wrong = 0;
                let mut of = 0;
                for method in Method::ALL {
                    for metric in [Metric::Rgb, Metric::Oklab] {
                        let options =
                            ilut::Options { colors, method, metric, ..Default::default() };
                        let made = quantize(&[&pixels], &options).expect("a table");
                        let table = made.table.colors();
                        wrong += table.len().saturating_sub(colors);
                        let indices = Nearest::new(&made.table, metric).indices(&pixels);
                        for (index, &color) in indices.into_iter().zip(pixels.colors()) {
                            of += 1;
                            let far = |&entry| distance(metric, entry, color);
                            let least = table.iter().map(far).fold(f64::INFINITY, f64::min);
                            let found = table.get(usize::from(index)).map(far);
                            // Oklab is in single precision there.
                            let most = least * (1.0 + 1e-5) + 1e-9;
                            let exact = what != "one colour" || least <= 0.0;
                            wrong += usize::from(!exact || found.is_none_or(|far| far > most));
                        }
                    }
                }
                Found::differing(wrong, of)
            }));
        }
    }
    cases
}

/// One pixel of grey with coverage.
fn pixel(light: f64, coverage: f64, bits: u32) -> Image {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "values from 0 to 1"
    )]
    let plane = |kind, value: f64| {
        let samples = match bits {
            8 => Samples::U8(vec![(255.0 * value).round() as u8]),
            16 => Samples::U16(vec![(65_535.0 * value).round() as u16]),
            _ => Samples::F32(vec![value as f32]),
        };
        Plane { kind, samples }
    };
    let planes = vec![plane(Kind::Grg, light * coverage), plane(Kind::Cvg, coverage)];
    let mut image = Image::new(1, 1, planes).expect("two planes");
    image.properties.transfer = Some(Transfer::Linear);
    image.properties.matte = Matte::Premultiplied;
    image
}

fn value(image: &Image, kind: Kind) -> f64 {
    match image.plane(kind) {
        Some(Samples::U8(samples)) => f64::from(samples[0]) / 255.0,
        Some(Samples::U16(samples)) => f64::from(samples[0]) / 65_535.0,
        Some(Samples::F32(samples)) => samples[0].into(),
        None => 1.0,
    }
}

fn covers() -> Vec<Case> {
    let mut cases = Vec::new();
    for (bits, words) in [(8, "8 bits"), (16, "16 bits"), (32, "32f")] {
        for (coverage, name) in [(0.0, "0"), (1.0 / 255.0, "1/255"), (1.0, "1")] {
            // Whole numbers stop growing where what is added is less than half a step.
            let most = match bits {
                _ if coverage <= 0.0 || coverage >= 1.0 => 0.0,
                8 => 0.5,
                16 => 2.1e-3,
                _ => 1e-5,
            };
            if bits == 16 && most <= 0.0 {
                continue;
            }
            let name = format!("coverage {name}, {words}");
            cases.push(Case::new(COVER, name, Promise::Within(most), move || {
                let over = Operator::from_name("over").expect("an operator");
                let sheet = pixel(1.0, coverage, bits);
                let mut sum = pixel(0.0, 0.0, bits);
                for _ in 0..1000 {
                    sum = composed(over, &[&sheet, &sum], &icomp::Options::default())
                        .expect("two images");
                }
                let left = (0..1000).fold(1.0, |left, _| left * (1.0 - coverage));
                let error = |kind| (value(&sum, kind) - (1.0 - left)).abs();
                Found::Error(error(Kind::Grg).max(error(Kind::Cvg)))
            }));
        }
    }
    cases
}

/// 16-bit grey of all tones from black to white, of these numbers.
fn ramp(tones: impl Iterator<Item = u16>) -> Image {
    let samples: Vec<u16> = tones.collect();
    let columns = u32::try_from(samples.len()).expect("at most 65536");
    let plane = |kind| Plane { kind, samples: Samples::U16(samples.clone()) };
    let mut image = Image::new(columns, 1, COLOR.map(plane).to_vec()).expect("three planes");
    image.properties.transfer = Some(Transfer::Srgb);
    image
}

fn tones() -> Vec<Case> {
    let gammas = [0.01, 1.0, 100.0].map(|gamma| {
        Case::new(TONES, format!("gamma {gamma}"), Promise::Within(0.51), move || {
            let operation = Operation::new("gamma", &[gamma]).expect("in range");
            let tones = || (0..=u16::MAX).step_by(13);
            let found = toned(ramp(tones()), &operation).expect("light");
            let Some(Samples::U16(found)) = found.plane(Kind::Red) else { panic!("16 bits") };
            Found::Error(tones().zip(found).fold(0.0, |most, (tone, &found)| {
                let expected = 65_535.0 * libm::pow(f64::from(tone) / 65_535.0, 1.0 / gamma);
                f64::max(most, (f64::from(found) - expected).abs())
            }))
        })
    });
    let bins = [1_usize, 2, 65_536].map(|bins| {
        Case::new(
            TONES,
            format!("a histogram of {bins} bins, tones lost"),
            Promise::Within(0.0),
            move || {
                let found = histogram(ramp(0..=u16::MAX), bins).expect("light");
                let lost =
                    |channel: &ieq::Channel| (channel.counts.iter().sum::<f64>() - 65_536.0).abs();
                Found::Error(found.channels.iter().map(lost).fold(0.0, f64::max))
            },
        )
    });
    gammas.into_iter().chain(bins).collect()
}
