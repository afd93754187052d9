//! The program as a process, and folders with files for it.

use crate::adapter::{gpu, root};
use serde_json::Value;
use std::fmt::{Display, Formatter};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

/// Settings that make a picture cheap.
pub(crate) const QUICK: &[&str] = &["--size", "24x16", "--set", "lights=32", "--set", "rsm.size=32"];

/// The exit and the output of a process.
#[derive(Debug)]
pub(crate) struct Done {
    /// The exit code; `None` where a signal ended it.
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Done {
    /// Runs a command to its end.
    pub(crate) fn of(command: &mut Command) -> Done {
        let output = command.output().unwrap();
        let [out, err] =
            [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
        Done { code: output.status.code(), out, err }
    }

    #[track_caller]
    pub(crate) fn success(self) -> Done {
        assert_eq!(self.code, Some(0), "{self}");
        self
    }

    /// Checks that it failed with this code, printed these words, and did not panic.
    #[track_caller]
    pub(crate) fn failure(self, code: i32, words: &[&str]) -> Done {
        assert_eq!(self.code, Some(code), "{self}");
        assert!(!self.err.contains("panicked"), "{self}");
        self.says(words)
    }

    /// Checks that it printed these words.
    #[track_caller]
    pub(crate) fn says(self, words: &[&str]) -> Done {
        let text = self.to_string();
        words.iter().for_each(|word| assert!(text.contains(word), "no `{word}` in: {text}"));
        self
    }

    /// Returns its standard output as JSON.
    #[track_caller]
    pub(crate) fn json(&self) -> Value {
        serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error}: {self}"))
    }
}

impl Display for Done {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}", self.out, self.err)
    }
}

/// Returns the command to run the program in a folder.
pub(crate) fn command(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lightloom"));
    command.current_dir(folder);
    command
}

/// Returns the command to run the program with the files of the tree, in another folder.
pub(crate) fn command_of_tree(folder: &Path) -> Command {
    let mut command = command(folder);
    command.arg("--root").arg(root());
    command
}

/// Runs the program in a folder.
pub(crate) fn run_in(folder: &Path, arguments: &[&str]) -> Done {
    Done::of(command(folder).args(arguments))
}

/// Runs the program in the tree.
pub(crate) fn lightloom(arguments: &[&str]) -> Done {
    run_in(&root(), arguments)
}

/// Renders a small picture of the Cornell box.
pub(crate) fn render(folder: &Path, pipeline: &str, file: &str, more: &[&str]) -> Done {
    run_in(folder, &[&["render", pipeline, "cornell-box", "-o", file], QUICK, more].concat())
}

/// A temporary folder.
pub(crate) struct Folder(tempfile::TempDir);

impl Folder {
    /// Creates a folder with these files.
    pub(crate) fn new(files: &[(&str, &str)]) -> Folder {
        let folder = Folder(tempfile::tempdir().unwrap());
        files.iter().for_each(|(name, text)| folder.write(name, text));
        folder
    }

    /// Creates a folder with these files, if there is an adapter.
    pub(crate) fn with_gpu(files: &[(&str, &str)]) -> Option<Folder> {
        gpu().map(|_| Folder::new(files))
    }

    pub(crate) fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Returns the path of a file as text.
    pub(crate) fn name(&self, name: &str) -> String {
        self.at(name).to_string_lossy().into_owned()
    }

    /// Writes a file as most editors do: beside the old one, renamed over it.
    pub(crate) fn write(&self, name: &str, text: &str) {
        let (path, temporary) = (self.at(name), self.at(&format!("{name}.new")));
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&temporary, text).unwrap();
        std::fs::rename(temporary, path).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.at(name)).unwrap()
    }
}

impl std::ops::Deref for Folder {
    type Target = Path;

    fn deref(&self) -> &Path {
        self.0.path()
    }
}

/// Waits until `ready`; panics where the process ends before.
#[track_caller]
pub(crate) fn wait_for(child: &mut std::process::Child, what: &str, ready: impl Fn() -> bool) {
    let start = Instant::now();
    while !ready() {
        assert!(child.try_wait().unwrap().is_none(), "it ended before {what}");
        assert!(start.elapsed() < Duration::from_secs(600), "no {what} in ten minutes");
        std::thread::sleep(Duration::from_millis(5));
    }
}
