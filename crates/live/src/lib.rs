//! A page on this machine that shows a picture while it is made: a server on 127.0.0.1 and what it serves.
//!
//! This crate knows neither the compiler nor the renderer. Whoever makes pictures puts them on a [`Board`], which the
//! page shows at once, and is asked as a [`Model`] for what a person does there: looks from elsewhere, clicks a pixel.
//!
//! The page is at an address with a random token. Requests without it, and those that name another host, are not
//! answered, so that neither another page in the browser nor another user of the machine sees the scene.

mod board;
mod model;
mod request;
mod server;

pub use board::{Board, Problem, Seen, Shot, Shown, Stage};
pub use model::{Look, Model, Pick, Place};
pub use server::{Server, StartError};
