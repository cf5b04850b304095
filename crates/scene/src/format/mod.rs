//! The compiled scene: versioned text, one fact a line (`docs/compiled-scene.md` is its grammar).
//!
//! Numbers are written as the shortest decimal that reads back to the same bits, so a scene that is written and read
//! is the same scene, and written again the same bytes. What follows from the rest and is in the file for other readers
//! (boxes, rectangles), this one works out again, and refuses a file that says anything else.
//!
//! ```
//! use scene::{Placement, Primitive, Scene, Solid, format};
//!
//! let mut scene = Scene::default();
//! scene.add_object(None, Solid::primitive(Primitive::Sphere, Placement::default()));
//! let mut text = Vec::new();
//! format::write(&scene, &mut text)?;
//! assert!(text.starts_with(b"portray scene 2\n"));
//! assert_eq!(format::read(&text)?, scene);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod check;
mod decimal;
mod derived;
mod error;
mod lines;
mod paint;
mod read;
mod write;

pub use error::ReadError;
pub use paint::write_paint;
pub use read::read;
pub use write::{write, write_surroundings};

/// The number in the first line; it rises with every change of the grammar or of what a line means.
pub const VERSION: u32 = 2;

#[cfg(test)]
mod tests {
    use crate::primitive::Primitive;

    /// Words that begin a line where a primitive may stand, too.
    const RESERVED: &[&str] =
        &["box", "complement", "frame", "instance", "intersection", "rectangle", "union"];

    #[test]
    fn no_primitive_is_called_like_another_line() {
        for kind in Primitive::ALL {
            assert!(!RESERVED.contains(&kind.keywords()[0]), "{kind:?}");
        }
    }
}
