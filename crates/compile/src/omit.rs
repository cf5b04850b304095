//! What a compiled scene does not need: definitions that no object comes to.
//!
//! A pass takes away whole rows of a table that nothing names any more, and numbers the rest anew in the same order. Objects
//! and all they are made of stay as they are, so the picture is the same to the byte. What a picture of a certain size
//! does not need is the renderer's affair.

use std::fmt::Write;

use scene::{Attributes, Node, Scene, Solid};

/// What one pass did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Omission {
    /// The pass, and what it looks at.
    pub name: &'static str,
    /// Why they may go.
    pub reason: &'static str,
    /// How many there are.
    pub before: usize,
    /// How many are left.
    pub after: usize,
}

/// A row of the table.
struct Pass {
    name: &'static str,
    reason: &'static str,
    /// Which rows are needed, in a scene that the passes before went over.
    needed: fn(&Scene) -> Vec<bool>,
    /// Takes the others away.
    keep: fn(&mut Scene, &[bool]),
}

/// All passes, in an order in which each leaves the next more to do.
static PASSES: [Pass; 3] = [
    Pass {
        name: "classes",
        reason: "no object is made of them",
        needed: needed_classes,
        keep: keep_classes,
    },
    Pass {
        name: "attributes",
        reason: "they are said of no solid that is left",
        needed: needed_attributes,
        keep: keep_attributes,
    },
    Pass {
        name: "pictures",
        reason: "no paint that is left shows them",
        needed: needed_images,
        keep: keep_images,
    },
];

/// Leaves out what no object of the scene comes to, and says what that was, by pass.
pub fn leave_out(scene: &mut Scene) -> Vec<Omission> {
    PASSES.iter().map(|pass| pass.run(scene)).collect()
}

impl Pass {
    fn run(&self, scene: &mut Scene) -> Omission {
        let needed = (self.needed)(scene);
        let after = needed.iter().filter(|&&needed| needed).count();
        if after < needed.len() {
            (self.keep)(scene, &needed);
        }
        Omission { name: self.name, reason: self.reason, before: needed.len(), after }
    }
}

/// A line for each pass.
pub fn table(omissions: &[Omission]) -> String {
    let mut text = String::from("pass           before    after\n");
    for Omission { name, reason, before, after } in omissions {
        writeln!(text, "{name:12} {before:>8} {after:>8}  {reason}").expect("a string");
    }
    text
}

/// The numbers of what is kept when it is counted again.
fn numbers(needed: &[bool]) -> Vec<u32> {
    let mut next = 0;
    let number = |&needed: &bool| {
        let number = next;
        next += u32::from(needed);
        number
    };
    needed.iter().map(number).collect()
}

fn retain<T>(rows: &mut Vec<T>, needed: &[bool]) {
    let mut needed = needed.iter();
    rows.retain(|_| needed.next() == Some(&true));
}

/// All solids of the scene.
fn solids(scene: &Scene) -> impl Iterator<Item = &Solid> {
    let classes = scene.classes.iter().map(|class| &class.solid);
    classes.chain(scene.objects.iter().map(|object| &object.solid))
}

fn solids_mut(scene: &mut Scene) -> impl Iterator<Item = &mut Solid> {
    let classes = scene.classes.iter_mut().map(|class| &mut class.solid);
    classes.chain(scene.objects.iter_mut().map(|object| &mut object.solid))
}

fn needed_classes(scene: &Scene) -> Vec<bool> {
    let mut needed = vec![false; scene.classes.len()];
    let note = |needed: &mut Vec<bool>, solid: &Solid| {
        for node in &solid.nodes {
            if let Node::Instance { class, .. } = node {
                needed[class.0 as usize] = true;
            }
        }
    };
    for object in &scene.objects {
        note(&mut needed, &object.solid);
    }
    // A class refers only to earlier ones.
    for (number, class) in scene.classes.iter().enumerate().rev() {
        if needed[number] {
            note(&mut needed, &class.solid);
        }
    }
    needed
}

