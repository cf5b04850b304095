//! PNM and PAM row by row.
#![cfg(feature = "exchange")]
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;

use idf::exchange::{AnymapWriter, open_rows, read_image, read_stream, write_image};
use idf::plane::COLOR;
use idf::{Image, Kind, Matte, Plane, ReadOptions, Samples, WriteOptions};

fn image(columns: u32, planes: Vec<(Kind, Samples)>) -> Image {
    let rows = u32::try_from(planes[0].1.len()).unwrap() / columns;
    let planes = planes.into_iter().map(|(kind, samples)| Plane { kind, samples });
    Image::new(columns, rows, planes.collect()).unwrap()
}

fn straight(mut image: Image) -> Image {
    image.properties.matte = Matte::Straight;
    image
}

fn bytes(samples: &[u8]) -> Samples {
    Samples::U8(samples.into())
}

#[test]
fn rows_of_pnm_and_pam_are_those_of_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let kinds = [vec![Kind::Grg], vec![Kind::Grg, Kind::Cvg], COLOR.to_vec()];
    for (number, kinds) in
        kinds.into_iter().chain([[&COLOR[..], &[Kind::Cvg]].concat()]).enumerate()
    {
        for is_deep in [false, true] {
            let count = 2100 * 700;
            let samples = |at: usize| {
                let value = move |pixel: usize| (pixel * (at + 3) / 5 % 65_521).to_le_bytes();
                if is_deep {
                    Samples::U16(
                        (0..count)
                            .map(|p| u16::from_le_bytes([value(p)[0], value(p)[1]]))
                            .collect(),
                    )
                } else {
                    Samples::U8((0..count).map(|p| value(p)[0]).collect())
                }
            };
            let planes = kinds.iter().enumerate().map(|(at, &kind)| (kind, samples(at)));
            let original = image(2100, planes.collect());
            let covered = kinds.contains(&Kind::Cvg);
            let original = if covered { straight(original) } else { original };
            let path = folder.path().join(if covered { "x.pam" } else { "x.ppm" });
            write_image(&path, &original, &WriteOptions::default()).unwrap();
            assert!(read_image(&path, &ReadOptions::default()).unwrap() == original, "{number}");
            let mut rows = open_rows(&path).unwrap().expect("rows as they are");
            assert_eq!(
                (rows.size(), rows.properties().matte),
                (original.size(), original.properties.matte)
            );
            // Beyond what is read at once, from the middle, and backwards.
            for range in [100..700, 699..700, 0..1] {
                let band = rows.band(range.clone()).unwrap();
                assert_eq!(band.properties.origin, [0, i32::try_from(range.start).unwrap()]);
                for plane in original.planes() {
                    let part = range.start as usize * 2100..range.end as usize * 2100;
                    assert!(
                        band.plane(plane.kind) == Some(&plane.samples.gathered(part)),
                        "{range:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn rows_that_do_not_lie_in_a_file_are_left_to_reading_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.pgm");
    let rows = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        open_rows(&path).unwrap().map(|rows| rows.size())
    };
    assert_eq!(rows(b"P5\n# a\n2 1\n255\n\x01\x02 and more"), Some([2, 1]));
    assert_eq!(rows(b"P5 2 1 65535\n\x01\x02\x03\x04"), Some([2, 1]));
    let long = [b"P5 #", &[b'a'; 5000][..], b"\n2 1 255\n\x01\x02"].concat();
    for other in [
        &b"P5\n2 1\n255\n\x01"[..],
        b"P5 2 1 254\n\x01\x02",
        b"P2 2 1 255\n1 2",
        b"P4 2 1\n\x80",
        b"P5 0 1 255\n",
        b"P5 2 1 65535\n\x01\x02\x03",
        b"",
        b"\x89PNG",
        &long,
    ] {
        assert_eq!(rows(other), None, "{other:?}");
    }
    assert_eq!(open_rows(&folder.path().join("x.png")).unwrap().map(|rows| rows.size()), None);
    assert!(open_rows(&folder.path().join("none.pgm")).is_err());
    // All of these but those that are cut off or no picture are read as before.
    fs::write(&path, long).unwrap();
    assert_eq!(read_image(&path, &ReadOptions::default()).unwrap().size(), [2, 1]);
    fs::write(&path, b"P5\n2 1\n255\n\x01").unwrap();
    assert!(read_image(&path, &ReadOptions::default()).is_err());
}

#[test]
fn a_pnm_is_written_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.pgm");
    fs::write(&path, "old").unwrap();
    let band = image(2, vec![(Kind::Grg, bytes(&[1, 2, 3, 4]))]);
    let mut writer = AnymapWriter::create(&path, [2, 3]).unwrap();
    writer.write(&band).unwrap();
    assert!(writer.write(&band).is_err(), "one row is left");
    assert!(writer.write(&image(3, vec![(Kind::Grg, bytes(&[1, 2, 3]))])).is_err(), "columns");
    assert!(writer.finish().is_err(), "a row is missing");
    assert_eq!(fs::read(&path).unwrap(), b"old");
    let mut writer = AnymapWriter::create(&path, [2, 3]).unwrap();
    writer.write(&band).unwrap();
    writer.write(&image(2, vec![(Kind::Grg, bytes(&[5, 6]))])).unwrap();
    writer.finish().unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"P5\n2 3\n255\n\x01\x02\x03\x04\x05\x06");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing else stays");
}

/// Rows are read here, the whole by a library that others use, too.
#[test]
fn damaged_files_are_read_as_a_stream_of_them_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.pam");
    let originals: [&[u8]; 4] = [
        b"P7\nWIDTH 3\nHEIGHT 2\nDEPTH 4\nMAXVAL 255\nTUPLTYPE RGB_ALPHA\nENDHDR\nabcdefghijklmnopqrstuvwx",
        b"P6\n# a\n3 2\n255\nabcdefghijklmnopqr",
        b"P5 3 2 65535\nabcdefghijkl",
        b"P5 3 2 255 abcdef",
    ];
    for original in originals {
        let cut = (0..original.len()).map(|length| original[..length].to_vec());
        let changed = (0..original.len()).flat_map(|at| {
            b"\0\n #-01279PRY\x80\xff".iter().map(move |&byte| {
                let mut bytes = original.to_vec();
                bytes[at] = byte;
                bytes
            })
        });
        let mut images = 0;
        for bytes in cut.chain(changed) {
            // A new file each time, as some systems wait for the disk where one is cut.
            fs::remove_file(&path).ok();
            fs::write(&path, &bytes).unwrap();
            let by_rows = open_rows(&path).unwrap();
            let streamed = read_stream(&path, &bytes[..], &ReadOptions::default());
            let text = String::from_utf8_lossy(&bytes);
            if let Some(mut rows) = by_rows {
                let streamed = streamed.unwrap_or_else(|error| panic!("{text}: {error}"));
                assert_eq!(rows.band(0..rows.size()[1]).unwrap(), streamed, "{text}");
                assert_eq!(read_image(&path, &ReadOptions::default()).unwrap(), streamed, "{text}");
                images += 1;
            }
        }
        assert!(images > 90, "{images}");
    }
}
