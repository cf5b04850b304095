//! Pictures and measured channels in other formats, in and out.
#![cfg(feature = "exchange")]
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;
use std::path::Path;

use idf::exchange::{Format, read_image, read_stream, write_image};
use idf::plane::COLOR;
use idf::{
    Ask, Depth, Image, Kind, Matte, Plane, ReadError, ReadOptions, Samples, Transfer, WriteOptions,
};

/// 3 x 2 pixels of one bit, palette of opaque red and half covered blue.
const INDEXED: &[u8] = &[
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52,
    0x00, 0x00, 0x00, 0x03, 0x00, 0x00, 0x00, 0x02, 0x01, 0x03, 0x00, 0x00, 0x00, 0xa7, 0xba, 0xf4,
    0x59, 0x00, 0x00, 0x00, 0x06, 0x50, 0x4c, 0x54, 0x45, 0xff, 0x00, 0x00, 0x00, 0x00, 0xff, 0x6c,
    0xa1, 0xfd, 0x8e, 0x00, 0x00, 0x00, 0x02, 0x74, 0x52, 0x4e, 0x53, 0xff, 0x80, 0x08, 0x0f, 0xb3,
    0x6a, 0x00, 0x00, 0x00, 0x0c, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x70, 0x60, 0x38, 0x00,
    0x00, 0x01, 0x84, 0x01, 0x01, 0x34, 0x82, 0x43, 0xfc, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e,
    0x44, 0xae, 0x42, 0x60, 0x82,
];

/// 2 x 1 grey pixels of 16 bits: 0x1234, 0xff00.
const DEEP: &[u8] = &[
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52,
    0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x10, 0x00, 0x00, 0x00, 0x00, 0x81, 0xd9, 0xfc,
    0x15, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x10, 0x32, 0xf9, 0xcf,
    0x00, 0x00, 0x02, 0xe7, 0x01, 0x46, 0xa0, 0xa5, 0x9e, 0x52, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45,
    0x4e, 0x44, 0xae, 0x42, 0x60, 0x82,
];

/// 60000 x 30000 pixels by its header, and the data of none.
const BOMB: &[u8] = &[
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52,
    0x00, 0x00, 0xea, 0x60, 0x00, 0x00, 0x75, 0x30, 0x01, 0x00, 0x00, 0x00, 0x00, 0xbd, 0xa7, 0x46,
    0xcd, 0x00, 0x00, 0x00, 0x09, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x00, 0x00, 0x00, 0x01,
    0x00, 0x01, 0xb1, 0x0d, 0xb6, 0x93, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42,
    0x60, 0x82,
];

fn decode(bytes: &[u8]) -> Result<Image, ReadError> {
    read_stream(Path::new("test"), bytes, &ReadOptions::default())
}

fn image(columns: u32, planes: Vec<(Kind, Samples)>) -> Image {
    let rows = u32::try_from(planes[0].1.len()).unwrap() / columns;
    let planes = planes.into_iter().map(|(kind, samples)| Plane { kind, samples });
    Image::new(columns, rows, planes.collect()).unwrap()
}

fn bytes(samples: &[u8]) -> Samples {
    Samples::U8(samples.into())
}

/// Writes and reads a file with this ending.
fn there_and_back(image: &Image, ending: &str) -> Image {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("x.{ending}"));
    write_image(&path, image, &WriteOptions::default()).unwrap();
    read_image(&path, &ReadOptions::default()).unwrap()
}

fn straight(mut image: Image) -> Image {
    image.properties.matte = Matte::Straight;
    image
}

#[test]
fn png_of_one_bit_with_a_palette_is_read() {
    let expected = image(
        3,
        vec![
            (Kind::Red, bytes(&[255, 0, 255, 0, 0, 255])),
            (Kind::Grn, bytes(&[0; 6])),
            (Kind::Blu, bytes(&[0, 255, 0, 255, 255, 0])),
            (Kind::Cvg, bytes(&[255, 128, 255, 128, 128, 255])),
        ],
    );
    assert_eq!(decode(INDEXED).unwrap(), straight(expected));
}

#[test]
fn png_of_sixteen_bits_is_read_whole() {
    let expected = image(2, vec![(Kind::Grg, Samples::U16(vec![0x1234, 0xff00]))]);
    assert_eq!(decode(DEEP).unwrap(), expected);
}

