//! A program with a window: it records in words what it is sent, and paints.

use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use x11rb::connection::Connection as _;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    Atom, AtomEnum, ChangeGCAux, ConnectionExt as _, CreateGCAux, CreateWindowAux, EventMask, Gcontext,
    GetKeyboardMappingReply, KeyButMask, KeyPressEvent, PropMode, Rectangle, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;
use xkeysym::Keysym;

pub(crate) const RED: [f32; 3] = [1.0, 0.0, 0.0];
pub(crate) const GREEN: [f32; 3] = [0.0, 1.0, 0.0];
pub(crate) const BLUE: [f32; 3] = [0.0, 0.0, 1.0];

pub(crate) struct Program {
    recorded: Arc<Mutex<Vec<String>>>,
    thread: JoinHandle<()>,
}

impl Program {
    pub(crate) fn show(display: &str, title: &str, size: [u16; 2]) -> Self {
        let recorded = Arc::default();
        let (connection, screen) = x11rb::connect(Some(display)).unwrap();
        let mut shown = Shown::new(connection, screen, title, size, Arc::clone(&recorded));
        Self { recorded, thread: std::thread::spawn(move || while shown.handle_one() {}) }
    }

    /// What happened, from the first event; a move to where the pointer is already is left out.
    pub(crate) fn recorded(&self) -> Vec<String> {
        let mut recorded = self.recorded.lock().unwrap().clone();
        let mut last = String::new();
        recorded.retain(|event| {
            let moved = event.starts_with("moved");
            let kept = !moved || *event != last;
            if moved {
                last.clone_from(event);
            }
            kept
        });
        recorded
    }

    pub(crate) fn wait_for(&self, event: &str) {
        let start = Instant::now();
        while !self.recorded().iter().any(|recorded| recorded == event) {
            assert!(start.elapsed() < Duration::from_secs(20), "no `{event}` in {:#?}", self.recorded());
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Waits until the program has ended by itself.
    pub(crate) fn end(self) {
        self.thread.join().unwrap();
    }

    /// The characters of the keys that were pressed.
    pub(crate) fn typed(&self) -> String {
        let keys = self.recorded();
        let keys = keys.iter().filter_map(|event| event.strip_prefix("key ")?.split(' ').next());
        keys.filter_map(|name| {
            let mut characters = name.chars();
            match (characters.next(), characters.next()) {
                (character, None) => character,
                _ if name == "space" => Some(' '),
                _ => None,
            }
        })
        .collect()
    }
}

struct Shown {
    connection: RustConnection,
    window: Window,
    pen: Gcontext,
    colour: u32,
    delete: Atom,
    keysyms: GetKeyboardMappingReply,
    recorded: Arc<Mutex<Vec<String>>>,
}

impl Shown {
    fn new(
        connection: RustConnection,
        screen: usize,
        title: &str,
        [width, height]: [u16; 2],
        recorded: Arc<Mutex<Vec<String>>>,
    ) -> Self {
        let screen = &connection.setup().roots[screen];
        let (root, visual, depth) = (screen.root, screen.root_visual, screen.root_depth);
        let (window, pen) = (connection.generate_id().unwrap(), connection.generate_id().unwrap());
        let mask = EventMask::KEY_PRESS
            | EventMask::KEY_RELEASE
            | EventMask::BUTTON_PRESS
            | EventMask::BUTTON_RELEASE
            | EventMask::POINTER_MOTION
            | EventMask::EXPOSURE;
        let aux = CreateWindowAux::new().event_mask(mask);
        connection
            .create_window(
                depth,
                window,
                root,
                0,
                0,
                width,
                height,
                0,
                WindowClass::INPUT_OUTPUT,
                visual,
                &aux,
            )
            .unwrap();
        let (property, string) = (AtomEnum::WM_NAME, AtomEnum::STRING);
        connection.change_property8(PropMode::REPLACE, window, property, string, title.as_bytes()).unwrap();
        connection.create_gc(pen, window, &CreateGCAux::new()).unwrap();
        connection.map_window(window).unwrap();
        let delete = connection.intern_atom(false, b"WM_DELETE_WINDOW").unwrap().reply().unwrap().atom;
        let (first, last) = (connection.setup().min_keycode, connection.setup().max_keycode);
        let keysyms = connection.get_keyboard_mapping(first, last - first + 1).unwrap().reply().unwrap();
        Self { connection, window, pen, colour: 0xff_0000, delete, keysyms, recorded }
    }

    /// Returns whether there is more to come: false once the window is closed or the server gone.
    fn handle_one(&mut self) -> bool {
        let Ok(event) = self.connection.wait_for_event() else { return false };
        let what = match event {
            Event::KeyPress(event) => format!("key {}", self.key(event)),
            Event::KeyRelease(event) => format!("released {}", self.key(event)),
            Event::MotionNotify(event) => format!("moved to {}, {}", event.event_x, event.event_y),
            Event::ButtonPress(event) => {
                self.colour = 0x00_ff00;
                self.paint();
                format!("button {} at {}, {}", event.detail, event.event_x, event.event_y)
            }
            Event::ButtonRelease(event) => {
                format!("button {} released at {}, {}", event.detail, event.event_x, event.event_y)
            }
            Event::ClientMessage(event) if event.data.as_data32()[0] == self.delete => {
                self.connection.destroy_window(self.window).unwrap();
                self.connection.sync().unwrap();
                "closed".to_owned()
            }
            _ => {
                self.paint();
                return true;
            }
        };
        let more = what != "closed";
        self.recorded.lock().unwrap().push(what);
        more
    }

    /// The name of the key under the modifiers that were held before it, and these.
    fn key(&self, event: KeyPressEvent) -> String {
        let held = |mask: KeyButMask| event.state.contains(mask);
        let first = self.connection.setup().min_keycode;
        let keysym = xkeysym::keysym(
            event.detail.into(),
            held(KeyButMask::SHIFT).into(),
            first.into(),
            self.keysyms.keysyms_per_keycode,
            &self.keysyms.keysyms,
        );
        let keysym = keysym.unwrap_or(Keysym::NoSymbol);
        let mut name = match keysym.key_char() {
            Some(' ') => "space".to_owned(),
            Some(character) if !character.is_control() => character.to_string(),
            _ => keysym.name().unwrap_or("nothing").trim_start_matches("XK_").to_owned(),
        };
        for (mask, modifier) in [(KeyButMask::CONTROL, " ctrl"), (KeyButMask::SHIFT, " shift")] {
            name.push_str(if held(mask) { modifier } else { "" });
        }
        name
    }

    /// Everything in the colour, and a blue corner of 10 pixels.
    fn paint(&self) {
        let all = Rectangle { x: 0, y: 0, width: 2000, height: 2000 };
        let corner = Rectangle { width: 10, height: 10, ..all };
        for (colour, area) in [(self.colour, all), (0x00_00ff, corner)] {
            self.connection.change_gc(self.pen, &ChangeGCAux::new().foreground(colour)).unwrap();
            self.connection.poly_fill_rectangle(self.window, self.pen, &[area]).unwrap();
        }
        self.connection.flush().unwrap();
    }
}
