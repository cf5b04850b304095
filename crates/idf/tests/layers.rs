//! Layers of `OpenEXR` files, as the library that others use writes and reads them.
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::path::Path;

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, IntegerBounds, LayerAttributes, Vec2,
    WritableImage, f16, read_all_flat_layers_from_file,
};
use idf::exchange::{Layers, read_image, read_layered, write_layered};
use idf::plane::COLOR;
use idf::{Image, Kind, ReadOptions, Samples};

type Layer = exr::image::Layer<AnyChannels<FlatSamples>>;

/// A part of 2 x 2 pixels with channels of these names and samples.
fn part(name: &str, place: [i32; 2], channels: Vec<(&str, FlatSamples)>) -> Layer {
    let mut attributes = LayerAttributes::named(name);
    attributes.layer_position = Vec2(place[0], place[1]);
    let channels = channels.into_iter().map(|(name, samples)| AnyChannel::new(name, samples));
    let channels = AnyChannels::sort(channels.collect());
    Layer::new((2, 2), attributes, Encoding::UNCOMPRESSED, channels)
}

fn floats(first: f32) -> FlatSamples {
    FlatSamples::F32([0.0, 1.0, 2.0, 3.0].map(|step| first + step).to_vec())
}

fn written(path: &Path, parts: Vec<Layer>) {
    let bounds = IntegerBounds::new((-9, -9), (40, 40));
    let attributes = exr::meta::header::ImageAttributes::new(bounds);
    exr::image::Image::from_layers(attributes, parts).write().to_file(path).unwrap();
}

/// Part, channel, place and samples of all that is in a file, in order.
fn all(path: &Path) -> Vec<(String, String, [i32; 2], FlatSamples)> {
    let file = read_all_flat_layers_from_file(path).unwrap();
    let mut found = Vec::new();
    for layer in file.layer_data {
        let name = layer.attributes.layer_name.unwrap_or_default().to_string();
        let place = layer.attributes.layer_position;
        for AnyChannel { name: channel, sample_data, .. } in layer.channel_data.list {
            let place = [place.x(), place.y()];
            found.push((name.clone(), channel.to_string(), place, sample_data));
        }
    }
    found.sort_by(|a, b| (&a.0, &a.1).cmp(&(&b.0, &b.1)));
    found
}

/// Diffuse and specular light, depth, a mask of half floats, hashes, and a part elsewhere.
fn several(path: &Path) {
    let channels = vec![
        ("diffuse.R", floats(0.0)),
        ("diffuse.G", floats(10.0)),
        ("diffuse.B", floats(20.0)),
        ("specular.R", floats(30.0)),
        ("specular.G", floats(40.0)),
        ("specular.B", floats(50.0)),
        ("specular.A", FlatSamples::F32(vec![0.5; 4])),
        ("Z", floats(60.0)),
        ("mask", FlatSamples::F16([0.0, 0.25, 0.5, 1.0].map(f16::from_f32).to_vec())),
        ("hash", FlatSamples::U32(vec![0xffff_fffe, 1, 2, 3])),
    ];
    let elsewhere = vec![("R", floats(1.0)), ("G", floats(1.0)), ("B", floats(1.0))];
    written(path, vec![part("main", [3, 4], channels), part("far", [9, 9], elsewhere)]);
}

fn light(image: &Image, kind: Kind) -> Vec<f32> {
    let Some(Samples::F32(samples)) = image.plane(kind) else { panic!("{:?}", image.kinds()) };
    samples.clone()
}

fn opened(path: &Path, picture: Option<&str>) -> (Image, Layers) {
    read_layered(path, picture, &ReadOptions::default()).unwrap()
}

#[test]
fn every_channel_comes_back_under_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let [old, new] = ["old.exr", "new.exr"].map(|name| folder.path().join(name));
    several(&old);
    let (image, layers) = opened(&old, None);
    assert_eq!(image.kinds(), [&COLOR[..], &[Kind::Dep]].concat());
    assert_eq!(light(&image, Kind::Grn), [10.0, 11.0, 12.0, 13.0]);
    assert_eq!(light(&image, Kind::Dep), [60.0, 61.0, 62.0, 63.0], "beside the layers");
    assert_eq!(layers.words(), ["hash", "mask", "specular", "far"]);
    write_layered(&new, &image, &layers).unwrap();
    assert_eq!(all(&new), all(&old));
    // A reader of pictures alone sees the same picture.
    assert_eq!(read_image(&new, &ReadOptions::default()).unwrap(), image);
}

#[test]
fn a_layer_is_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.exr");
    several(&path);
    let (specular, others) = opened(&path, Some("specular"));
    let kinds = [&COLOR[..], &[Kind::Cvg, Kind::Dep]].concat();
    assert_eq!(specular.kinds(), kinds);
    assert_eq!(light(&specular, Kind::Blu), [50.0, 51.0, 52.0, 53.0]);
    assert_eq!(others.words(), ["diffuse", "hash", "mask", "far"]);
    let (mask, _) = opened(&path, Some("mask"));
    assert_eq!(light(&mask, Kind::Grg), [0.0, 0.25, 0.5, 1.0]);
    assert_eq!(mask.kinds(), [Kind::Grg, Kind::Dep]);
    let (green, _) = opened(&path, Some("diffuse.G"));
    assert_eq!(light(&green, Kind::Grg), [10.0, 11.0, 12.0, 13.0]);
    let (depth, _) = opened(&path, Some("Z"));
    assert_eq!(depth.kinds(), [Kind::Grg]);
    let (far, _) = opened(&path, Some("far"));
    assert_eq!((far.kinds(), far.properties.origin), (COLOR.to_vec(), [9, 9]));
    let error = read_layered(&path, Some("glow"), &ReadOptions::default()).unwrap_err();
    let source = std::error::Error::source(&error).unwrap().to_string();
    assert_eq!(
        source,
        "no layer or channel is called `glow`, found main diffuse hash mask specular far"
    );
}

#[test]
fn depth_in_a_part_of_its_own_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let [path, new] = ["x.exr", "new.exr"].map(|name| folder.path().join(name));
    let colors = ["R", "G", "B"].map(|name| (name, floats(0.0))).to_vec();
    let depth = |place| part("depth", place, vec![("Z", floats(7.0))]);
    written(&path, vec![part("beauty", [0, 0], colors.clone()), depth([0, 0])]);
    let (image, layers) = opened(&path, None);
    assert_eq!(image.kinds(), [&COLOR[..], &[Kind::Dep]].concat());
    assert!(layers.is_empty());
    write_layered(&new, &image, &layers).unwrap();
    assert_eq!(read_image(&new, &ReadOptions::default()).unwrap(), image);
    // Of pixels that lie elsewhere it is no depth of this picture.
    written(&path, vec![part("beauty", [0, 0], colors), depth([1, 0])]);
    let (image, layers) = opened(&path, None);
    assert_eq!((image.kinds(), layers.words()), (COLOR.to_vec(), vec!["depth".to_owned()]));
}

#[test]
fn names_may_be_the_usual_ones_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.exr");
    several(&path);
    let (image, mut layers) = opened(&path, Some("specular"));
    layers.retain(&["diffuse".into()]);
    layers.forget_names();
    write_layered(&path, &image, &layers).unwrap();
    let names: Vec<String> = all(&path).into_iter().map(|row| row.1).collect();
    let expected = ["A", "B", "G", "R", "Z", "diffuse.B", "diffuse.G", "diffuse.R"];
    assert_eq!(names, expected);
}
