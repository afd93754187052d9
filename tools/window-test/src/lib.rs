//! Drives a window by real input events under Xvfb, an X server without a screen: for tests.
//!
//! [`Display::start`] starts a server of its own, so tests can run at once and none touches the desktop. The program
//! under test is started with [`Display::env`]; [`Display::wait_for_window`] finds its window. `xdotool` sends keys, clicks,
//! drags and scrolling by the extension XTEST, which a program cannot distinguish from a keyboard and a mouse.
//!
//! ```no_run
//! use std::time::Duration;
//! use window_test::{Button, Display};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let Some(display) = Display::start() else { return Ok(()) };
//! let mut program = std::process::Command::new("xterm").envs([display.env()]).spawn()?;
//! let window = display.wait_for_window("xterm", Duration::from_secs(10))?;
//! window.type_text("ls");
//! window.key("ctrl+c");
//! window.drag((10, 10), (200, 40), 8, Button::Left);
//! window.screenshot().write("xterm.png", metrics::Display::AS_IS, None)?;
//! program.kill()?;
//! # Ok(())
//! # }
//! ```
//!
//! No window manager runs. A window lies in the upper left corner, is as large as it asks, and has no frame.
//! [`Display::wait_for_window`] gives it the keyboard. What fails here is the test's environment, and panics.

use metrics::{Image, linear_from_srgb};
use std::fs::File;
use std::io::{BufRead as _, BufReader, ErrorKind, Read as _, Seek as _, SeekFrom};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// The screen \[pixels\]; no window may be larger.
const SCREEN: (u16, u16) = (1280, 800);

/// The bytes of a row of the screen.
const ROW: usize = SCREEN.0 as usize * 4;

/// The time between two looks for what is waited for.
const POLL: Duration = Duration::from_millis(20);

/// The pause after each event \[s\]: about a frame of a program that draws on the CPU.
const PACE: &str = "0.03";

/// A running X server without a screen. It ends when this and every [`Window`] on it are dropped.
#[derive(Clone, Debug)]
pub struct Display {
    server: Arc<Server>,
}

#[derive(Debug)]
struct Server {
    process: Child,
    name: String,
    /// Holds the file in which the server keeps the pixels of its screen.
    memory: TempDir,
}

