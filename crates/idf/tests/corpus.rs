//! Damaged files give errors or images, never panics.
#![cfg(feature = "exchange")]
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;
use std::path::Path;

use ::image::codecs::{jpeg::JpegEncoder, tiff::TiffEncoder, webp::WebPEncoder};
use ::image::{ExtendedColorType, ImageEncoder};
use rayon::prelude::*;

use idf::description::parse;
use idf::exchange::{read_stream, write_frames, write_image};
use idf::plane::COLOR;
use idf::{
    Ask, Encoding, Image, Kind, Plane, ReadError, ReadOptions, Samples, WriteOptions, add, read,
    write,
};

/// A small image of every depth, with coded and raw files, a table and a log.
fn corpus(folder: &Path) -> Image {
    let path = folder.join("c");
    let planes = vec![
        Plane { kind: Kind::Grg, samples: Samples::U16((0..48).map(|i| i / 12 * 257).collect()) },
        Plane { kind: Kind::Cvg, samples: Samples::U8((0..48).map(|i| i / 24).collect()) },
        Plane { kind: Kind::Dep, samples: Samples::F32(vec![1.5; 48]) },
    ];
    let mut image = Image::new(12, 4, planes).unwrap();
    image.properties.origin = [3, -4];
    image.properties.background = Some([0.8, 0.5, 0.25]);
    image.properties.transfer = Some(idf::Transfer::Gamma(2.2));
    image.properties.unknown = vec!["camera 35 # mm".into()];
    image.properties.history = vec!["then\tme\t1\ta \"b c\"\t".into()];
    write(&path, &image, &WriteOptions::default()).unwrap();
    let indices = Plane { kind: Kind::Enc, samples: Samples::U8((0..48).collect()) };
    let mut more = Image::new(12, 4, vec![indices]).unwrap();
    more.lut = idf::Lut::new((0..48).map(|i| [i, 2 * i, 255 - i]).collect());
    add(&path, &more, &WriteOptions { encoding: Encoding::Raw, ..WriteOptions::default() })
        .unwrap();
    open(folder).unwrap()
}

fn open(folder: &Path) -> Result<Image, ReadError> {
    read(&folder.join("c.idf"), &ReadOptions { history: true, ..ReadOptions::default() })
}

/// Opens only the channel in file `name`, or all for a text.
fn open_one(folder: &Path, name: &str) -> Result<Image, ReadError> {
    let kind = Kind::from_word(&name[2..]).filter(|&kind| kind != Kind::Log);
    let Some(kind) = kind else { return open(folder) };
    let options = ReadOptions { ask: Ask::Only(vec![kind]), ..ReadOptions::default() };
    read(&folder.join("c.idf"), &options)
}

/// Other values for a byte: each bit turned, the ends, and a sixteenth of all, another one at each
/// place. All 255 were tried once, with the same end, in two minutes.
fn changes(byte: u8, at: usize) -> Vec<u8> {
    let bits = (0..8).map(|bit| byte ^ 1 << bit);
    let sixteenth = (0..=255_u8).filter(|&value| (usize::from(value) + 5 * at).is_multiple_of(16));
    let mut values: Vec<u8> = bits.chain([0, 255]).chain(sixteenth).collect();
    values.sort_unstable();
    values.dedup();
    values.retain(|&value| value != byte);
    values
}

const FILES: [&str; 7] = ["c.idf", "c.grg", "c.cvg", "c.dep", "c.enc", "c.lut", "c.log"];

#[test]
fn the_corpus_has_every_encoding() {
    let folder = tempfile::tempdir().unwrap();
    let image = corpus(folder.path());
    assert_eq!(image.kinds(), [Kind::Grg, Kind::Cvg, Kind::Dep, Kind::Enc, Kind::Lut]);
    let text = fs::read_to_string(folder.path().join("c.idf")).unwrap();
    assert!(text.contains("grg c.grg 12 4 16 rle\n"), "{text}");
    assert!(text.contains("dep c.dep 12 4 32f rle\n"), "{text}");
    assert!(text.contains("enc c.enc 12 4 8 raw\n"), "{text}");
}

