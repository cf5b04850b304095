//! What `portray` lets one choose about what is left out.

use std::fmt::Write;

use clap::Args;

use super::{LoadOptions, Omission};
use crate::World;

/// Options about what is left out.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct OmitArguments {
    /// Leave nothing out that the scene does not need; the picture is the same
    #[arg(long)]
    keep_all: bool,
    /// Say what is left out, and why
    #[arg(long)]
    explain: bool,
}

impl OmitArguments {
    /// How to load a scene for one picture.
    pub(crate) fn load_options(self, picture: (u32, u32), glossy: bool) -> LoadOptions {
        let keep_all = self.keep_all;
        LoadOptions { keep_all, picture: Some(picture), glossy, ..LoadOptions::default() }
    }

    /// Tells on standard error what was left out, if that is wanted.
    pub(crate) fn explain(self, world: &World) {
        if self.explain {
            idf::command::print(&table(world.omissions(), self.keep_all));
        }
    }
}

/// A line for each pass.
fn table(omissions: &[Omission], keep_all: bool) -> String {
    let mut text = String::from("pass           before    after\n");
    for Omission { name, what, reason, before, after } in omissions {
        writeln!(text, "{name:12} {before:>8} {after:>8}  {what}: {reason}").expect("a string");
    }
    if keep_all {
        text += "all of it is kept: --keep-all\n";
    }
    text
}
