//! Command lines as a user types them, in a folder of their own with the programs of the suite.

#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::support::root;

/// Programs that `program.rs` is.
const PROGRAMS: &[&str] = &[
    "icomp", "icopy", "iencode", "ieq", "ierr", "ilut", "ishow", "istars", "portray", "prcomp",
    "prlsp",
];

/// One that starts itself again, and so has to have its own name where the system knows it.
const STARTS_ITSELF: &str = "prfarm";

/// A folder in which `scenes` and `scripts` are those of the repository.
pub(crate) struct Shell {
    folder: tempfile::TempDir,
}

impl Shell {
    /// An empty folder.
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for name in ["programs", "temporary"] {
            fs::create_dir(folder.path().join(name)).unwrap();
        }
        for program in PROGRAMS {
            let link = folder.path().join("programs").join(program);
            symlink(env!("CARGO_BIN_EXE_suite-program"), link).unwrap();
        }
        let program = folder.path().join("programs").join(STARTS_ITSELF);
        let whole = Path::new(env!("CARGO_BIN_EXE_suite-program"));
        // Not over the borders of file systems.
        fs::hard_link(whole, &program).or_else(|_| fs::copy(whole, &program).map(drop)).unwrap();
        for name in ["scenes", "scripts"] {
            symlink(root().join(name), folder.path().join(name)).unwrap();
        }
        Self { folder }
    }

    /// The folder that lines are run in.
    pub(crate) fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// The path of a file there.
    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.folder().join(name)
    }

    /// What comes of a line. Temporary files have to be gone after it.
    pub(crate) fn output(&self, line: &str) -> Output {
        let mut path = self.file("programs").into_os_string();
        path.push(":");
        path.push(std::env::var_os("PATH").unwrap_or_default());
        let output = Command::new("bash")
            .args(["-c", line])
            .current_dir(self.folder())
            .env("PATH", path)
            .env("TMPDIR", self.file("temporary"))
            .output()
            .unwrap();
        let left = fs::read_dir(self.file("temporary")).unwrap().count();
        assert_eq!(left, 0, "temporary files of {line}");
        output
    }

    /// Standard output of a line that has to succeed.
    pub(crate) fn run(&self, line: &str) -> String {
        let output = self.output(line);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{line}: {}\n{errors}", output.status);
        String::from_utf8_lossy(&output.stdout).into_owned()
    }
}

/// The lines of all `sh` blocks of a text.
pub(crate) fn commands(text: &str) -> Vec<&str> {
    let mut commands = Vec::new();
    let mut inside = false;
    for line in text.lines() {
        if let Some(language) = line.strip_prefix("```") {
            inside = language == "sh";
        } else if inside {
            commands.push(line);
        }
    }
    commands
}