#[test]
fn every_changed_byte_gives_an_error_or_an_image() {
    FILES.into_par_iter().for_each(|name| {
        let folder = tempfile::tempdir().unwrap();
        let image = corpus(folder.path());
        let path = folder.path().join(name);
        let whole = fs::read(&path).unwrap();
        let (mut images, mut errors) = (0, 0);
        for at in 0..whole.len() {
            // For a text, those that mean something in it, as
            // `every_changed_byte_of_a_text_is_parsed` has the others; for samples, a few.
            let wanted = |byte: &u8| match name {
                "c.enc" | "c.lut" => byte.is_power_of_two(),
                "c.idf" | "c.log" => b"\0\n\r #\"\\./-0129abcfrx\x80\xff".contains(byte),
                _ => true,
            };
            let all: Vec<u8> = if name.ends_with("idf") || name.ends_with("log") {
                (0..=255).collect()
            } else {
                changes(whole[at], at)
            };
            for byte in all.into_iter().filter(wanted) {
                let mut damaged = whole.clone();
                damaged[at] = byte;
                fs::write(&path, &damaged).unwrap();
                match open_one(folder.path(), name) {
                    Ok(read) => {
                        assert_eq!(read.size(), image.size(), "{name} {at} {byte}");
                        images += 1;
                    }
                    Err(error) => {
                        assert!(!error.to_string().is_empty());
                        errors += 1;
                    }
                }
            }
        }
        fs::write(&path, &whole).unwrap();
        assert!(images > 0, "{name}: nothing was read");
        let checked = !matches!(name, "c.enc" | "c.lut");
        assert_eq!(errors > 0, checked, "{name}: {errors} errors");
        assert_eq!(open(folder.path()).unwrap(), image);
    });
}

#[test]
fn every_changed_byte_of_a_text_is_parsed() {
    let folder = tempfile::tempdir().unwrap();
    corpus(folder.path());
    let whole = fs::read(folder.path().join("c.idf")).unwrap();
    let (mut descriptions, mut errors) = (0, 0);
    for at in 0..whole.len() {
        for byte in 0..=255_u8 {
            let mut damaged = whole.clone();
            damaged[at] = byte;
            let Ok(text) = String::from_utf8(damaged) else { continue };
            match parse(&text) {
                // What is understood is printed so that it is understood the same.
                Ok(description) => {
                    assert_eq!(parse(&description.to_string()), Ok(description), "{text}");
                    descriptions += 1;
                }
                Err(error) => {
                    assert!(error.line >= 1 && error.line <= text.lines().count(), "{text}");
                    errors += 1;
                }
            }
        }
    }
    assert!(descriptions > whole.len() && errors > whole.len(), "{descriptions} {errors}");
}

#[test]
fn every_truncation_gives_an_error_or_less() {
    let folder = tempfile::tempdir().unwrap();
    let image = corpus(folder.path());
    for name in FILES {
        let path = folder.path().join(name);
        let whole = fs::read(&path).unwrap();
        for length in 0..whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            match open(folder.path()) {
                Ok(read) => {
                    let text = matches!(name, "c.idf" | "c.log");
                    assert!(text, "{name} of {length} bytes was read");
                    assert_eq!(read.size(), image.size());
                }
                Err(error) => {
                    let message = error.to_string();
                    assert!(message.contains(name) || name == "c.idf", "{name}: {message}");
                }
            }
        }
        fs::write(&path, [&whole[..], b"\0"].concat()).unwrap();
        // In a text, one byte more is one line more.
        let text = matches!(name, "c.idf" | "c.log");
        assert_eq!(open(folder.path()).is_ok(), text, "{name} with one byte more");
        fs::write(&path, &whole).unwrap();
    }
}