#[test]
fn png_comes_back_in_every_form() {
    let light: Vec<Vec<Kind>> = vec![vec![Kind::Grg], COLOR.to_vec()];
    for kinds in light {
        for covered in [false, true] {
            for depth in [Depth::U8, Depth::U16] {
                let kinds = kinds.iter().copied().chain(covered.then_some(Kind::Cvg));
                let planes = kinds.enumerate().map(|(i, kind)| {
                    let step = u16::try_from(i).unwrap() + 1;
                    let words: Vec<u16> = (0..35).map(|at| at * step * 331).collect();
                    let samples = match depth {
                        Depth::U8 => {
                            Samples::U8(words.iter().map(|w| w.to_be_bytes()[1]).collect())
                        }
                        _ => Samples::U16(words),
                    };
                    (kind, samples)
                });
                let original = image(7, planes.collect());
                let original = if covered { straight(original) } else { original };
                assert_eq!(there_and_back(&original, "png"), original);
            }
        }
    }
}

#[test]
fn premultiplied_bytes_come_back_through_png() {
    // Every byte that light of up to full strength has at every coverage.
    let (mut light, mut coverage) = (vec![0; 256 * 256], vec![0; 256 * 256]);
    for cvg in 0..=255_u8 {
        let most = idf::srgb8(f64::from(cvg) / 255.0);
        for value in 0..=255 {
            light[usize::from(cvg) * 256 + usize::from(value)] = value.min(most);
            coverage[usize::from(cvg) * 256 + usize::from(value)] = cvg;
        }
    }
    let original = image(256, vec![(Kind::Grg, bytes(&light)), (Kind::Cvg, bytes(&coverage))]);
    let back = there_and_back(&original, "png");
    assert_eq!(back.properties.matte, Matte::Straight);
    assert_eq!(back.with_matte(Matte::Premultiplied).unwrap(), original);
}

#[test]
fn exr_is_linear_premultiplied_and_in_its_place() {
    let mut original = image(
        2,
        vec![
            (Kind::Red, bytes(&[255, 0])),
            (Kind::Grn, bytes(&[188, 0])),
            (Kind::Blu, bytes(&[0, 13])),
            (Kind::Cvg, bytes(&[255, 51])),
        ],
    );
    original.properties.origin = [-7, 12];
    let back = there_and_back(&original, "exr");
    assert_eq!(back.properties.origin, [-7, 12]);
    assert_eq!(back.transfer(Depth::F32), Transfer::Linear);
    let values = |kind| back.decoded(kind).unwrap();
    assert_eq!(values(Kind::Red), [1.0, 0.0]);
    // ((188/255 + 0.055) / 1.055)^2.4 and ((13/255 + 0.055) / 1.055)^2.4
    assert!((values(Kind::Grn)[0] - 0.502_886_5).abs() < 1e-6, "{:?}", values(Kind::Grn));
    assert!((values(Kind::Blu)[1] - 0.004_024_7).abs() < 1e-6, "{:?}", values(Kind::Blu));
    assert_eq!(values(Kind::Cvg), [1.0, 0.2]);
    assert_eq!(back.at_depth(Depth::U8).unwrap().planes(), original.planes());
    // Straight light is multiplied on the way.
    let half = vec![(Kind::Grg, bytes(&[255])), (Kind::Cvg, bytes(&[51]))];
    let back = there_and_back(&straight(image(1, half)), "exr");
    assert_eq!(back.decoded(Kind::Grg).unwrap(), [0.2]);
}

#[test]
fn exr_keeps_any_light() {
    let light = Samples::F32(vec![-1.5, 1e30, f32::INFINITY, 1e-40, -0.0, 7.0]);
    let original = image(3, vec![(Kind::Grg, light)]);
    assert_eq!(there_and_back(&original, "exr"), original);
}

#[test]
fn exr_of_named_layers_and_half_floats_is_read() {
    use exr::prelude::*;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.exr");
    let list = ["side.B", "side.G", "side.R", "side.Z"].into_iter().zip(1_u8..);
    let channels = list.map(|(name, value)| {
        AnyChannel::new(name, FlatSamples::F16(vec![f16::from_f32(value.into()); 2]))
    });
    let channels = AnyChannels::sort(channels.collect());
    Image::from_channels((2, 1), channels).write().to_file(&path).unwrap();
    let read = read_image(&path, &ReadOptions::default()).unwrap();
    assert_eq!(read.kinds(), [COLOR.to_vec(), vec![Kind::Dep]].concat());
    let expected = [3.0, 2.0, 1.0].map(|value| vec![value; 2]);
    assert_eq!(COLOR.map(|kind| read.decoded(kind).unwrap()), expected);
}

