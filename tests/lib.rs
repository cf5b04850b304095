//! Bodies of the fuzz targets, one for each reader of foreign bytes. Only tests live in this package.
//!
//! `cargo test` runs them over a corpus with seeded mutations; `tests/fuzz` hands them to libFuzzer.

use std::path::Path;

use compile::SourceMap;

/// A scene description compiles, or is refused with a place; what compiles can be written, read back and loaded.
///
/// # Panics
///
/// When that does not hold.
pub fn sdl(bytes: &[u8]) {
    // Mutations turn small numbers of turns into great ones; those are tried elsewhere.
    let options = compile::Options { max_primitives: 10_000, ..compile::Options::default() };
    let compiled = compile::compile_text_with(bytes, &options);
    match &compiled.scene {
        Some(scene) => {
            let mut text = Vec::new();
            scene::format::write(scene, &mut text).expect("a compiled scene can be written");
            assert_eq!(&scene::format::read(&text).expect("and read"), scene, "the same scene");
            load(scene);
        }
        None => assert!(!compiled.error_report().is_empty(), "a refusal says why"),
    }
}

/// A scene description is laid out to one that means the same and stays as it is, or is refused for what is no token;
/// its names are found, and what is said of it can be printed, whatever it is.
///
/// # Panics
///
/// When that does not hold.
pub fn layout(bytes: &[u8]) {
    let options = compile::Options { max_primitives: 1000, ..compile::Options::default() };
    let compiled = compile::compile_text_with(bytes, &options);
    let read = |text: &[u8]| SourceMap::from_reader(Path::new("a.sdl"), text);
    let Ok(mut sources) = read(bytes) else { return assert!(compiled.scene.is_none(), "unread") };
    match compile::layout::laid_out(&sources) {
        Ok(once) => {
            let again = read(once.as_bytes()).expect("what is laid out can be read");
            assert_eq!(compile::layout::laid_out(&again).as_ref(), Ok(&once), "twice is once");
            let same = compile::compile_text_with(&once, &options).scene;
            assert_eq!(same, compiled.scene, "the same scene");
        }
        Err(_) => assert!(compiled.scene.is_none(), "what is no token is no scene"),
    }
    let (_, diagnostics) = compile::index(&mut sources);
    for diagnostic in &diagnostics {
        assert!(!diagnostic.human(&sources).is_empty(), "in words");
        assert!(!diagnostic.json(&sources).contains('\n'), "an object on one line");
    }
}

/// A compiled scene is read, or refused; what is read is written to the same scene and can be loaded.
///
/// # Panics
///
/// When that does not hold.
pub fn compiled_scene(bytes: &[u8]) {
    if let Ok(scene) = scene::format::read(bytes) {
        let mut text = Vec::new();
        scene::format::write(&scene, &mut text).expect("what was read can be written");
        assert_eq!(scene::format::read(&text).expect("and read"), scene, "the same scene");
        load(&scene);
    }
}

/// A tiny picture of a scene, if it has a camera and is not large.
fn load(scene: &scene::Scene) {
    let Ok(world) = render::World::load(scene) else { return };
    if world.leaf_count() > 1000 {
        return;
    }
    let options =
        render::Options { columns: 4, rows: 4, depth: 4, threads: 1, ..render::Options::default() };
    let picture = render::render(&world, &options, &|_| ()).expect("one thread can be had");
    for pixel in picture.film.pixels() {
        assert!(pixel.color.iter().all(|channel| channel.is_finite()), "{pixel:?}");
        assert!((0.0..=1.0).contains(&pixel.coverage), "{pixel:?}");
    }
}

/// An image description is parsed, or refused; what is parsed prints and parses to the same.
///
/// # Panics
///
/// When that does not hold.
pub fn description(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Ok(description) = idf::description::parse(text) {
        let printed = description.to_string();
        let again = idf::description::parse(&printed).expect("what is printed can be parsed");
        assert_eq!(again.to_string(), printed, "printing is stable");
    }
}

/// A run-length coded row gives a row of its length, or is refused; a row codes to what decodes to it.
///
/// # Panics
///
/// When that does not hold.
pub fn rle(bytes: &[u8]) {
    let Some((&length, coded)) = bytes.split_first() else { return };
    let mut row = vec![0; usize::from(length) + 1];
    // Whether it is accepted depends on the bytes; that it returns is what is tried here.
    let accepted = idf::rle::decode_row(coded, &mut row).is_ok();
    if !coded.is_empty() {
        let mut again = Vec::new();
        idf::rle::encode_row(coded, &mut again);
        let mut decoded = vec![0; coded.len()];
        idf::rle::decode_row(&again, &mut decoded).expect("what is coded can be decoded");
        assert_eq!(decoded, coded, "the same row; {accepted}");
    }
}

/// Bands of rows are what the whole image has at their place, or both are refused.
///
/// The first bytes say columns, rows, depth and encoding, and where bands end; the rest is the file
/// of one channel, for `raw` cut or filled up to its length.
///
/// # Panics
///
/// When that does not hold, or the system gives no temporary folder.
pub fn bands(bytes: &[u8]) {
    let Some((&[columns, rows, form, height], data)) = bytes.split_first_chunk() else { return };
    let [columns, rows] = [columns, rows].map(|length| u32::from(length % 64) + 1);
    let (depth, width) = [("8", 1), ("16", 2), ("32f", 4)][usize::from(form >> 1) % 3];
    let encoding = if form & 1 == 0 { "raw" } else { "rle" };
    let mut data = data.to_vec();
    if encoding == "raw" {
        data.resize(columns as usize * rows as usize * width, 7);
    }
    let folder = tempfile::tempdir().expect("a temporary folder can be had");
    let path = folder.path().join("x.idf");
    let text =
        format!("idf 1\nsize {columns} {rows}\ngrg x.grg {columns} {rows} {depth} {encoding}\n");
    let written = std::fs::write(&path, text);
    written.and_then(|()| std::fs::write(path.with_extension("grg"), data)).expect("it is ours");
    let options = idf::ReadOptions::default();
    let whole = idf::read(&path, &options);
    let reader = idf::rows::Reader::open(&path, &options);
    let Ok(mut reader) = reader else {
        assert!(whole.is_err(), "the image was read, and not opened for bands");
        return;
    };
    let height = u32::from(height % 64) + 1;
    let mut together: Vec<u32> = Vec::new();
    let mut is_damaged = false;
    for start in (0..rows).step_by(height as usize) {
        match reader.band(start..rows.min(start + height)) {
            Ok(band) => together.extend(bits(&band)),
            Err(error) => {
                is_damaged = true;
                assert!(!error.to_string().is_empty(), "a message");
            }
        }
    }
    match whole {
        Ok(image) => assert!(!is_damaged && bits(&image) == together, "the same samples"),
        Err(_) => assert!(is_damaged, "all bands were read, and not the whole"),
    }
}

/// The bits of the samples of grey.
fn bits(image: &idf::Image) -> Vec<u32> {
    match image.plane(idf::Kind::Grg) {
        Some(idf::Samples::U8(samples)) => samples.iter().map(|&s| s.into()).collect(),
        Some(idf::Samples::U16(samples)) => samples.iter().map(|&s| s.into()).collect(),
        Some(idf::Samples::F32(samples)) => samples.iter().map(|s| s.to_bits()).collect(),
        None => Vec::new(),
    }
}
