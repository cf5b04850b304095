//! The kitty graphics protocol: a PNG in base 64, in chunks of at most 4096 characters
//! (<https://sw.kovidgoyal.net/kitty/graphics-protocol/>).

use std::path::Path;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use idf::exchange::write_stream;
use idf::plane::COLOR;
use idf::{Image, Plane, Samples};
use ilut::Pixels;

use crate::{Drawing, ShowError};

/// Most characters of a chunk.
const CHUNK: usize = 4096;

/// Shows an opaque picture where the cursor is; the terminal answers nothing (`q=2`).
pub(crate) fn drawing(pixels: &Pixels) -> Result<Drawing, ShowError> {
    let plane = |(channel, kind)| {
        let bytes = pixels.colors().iter().map(|color: &[u8; 4]| color[channel]).collect();
        Plane { kind, samples: Samples::U8(bytes) }
    };
    let planes = COLOR.into_iter().enumerate().map(plane).collect();
    let image = Image::new(pixels.columns(), pixels.rows(), planes)?;
    let mut png = Vec::new();
    write_stream(Path::new("terminal"), &mut png, &image)
        .map_err(|error| ShowError::Code(idf::command::chain(&error)))?;
    let text = STANDARD.encode(&png);
    let chunks = text.as_bytes().chunks(CHUNK);
    let last = chunks.len() - 1;
    let mut pieces = Vec::new();
    for (position, chunk) in chunks.enumerate() {
        let head = if position == 0 { "a=T,f=100,q=2," } else { "" };
        let more = u8::from(position < last);
        let chunk = str::from_utf8(chunk).expect("base 64 is ASCII");
        pieces.push(format!("\x1b_G{head}m={more};{chunk}\x1b\\"));
    }
    pieces.push("\n".into());
    // The last chunk may be empty; what came is no PNG then, and dropped.
    Ok(Drawing { pieces, closing: "\x1b_Gm=0,q=2;\x1b\\\n" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use idf::exchange::read_stream;
    use idf::{Kind, ReadOptions};

    #[test]
    fn chunks_hold_the_picture() {
        // Noise, so that there are several chunks.
        let mut state = 7_u32;
        let mut byte = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        let colors: Vec<[u8; 4]> = (0..3000).map(|_| [byte(), byte(), byte(), 255]).collect();
        let drawing = drawing(&Pixels::new(60, 50, colors.clone()).unwrap()).unwrap();
        let (end, chunks) = drawing.pieces.split_last().unwrap();
        assert_eq!(end, "\n");
        assert!(chunks.len() > 2, "{}", chunks.len());
        let mut text = String::new();
        for (position, chunk) in chunks.iter().enumerate() {
            let body = chunk.strip_prefix("\x1b_G").unwrap().strip_suffix("\x1b\\").unwrap();
            let (keys, data) = body.split_once(';').unwrap();
            let expected = match position {
                0 => "a=T,f=100,q=2,m=1",
                _ if position + 1 < chunks.len() => "m=1",
                _ => "m=0",
            };
            assert_eq!(keys, expected);
            assert!(data.len() <= 4096 && (data.len() % 4 == 0), "{}", data.len());
            text.push_str(data);
        }
        let png = STANDARD.decode(text).unwrap();
        let image = read_stream(Path::new("x"), &png[..], &ReadOptions::default()).unwrap();
        assert_eq!(image.size(), [60, 50]);
        let green: Vec<u8> = colors.iter().map(|color| color[1]).collect();
        assert_eq!(image.plane(Kind::Grn), Some(&Samples::U8(green)));
    }
}