#[test]
fn pnm_is_read_and_written_opaque() {
    let expected = image(2, vec![(Kind::Grg, bytes(&[0, 128, 255, 7]))]);
    assert_eq!(decode(b"P2 2 2 255\n0 128\n255 7\n").unwrap(), expected);
    assert_eq!(decode(b"P5\n2 2\n255\n\x00\x80\xff\x07").unwrap(), expected);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.ppm");
    let mut covered = image(1, vec![(Kind::Grg, bytes(&[0])), (Kind::Cvg, bytes(&[0]))]);
    covered.properties.background = Some([1.0; 3]);
    write_image(&path, &covered, &WriteOptions::default()).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"P5\n1 1\n255\n\xff");
    let deep = COLOR.map(|kind| (kind, Samples::U16(vec![0x0102])));
    write_image(&path, &image(1, deep.into()), &WriteOptions::default()).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"P6\n1 1\n65535\n\x01\x02\x01\x02\x01\x02");
}

#[test]
fn pam_keeps_coverage() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.pam");
    let planes = vec![(Kind::Grg, bytes(&[1, 200])), (Kind::Cvg, bytes(&[255, 100]))];
    let original = straight(image(2, planes));
    write_image(&path, &original, &WriteOptions::default()).unwrap();
    let header = "P7\nWIDTH 2\nHEIGHT 1\nDEPTH 2\nMAXVAL 255\nTUPLTYPE GRAYSCALE_ALPHA\nENDHDR\n";
    let expected = [header.as_bytes(), &[1, 255, 200, 100]].concat();
    assert_eq!(fs::read(&path).unwrap(), expected);
    assert_eq!(decode(&expected).unwrap(), original);
    for kinds in [vec![Kind::Grg], COLOR.to_vec(), [&COLOR[..], &[Kind::Cvg]].concat()] {
        let deep = kinds.iter().map(|&kind| (kind, Samples::U16(vec![0x0102, 0xfffe])));
        let original = image(2, deep.collect());
        let original = if kinds.contains(&Kind::Cvg) { straight(original) } else { original };
        assert_eq!(there_and_back(&original, "pam"), original);
    }
}

#[test]
fn samples_of_a_pnm_are_scaled_to_its_largest() {
    let read = decode(b"P2 3 1 15\n0 7 15\n").unwrap();
    assert_eq!(read.plane(Kind::Grg), Some(&bytes(&[0, 119, 255])));
    let read = decode(b"P5 3 1 1000\n\x00\x00\x01\xf4\x03\xe8").unwrap();
    assert_eq!(read.plane(Kind::Grg), Some(&Samples::U16(vec![0, 32_768, 65_535])));
}

#[test]
fn tiff_and_webp_are_read() {
    use ::image::codecs::{tiff::TiffEncoder, webp::WebPEncoder};
    use ::image::{ExtendedColorType, ImageEncoder};
    let pixels = [1, 2, 3, 255, 4, 5, 6, 100];
    let expected = straight(image(
        2,
        vec![
            (Kind::Red, bytes(&[1, 4])),
            (Kind::Grn, bytes(&[2, 5])),
            (Kind::Blu, bytes(&[3, 6])),
            (Kind::Cvg, bytes(&[255, 100])),
        ],
    ));
    let mut webp = Vec::new();
    WebPEncoder::new_lossless(&mut webp).encode(&pixels, 2, 1, ExtendedColorType::Rgba8).unwrap();
    assert_eq!(decode(&webp).unwrap(), expected);
    let tiff = |pixels: &[u8], color| {
        let mut file = std::io::Cursor::new(Vec::new());
        TiffEncoder::new(&mut file).write_image(pixels, 2, 1, color).unwrap();
        decode(&file.into_inner()).unwrap()
    };
    assert_eq!(tiff(&pixels, ExtendedColorType::Rgba8), expected);
    let deep: Vec<u8> = [258_u16, 65_535].iter().flat_map(|word| word.to_ne_bytes()).collect();
    let expected = image(2, vec![(Kind::Grg, Samples::U16(vec![258, 65_535]))]);
    assert_eq!(tiff(&deep, ExtendedColorType::L16), expected);
    let float = [1.5_f32, -2.0, 0.25, 1e9, 0.0, 7.0];
    let float: Vec<u8> = float.iter().flat_map(|value| value.to_ne_bytes()).collect();
    let read = tiff(&float, ExtendedColorType::Rgb32F);
    assert_eq!(read.decoded(Kind::Red).unwrap(), [1.5, 1e9]);
    assert_eq!(read.transfer(Depth::F32), Transfer::Linear);
}