impl Display {
    /// Starts a server. Returns `None`, and prints why, where Xvfb or xdotool is not installed.
    ///
    /// # Panics
    /// If Xvfb is installed and does not start.
    pub fn start() -> Option<Display> {
        let memory = tempfile::tempdir().expect("a folder");
        // `-displayfd 1`: the server takes a free number, and writes it to its standard output once it listens.
        // `-noreset`: else it starts anew when its last client leaves, and refuses those that connect meanwhile. Each xdotool
        // is such a client.
        let server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-noreset", "-nolisten", "tcp", "-dpi", "96", "-screen", "0"])
            .arg(format!("{}x{}x24", SCREEN.0, SCREEN.1))
            .arg("-fbdir")
            .arg(memory.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let has_xdotool = Command::new("xdotool").arg("version").output().is_ok();
        let mut process = match server {
            Err(error) if error.kind() == ErrorKind::NotFound => return skipped("Xvfb"),
            spawned => spawned.expect("Xvfb starts"),
        };
        let mut number = String::new();
        if let Some(output) = process.stdout.take() {
            BufReader::new(output).read_line(&mut number).expect("Xvfb writes its number");
        }
        let server = Server { process, name: format!(":{}", number.trim()), memory };
        assert!(!number.is_empty(), "Xvfb ends before it listens");
        if has_xdotool { Some(Display { server: Arc::new(server) }) } else { skipped("xdotool") }
    }

    /// Returns the variable that sends a program's windows here, and its value: for [`Command::envs`].
    ///
    /// A program that prefers Wayland must not find it: remove `WAYLAND_DISPLAY`.
    pub fn env(&self) -> (&'static str, &str) {
        ("DISPLAY", &self.server.name)
    }

    /// Waits until a window is shown whose title contains `title`, and gives it the keyboard.
    ///
    /// # Errors
    /// After `timeout`.
    pub fn wait_for_window(&self, title: &str, timeout: Duration) -> Result<Window, String> {
        let start = Instant::now();
        loop {
            let found = self.server.xdotool(&["search", "--onlyvisible", "--name", title]);
            if let Some(id) = found.ok().as_deref().and_then(|ids| ids.lines().next()) {
                let mut window = Window { server: Arc::clone(&self.server), id: id.to_owned(), size: (0, 0) };
                window.send(&["windowfocus", id]);
                window.size = window.geometry();
                return Ok(window);
            }
            if start.elapsed() >= timeout {
                return Err(format!("there is no window whose title contains `{title}` after {timeout:?}"));
            }
            std::thread::sleep(POLL);
        }
    }
}

fn skipped(program: &str) -> Option<Display> {
    eprintln!("skipped: {program} is not installed");
    None
}

impl Server {
    /// Runs `xdotool` and returns what it prints.
    fn xdotool(&self, arguments: &[&str]) -> Result<String, String> {
        let done = Command::new("xdotool").args(arguments).env("DISPLAY", &self.name).output();
        let done = done.map_err(|error| error.to_string())?;
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        if done.status.success() { Ok(text(&done.stdout)) } else { Err(text(&done.stderr)) }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // Both fail only where the process has ended.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A button of the mouse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Button {
    /// The first.
    Left = 1,
    /// The second, which is the wheel.
    Middle = 2,
    /// The third.
    Right = 3,
}

/// A window of a program under test. Positions are pixels of the window, from its upper left corner.
///
/// After every event there is a pause, so that a program that reads its input once a frame sees one event after the
/// other, as from a hand. [`Window::wait_until`] is how a test knows that a slower program has handled them.
///
/// All but [`Window::wait_until`] panic where the window or the server is gone.
#[derive(Clone, Debug)]
pub struct Window {
    server: Arc<Server>,
    id: String,
    size: (u16, u16),
}

impl Window {
    /// Presses and releases a key, with modifiers held. Names are those of X: `"ctrl+shift+p"`, `"F1"`, `"Escape"`.
    pub fn key(&self, chord: &str) {
        self.send(&["key", chord, "sleep", PACE]);
    }

    /// Holds a key for this long. The server repeats it, as it does under a finger.
    pub fn hold(&self, key: &str, duration: Duration) {
        let seconds = duration.as_secs_f32().to_string();
        self.send(&["keydown", key, "sleep", &seconds, "keyup", key, "sleep", PACE]);
    }

    /// Types a text, character by character. Enter is the key `Return`: of a line feed xdotool makes Linefeed.
    pub fn type_text(&self, text: &str) {
        self.send(&["type", "--delay", "30", text]);
    }

    /// Moves the pointer here.
    pub fn move_to(&self, x: i16, y: i16) {
        self.at(x, y, &[]);
    }

    /// Clicks here twice with the left button.
    pub fn double_click(&self, x: i16, y: i16) {
        self.at(x, y, &["click", "--repeat", "2", "--delay", "60", "1"]);
    }

    /// Presses a button at `from`, moves to `to` in `steps` equal steps (at least one), and releases it there.
    pub fn drag(&self, from: (i16, i16), to: (i16, i16), steps: u16, button: Button) {
        let (steps, button) = (steps.max(1), (button as u8).to_string());
        self.at(from.0, from.1, &["mousedown", &button]);
        for step in 1..=steps {
            let share = f32::from(step) / f32::from(steps);
            let between = |from: i16, to: i16| (f32::from(from) + f32::from(to - from) * share) as i16;
            self.move_to(between(from.0, to.0), between(from.1, to.1));
        }
        self.send(&["mouseup", &button, "sleep", PACE]);
    }

    /// Turns the wheel here: up, away from the hand, where `ticks` is above 0, and down where it is below.
    pub fn scroll(&self, x: i16, y: i16, ticks: i32) {
        let button = if ticks > 0 { "4" } else { "5" };
        self.at(x, y, &["click", "--repeat", &ticks.unsigned_abs().to_string(), "--delay", "60", button]);
    }

