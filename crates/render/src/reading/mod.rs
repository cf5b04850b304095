//! From the name of a scene to the scene.

pub(crate) mod command;