/// A PNG with one more chunk before its samples.
fn with_chunk(png: &[u8], name: [u8; 4], data: &[u8]) -> Vec<u8> {
    let mut chunk = [&name[..], data].concat();
    let sum = chunk.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 * (crc & 1)))
    });
    chunk.extend((!sum).to_be_bytes());
    let length = u32::try_from(data.len()).unwrap().to_be_bytes();
    let header = 8 + 25;
    [&png[..header], &length, &chunk, &png[header..]].concat()
}

#[test]
fn a_png_says_how_its_light_is_stored() {
    let transfer = |png: &[u8]| decode(png).unwrap().properties.transfer;
    let gamma = |scaled: u32| with_chunk(DEEP, *b"gAMA", &scaled.to_be_bytes());
    assert_eq!(transfer(&gamma(45_455)), None);
    assert_eq!(transfer(&gamma(43_200)), None);
    assert_eq!(transfer(&gamma(100_000)), Some(Transfer::Linear));
    assert_eq!(transfer(&gamma(55_556)), Some(Transfer::Gamma(100_000.0 / 55_556.0)));
    assert_eq!(transfer(&with_chunk(&gamma(55_556), *b"sRGB", &[0])), None);
    let error = decode(&gamma(1)).unwrap_err();
    let message = std::error::Error::source(&error).unwrap().to_string();
    assert_eq!(message, "a gamma of 1 / 100000, expected 10000 to 1000000");
}

#[test]
fn png_is_in_its_place() {
    let mut original = image(2, vec![(Kind::Grg, bytes(&[7, 9]))]);
    original.properties.origin = [-70_000, 12];
    assert_eq!(there_and_back(&original, "png"), original);
    let mut indexed = image(2, vec![(Kind::Enc, bytes(&[0, 0]))]);
    indexed.lut = idf::Lut::new(vec![[5; 3]]);
    indexed.properties.origin = [3, -4];
    assert_eq!(there_and_back(&indexed, "png").properties.origin, [3, -4]);
    let place = |data: &[u8]| decode(&with_chunk(DEEP, *b"oFFs", data)).unwrap().properties.origin;
    assert_eq!(place(&[0, 0, 0, 5, 255, 255, 255, 255, 0]), [5, -1]);
    // In micrometres it is no place on a canvas of pixels.
    assert_eq!(place(&[0, 0, 0, 5, 0, 0, 0, 6, 1]), [0, 0]);
    let mut damaged = with_chunk(DEEP, *b"oFFs", &[0, 0, 0, 5, 0, 0, 0, 6, 0]);
    damaged[44] ^= 1;
    assert_eq!(decode(&damaged).unwrap().properties.origin, [0, 0]);
}

#[test]
fn exr_holds_measured_channels() {
    let float = |step: f32| Samples::F32(vec![step, -step, 1e9]);
    let planes = vec![
        (Kind::Grg, float(0.5)),
        (Kind::Dep, float(1.0)),
        (Kind::Nrx, float(2.0)),
        (Kind::Nry, float(3.0)),
        (Kind::Nrz, float(4.0)),
        (Kind::Obj, Samples::U16(vec![0, 3, 65_535])),
    ];
    let original = image(3, planes.clone());
    assert_eq!(there_and_back(&original, "exr"), original);
    // Measured channels alone, and numbers of objects as floating point.
    let mut alone = planes[1..5].to_vec();
    alone.push((Kind::Obj, float(7.0)));
    assert_eq!(there_and_back(&image(3, alone.clone()), "exr"), image(3, alone));
    // A picture is light and coverage.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.exr");
    write_image(&path, &original, &WriteOptions::default()).unwrap();
    let picture = ReadOptions { ask: Ask::Picture, ..ReadOptions::default() };
    assert_eq!(read_image(&path, &picture).unwrap().kinds(), [Kind::Grg]);
}

