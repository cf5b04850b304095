//! What the page asks of whoever makes its pictures.

use scene::Camera;

use crate::board::Shot;

/// Makes the pictures of a page, and knows what is in them.
pub trait Model: Send + Sync {
    /// The last good scene from a camera, with one sample a pixel, or with fewer where they would take too long; what is on
    /// the way is given up. Called from several threads.
    ///
    /// # Errors
    ///
    /// Why there is no such picture, for the person at the page.
    fn look(&self, camera: &Camera) -> Result<Look, String>;

    /// Makes the picture from a camera, or from the scene's own, as good as it gets, and puts it on the board.
    fn settle(&self, camera: Option<Camera>);

    /// What is seen in a pixel of the newest picture; nothing where it shows the background, or outside of it.
    fn pick(&self, column: u32, row: u32) -> Option<Pick>;
}

/// A picture from somewhere.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Look {
    /// The picture.
    pub shot: Shot,
    /// The camera as a statement of the language, in ASCII.
    pub statement: String,
    /// What it took to make, in microseconds.
    pub microseconds: u64,
}

/// The first surface behind the middle of a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Pick {
    /// Counted from 1 in the order of the scene.
    pub object: usize,
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Where it is written, if the scene is a text.
    pub place: Option<Place>,
    /// From the eye along the ray, in scene units.
    pub depth: f64,
    /// Unit normal in the scene, toward the eye.
    pub normal: [f64; 3],
}

/// A place in a source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: String,
    /// Counted from 1.
    pub line: u32,
    /// Counted from 1 in characters.
    pub column: u32,
    /// The line.
    pub text: String,
}
