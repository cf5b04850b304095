//! The table of `docs/farm.md`: how tiles and numbers of parts share a picture out, simulated with the rays of each part.
//!
//! `cargo run --release -p farm --example sizing -- SECONDS START END` takes the seconds of the whole picture on one thread, those that a
//! part costs besides, and those from the last part to the picture.

#![expect(clippy::print_stdout, reason = "a program")]

use std::error::Error;
use std::path::Path;

use farm::schedule::Farm;
use idf::part::{Share, Tiles};
use render::part::{render_part, sampled_pixels};
use render::{Filter, Options, Sampling, World};

const SCENE: &str = "scenes/wine-glass/wine-glass.sdl";
const SIDE: u32 = 1024;

fn main() -> Result<(), Box<dyn Error>> {
    let numbers: Result<Vec<f64>, _> = std::env::args().skip(1).map(|word| word.parse()).collect();
    let [seconds, start, end] = numbers?[..] else {
        return Err("expected SECONDS START END".into());
    };
    let compiled = compile::compile_path_with(Path::new(SCENE), &compile::Options::default());
    let world = World::load(&compiled.scene.ok_or("a scene")?)?;
    let options =
        Options { columns: SIDE, rows: SIDE, sampling: Sampling::Grid(2), ..Options::default() };
    let rays = |share: Share| -> Result<f64, Box<dyn Error>> {
        #[expect(clippy::cast_precision_loss, reason = "counts below 2⁵³")]
        Ok(render_part(&world, &options, share, &|_| ())?.stats.rays() as f64)
    };
    let whole = rays(Share::Tiles(Tiles { number: 0, count: 1, side: 64 }))?;
    println!(
        "| tile | parts | rays of the longest over the mean | pixels more, mitchell | 1 node | 2 | 4 | 8 | 16 |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for side in [8, 16, 32, 64, 128] {
        for count in [8, 16, 32, 64] {
            let tiles = |number| Share::Tiles(Tiles { number, count, side });
            let parts: Vec<f64> = (0..count).map(|n| rays(tiles(n))).collect::<Result<_, _>>()?;
            let mean = whole / f64::from(count);
            let longest = parts.iter().copied().fold(0.0, f64::max) / mean;
            let wide = Options { filter: Filter::Mitchell, ..options };
            let sampled: u64 = (0..count).map(|n| sampled_pixels(tiles(n), &wide)).sum();
            #[expect(clippy::cast_precision_loss, reason = "counts below 2⁵³")]
            let more = sampled as f64 / (f64::from(SIDE) * f64::from(SIDE)) - 1.0;
            let costs: Vec<f64> = parts.iter().map(|rays| seconds * rays / whole).collect();
            let efficiency = [1, 2, 4, 8, 16]
                .map(|workers| format!("{:.2}", Farm { workers, start, end }.efficiency(&costs)));
            println!(
                "| {side} | {count} | {longest:.2} | {:.0} % | {} |",
                100.0 * more,
                efficiency.join(" | ")
            );
        }
    }
    Ok(())
}