/// The kinds that a file with channels of these names has.
fn exr_kinds(names: &[&str]) -> Result<Vec<Kind>, ReadError> {
    use exr::prelude::{AnyChannel, AnyChannels, FlatSamples, Image, WritableImage};
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.exr");
    let channel = |&name: &&str| AnyChannel::new(name, FlatSamples::F32(vec![1.0; 2]));
    let channels = AnyChannels::sort(names.iter().map(channel).collect());
    Image::from_channels((2, 1), channels).write().to_file(&path).unwrap();
    read_image(&path, &ReadOptions::default()).map(|image| image.kinds())
}

#[test]
fn exr_channels_go_by_several_names() {
    let kinds = |names: &[&str]| exr_kinds(names).unwrap();
    assert_eq!(
        kinds(&["V.Combined.R", "V.Combined.G", "V.Combined.B", "V.Combined.A", "V.Depth.Z"]),
        [Kind::Red, Kind::Grn, Kind::Blu, Kind::Cvg, Kind::Dep]
    );
    let normal = [Kind::Nrx, Kind::Nry, Kind::Nrz];
    assert_eq!(kinds(&["V.Normal.X", "V.Normal.Y", "V.Normal.Z"]), normal);
    assert_eq!(kinds(&["N.x", "N.y", "N.z"]), normal);
    assert_eq!(kinds(&["Z", "A"]), [Kind::Cvg, Kind::Dep]);
    let error = exr_kinds(&["P.X", "P.Y", "P.Z", "foo"]).unwrap_err();
    let message = std::error::Error::source(&error).unwrap().to_string();
    let expected = "expected channels of R G B Y A Z N.X N.Y N.Z id, found P.X P.Y P.Z foo";
    assert_eq!(message, expected);
}

#[test]
fn damaged_lossy_exr_is_an_error_or_an_image() {
    use exr::prelude::*;
    let samples = FlatSamples::F16((0_u8..64).map(|at| f16::from_f32(at.into())).collect());
    let channels = AnyChannels::sort([AnyChannel::new("Y", samples)].into_iter().collect());
    let encoding = Encoding { compression: Compression::B44, ..Encoding::UNCOMPRESSED };
    let layer = Layer::new((8, 8), LayerAttributes::named("light"), encoding, channels);
    let mut file = std::io::Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut file).unwrap();
    let whole = file.into_inner();
    assert_eq!(decode(&whole).unwrap().size(), [8, 8]);
    let mut errors = 0;
    for at in 0..whole.len() {
        for byte in [0, 255, whole[at] ^ 16] {
            let mut damaged = whole.clone();
            damaged[at] = byte;
            errors += usize::from(decode(&damaged).is_err());
        }
    }
    assert!(errors > whole.len(), "{errors} errors in {} bytes", whole.len());
}

#[test]
fn a_photograph_stands_upright() {
    // An EXIF segment of one entry, the orientation: 6, the camera was turned to the left.
    let exif = [
        &b"\xff\xe1\x00\x22Exif\0\0MM\0*\0\0\0\x08\0\x01"[..],
        b"\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0",
    ]
    .concat();
    let mut file = Vec::new();
    let pixels: Vec<u8> = (0..16 * 8).map(|at| if at % 16 < 8 { 250 } else { 10 }).collect();
    ::image::codecs::jpeg::JpegEncoder::new_with_quality(&mut file, 100)
        .encode(&pixels, 16, 8, ::image::ExtendedColorType::L8)
        .unwrap();
    file.splice(2..2, exif);
    let read = decode(&file).unwrap();
    assert_eq!(read.size(), [8, 16]);
    let Some(Samples::U8(grey)) = read.plane(Kind::Grg) else { panic!("not 8 bits") };
    // The left side is on top.
    assert!(grey[..64].iter().all(|&value| value > 240), "{grey:?}");
    assert!(grey[64..].iter().all(|&value| value < 20), "{grey:?}");
}

