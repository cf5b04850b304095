//! What a scene is: solids, optics, lights, a camera, and the compiled scene file.
//!
//! The compiler makes a [`Scene`], the tracer reads one; neither knows the other. The data is flat: classes and
//! objects hold their expression as one post-order array ([`Solid`]), attributes are interned, and nothing here is
//! boxed and recursive, so a deep scene is dropped as cheaply as a wide one.
//!
//! Space is right-handed with y up; lengths are scene units. Rotations are degrees until their exact sine and cosine
//! are taken. Colours are linear RGB; conversion from display values happens in the compiler.
//!
//! ```
//! use scene::{Primitive, Scene, Solid, Placement};
//!
//! let mut scene = Scene::default();
//! scene.add_object(None, Solid::primitive(Primitive::Sphere, Placement::default()));
//! let bounds = scene.bounds().objects[0];
//! assert!(bounds.contains(glam::DVec3::new(0.0, 1.0, 0.0)));
//! ```

pub mod bound;
pub mod camera;
pub mod class;
pub mod color;
pub mod csg;
pub mod form;
pub mod format;
pub mod lanes;
pub mod light;
pub mod optics;
pub mod primitive;
pub mod ray;
pub mod rectangle;
pub mod texture;
pub mod transform;

pub use camera::{Camera, Lens, Sight, View};
pub use class::{Attributes, AttributesId, Class, Object, Scene};
pub use color::Rgb;
pub use csg::{ClassId, FormId, Frame, FrameId, Node, Solid};
pub use form::Form;
pub use lanes::{Eight, EightMask, Four, FourMask, Lanes};
pub use light::{Light, LightKind};
pub use optics::{ImageFile, ImageId, Index, Optics, Paint, Transparency};
pub use primitive::{Face, Primitive};
pub use ray::{Bounds, FacedSpan, Ray};
pub use transform::{Map, Placement};