    /// Gives the window another size \[pixels\].
    ///
    /// # Panics
    /// If the screen is smaller.
    pub fn resize(&mut self, width: u16, height: u16) {
        assert!(width <= SCREEN.0 && height <= SCREEN.1, "the screen is smaller");
        self.send(&["windowsize", &self.id, &width.to_string(), &height.to_string(), "sleep", PACE]);
        self.size = (width, height);
    }

    /// Returns what the window shows: display light, decoded from sRGB, with alpha 1. Written with
    /// [`metrics::Display::AS_IS`], a PNG file shows the same.
    pub fn screenshot(&self) -> Image {
        self.image_of(&self.rows())
    }

    /// The rows of the screen that the window is on: four bytes a pixel, blue first.
    fn rows(&self) -> Vec<u8> {
        let read = || -> std::io::Result<Vec<u8>> {
            let mut file = File::open(self.server.memory.path().join("Xvfb_screen0"))?;
            // The pixels end the file.
            file.seek(SeekFrom::End(-((ROW * usize::from(SCREEN.1)) as i64)))?;
            let mut rows = vec![0; ROW * usize::from(self.size.1)];
            file.read_exact(&mut rows)?;
            Ok(rows)
        };
        read().expect("the screen's pixels")
    }

    fn image_of(&self, rows: &[u8]) -> Image {
        let (width, height) = (usize::from(self.size.0), usize::from(self.size.1));
        let light: Vec<f32> = (0..=u8::MAX).map(|byte| linear_from_srgb(f32::from(byte) / 255.0)).collect();
        let pixel = |x: usize, y: usize| {
            let at = y * ROW + x * 4;
            let [r, g, b] = [2, 1, 0].map(|channel| light[usize::from(rows[at + channel])]);
            [r, g, b, 1.0]
        };
        Image::from_fn(width, height, pixel).expect("a window has pixels")
    }

    /// Takes screenshots until `seen` returns true for one, and returns that one.
    ///
    /// # Errors
    /// After `timeout`, with the path of the last screenshot, which is kept.
    pub fn wait_until(
        &self,
        timeout: Duration,
        mut seen: impl FnMut(&Image) -> bool,
    ) -> Result<Image, String> {
        let start = Instant::now();
        let mut rows = self.rows();
        let mut screenshot = self.image_of(&rows);
        loop {
            // Read before the screenshot is taken, so that the last one is not older than the timeout.
            let over = start.elapsed() >= timeout;
            let now = self.rows();
            // Most of them are the same, and to decode one takes the time that the program under test needs.
            if now != rows {
                screenshot = self.image_of(&now);
                rows = now;
            }
            if seen(&screenshot) {
                return Ok(screenshot);
            }
            if over {
                return Err(format!("not seen after {timeout:?}; {}", kept(&screenshot)));
            }
            std::thread::sleep(POLL);
        }
    }

    fn at(&self, x: i16, y: i16, then: &[&str]) {
        let (x, y) = (x.to_string(), y.to_string());
        self.send(
            &[&["mousemove", "--window", &self.id, &x, &y, "sleep", PACE], then, &["sleep", PACE]].concat(),
        );
    }

    fn geometry(&self) -> (u16, u16) {
        let text = self.send(&["getwindowgeometry", "--shell", &self.id]);
        let number = |name: &str| text.lines().find_map(|line| line.strip_prefix(name)?.parse().ok());
        assert_eq!((number("X="), number("Y=")), (Some(0), Some(0)), "the window lies in the corner");
        (number("WIDTH=").expect("a width"), number("HEIGHT=").expect("a height"))
    }

    fn send(&self, arguments: &[&str]) -> String {
        self.server.xdotool(arguments).unwrap_or_else(|error| panic!("xdotool {arguments:?}: {error}"))
    }
}

/// Writes a screenshot that shows why a test failed, and returns a message with its path.
fn kept(screenshot: &Image) -> String {
    let name = format!("window-test-{}-{:?}.png", std::process::id(), std::thread::current().id());
    let path = std::env::temp_dir().join(name.replace(['(', ')'], ""));
    match screenshot.write(&path, metrics::Display::AS_IS, None) {
        Ok(()) => format!("the last screenshot is {}", path.display()),
        Err(error) => format!("no screenshot was kept: {error}"),
    }
}
