//! Layers of EXR files.

use super::*;

/// Writes an `x.exr` of two layers, depth and a mask, 2 x 1.
fn layered(folder: &Path) {
    let float = |kind, values: [f32; 2]| Plane { kind, samples: Samples::F32(values.into()) };
    let planes = COLOR.map(|kind| float(kind, [0.25, 0.5]));
    let planes = planes.into_iter().chain([float(Kind::Dep, [7.0, 8.0])]).collect();
    let image = Image::new(2, 1, planes).unwrap();
    let mut layers = idf::exchange::Layers::default();
    for (name, first) in [("glow.R", 1.0), ("glow.G", 0.0), ("glow.B", 0.0), ("mask", 0.125)] {
        layers.add(name, &image, vec![first, first / 2.0]).unwrap();
    }
    idf::exchange::write_layered(&folder.join("x.exr"), &image, &layers).unwrap();
}

fn named(folder: &Path, name: &str, layer: &str) -> Image {
    let options = ReadOptions::default();
    idf::exchange::read_layered(&folder.join(name), Some(layer), &options).unwrap().0
}

#[test]
fn layers_of_standard_input_are_kept_or_named() {
    let folder = folder();
    let folder = folder.path();
    layered(folder);
    let copy = |arguments: &str| {
        let mut child = Command::new(env!("CARGO_BIN_EXE_icopy"))
            .args(arguments.split_whitespace())
            .current_dir(folder)
            .stdin(fs::File::open(folder.join("x.exr")).unwrap())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        assert!(child.wait().unwrap().success(), "{arguments}");
        std::io::read_to_string(child.stderr.take().unwrap()).unwrap()
    };
    assert_eq!(copy("- same.exr"), "");
    assert_eq!(named(folder, "same.exr", "glow"), named(folder, "x.exr", "glow"));
    let said = copy("- y");
    assert!(said.contains("left out as IDF has no place for it: glow mask"), "{said}");
    assert_eq!(copy("- glow --channels glow"), "");
    assert_eq!(open(folder, "glow").decoded(Kind::Red).unwrap(), [1.0, 0.5]);
}

#[test]
fn layers_of_exr_are_kept_or_named() {
    let folder = folder();
    let folder = folder.path();
    layered(folder);
    let copy = |arguments: &str| {
        let output = icopy(folder, arguments);
        assert!(output.status.success(), "{arguments}: {output:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    assert_eq!(copy("x.exr same.exr"), "");
    assert_eq!(named(folder, "same.exr", "glow"), named(folder, "x.exr", "glow"));
    assert_eq!(named(folder, "same.exr", "mask"), named(folder, "x.exr", "mask"));
    assert_eq!(open(folder, "same.exr"), open(folder, "x.exr"));
    assert_eq!(copy("x.exr turned.exr --flip x --crop 0,0,1,1"), "");
    let red = |image: &Image| image.decoded(Kind::Red).unwrap();
    assert_eq!(red(&named(folder, "turned.exr", "glow")), [1.0]);
    assert_eq!(copy("x.exr turned.exr --flip x"), "");
    assert_eq!(red(&named(folder, "turned.exr", "glow")), [0.5, 1.0]);
    let said = copy("x.exr y");
    assert!(
        said.contains("left out as IDF has no place for it: glow mask; icopy --channels NAME"),
        "{said}"
    );
    assert_eq!(open(folder, "y").kinds(), [&COLOR[..], &[Kind::Dep]].concat());
    assert_eq!(copy("x.exr glow --channels glow,dep"), "");
    assert_eq!(red(&open(folder, "glow")), [1.0, 0.5]);
    assert_eq!(open(folder, "glow").kinds(), [&COLOR[..], &[Kind::Dep]].concat());
    assert_eq!(copy("x.exr mask --channels dep=mask"), "");
    assert_eq!(open(folder, "mask").decoded(Kind::Dep).unwrap(), [0.125, 0.0625]);
    assert_eq!(copy("x.exr both.exr --channels rgb=glow,mask"), "");
    assert_eq!(red(&open(folder, "both.exr")), [1.0, 0.5]);
    assert_eq!(named(folder, "both.exr", "mask").kinds(), [Kind::Grg]);
    for (arguments, status, message) in [
        ("x.exr y.exr --channels gleam", 1, "no layer or channel is called `gleam`, found"),
        ("x.exr y.exr --channels glow,gleam", 1, "no layer or channel is called `gleam`"),
        ("x.exr y.png --channels glow,mask", 2, "only an .exr keeps several layers, found `mask`"),
        ("x.exr x.exr y.exr --channels glow", 2, "layers, as `glow`, are copied of one image"),
        ("x.exr y.exr --channels red=glow,grn=mask", 2, "expected the channels of one layer"),
    ] {
        let (found, said) = failure(folder, arguments);
        assert!(said.contains(message), "{arguments}: {said}");
        assert_eq!(found, Some(status), "{arguments}");
    }
}
