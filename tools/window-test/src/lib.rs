//! Drives a window by real input events under Xvfb, an X server without a screen: for tests.
//!
//! [`Display::start`] starts a server of its own, so tests can run at once and none touches the desktop. The program
//! under test is started with [`Display::env`]; [`Display::wait_for_window`] finds its window. Keys, clicks, drags and
//! scrolling go through the extension XTEST, so that the program cannot tell them from those of a keyboard and a mouse.
//!
//! ```no_run
//! use std::time::Duration;
//! use window_test::{Button, Display};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let Some(display) = Display::start() else { return Ok(()) };
//! let mut program = std::process::Command::new("xterm").envs([display.env()]).spawn()?;
//! let window = display.wait_for_window("xterm", Duration::from_secs(10))?;
//! window.type_text("ls")?;
//! window.key("ctrl+c")?;
//! window.drag((10, 10), (200, 40), 8, Button::Left)?;
//! window.screenshot()?.write("xterm.png", metrics::Display::AS_IS, None)?;
//! program.kill()?;
//! # Ok(())
//! # }
//! ```
//!
//! No window manager runs. A window lies where its program puts it, is as large as it asks, and has no frame.
//! [`Display::wait_for_window`] gives it the keyboard, which nobody else would.

mod display;
mod error;
mod keyboard;
mod window;

pub use display::Display;
pub use error::Error;
pub use window::{Button, Window};
