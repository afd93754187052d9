//! The program with its window open, a copy of the tree that it watches, and a user's account.

use super::{DIM, PATIENCE, SIZE, SMALL, STILL};
use crate::adapter::{gpu, root};
use metrics::{Image, PIXELS_PER_DEGREE, Pair};
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tempfile::TempDir;
use window_test::{Display, Window};

/// Windows are opened one at a time: each renders on all cores.
pub(super) fn turn() -> Option<MutexGuard<'static, ()>> {
    static TURN: Mutex<()> = Mutex::new(());
    gpu()?;
    Some(TURN.lock().unwrap_or_else(PoisonError::into_inner))
}

/// A copy of the tree's text files, with two pipelines of its own.
pub(super) struct Tree(TempDir);

impl Tree {
    pub(super) fn new() -> Tree {
        let tree = Tree(tempfile::tempdir().unwrap());
        for name in ["crates/interfaces", "passes", "pipelines", "scenes", "shaders"] {
            copy(&root().join(name), &tree.at(name));
        }
        std::fs::write(tree.at("pipelines/small.ron"), SMALL).unwrap();
        std::fs::write(tree.at("pipelines/dim.ron"), DIM).unwrap();
        tree
    }

    pub(super) fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(super) fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.at(name)).unwrap()
    }

    /// Saves as most editors do: a new file beside the old, renamed over it.
    pub(super) fn save(&self, name: &str, text: &str) {
        self.save_all(&[(name, text)]);
    }

    /// Saves several files at once: all are written before the first is renamed, so that nothing slow is in between.
    pub(super) fn save_all(&self, files: &[(&str, &str)]) {
        let temporary = |name: &str| self.at(&format!("{name}.new"));
        files.iter().for_each(|(name, text)| std::fs::write(temporary(name), text).unwrap());
        files.iter().for_each(|(name, _)| std::fs::rename(temporary(name), self.at(name)).unwrap());
    }

    /// Writes files as git checks out a branch: while it holds the lock of its index, however long that takes.
    pub(super) fn check_out(&self, files: &[(PathBuf, String)]) {
        let lock = self.at(".git/index.lock");
        std::fs::create_dir_all(self.at(".git")).unwrap();
        std::fs::write(&lock, "").unwrap();
        files.iter().for_each(|(path, text)| std::fs::write(path, text).unwrap());
        std::fs::remove_file(lock).unwrap();
    }

    /// Saves as others do.
    pub(super) fn save_in_place(&self, name: &str, text: &str) {
        std::fs::write(self.at(name), text).unwrap();
    }

    /// Every shader.
    pub(super) fn shaders(&self) -> Vec<PathBuf> {
        let (mut found, mut left) = (Vec::new(), vec![self.0.path().to_owned()]);
        while let Some(folder) = left.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    left.push(path);
                } else if path.extension().is_some_and(|ending| ending == "wgsl") {
                    found.push(path);
                }
            }
        }
        found
    }

    pub(super) fn lightloom(&self, arguments: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lightloom"));
        command.args(arguments).arg("--root").arg(self.0.path()).current_dir(self.0.path());
        command.output().unwrap()
    }

    /// Returns the picture that `lightloom render` makes for a screen.
    pub(super) fn rendered(&self, pipeline: &str, scene: &str, (width, height): (u16, u16)) -> Image {
        let (file, size) = (self.at("rendered.png"), format!("{width}x{height}"));
        let out = file.to_string_lossy();
        let arguments = ["render", pipeline, scene, "-o", &out, "--output", "display", "--size", &size];
        let done = self.lightloom(&arguments);
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        Image::read(file).unwrap()
    }
}

pub(super) fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let copied = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &copied);
        } else if path.extension().is_some_and(|ending| ending == "ron" || ending == "wgsl") {
            std::fs::copy(path, copied).unwrap();
        }
    }
}

/// A user's account: where the window's state, its files and what it prints are kept.
pub(super) struct Home(TempDir);