#[test]
fn jpeg_is_read_and_not_written() {
    let mut file = Vec::new();
    let pixels = [200; 3 * 64];
    ::image::codecs::jpeg::JpegEncoder::new_with_quality(&mut file, 100)
        .encode(&pixels, 8, 8, ::image::ExtendedColorType::Rgb8)
        .unwrap();
    let read = decode(&file).unwrap();
    assert_eq!((read.size(), read.kinds()), ([8, 8], COLOR.to_vec()));
    let Some(Samples::U8(red)) = read.plane(Kind::Red) else { panic!("not 8 bits") };
    assert!(red.iter().all(|value| value.abs_diff(200) <= 1), "{red:?}");
    let error = write_image(Path::new("x.jpg"), &read, &WriteOptions::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "cannot write `x.jpg`: expected a name that ends in .idf .png .exr .ppm .pgm .pbm .pnm .pam \
         .gif"
    );
}

#[test]
fn a_small_file_does_not_take_much_memory() {
    let error = decode(BOMB).unwrap_err();
    let message = std::error::Error::source(&error).unwrap().to_string();
    assert!(message.starts_with("60000 x 30000 pixels of 1 channels"), "{message}");
    let error = decode(b"P5 60000 30000 255\n").unwrap_err();
    let message = std::error::Error::source(&error).unwrap().to_string();
    assert!(message.starts_with("60000 x 30000 pixels of 1 channels"), "{message}");
}

#[test]
fn unknown_formats_are_refused() {
    let error = decode(b"BM").unwrap_err().to_string();
    assert_eq!(error, "test: unknown format, expected PNG OpenEXR PNM PAM GIF JPEG TIFF WebP");
    assert_eq!(Format::of(Path::new("x.tga")), None);
    assert_eq!(Format::of(Path::new("a.b/x")), Some(Format::Idf));
    assert_eq!(Format::of(Path::new("X.PNG")), Some(Format::Png));
    let error = read_image(Path::new("x.tga"), &ReadOptions::default()).unwrap_err();
    let expected = "x.tga: unknown format, expected .idf .png .exr .ppm .pgm .pbm .pnm .pam .gif .jpg .jpeg .tif .tiff .webp";
    assert_eq!(error.to_string(), expected);
}

#[test]
fn channels_are_picked_from_any_format() {
    let options =
        |kinds: &[Kind]| ReadOptions { ask: Ask::Only(kinds.into()), ..ReadOptions::default() };
    let coverage = read_stream(Path::new("t"), INDEXED, &options(&[Kind::Cvg])).unwrap();
    assert_eq!(coverage.plane(Kind::Cvg), Some(&bytes(&[255, 128, 255, 128, 128, 255])));
    // Light alone is what is seen: 128/255 of linear blue is stored as 188.
    let light = read_stream(Path::new("t"), INDEXED, &options(&COLOR)).unwrap();
    assert_eq!(light.plane(Kind::Blu), Some(&bytes(&[0, 188, 0, 188, 188, 0])));
    let error = read_stream(Path::new("t"), INDEXED, &options(&[Kind::Grg])).unwrap_err();
    assert_eq!(error.to_string(), "t: no channel `grg`, found red grn blu cvg enc lut");
}

#[test]
fn indices_are_written_as_colors_and_coverage_alone_as_grey() {
    let mut indexed = image(2, vec![(Kind::Enc, bytes(&[1, 0]))]);
    indexed.lut = idf::Lut::new(vec![[1, 2, 3], [4, 5, 6]]);
    let back = there_and_back(&indexed, "png");
    assert_eq!(back.planes(), indexed.resolved().unwrap().planes());
    let coverage = image(2, vec![(Kind::Cvg, bytes(&[9, 200]))]);
    for ending in ["png", "pgm"] {
        let back = there_and_back(&coverage, ending);
        assert_eq!(back.plane(Kind::Grg), coverage.plane(Kind::Cvg), "{ending}");
    }
    let back = there_and_back(&coverage, "exr");
    assert_eq!(back.decoded(Kind::Grg).unwrap(), coverage.decoded(Kind::Cvg).unwrap());
}

#[test]
fn what_cannot_be_written_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    fs::write(&path, "old").unwrap();
    let measured = image(1, vec![(Kind::Dep, Samples::F32(vec![1.0]))]);
    let error = write_image(&path, &measured, &WriteOptions::default()).unwrap_err();
    assert!(error.to_string().ends_with("x.png`: no `grg`, found dep"), "{error}");
    let hole = image(1, vec![(Kind::Grg, Samples::F32(vec![f32::NAN]))]);
    let error = write_image(&path, &hole, &WriteOptions::default()).unwrap_err();
    assert!(error.to_string().ends_with("`grg` is not a number at column 0, row 0"), "{error}");
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}