fn keep_classes(scene: &mut Scene, needed: &[bool]) {
    retain(&mut scene.classes, needed);
    let numbers = numbers(needed);
    for solid in solids_mut(scene) {
        for node in &mut solid.nodes {
            if let Node::Instance { class, .. } = node {
                class.0 = numbers[class.0 as usize];
            }
        }
    }
}

fn needed_attributes(scene: &Scene) -> Vec<bool> {
    let mut needed = vec![false; scene.attributes.len()];
    // The first is what is said where nothing is.
    needed[0] = true;
    for frame in solids(scene).flat_map(|solid| &solid.frames) {
        needed[frame.attributes.0 as usize] = true;
    }
    needed
}

fn keep_attributes(scene: &mut Scene, needed: &[bool]) {
    retain(&mut scene.attributes, needed);
    let numbers = numbers(needed);
    for frame in solids_mut(scene).flat_map(|solid| &mut solid.frames) {
        frame.attributes.0 = numbers[frame.attributes.0 as usize];
    }
}

fn needed_images(scene: &Scene) -> Vec<bool> {
    let mut needed = vec![false; scene.images.len()];
    for Attributes { paint, .. } in &scene.attributes {
        for image in paint.iter().filter_map(|coat| coat.texture.image()) {
            needed[image.0 as usize] = true;
        }
    }
    needed
}

fn keep_images(scene: &mut Scene, needed: &[bool]) {
    retain(&mut scene.images, needed);
    let numbers = numbers(needed);
    for Attributes { paint, .. } in &mut scene.attributes {
        for coat in paint {
            coat.texture.renumber_image(|image| scene::ImageId(numbers[image.0 as usize]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile_text;

    fn scene(text: &str) -> Scene {
        compile_text(text).scene.expect("no errors")
    }

    fn counts(scene: &mut Scene) -> Vec<[usize; 2]> {
        leave_out(scene).iter().map(|pass| [pass.before, pass.after]).collect()
    }

    const NEEDED: &str = "class inner is red sphere
        class outer is inner + green block
        object is blue outer * outer at (1, 0, 0)";

    #[test]
    fn what_nothing_comes_to_goes() {
        let mut found = scene(&format!(
            "class lone is yellow cone
             class loner is lone + orange cylinder + paraboloid
             {NEEDED}
             class late is purple outer"
        ));
        let expected = scene(NEEDED);
        assert!(found != expected, "there is more");
        let said = counts(&mut found);
        assert_eq!(said[0], [5, 2], "classes");
        assert_eq!(said[1][1], expected.attributes.len(), "attributes");
        assert!(said[1][0] > said[1][1], "{said:?}");
        // Whatever order the sets were made in, solids stand for the same.
        assert_eq!(found.classes.len(), expected.classes.len());
        let looks = |scene: &Scene| -> Vec<Attributes> {
            let frames = solids(scene).flat_map(|solid| &solid.frames);
            frames.map(|frame| scene.attributes[frame.attributes.0 as usize].clone()).collect()
        };
        assert_eq!(looks(&found), looks(&expected));
        let nodes = |scene: &Scene| -> Vec<Node> {
            solids(scene).flat_map(|solid| &solid.nodes).copied().collect()
        };
        assert_eq!(nodes(&found), nodes(&expected));
    }

    #[test]
    fn what_is_needed_stays() {
        let mut found = scene(NEEDED);
        let before = found.clone();
        assert!(counts(&mut found).iter().all(|[before, after]| before == after));
        assert_eq!(found, before);
    }

    #[test]
    fn without_objects_all_goes_but_the_empty_set() {
        let mut found = scene("class lone is yellow cone  camera at (0, 0, 5)");
        assert_eq!(counts(&mut found), [[1, 0], [2, 1], [0, 0]]);
        assert_eq!(found.attributes, [Attributes::default()]);
    }
}
