//! Parts to pictures.

use std::error::Error;

use idf::command::Job as History;
use idf::command::save;
use idf::part::Assembly;

use crate::command::RenderArguments;
use crate::folder::Folder;
use crate::picture::{Picture, Work};
use crate::report::Figures;

/// Puts the parts of a picture together, if all are there, and writes it; the numbers of those that are not otherwise.
///
/// # Errors
///
/// If the picture cannot be written.
pub(crate) fn merge(
    arguments: &RenderArguments,
    folder: &Folder,
    work: &mut Work,
    picture: &Picture,
    history: History,
) -> Result<Result<(), Vec<usize>>, Box<dyn Error>> {
    let mut missing = Vec::new();
    let mut assembly: Option<Assembly> = None;
    let mut figures = Figures::default();
    let units = work.units(picture);
    let parts = units.len();
    for number in units {
        let unit = work.unit(number).ok_or("a part of another render")?;
        let Some(image) = folder.finished(unit, &work.job, &picture.part) else {
            missing.push(number);
            continue;
        };
        figures.add(&image.properties.history);
        match &mut assembly {
            Some(assembly) => assembly.add(&image)?,
            None => assembly = Some(Assembly::new(&image)?),
        }
    }
    if !missing.is_empty() {
        return Ok(Err(missing));
    }
    let mut image = assembly.ok_or("a picture without parts")?.finish()?;
    // One line in place of one for each part.
    image.properties.history.clear();
    let history = figures.told(history.with_figure("parts", parts));
    save(&picture.name, image, &arguments.picture.coding().write_options(), &history)?;
    if let Some((ledger, number)) = work.ledger.as_mut().zip(picture.frame) {
        ledger.add(number, picture.part.picture, &picture.name)?;
    }
    if !arguments.keep_parts {
        folder.clear(picture.frame);
    }
    Ok(Ok(()))
}
