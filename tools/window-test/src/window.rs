use crate::Error;
use crate::display::{POLL, Server};
use metrics::{Image, linear_from_srgb};
use std::sync::Arc;
use std::time::{Duration, Instant};
use x11rb::connection::Connection as _;
use x11rb::protocol::xproto::{
    self, ConfigureWindowAux, ConnectionExt as _, ImageFormat, ImageOrder, InputFocus,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::wrapper::ConnectionExt as _;

/// The pause after an event where none is asked for: about a frame of a program that draws on the CPU.
const PACE: Duration = Duration::from_millis(30);

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

/// Buttons of X that stand for the wheel.
const WHEEL_UP: u8 = 4;
const WHEEL_DOWN: u8 = 5;

/// A window of a program under test. Positions are pixels of the window, from its upper left corner.
///
/// After every event there is a pause ([`Window::set_pace`]), so that a program that looks at its input once in a frame
/// sees one event after the other, as from a hand. A program slower than that may see several at once;
/// [`Window::wait_until`] is how a test knows that it has come so far.
///
/// Every call fails with [`Error::Refused`] where the window is gone, and with [`Error::Broken`] where the server is.
#[derive(Clone, Debug)]
pub struct Window {
    server: Arc<Server>,
    id: xproto::Window,
    pace: Duration,
}

impl Window {
    pub(crate) fn new(server: Arc<Server>, id: xproto::Window) -> Self {
        Self { server, id, pace: PACE }
    }

    /// Sets the pause after each event, at first 30 ms.
    pub fn set_pace(&mut self, pace: Duration) {
        self.pace = pace;
    }

    /// Gives this window the keyboard.
    ///
    /// # Errors
    /// As all calls.
    pub fn focus(&self) -> Result<(), Error> {
        let now = x11rb::CURRENT_TIME;
        Ok(self.server.connection.set_input_focus(InputFocus::PARENT, self.id, now)?.check()?)
    }

    /// Presses and releases a key, with modifiers held: `"ctrl+shift+p"`, `"F1"`, `"escape"`, `"?"`.
    ///
    /// A key is one character, or a name; `+` is `plus`. A character that needs Shift brings it.
    ///
    /// # Errors
    /// [`Error::UnknownKey`] and [`Error::UnknownModifier`].
    pub fn key(&self, chord: &str) -> Result<(), Error> {
        self.hold(chord, Duration::ZERO)
    }

    /// Holds a key, with modifiers, for this long. The server repeats it, as it does under a finger.
    ///
    /// # Errors
    /// Those of [`Window::key`].
    pub fn hold(&self, chord: &str, duration: Duration) -> Result<(), Error> {
        let codes = self.server.keyboard.chord(chord)?;
        for &code in &codes {
            self.send(xproto::KEY_PRESS_EVENT, code)?;
        }
        self.pause()?;
        std::thread::sleep(duration.saturating_sub(self.pace));
        for &code in codes.iter().rev() {
            self.send(xproto::KEY_RELEASE_EVENT, code)?;
        }
        self.pause()
    }

    /// Types a text, character by character; a line feed is Enter.
    ///
    /// # Errors
    /// [`Error::UnknownKey`] for a character that a US keyboard lacks; nothing has been typed then.
    pub fn type_text(&self, text: &str) -> Result<(), Error> {
        let keyboard = &self.server.keyboard;
        let shift = keyboard.shift()?;
        let keys: Vec<_> =
            text.chars().map(|character| keyboard.character(character)).collect::<Result<_, _>>()?;
        for key in keys {
            let held = key.shift.then_some(shift);
            for code in held.into_iter().chain([key.code]) {
                self.send(xproto::KEY_PRESS_EVENT, code)?;
            }
            for code in [key.code].into_iter().chain(held) {
                self.send(xproto::KEY_RELEASE_EVENT, code)?;
            }
            self.pause()?;
        }
        Ok(())
    }

    /// Moves the pointer here.
    ///
    /// # Errors
    /// As all calls.
    pub fn move_to(&self, x: i16, y: i16) -> Result<(), Error> {
        let Server { connection, root, .. } = &*self.server;
        let at = connection.translate_coordinates(self.id, *root, x, y)?.reply()?;
        let (motion, absolute) = (xproto::MOTION_NOTIFY_EVENT, 0);
        connection.xtest_fake_input(motion, absolute, 0, *root, at.dst_x, at.dst_y, 0)?.check()?;
        self.pause()
    }

    /// Clicks here with the left button.
    ///
    /// # Errors
    /// As all calls.
    pub fn click(&self, x: i16, y: i16) -> Result<(), Error> {
        self.click_with(x, y, Button::Left)
    }

    /// Clicks here.
    ///
    /// # Errors
    /// As all calls.
    pub fn click_with(&self, x: i16, y: i16, button: Button) -> Result<(), Error> {
        self.move_to(x, y)?;
        self.press(button as u8)?;
        self.release(button as u8)
    }

    /// Clicks here twice with the left button.
    ///
    /// # Errors
    /// As all calls.
    pub fn double_click(&self, x: i16, y: i16) -> Result<(), Error> {
        self.click(x, y)?;
        self.click(x, y)
    }

    /// Presses a button at `from`, moves to `to` in `steps` equal steps (at least one), and releases it there.
    ///
    /// # Errors
    /// As all calls; the button is then held still.
    pub fn drag(&self, from: (i16, i16), to: (i16, i16), steps: u16, button: Button) -> Result<(), Error> {
        let steps = i32::from(steps.max(1));
        let between = |from: i16, to: i16, step: i32| {
            // Lies between the two, so that it fits.
            (i32::from(from) + (i32::from(to) - i32::from(from)) * step / steps) as i16
        };
        self.move_to(from.0, from.1)?;
        self.press(button as u8)?;
        for step in 1..=steps {
            self.move_to(between(from.0, to.0, step), between(from.1, to.1, step))?;
        }
        self.release(button as u8)
    }

    /// Turns the wheel here: up, away from the hand, where `ticks` is above 0, and down where it is below.
    ///
    /// # Errors
    /// As all calls.
    pub fn scroll(&self, x: i16, y: i16, ticks: i32) -> Result<(), Error> {
        self.move_to(x, y)?;
        let button = if ticks > 0 { WHEEL_UP } else { WHEEL_DOWN };
        for _ in 0..ticks.unsigned_abs() {
            self.press(button)?;
            self.release(button)?;
        }
        Ok(())
    }

    /// Returns the size \[pixels\].
    ///
    /// # Errors
    /// As all calls.
    pub fn size(&self) -> Result<[u16; 2], Error> {
        let geometry = self.server.connection.get_geometry(self.id)?.reply()?;
        Ok([geometry.width, geometry.height])
    }

    /// Gives the window another size \[pixels, at least 1\].
    ///
    /// # Errors
    /// As all calls.
    pub fn resize(&self, width: u16, height: u16) -> Result<(), Error> {
        let size = ConfigureWindowAux::new().width(u32::from(width)).height(u32::from(height));
        self.server.connection.configure_window(self.id, &size)?.check()?;
        self.pause()
    }

    /// Asks the program to close the window, as the button in a window's frame does.
    ///
    /// # Errors
    /// As all calls.
    pub fn close(&self) -> Result<(), Error> {
        let connection = &self.server.connection;
        let atom = |name: &[u8]| Ok::<_, Error>(connection.intern_atom(false, name)?.reply()?.atom);
        let data = [atom(b"WM_DELETE_WINDOW")?, x11rb::CURRENT_TIME, 0, 0, 0];
        let message = xproto::ClientMessageEvent::new(32, self.id, atom(b"WM_PROTOCOLS")?, data);
        connection.send_event(false, self.id, xproto::EventMask::NO_EVENT, message)?.check()?;
        self.pause()
    }

    /// Returns what the window shows: display light, decoded from sRGB, with alpha 1. Written with
    /// [`metrics::Display::AS_IS`], a PNG file shows the same.
    ///
    /// # Errors
    /// [`Error::Outside`] where part of the window lies outside the screen.
    pub fn screenshot(&self) -> Result<Image, Error> {
        let Server { connection, root, size: screen, .. } = &*self.server;
        let [width, height] = self.size()?;
        let at = connection.translate_coordinates(self.id, *root, 0, 0)?.reply()?;
        let fits =
            |at: i16, size: u16, screen: u16| at >= 0 && i32::from(at) + i32::from(size) <= i32::from(screen);
        if !fits(at.dst_x, width, screen[0]) || !fits(at.dst_y, height, screen[1]) {
            let (position, size) = ([at.dst_x, at.dst_y], [width, height]);
            return Err(Error::Outside { position, size, screen: *screen });
        }
        let all_planes = u32::MAX;
        let reply =
            connection.get_image(ImageFormat::Z_PIXMAP, self.id, 0, 0, width, height, all_planes)?.reply()?;
        let (width, height) = (usize::from(width), usize::from(height));
        if reply.depth != 24 || reply.data.len() != width * height * 4 {
            return Err(Error::PixelLayout);
        }
        // A pixel is the number 0x00RRGGBB, in the byte order of the server.
        let number = if connection.setup().image_byte_order == ImageOrder::LSB_FIRST {
            u32::from_le_bytes
        } else {
            u32::from_be_bytes
        };
        let light: Vec<f32> = (0..=u8::MAX).map(|byte| linear_from_srgb(f32::from(byte) / 255.0)).collect();
        let (pixels, _) = reply.data.as_chunks::<4>();
        let rgba = pixels.iter().map(|&pixel| {
            let [_, r, g, b] = number(pixel).to_be_bytes().map(|byte| light[usize::from(byte)]);
            [r, g, b, 1.0]
        });
        Ok(Image::new(width, height, rgba.collect())?)
    }

    /// Takes screenshots until `seen` returns true for one, and returns that one.
    ///
    /// # Errors
    /// [`Error::NotSeen`] after `timeout`, with the path of the last screenshot, which is kept.
    pub fn wait_until(
        &self,
        timeout: Duration,
        mut seen: impl FnMut(&Image) -> bool,
    ) -> Result<Image, Error> {
        let start = Instant::now();
        loop {
            // Asked before the screenshot is taken, so that there is one at the end of the time, however short.
            let over = start.elapsed() >= timeout;
            let screenshot = self.screenshot()?;
            if seen(&screenshot) {
                return Ok(screenshot);
            }
            if over {
                return Err(Error::NotSeen { timeout, screenshot: keep(&screenshot)? });
            }
            std::thread::sleep(POLL);
        }
    }

    fn press(&self, button: u8) -> Result<(), Error> {
        self.send(xproto::BUTTON_PRESS_EVENT, button)?;
        self.pause()
    }

    fn release(&self, button: u8) -> Result<(), Error> {
        self.send(xproto::BUTTON_RELEASE_EVENT, button)?;
        self.pause()
    }

    /// Sends an event of a key or a button.
    fn send(&self, event: u8, code: u8) -> Result<(), Error> {
        let Server { connection, root, .. } = &*self.server;
        Ok(connection.xtest_fake_input(event, code, 0, *root, 0, 0, 0)?.check()?)
    }

    /// Waits until the server has handled all that was sent, and for the program to see it.
    fn pause(&self) -> Result<(), Error> {
        self.server.connection.sync()?;
        std::thread::sleep(self.pace);
        Ok(())
    }
}

/// Writes a screenshot that says why a test failed.
fn keep(screenshot: &Image) -> Result<std::path::PathBuf, Error> {
    let file =
        tempfile::Builder::new().prefix("window-test-").suffix(".png").tempfile().map_err(Error::Keep)?;
    screenshot.write(file.path(), metrics::Display::AS_IS, None)?;
    file.into_temp_path().keep().map_err(|error| Error::Keep(error.error))
}
