//! Paint and the pictures it shows: one coat a line, one file a line.

use std::io::{self, Write};

use super::check::{ANY, Range as Numbers, SHARE};
use super::error::ReadError;
use super::lines::Lines;
use crate::optics::{ImageFile, ImageId, Paint};
use crate::texture::{Parameter, Range, Texture, Weight, word};

/// Writes a coat without the end of its line; `images` is how many there are.
///
/// # Errors
///
/// What `out` says, or [`io::ErrorKind::InvalidInput`] for a coat that no reader would take.
pub fn write_paint(coat: &Paint, images: usize, out: &mut impl Write) -> io::Result<()> {
    write!(out, "paint")?;
    let mut texture = Some(&coat.texture);
    while let Some(written) = texture {
        write_texture(written, out)?;
        texture = written.inner();
    }
    require(coat.texture.is_whole(), || "a texture with what it works on".to_owned())?;
    if let Some(ImageId(image)) = coat.texture.image() {
        write!(out, " file {image}")?;
        require((image as usize) < images, || format!("an image of {images}, found {image}"))?;
    }
    match coat.color {
        Some(color) => {
            write!(out, " color")?;
            color.to_array().into_iter().try_for_each(|share| number(share, &SHARE, out))
        }
        None => require(!coat.texture.needs_color(), || "a colour".to_owned()),
    }
}

fn write_texture(texture: &Texture, out: &mut impl Write) -> io::Result<()> {
    let function = texture.function();
    write!(out, " {}", function.keyword)?;
    for (parameter, &value) in function.parameters.iter().zip(texture.arguments()) {
        if !matches!(parameter.range, Range::Coordinate(1 | 2)) {
            write!(out, " {}", parameter.name)?;
        }
        match parameter.range {
            Range::Word(words) => write!(out, " {}", word(words, value))?,
            _ => number(value, &ANY, out)?,
        }
    }
    if texture.inner().is_some() { write!(out, " of") } else { Ok(()) }
}

fn number(value: f64, range: &Numbers, out: &mut impl Write) -> io::Result<()> {
    write!(out, " {value:?}")?;
    require(range.allows(value), || format!("{}, found {value:?}", range.words))
}

/// Writes the line of an image without its end.
pub(super) fn write_image(
    number: usize,
    image: &ImageFile,
    out: &mut impl Write,
) -> io::Result<()> {
    write!(out, "image {number} ")?;
    quoted(&image.path, out)
}

fn quoted(text: &str, out: &mut impl Write) -> io::Result<()> {
    let text_is_fit = !text.is_empty() && !text.contains(char::is_control);
    require(text_is_fit, || format!("a file name without control characters, found {text:?}"))?;
    write!(out, "\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

fn require(holds: bool, expected: impl FnOnce() -> String) -> io::Result<()> {
    if holds {
        return Ok(());
    }
    let message = format!("compiled scene: expected {}", expected());
    Err(io::Error::new(io::ErrorKind::InvalidInput, message))
}

/// What follows `image`, up to the end of the line.
pub(super) fn read_image(lines: &mut Lines<'_>, number: usize) -> Result<ImageFile, ReadError> {
    lines.ordinal(number)?;
    let (line, column) = lines.place();
    let path = lines.quoted()?;
    lines.end_line()?;
    Ok(ImageFile { path, source: String::new(), line, column })
}

/// What follows `paint`, up to the end of the line; `images` is how many there are.
pub(super) fn read_paint(lines: &mut Lines<'_>, images: usize) -> Result<Paint, ReadError> {
    let mut texture = read_texture(lines)?;
    if matches!(texture.function().weight, Weight::Relief) {
        lines.expect("of")?;
        let mark = lines.mark();
        let inner = read_subject(lines, images)?;
        let nested = || lines.error_at(mark, "a texture function that is no relief");
        texture = texture.of_function(inner).ok_or_else(nested)?;
    } else {
        texture = with_image(texture, lines, images)?;
    }
    let color = if texture.needs_color() || lines.peek() == b"color" {
        lines.expect("color")?;
        Some(lines.vector(&SHARE)?)
    } else {
        None
    };
    lines.end_line()?;
    Ok(Paint { texture, color })
}

fn read_subject(lines: &mut Lines<'_>, images: usize) -> Result<Texture, ReadError> {
    let texture = read_texture(lines)?;
    with_image(texture, lines, images)
}

fn with_image(
    texture: Texture,
    lines: &mut Lines<'_>,
    images: usize,
) -> Result<Texture, ReadError> {
    if !matches!(texture.function().weight, Weight::Picture(_)) {
        return Ok(texture);
    }
    lines.expect("file")?;
    Ok(texture.of_image(ImageId(lines.index("an image", images)?)))
}

fn read_texture(lines: &mut Lines<'_>) -> Result<Texture, ReadError> {
    let mut texture = lines.parsed("a texture function", Texture::named)?;
    for (i, &Parameter { name, range, .. }) in texture.function().parameters.iter().enumerate() {
        if !matches!(range, Range::Coordinate(1 | 2)) {
            lines.expect(name)?;
        }
        let value = |text: &str| match range {
            Range::Word(words) => words.iter().position(|word| *word == text).map(|i| i as f64),
            _ => text.parse().ok(),
        };
        let set = |text: &str| texture.set(i, value(text)?).ok();
        lines.parsed("an argument in its range", set)?;
    }
    Ok(texture)
}
