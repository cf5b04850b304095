//! What the page shows, with those who wait for it to change.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use scene::Camera;
use serde_json::{Value, json};

/// A picture as the page draws it, at the size of the board: one of fewer pixels is drawn larger.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shot {
    /// Pixels from left to right.
    pub columns: u32,
    /// Pixels from top to bottom.
    pub rows: u32,
    /// Red, green, blue and 255 of each pixel, row by row from the top: display values.
    pub rgba: Vec<u8>,
}

/// How far a picture has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// There is none.
    #[default]
    Nothing,
    /// Fewer samples than pixels: one for each takes too long to wait for.
    Coarse,
    /// One sample a pixel, to be there at once.
    AtOnce,
    /// The picture that was asked for, which more samples make better.
    Asked,
    /// It stays as it is.
    Finished,
}

impl Stage {
    /// As the page names it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::Coarse => "coarse",
            Self::AtOnce => "at once",
            Self::Asked => "refining",
            Self::Finished => "finished",
        }
    }
}

/// Something that is wrong with the scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// There is no picture of it; else a warning.
    pub is_error: bool,
    /// The file, if a place in one is known.
    pub file: Option<String>,
    /// Counted from 1, with `file`.
    pub line: u32,
    /// Counted from 1 in characters, with `file`.
    pub column: u32,
    /// Message, source line, caret and hint, as lines of text.
    pub text: String,
}

/// All that the page shows beside the picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shown {
    /// The name of the scene's file.
    pub scene: String,
    /// Columns and rows that pictures are shown in.
    pub size: [u32; 2],
    /// What is wrong with the text as it is now; the picture is that of the last text that was right.
    pub problems: Vec<Problem>,
    /// Where the picture is seen from.
    pub camera: Option<Camera>,
    /// The same as a statement of the language.
    pub statement: String,
    /// How far the picture is.
    pub stage: Stage,
    /// How many texts without errors there were until the one that the picture is of.
    pub revision: u64,
    /// Names and values of the statistics.
    pub figures: Vec<(String, String)>,
    /// What was left out: the pass, what it looks at and why it may go, with how many there were and are.
    pub omissions: Vec<(String, String, [u64; 2])>,
}

/// What the page shows. Everyone who waits sees the newest state, not each.
#[derive(Debug, Default)]
pub struct Board {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    /// How often anything changed.
    version: u64,
    /// How often the picture did.
    picture: u64,
    shown: Shown,
    shot: Option<Arc<Shot>>,
}

/// A state of the board.
#[derive(Clone, Debug)]
pub struct Seen {
    /// Grows with each change.
    pub version: u64,
    /// Grows with each picture; 0 before the first.
    pub picture: u64,
    /// What stands beside it.
    pub shown: Shown,
    /// The picture, if there is one.
    pub shot: Option<Arc<Shot>>,
}

impl Board {
    /// Changes what stands beside the picture.
    pub fn say(&self, change: impl FnOnce(&mut Shown)) {
        self.change(|state| change(&mut state.shown));
    }

    /// Shows a picture, with what is to stand beside it.
    pub fn show(&self, shot: Shot, change: impl FnOnce(&mut Shown)) {
        self.change(|state| {
            state.shot = Some(Arc::new(shot));
            state.picture += 1;
            change(&mut state.shown);
        });
    }

    fn change(&self, change: impl FnOnce(&mut State)) {
        let mut state = self.lock();
        change(&mut state);
        state.version += 1;
        drop(state);
        self.changed.notify_all();
    }

    /// The state as it is.
    #[must_use]
    pub fn now(&self) -> Seen {
        self.lock().seen()
    }

    /// The first state that is not `version`, or nothing after some time without one.
    #[must_use]
    pub fn after(&self, version: u64, patience: Duration) -> Option<Seen> {
        let state = self.lock();
        let same = |state: &mut State| state.version == version;
        let (state, late) = self
            .changed
            .wait_timeout_while(state, patience, same)
            .unwrap_or_else(PoisonError::into_inner);
        (!late.timed_out()).then(|| state.seen())
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // What is there is whole: it is only ever replaced.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn seen(&self) -> Seen {
        Seen {
            version: self.version,
            picture: self.picture,
            shown: self.shown.clone(),
            shot: self.shot.clone(),
        }
    }
}

impl Seen {
    /// As the page reads it, without the pixels.
    pub(crate) fn json(&self) -> Value {
        let shown = &self.shown;
        let problem = |problem: &Problem| {
            let Problem { is_error, file, line, column, text } = problem;
            json!({ "error": is_error, "file": file, "line": line, "column": column, "text": text })
        };
        let omission = |(name, why, [before, after]): &(String, String, [u64; 2])| json!({ "name": name, "why": why, "before": before, "after": after });
        json!({
            "version": self.version,
            "picture": self.picture,
            "scene": shown.scene,
            "size": shown.size,
            "stage": shown.stage.word(),
            "revision": shown.revision,
            "problems": shown.problems.iter().map(problem).collect::<Vec<_>>(),
            "camera": shown.camera.as_ref().map(camera),
            "statement": shown.statement,
            "figures": shown.figures,
            "omissions": shown.omissions.iter().map(omission).collect::<Vec<_>>(),
        })
    }
}

/// A camera as the page reads it.
fn camera(camera: &Camera) -> Value {
    json!({
        "position": camera.position.to_array(),
        "target": camera.target.to_array(),
        "focal_length": camera.focal_length_mm,
        "parallel": camera.parallel,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn those_who_wait_see_the_newest() {
        let board = Board::default();
        assert!(board.after(0, Duration::ZERO).is_none(), "nothing has changed");
        board.say(|shown| shown.scene = "a".into());
        board.say(|shown| shown.scene = "b".into());
        let seen = board.after(0, Duration::ZERO).unwrap();
        assert_eq!((seen.version, seen.picture, seen.shown.scene.as_str()), (2, 0, "b"));
        let shot = Shot { columns: 1, rows: 1, rgba: vec![1, 2, 3, 255] };
        board.show(shot.clone(), |shown| shown.stage = Stage::AtOnce);
        let seen = board.after(2, Duration::ZERO).unwrap();
        assert_eq!((seen.picture, seen.shot.as_deref()), (1, Some(&shot)));
        assert_eq!(seen.json()["stage"], "at once");
        assert!(board.after(3, Duration::ZERO).is_none(), "it is the newest");
    }
}
