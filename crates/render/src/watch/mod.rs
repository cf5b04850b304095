//! A scene that is rendered again whenever its text changes, and gets better until then.
//!
//! `command` reads the scene and looks after its files, `session` makes pictures of it, and the page (`live`) or the terminal
//! shows them. A change stops what is being rendered at once.

pub(crate) mod command;
mod files;
mod session;
mod terminal;
