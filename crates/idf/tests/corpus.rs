//! Damaged files give errors or images, never panics.
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;
use std::path::Path;

use idf::description::parse;
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
    let folder = tempfile::tempdir().unwrap();
    let image = corpus(folder.path());
    for name in FILES {
        let path = folder.path().join(name);
        let whole = fs::read(&path).unwrap();
        let (mut images, mut errors) = (0, 0);
        for at in 0..whole.len() {
            // Every value for coded rows; for a text, those that mean something in it, as
            // `every_changed_byte_of_a_text_is_parsed` has the others; for samples, a few.
            let wanted = |byte: &u8| match name {
                "c.enc" | "c.lut" => byte.is_power_of_two(),
                "c.idf" | "c.log" => b"\0\n\r #\"\\./-0129abcfrx\x80\xff".contains(byte),
                _ => true,
            };
            for byte in (0..=255_u8).filter(wanted) {
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
    }
    assert_eq!(open(folder.path()).unwrap(), image);
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
