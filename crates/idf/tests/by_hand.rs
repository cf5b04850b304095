//! Descriptions edited by hand: comments and unknown keys stay, channels are borrowed.
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;
use std::path::Path;

use idf::{Ask, Image, Kind, Plane, ReadOptions, Samples, WriteOptions, add, read, write};

/// Writes an image of 2 x 1 with planes of one value.
fn image(path: &Path, kinds: &[Kind], value: u8) -> Image {
    let plane = |&kind| Plane { kind, samples: Samples::U8(vec![value; 2]) };
    let image = Image::new(2, 1, kinds.iter().map(plane).collect()).unwrap();
    write(path, &image, &WriteOptions::default()).unwrap();
    image
}

const TEXT: &str = "\
# the glass of the cover
idf 1
size  2 1          # as printed
lamp  40 W         # a key of another program

# the mask was painted by hand
cvg   mask.grg 2 1 8 raw    # borrowed
grg   glass.grg 2 1 8 raw
";

#[test]
fn what_is_added_leaves_the_rest_as_it_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let (glass, mask) = (folder.path().join("glass"), folder.path().join("mask"));
    image(&glass, &[Kind::Grg], 90);
    image(&mask, &[Kind::Grg], 128);
    let text = folder.path().join("glass.idf");
    fs::write(&text, TEXT).unwrap();
    let read_all = || read(&glass, &ReadOptions::default()).unwrap();
    assert_eq!(read_all().plane(Kind::Cvg), Some(&Samples::U8(vec![128; 2])));
    let indices = Plane { kind: Kind::Enc, samples: Samples::U8(vec![0, 1]) };
    let mut more = Image::new(2, 1, vec![indices]).unwrap();
    more.lut = idf::Lut::with_coverage(vec![[1, 2, 3, 4], [5, 6, 7, 255]]);
    add(&glass, &more, &WriteOptions::default()).unwrap();
    let added = "enc glass.enc 2 1 8 raw\nlut glass.lut 2 4 8 raw\n";
    assert_eq!(fs::read_to_string(&text).unwrap(), format!("{TEXT}{added}"));
    let all = read_all();
    assert_eq!(all.kinds(), [Kind::Cvg, Kind::Grg, Kind::Enc, Kind::Lut]);
    assert_eq!(all.lut, more.lut);
    // In the place of one that is borrowed comes an own one; the other image keeps its file.
    let own = Plane { kind: Kind::Cvg, samples: Samples::U8(vec![7; 2]) };
    add(&glass, &Image::new(2, 1, vec![own]).unwrap(), &WriteOptions::default()).unwrap();
    let expected = TEXT.replace("cvg   mask.grg 2 1 8 raw    #", "cvg glass.cvg 2 1 8 raw #");
    assert_eq!(fs::read_to_string(&text).unwrap(), format!("{expected}{added}"));
    let lender = read(&mask, &ReadOptions::default()).unwrap();
    assert_eq!(lender.plane(Kind::Grg), Some(&Samples::U8(vec![128; 2])));
}

#[test]
fn comments_and_unknown_lines_go_along_with_the_image() {
    let folder = tempfile::tempdir().unwrap();
    let glass = folder.path().join("glass");
    image(&glass, &[Kind::Grg], 90);
    fs::write(folder.path().join("glass.idf"), TEXT.replace("cvg ", "#cvg ")).unwrap();
    let copy = read(&glass, &ReadOptions::default()).unwrap();
    write(&folder.path().join("copy"), &copy, &WriteOptions::default()).unwrap();
    let text = fs::read_to_string(folder.path().join("copy.idf")).unwrap();
    let expected = "idf 1\nsize 2 1\n# the glass of the cover\n\
                    lamp  40 W         # a key of another program\n\
                    # the mask was painted by hand\n\
                    #cvg   mask.grg 2 1 8 raw    # borrowed\n\
                    grg copy.grg 2 1 8 raw\n";
    assert_eq!(text, expected);
}

#[test]
fn a_borrowed_channel_of_another_size_opens_alone() {
    let folder = tempfile::tempdir().unwrap();
    let glass = folder.path().join("glass");
    image(&glass, &[Kind::Grg], 90);
    fs::write(folder.path().join("small"), [3]).unwrap();
    let text = TEXT.replace("mask.grg 2 1", "small 1 1");
    fs::write(folder.path().join("glass.idf"), text).unwrap();
    let ask = |kind| ReadOptions { ask: Ask::Only(vec![kind]), ..ReadOptions::default() };
    assert_eq!(read(&glass, &ask(Kind::Cvg)).unwrap().size(), [1, 1]);
    assert_eq!(read(&glass, &ask(Kind::Grg)).unwrap().size(), [2, 1]);
    let error = read(&glass, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("icopy --channels grg --resize 1x1"), "{error}");
}
