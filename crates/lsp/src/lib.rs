//! The scene description language in editors.
//!
//! A server of the language server protocol: texts come in, and after every change what the compiler has to say goes out.
//! Questions about a place are answered from the compiler's index of names and its table of words.
//!
//! ```
//! use lsp::position::{Encoding, Lines};
//! use lsp_types::Position;
//!
//! // A column counts units of UTF-16: the wine glass takes two.
//! let lines = Lines::new("fog 2\n/* 🍷 */ fog 3", Encoding::Utf16);
//! assert_eq!(lines.position(17), Position::new(1, 9));
//! assert_eq!(lines.offset(Position::new(1, 9)), 17);
//! ```

#[cfg(feature = "command")]
pub mod command;
mod completion;
mod hover;
mod meaning;
mod names;
mod place;
pub mod position;
mod scene_text;
pub mod server;
pub mod transport;
mod uri;
