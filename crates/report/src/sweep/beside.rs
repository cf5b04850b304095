//! What stands beside a scene's own pictures: few colours, and another renderer.

use std::fs;

use idf::exchange::read_image;
use idf::{Ask, ReadOptions};

use super::bench::Bench;
use super::{Found, Result};
use crate::journal::{Digest, Figures};
use crate::{colors, peer};

impl Bench<'_> {
    pub(super) fn coloring(&mut self, found: &mut Found) -> Result<()> {
        let path = self.file("pictures", "reference-box.png");
        if !path.exists() {
            return Ok(());
        }
        let options = ReadOptions { ask: Ask::Picture, ..ReadOptions::default() };
        let pixels = ilut::Pixels::of(&read_image(&path, &options)?, None)?;
        let digest = Digest::default().and(pixels.colors().as_flattened());
        for way in colors::ways() {
            let words = format!("{} of {digest}", way.words());
            let figures = self.measured(&words, 0.5, |bench| {
                let (figures, image) = way.measured(&pixels)?;
                bench.save("pictures", &format!("{}.png", way.file()), &image)?;
                Ok(figures)
            })?;
            found.colors.extend(figures.map(|figures| (way, figures)));
        }
        Ok(())
    }

    pub(super) fn peers(&mut self, found: &mut Found) -> Result<()> {
        let Some(file) = &self.settings.peer else { return Ok(()) };
        let Some(version) = peer::version() else {
            self.missing.push("POV-Ray: it is not installed".into());
            return Ok(());
        };
        let text = fs::read(file).map_err(|error| format!("{}: {error}", file.display()))?;
        let source = format!("{version} {}", Digest::default().and(&text));
        let mut reference = None;
        let mut plain = 0.0;
        for way in peer::WAYS {
            let words = format!("povray {} of {source}", way.options);
            let cost = plain * way.cost;
            let size = self.settings.size;
            let figures = self.measured(&words, cost, |bench| {
                let to = bench.file("references", &bench.keyed("povray.png"));
                let picture = bench.file("pictures", &format!("{}.png", way.file()));
                match peer::measured(file, way, size, [&to, &picture], &mut reference) {
                    Ok(figures) => Ok(figures),
                    Err(error) => Ok(Figures::default().with_note(error)),
                }
            })?;
            let Some(figures) = figures else { continue };
            if plain <= 0.0 {
                plain = figures.get("seconds").unwrap_or(0.0);
            }
            if figures.note.is_empty() {
                found.peers.push((way, figures));
            } else {
                self.missing.push(format!("POV-Ray {}: {}", way.options, figures.note));
            }
        }
        Ok(())
    }
}
