//! The command line of `prreport passes`.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use idf::command::{UsageError, print, write_text};

use super::measure::{measured, seen};
use super::sheet::{Row, page, tables};
use crate::command::{Common, Size, subjects};
use crate::journal::Journal;
use crate::sweep::scene_digest;

/// What leaving out saves on scenes, pass by pass
///
/// Each scene is loaded and traced on one thread with all passes that leave out what it does not need, without any of them,
/// and without each of them alone, in turn. The least of several runs counts.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  prreport passes scenes/gallery/*.sdl -o passes")]
pub(crate) struct PassesArguments {
    /// Scenes: descriptions (.sdl) or compiled ones (.prc)
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    /// The folder of the report; it is made if it is not there
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// Columns and rows of all pictures
    #[arg(long, value_name = "WxH", default_value = "256x256")]
    size: Size,
    #[command(flatten)]
    common: Common,
}

/// Does what the command line says.
///
/// # Errors
///
/// What kept the report from being made.
pub(crate) fn run(arguments: &PassesArguments) -> Result<(), Box<dyn Error>> {
    let PassesArguments { output: folder, size: Size(size), common, .. } = arguments;
    if common.threads.count().is_some() {
        return Err(UsageError("--threads: `passes` measures on one thread".into()).into());
    }
    let subjects = subjects(&arguments.scenes, &[], common.talk)?;
    fs::create_dir_all(folder)
        .map_err(|error| format!("cannot make the folder {}: {error}", folder.display()))?;
    let mut journal = Journal::open(folder, common.fresh)?;
    let progress = common.talk.progress(subjects.len() as u64);
    let mut rows: Vec<Row> = Vec::new();
    for subject in &subjects {
        let named = |error: &dyn Error| format!("{}: {error}", subject.path.display());
        let seen = seen(&subject.scene, *size).map_err(|error| named(&*error))?;
        let digest = scene_digest(&subject.scene)?;
        let key = format!("{} passes {digest} {}x{}", env!("CARGO_PKG_VERSION"), size.0, size.1);
        let figures = match journal.get(&key) {
            Some(known) => known.clone(),
            None => {
                progress.stage(subject.name.clone());
                common.talk.note(&subject.name);
                let found =
                    measured(&subject.scene, &seen, *size).map_err(|error| named(&*error))?;
                journal.keep(&key, &found)?;
                found
            }
        };
        progress.advance(1);
        rows.push(Row { name: subject.name.clone(), seen, figures });
        write(&rows, *size, folder)?;
    }
    drop(progress);
    let told: Vec<String> = tables(&rows)
        .iter()
        .map(|table| format!("{}\n\n{}", table.title, table.markdown()))
        .collect();
    write_text(Path::new("-"), &told.join("\n"))?;
    if !common.talk.is_quiet() {
        print(&format!("{}\n", folder.join("report.html").display()));
    }
    Ok(())
}

fn write(rows: &[Row], size: (u32, u32), folder: &Path) -> Result<(), Box<dyn Error>> {
    for table in tables(rows) {
        write_text(&folder.join(format!("{}.csv", table.name)), &table.csv())?;
    }
    Ok(write_text(&folder.join("report.html"), &page(rows, size))?)
}