impl Home {
    /// An account whose window last showed a pixel of the frame in each of its own, with or without the settings.
    pub(super) fn new(settings: bool) -> Home {
        let home = Home(tempfile::tempdir().unwrap());
        let remembered =
            format!(r#"{{"resolution":1.0,"handles":false,"panels":false,"settings":{settings}}}"#);
        std::fs::write(home.at("state.ron"), format!("{{\"lightloom\": {remembered:?}}}")).unwrap();
        home
    }

    pub(super) fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}

/// The program while its window is open.
pub(super) struct Viewer {
    pub(super) window: Window,
    /// The time for which a picture must stay the same before it counts as the last one: longer than steps of the program take, by
    /// how long it took to start.
    still: Duration,
    pub(super) program: RefCell<Child>,
    pub(super) home: PathBuf,
    pub(super) _display: Display,
}

impl Viewer {
    /// Opens the window at a size; `None` where there is no Xvfb.
    pub(super) fn open(
        tree: &Tree,
        home: &Home,
        arguments: &[&str],
        (width, height): (u16, u16),
    ) -> Option<Viewer> {
        let display = Display::start()?;
        let file = |name: &str| std::fs::File::create(home.at(name)).unwrap();
        let start = Instant::now();
        let mut program = Command::new(env!("CARGO_BIN_EXE_lightloom"))
            .arg("view")
            .args(arguments)
            .arg("--root")
            .arg(tree.0.path())
            .arg("--state")
            .arg(home.at("state.ron"))
            .current_dir(home.0.path())
            .env_remove("WAYLAND_DISPLAY")
            .envs([display.env()])
            .env("HOME", home.0.path())
            .env("XDG_DATA_HOME", home.0.path())
            .env("XDG_RUNTIME_DIR", home.0.path())
            .stdin(Stdio::null())
            .stdout(file("stdout"))
            .stderr(file("stderr"))
            .spawn()
            .unwrap();
        let mut window = loop {
            match display.wait_for_window("Lightloom", Duration::from_secs(1)) {
                Ok(window) => break window,
                Err(error) => {
                    let ended = program.try_wait().unwrap();
                    if ended.is_some() || start.elapsed() > PATIENCE {
                        let printed = std::fs::read_to_string(home.at("stderr")).unwrap();
                        // It fails only where the program has ended.
                        let _ = program.kill();
                        panic!("{error} ({ended:?}): {printed}");
                    }
                }
            }
        };
        let still = STILL.max(3 * start.elapsed());
        window.resize(width, height);
        Some(Viewer {
            window,
            still,
            program: RefCell::new(program),
            home: home.0.path().to_owned(),
            _display: display,
        })
    }

    /// Opens the window with nothing but the picture in it.
    pub(super) fn bare(tree: &Tree, home: &Home, arguments: &[&str]) -> Option<Viewer> {
        let viewer = Viewer::open(tree, home, arguments, SIZE)?;
        viewer.key("F11");
        Some(viewer)
    }

    /// Returns its standard output.
    pub(super) fn stdout(&self) -> String {
        std::fs::read_to_string(self.home.join("stdout")).unwrap()
    }

    /// Returns its standard error.
    pub(super) fn stderr(&self) -> String {
        std::fs::read_to_string(self.home.join("stderr")).unwrap()
    }

    /// Returns the number of reloads that it has reported.
    pub(super) fn reloads(&self) -> usize {
        self.stdout().lines().filter(|line| line.contains("read again")).count()
    }

    pub(super) fn key(&self, chord: &str) {
        self.window.key(chord);
    }

    /// Waits until the window shows what is wanted.
    pub(super) fn wait_for_picture(&self, what: &str, seen: impl FnMut(&Image) -> bool) -> Image {
        let found = self.window.wait_until(PATIENCE, seen);
        found.unwrap_or_else(|error| panic!("{what}: {error}\n{}", self.printed()))
    }

    /// Waits until the window shows this picture, bit for bit.
    pub(super) fn wait_for_same(&self, what: &str, expected: &Image) {
        self.wait_for_picture(what, |seen| seen == expected);
    }

    /// Waits until the window shows another picture than this, and has come to rest.
    pub(super) fn wait_for_other(&self, what: &str, before: &Image) -> Image {
        self.wait_for_picture(what, |seen| seen != before);
        self.rest(what)
    }

    /// Waits until what the window shows stays as it is.
    pub(super) fn rest(&self, what: &str) -> Image {
        let (mut last, mut since) = (None, Instant::now());
        self.wait_for_picture(what, |seen| {
            if last.as_ref() != Some(seen) {
                (last, since) = (Some(seen.clone()), Instant::now());
            }
            since.elapsed() > self.still
        })
    }

    /// Waits until the program prints something, or a picture would count as the last one.
    pub(super) fn wait_for_output(&self) {
        let length = || self.stdout().len() + self.stderr().len();
        let (before, start) = (length(), Instant::now());
        while length() == before && start.elapsed() < self.still {
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Waits until something has been printed.
    pub(super) fn wait_for(&self, what: &str, ready: impl Fn(&Viewer) -> bool) {
        let start = Instant::now();
        while !ready(self) {
            assert!(start.elapsed() < PATIENCE, "no {what} in {PATIENCE:?}\n{}", self.printed());
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Returns its exit status; `None` while it runs.
    pub(super) fn ended(&self) -> Option<ExitStatus> {
        self.program.borrow_mut().try_wait().unwrap()
    }

    /// All that is known, for the message of a test that fails.
    pub(super) fn printed(&self) -> String {
        let ended = self.ended().map_or("it runs".to_owned(), |status| status.to_string());
        format!("{ended}\n{}{}", self.stdout(), self.stderr())
    }

    /// Quits as a user does.
    pub(super) fn quit(self) {
        self.key("ctrl+q");
        self.wait_for("end after Ctrl-Q", |viewer| viewer.ended().is_some());
        assert!(self.ended().is_some_and(|status| status.success()), "{}", self.printed());
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        // Both fail only where it has ended.
        let program = self.program.get_mut();
        let _ = program.kill();
        let _ = program.wait();
    }
}

/// The mean ꟻLIP of two pictures of a screen.
pub(super) fn flip(a: &Image, b: &Image) -> f64 {
    Pair::new(a, b)
        .map_or(1.0, |pair| metrics::flip(&pair, metrics::Display::AS_IS, PIXELS_PER_DEGREE).mean())
}
