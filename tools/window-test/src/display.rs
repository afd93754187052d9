use crate::keyboard::Keyboard;
use crate::{Error, Window};
use std::io::{BufRead as _, BufReader, ErrorKind, Read as _};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};
use x11rb::connection::Connection as _;
use x11rb::protocol::xproto::{self, ConnectionExt as _, MapState};
use x11rb::rust_connection::RustConnection;

/// The size of the screen where none is asked for \[pixels\].
const SIZE: [u16; 2] = [1280, 800];

/// How often it is looked again for what is waited for.
pub(crate) const POLL: Duration = Duration::from_millis(20);

/// A running X server without a screen. It ends when this and every [`Window`] on it are dropped.
#[derive(Clone, Debug)]
pub struct Display {
    server: Arc<Server>,
}

impl Display {
    /// Starts a server with a screen of 1280x800 pixels. Returns `None`, having said so, where Xvfb is not installed.
    ///
    /// # Panics
    /// If Xvfb is there and does not start: a test that passed silently then would hide it.
    pub fn start() -> Option<Self> {
        Self::start_sized(SIZE)
    }

    /// Does as [`Display::start`], with a screen of this size \[pixels\].
    ///
    /// # Panics
    /// If Xvfb is there and does not start.
    pub fn start_sized(size: [u16; 2]) -> Option<Self> {
        let started = Server::start(size).unwrap_or_else(|error| panic!("Xvfb does not start: {error}"));
        if started.is_none() {
            eprintln!("skipped: Xvfb is not installed");
        }
        started.map(|server| Self { server: Arc::new(server) })
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
    /// [`Error::NoWindow`] after `timeout`, with the titles that there are.
    pub fn wait_for_window(&self, title: &str, timeout: Duration) -> Result<Window, Error> {
        let start = Instant::now();
        loop {
            let windows = self.server.windows()?;
            if let Some(&(id, _)) = windows.iter().find(|(_, name)| name.contains(title)) {
                let window = Window::new(Arc::clone(&self.server), id);
                window.focus()?;
                return Ok(window);
            }
            if start.elapsed() >= timeout {
                let titles = windows.into_iter().map(|(_, name)| name).collect();
                return Err(Error::NoWindow { title: title.into(), timeout, titles });
            }
            std::thread::sleep(POLL);
        }
    }
}

/// The process and the connection to it.
#[derive(Debug)]
pub(crate) struct Server {
    process: Child,
    name: String,
    pub(crate) connection: RustConnection,
    pub(crate) root: xproto::Window,
    pub(crate) size: [u16; 2],
    pub(crate) keyboard: Keyboard,
    net_wm_name: xproto::Atom,
}

impl Server {
    fn start(size: [u16; 2]) -> Result<Option<Self>, Box<dyn std::error::Error>> {
        let [width, height] = size;
        // `-displayfd 1`: the server takes a free number, and writes it to its standard output once it listens.
        // `-terminate`: it ends with the last client, so also when the test is killed, whose connection is the first.
        let mut command = Command::new("Xvfb");
        command
            .args(["-displayfd", "1", "-nolisten", "tcp", "-dpi", "96", "-screen", "0"])
            .args([&format!("{width}x{height}x24"), "-terminate"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let process = match command.spawn() {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            spawned => spawned?,
        };
        Self::connect(process, size).map(Some)
    }

    fn connect(mut process: Child, size: [u16; 2]) -> Result<Self, Box<dyn std::error::Error>> {
        let mut number = String::new();
        let output = process.stdout.take().ok_or("no output")?;
        BufReader::new(output).read_line(&mut number)?;
        let mut errors = process.stderr.take().ok_or("no errors")?;
        if number.trim().is_empty() {
            let mut message = String::new();
            errors.read_to_string(&mut message)?;
            process.wait()?;
            return Err(message.into());
        }
        // Its warnings are of no use, but a full pipe would stop it.
        std::thread::spawn(move || std::io::copy(&mut errors, &mut std::io::sink()));
        let name = format!(":{}", number.trim());
        let (connection, screen) = RustConnection::connect(Some(&name))?;
        let root = connection.setup().roots.get(screen).ok_or("no screen")?.root;
        let keyboard = Keyboard::read(&connection)?;
        let net_wm_name = connection.intern_atom(false, b"_NET_WM_NAME")?.reply()?.atom;
        Ok(Self { process, name, connection, root, size, keyboard, net_wm_name })
    }

    /// Returns every window that is shown and has a title.
    fn windows(&self) -> Result<Vec<(xproto::Window, String)>, Error> {
        let mut found = Vec::new();
        let mut left = vec![self.root];
        while let Some(window) = left.pop() {
            // A window can go between one question and the next.
            let Some(tree) = gone(self.connection.query_tree(window)?.reply())? else { continue };
            left.extend(tree.children);
            let Some(attributes) = gone(self.connection.get_window_attributes(window)?.reply())? else {
                continue;
            };
            if attributes.map_state == MapState::VIEWABLE
                && let Some(title) = self.title(window)?
            {
                found.push((window, title));
            }
        }
        Ok(found)
    }

    fn title(&self, window: xproto::Window) -> Result<Option<String>, Error> {
        for property in [self.net_wm_name, xproto::AtomEnum::WM_NAME.into()] {
            let any = xproto::AtomEnum::ANY;
            let value = self.connection.get_property(false, window, property, any, 0, 1024)?.reply();
            if let Some(value) = gone(value)?.map(|reply| reply.value).filter(|value| !value.is_empty()) {
                return Ok(Some(String::from_utf8_lossy(&value).into_owned()));
            }
        }
        Ok(None)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // The process has ended where either fails, which is what is wanted.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Turns the server's refusal into `None`.
fn gone<T>(reply: Result<T, x11rb::errors::ReplyError>) -> Result<Option<T>, Error> {
    match reply.map_err(Error::from) {
        Ok(reply) => Ok(Some(reply)),
        Err(Error::Refused(_)) => Ok(None),
        Err(error) => Err(error),
    }
}
