//! POV-Ray's ways of anti-aliasing on a scene that was written for it, each against its own picture of many samples.

use std::error::Error;
use std::path::Path;
use std::process::{Command, Stdio};

use idf::exchange::read_image;
use idf::{Ask, ReadOptions};

use crate::journal::Figures;
use crate::truth::Shown;

/// A way of anti-aliasing.
#[derive(Debug)]
pub struct Way {
    /// Which points belong together on a plot.
    pub kind: &'static str,
    /// What stands beside the point.
    pub label: &'static str,
    /// Words of its command line.
    pub options: &'static str,
    /// Samples a pixel at most, about.
    pub cost: f64,
}

/// What all others are compared with.
const REFERENCE: &str = "+AM1 +A0.0 +R8";
/// Samples of it.
const REFERENCE_COST: f64 = 64.0;

/// All ways; the plain one first, which tells what a sample costs.
#[rustfmt::skip]
pub const WAYS: &[Way] = &[
    Way { kind: "POV-Ray, none", label: "1", options: "-A", cost: REFERENCE_COST },
    Way { kind: "POV-Ray, method 1", label: ".3 R2", options: "+AM1 +A0.3 +R2", cost: 4.0 },
    Way { kind: "POV-Ray, method 1", label: ".3 R3", options: "+AM1 +A0.3 +R3", cost: 9.0 },
    Way { kind: "POV-Ray, method 1", label: ".1 R3", options: "+AM1 +A0.1 +R3", cost: 9.0 },
    Way { kind: "POV-Ray, method 1", label: ".1 R4", options: "+AM1 +A0.1 +R4", cost: 16.0 },
    Way { kind: "POV-Ray, method 1", label: ".03 R5", options: "+AM1 +A0.03 +R5", cost: 25.0 },
    Way { kind: "POV-Ray, method 2", label: ".3 R2", options: "+AM2 +A0.3 +R2", cost: 4.0 },
    Way { kind: "POV-Ray, method 2", label: ".3 R3", options: "+AM2 +A0.3 +R3", cost: 9.0 },
    Way { kind: "POV-Ray, method 2", label: ".1 R3", options: "+AM2 +A0.1 +R3", cost: 9.0 },
    Way { kind: "POV-Ray, method 2", label: ".03 R4", options: "+AM2 +A0.03 +R4", cost: 16.0 },
];

impl Way {
    /// A name for files.
    #[must_use]
    pub fn file(&self) -> String {
        format!("povray{}", self.options.replace([' ', '+', '-'], "-").replace("--", "-"))
    }
}

/// What POV-Ray says it is; none if it is not installed.
#[must_use]
pub fn version() -> Option<String> {
    let output = Command::new("povray").arg("--version").stdin(Stdio::null()).output().ok()?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let said = if said.trim().is_empty() {
        String::from_utf8_lossy(&output.stdout).into_owned()
    } else {
        said
    };
    let line = said.lines().find(|line| line.contains("POV-Ray"))?;
    Some(line.trim().to_owned())
}

/// Renders `scene` to a file: CPU seconds of tracing.
fn traced(
    scene: &Path,
    options: &str,
    (columns, rows): (u32, u32),
    to: &Path,
) -> Result<f64, Box<dyn Error>> {
    let path = |sign: &str, path: &Path| format!("{sign}{}", path.display());
    let output = Command::new("povray")
        .args([path("+I", scene), path("+O", to)])
        .args([format!("+W{columns}"), format!("+H{rows}")])
        .args(["-D", "-J", "+WT1", "+FN16"])
        .args(options.split(' '))
        .stdin(Stdio::null())
        .output()?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    if !output.status.success() {
        let last = said.lines().rev().find(|line| line.contains("rror")).unwrap_or("it failed");
        return Err(last.trim().to_owned().into());
    }
    cpu_seconds(&said).ok_or_else(|| "it does not say how long it took".into())
}

/// CPU seconds of tracing, as POV-Ray writes them.
fn cpu_seconds(said: &str) -> Option<f64> {
    // Of parsing, of photons and of tracing: the last counts.
    let mut lines = said.lines().rev();
    let words = lines.find(|line| line.contains("CPU-seconds"))?.split("with ").nth(1)?;
    words.split_whitespace().next()?.parse().ok()
}

/// `seconds` and `error` in display steps against its own picture of many samples, which is made where it is not there
/// yet. `files` are those of that picture and of this one.
///
/// # Errors
///
/// If POV-Ray fails, or writes what cannot be read.
pub fn measured(
    scene: &Path,
    way: &Way,
    size: (u32, u32),
    [reference_file, file]: [&Path; 2],
    reference: &mut Option<Shown>,
) -> Result<Figures, Box<dyn Error>> {
    let shown = |path: &Path| -> Result<Shown, Box<dyn Error>> {
        let options = ReadOptions { ask: Ask::Picture, ..ReadOptions::default() };
        Ok(Shown::of(&read_image(path, &options)?)?)
    };
    let reference = match reference {
        Some(reference) => reference,
        None => {
            if !reference_file.exists() {
                let begun = reference_file.with_extension("part.png");
                traced(scene, REFERENCE, size, &begun)?;
                std::fs::rename(&begun, reference_file)?;
            }
            reference.insert(shown(reference_file)?)
        }
    };
    let seconds = traced(scene, way.options, size, file)?;
    let error = shown(file)?.apart(reference);
    Ok(Figures::default().with("seconds", seconds).with("error", error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_as_they_are_written() {
        let said = "Render Time:\n  Photon Time:      No photons\n  Trace Time:       0 hours  0 minutes  0 seconds (0.264 seconds)\n\
                    \x20             using 1 thread(s) with 0.250 CPU-seconds total\nPOV-Ray finished\n";
        assert_eq!(cpu_seconds(said), Some(0.25));
        assert_eq!(cpu_seconds("nothing"), None);
    }

    #[test]
    fn ways_have_files_of_their_own() {
        let mut files: Vec<String> = WAYS.iter().map(Way::file).collect();
        files.sort_unstable();
        files.dedup();
        assert_eq!(files.len(), WAYS.len());
    }
}
