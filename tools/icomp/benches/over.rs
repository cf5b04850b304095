//! Pixels per second of `over`, on one thread, of 4K pictures with coverage.
//!
//! `cargo bench -p icomp` prints the best of several runs of each, with coverage that is nowhere 0
//! or 1, and with blocks of none and all as pictures have them.

use std::hint::black_box;
use std::io::Write;
use std::sync::LazyLock;
use std::time::Instant;

use icomp::{Operator, Options, Plan, Source};
use idf::plane::COLOR;
use idf::{Depth, Image, ImageError, Kind, Matte, Plane, Samples, Transfer};

const COLUMNS: u32 = 3840;
const ROWS: u32 = 2160;

fn main() -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    pool.install(|| {
        for soft in [true, false] {
            let what = if soft { "soft" } else { "blocks" };
            for (name, depth, transfer, matte) in [
                ("8 linear", Depth::U8, Transfer::Linear, Matte::Premultiplied),
                ("8 srgb", Depth::U8, Transfer::Srgb, Matte::Premultiplied),
                ("8 srgb straight", Depth::U8, Transfer::Srgb, Matte::Straight),
                ("16 linear", Depth::U16, Transfer::Linear, Matte::Premultiplied),
                ("16 srgb", Depth::U16, Transfer::Srgb, Matte::Premultiplied),
                ("32f linear", Depth::F32, Transfer::Linear, Matte::Premultiplied),
            ] {
                let a = picture(1, depth, transfer, matte, soft)?;
                let b = picture(2, depth, transfer, matte, soft)?;
                for operator in ["over", "xor"] {
                    report(&format!("{operator} {name} {what}"), operator, &a, &b)?;
                }
            }
        }
        Ok(())
    })
}

/// A picture of smooth light with coverage: noise of 1 to 254, or a disc with a soft rim.
fn picture(
    seed: u32,
    depth: Depth,
    transfer: Transfer,
    matte: Matte,
    soft: bool,
) -> Result<Image, ImageError> {
    let mut state = seed;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    let center = [f64::from(COLUMNS) * 0.4 * f64::from(seed), f64::from(ROWS) * 0.5];
    let mut planes = vec![Vec::new(); 4];
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let [x, y] = [f64::from(column) - center[0], f64::from(row) - center[1]];
            let rim = (900.0 - x.hypot(y)) / 40.0;
            let coverage = if soft { (1.0 + 253.0 * noise()) / 255.0 } else { rim.clamp(0.0, 1.0) };
            for (channel, plane) in (1_u8..).zip(&mut planes[..3]) {
                let light = f64::from(column * u32::from(channel) % 1000) / 1000.0;
                let share = if matte == Matte::Straight { 1.0 } else { coverage };
                plane.push(narrow(light * share));
            }
            planes[3].push(narrow(coverage));
        }
    }
    let encoded = |(kind, values): (Kind, &Vec<f32>)| {
        let transfer = if kind == Kind::Cvg { Transfer::Linear } else { transfer };
        let samples = Samples::encoded(values, depth, transfer);
        Plane { kind, samples: samples.expect("no value is not a number") }
    };
    let kinds = COLOR.into_iter().chain([Kind::Cvg]);
    let mut image = Image::new(COLUMNS, ROWS, kinds.zip(&planes).map(encoded).collect())?;
    image.properties.transfer = Some(transfer);
    image.properties.matte = matte;
    Ok(image)
}

#[expect(clippy::cast_possible_truncation, reason = "planes hold 32-bit values by definition")]
fn narrow(value: f64) -> f32 {
    value as f32
}

/// Seconds that this thread has worked; where the system does not say, that have passed.
fn seconds() -> f64 {
    let schedule = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let worked = schedule.split(' ').next().and_then(|word| word.parse::<f64>().ok());
    worked.map_or_else(|| START.elapsed().as_secs_f64(), |nanoseconds| nanoseconds * 1e-9)
}

static START: LazyLock<Instant> = LazyLock::new(Instant::now);

/// Prints the megapixels per second of one operator.
fn report(
    name: &str,
    operator: &str,
    a: &Image,
    b: &Image,
) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
    let operator = Operator::from_name(operator).ok_or("no such operator")?;
    let sources = [a, b].map(|image| Source { sample: image, window: image.window() });
    let plan = Plan::new(operator, &sources, &Options::default())?;
    let mut planes = plan.band(&[Some(a), Some(b)], 0..ROWS)?.planes().to_vec();
    let mut planes: Vec<Samples> = planes.drain(..).map(|plane| plane.samples).collect();
    let mut best = f64::INFINITY;
    for _ in 0..7 {
        let start = seconds();
        plan.fill(&[Some(black_box(a)), Some(black_box(b))], 0..ROWS, &mut planes)?;
        black_box(&planes);
        best = best.min(seconds() - start);
    }
    let rate = f64::from(COLUMNS * ROWS) / best / 1e6;
    writeln!(std::io::stdout(), "{name:32} {rate:8.0} megapixels per second")?;
    Ok(())
}