/// A small file of each other format and form.
fn files(folder: &Path) -> Vec<(&'static str, Vec<u8>)> {
    let image = |planes: Vec<(Kind, Samples)>| {
        let planes = planes.into_iter().map(|(kind, samples)| Plane { kind, samples });
        Image::new(3, 2, planes.collect()).unwrap()
    };
    let color = || COLOR.map(|kind| (kind, Samples::U8(vec![1, 2, 3, 200, 201, 7]))).to_vec();
    let coverage = (Kind::Cvg, Samples::U8(vec![255, 0, 128, 128, 1, 255]));
    let mut indexed = image(vec![(Kind::Enc, Samples::U8(vec![0, 1, 2, 2, 1, 0]))]);
    indexed.lut = idf::Lut::with_coverage(vec![[1, 2, 3, 255], [4, 5, 6, 0], [7, 8, 9, 255]]);
    let grey = |samples| image(vec![(Kind::Grg, samples)]);
    let mut placed = grey(Samples::U16(vec![1, 256, 512, 9, 8, 7]));
    placed.properties.origin = [5, -6];
    let float = grey(Samples::F32(vec![0.5, 1.0, -1.0, 2.0, 3.0, 4.0]));
    let written = |name: &'static str, image: &Image| {
        let path = folder.join(name);
        write_image(&path, image, &WriteOptions::default()).unwrap();
        (name, fs::read(path).unwrap())
    };
    let mut files = vec![
        written("colour.png", &image([color(), vec![coverage.clone()]].concat())),
        written("placed.png", &placed),
        written("indexed.png", &indexed),
        written("indexed.gif", &indexed),
        written("float.exr", &float),
        written("deep.pgm", &grey(Samples::U16(vec![1, 256, 512, 9, 8, 7]))),
        written("covered.pam", &image([color(), vec![coverage]].concat())),
        ("text.pgm", b"P2 # grey\n3 2 15\n0 1 2\n13 4 5\n".to_vec()),
        ("bits.pbm", b"P4\n3 2\n\xa0\x40".to_vec()),
    ];
    let frames = folder.join("frames.gif");
    write_frames(&frames, &[indexed.clone(), indexed], 10, 0).unwrap();
    files.push(("frames.gif", fs::read(frames).unwrap()));
    let pixels: Vec<u8> = (0..18).map(|at| at * 13).collect();
    let mut jpeg = Vec::new();
    JpegEncoder::new_with_quality(&mut jpeg, 50)
        .encode(&pixels, 3, 2, ExtendedColorType::Rgb8)
        .unwrap();
    files.push(("photo.jpg", jpeg));
    let mut tiff = std::io::Cursor::new(Vec::new());
    let encoder = TiffEncoder::new(&mut tiff);
    encoder.write_image(&pixels, 3, 2, ExtendedColorType::Rgb8).unwrap();
    files.push(("colour.tif", tiff.into_inner()));
    let mut webp = Vec::new();
    WebPEncoder::new_lossless(&mut webp).encode(&pixels, 3, 2, ExtendedColorType::Rgb8).unwrap();
    files.push(("lossless.webp", webp));
    files
}

fn decode(bytes: &[u8]) -> Result<Image, ReadError> {
    read_stream(Path::new("x"), bytes, &ReadOptions::default())
}

#[test]
fn every_changed_byte_of_other_formats_gives_an_error_or_an_image() {
    let folder = tempfile::tempdir().unwrap();
    for (name, whole) in files(folder.path()) {
        assert!(decode(&whole).is_ok(), "{name}: {:?}", decode(&whole));
        let errors = (0..whole.len()).into_par_iter().map(|at| {
            let mut damaged = whole.clone();
            let mut errors = 0;
            for byte in changes(whole[at], at) {
                damaged[at] = byte;
                match decode(&damaged) {
                    // A byte of these stands for at most 1032 x 8 pixels.
                    Ok(image) => {
                        let pixels = u64::from(image.columns()) * u64::from(image.rows());
                        assert!(pixels <= 8256 * whole.len() as u64, "{name} {at} {byte}");
                    }
                    Err(error) => {
                        errors += 1;
                        assert!(!error.to_string().is_empty());
                    }
                }
            }
            errors
        });
        // The first bytes of a file at least say what it is.
        assert!(errors.sum::<usize>() >= 2 * 16, "{name}");
    }
}

#[test]
fn every_truncation_of_other_formats_gives_an_error_or_the_image() {
    let folder = tempfile::tempdir().unwrap();
    for (name, whole) in files(folder.path()) {
        let image = decode(&whole).unwrap();
        for length in 0..whole.len() {
            if let Ok(read) = decode(&whole[..length]) {
                assert_eq!(read, image, "{name} of {length} bytes");
            }
        }
        assert!(decode(&whole[..whole.len() / 2]).is_err(), "{name}");
    }
}
