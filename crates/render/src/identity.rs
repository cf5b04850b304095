//! A number for all that a picture is made of: the same for the same picture, another for another scene or option.

use std::collections::BTreeMap;
use std::path::Path;

use idf::part::Sum;
use idf::{Image, Kind};
use scene::Scene;

use crate::options::{Accel, Options};
use crate::picture::Form;
use crate::world::LoadOptions;

/// Finds identities; remembers the pictures that it has looked into, by their paths.
#[derive(Debug, Default)]
pub struct Identities {
    pictures: BTreeMap<String, u128>,
}

impl Identities {
    /// The identity of a picture: of this version of the program, the scene as it is compiled, what is in the pictures that
    /// it shows, and the options that can be seen in a picture. Names of files are not in it, nor what only changes how
    /// long it takes.
    pub fn of(
        &mut self,
        scene: &Scene,
        options: &Options,
        load: &LoadOptions,
        form: Form,
        kinds: Option<&[Kind]>,
    ) -> u128 {
        let mut sum = Sum::default();
        sum.add(env!("CARGO_PKG_VERSION").as_bytes());
        let seen = Options { accel: Accel::default(), threads: 0, ..*options };
        let loaded = LoadOptions { keep_all: false, keep_pass: None, ..*load };
        sum.add(format!("{seen:?} {loaded:?} {form:?} {kinds:?}").as_bytes());
        let mut scene = scene.clone();
        for image in &mut scene.images {
            let content = match self.pictures.get(&image.path) {
                Some(&content) => content,
                None => {
                    let content = content(Path::new(&image.path));
                    self.pictures.insert(image.path.clone(), content);
                    content
                }
            };
            image.path = format!("{content:032x}");
        }
        let mut text = Vec::new();
        // Memory takes all that is written.
        scene::format::write(&scene, &mut text).ok();
        sum.add(&text);
        sum.value()
    }
}

/// What is in a picture; the same for all that cannot be read: a scene that needs one of them cannot be rendered.
fn content(path: &Path) -> u128 {
    idf::exchange::read_picture(path).map_or(0, |image| image_content(&image))
}

fn image_content(image: &Image) -> u128 {
    let mut sum = Sum::default();
    let properties = &image.properties;
    sum.add(format!("{:?} {:?}", image.size(), image.lut).as_bytes());
    sum.add(format!("{:?} {:?}", properties.transfer, properties.matte).as_bytes());
    for plane in image.planes() {
        sum.add(plane.kind.word().as_bytes());
        sum.add_samples(&plane.samples);
    }
    sum.value()
}
