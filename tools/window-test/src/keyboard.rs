//! Which keycodes give a character or a key: the mapping of the server's keyboard, read backwards.

use crate::Error;
use x11rb::connection::Connection as _;
use x11rb::protocol::xproto::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;
use xkeysym::Keysym;

/// Keys that are not a character. Letters' case does not matter.
const NAMED: [(&str, Keysym); 33] = [
    ("alt", Keysym::Alt_L),
    ("backspace", Keysym::BackSpace),
    ("ctrl", Keysym::Control_L),
    ("delete", Keysym::Delete),
    ("down", Keysym::Down),
    ("end", Keysym::End),
    ("enter", Keysym::Return),
    ("escape", Keysym::Escape),
    ("f1", Keysym::F1),
    ("f2", Keysym::F2),
    ("f3", Keysym::F3),
    ("f4", Keysym::F4),
    ("f5", Keysym::F5),
    ("f6", Keysym::F6),
    ("f7", Keysym::F7),
    ("f8", Keysym::F8),
    ("f9", Keysym::F9),
    ("f10", Keysym::F10),
    ("f11", Keysym::F11),
    ("f12", Keysym::F12),
    ("home", Keysym::Home),
    ("insert", Keysym::Insert),
    ("left", Keysym::Left),
    ("minus", Keysym::minus),
    ("pagedown", Keysym::Page_Down),
    ("pageup", Keysym::Page_Up),
    ("plus", Keysym::plus),
    ("right", Keysym::Right),
    ("shift", Keysym::Shift_L),
    ("space", Keysym::space),
    ("super", Keysym::Super_L),
    ("tab", Keysym::Tab),
    ("up", Keysym::Up),
];

/// Returns the names of keys that are not one character.
pub(crate) fn names() -> String {
    NAMED.map(|(name, _)| name).join(", ")
}

/// A key, and whether Shift is held with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Key {
    pub(crate) code: u8,
    pub(crate) shift: bool,
}

/// The keysyms of each keycode.
#[derive(Debug)]
pub(crate) struct Keyboard {
    first: u8,
    per_code: usize,
    keysyms: Vec<u32>,
}

impl Keyboard {
    /// Reads the mapping of the server's keyboard.
    pub(crate) fn read(connection: &RustConnection) -> Result<Self, Error> {
        let (first, last) = (connection.setup().min_keycode, connection.setup().max_keycode);
        let mapping = connection.get_keyboard_mapping(first, last - first + 1)?.reply()?;
        Ok(Self { first, per_code: usize::from(mapping.keysyms_per_keycode), keysyms: mapping.keysyms })
    }

    /// Returns the keys of `ctrl+shift+p`, modifiers first. A character that needs Shift brings it.
    pub(crate) fn chord(&self, chord: &str) -> Result<Vec<u8>, Error> {
        let mut parts: Vec<&str> = chord.split('+').collect();
        let key = self.named(parts.pop().unwrap_or_default())?;
        let mut codes = Vec::with_capacity(parts.len() + 2);
        for modifier in parts {
            if !["ctrl", "shift", "alt", "super"].contains(&modifier.to_lowercase().as_str()) {
                return Err(Error::UnknownModifier { modifier: modifier.into(), chord: chord.into() });
            }
            codes.push(self.named(modifier)?.code);
        }
        let shift = self.shift()?;
        if key.shift && !codes.contains(&shift) {
            codes.push(shift);
        }
        codes.push(key.code);
        Ok(codes)
    }

    /// Returns the key of a character.
    pub(crate) fn character(&self, character: char) -> Result<Key, Error> {
        let keysym = match character {
            '\n' => Keysym::Return,
            '\t' => Keysym::Tab,
            character => Keysym::from_char(character),
        };
        self.find(keysym).ok_or_else(|| Error::UnknownKey { key: character.to_string() })
    }

    /// Returns the keycode of Shift.
    pub(crate) fn shift(&self) -> Result<u8, Error> {
        Ok(self.named("shift")?.code)
    }

    /// Returns the key of a name or a character.
    fn named(&self, name: &str) -> Result<Key, Error> {
        let lower = name.to_lowercase();
        let named = NAMED.iter().find(|(known, _)| *known == lower).map(|&(_, keysym)| keysym);
        let mut characters = name.chars();
        let unknown = || Error::UnknownKey { key: name.into() };
        match (named, characters.next(), characters.next()) {
            (Some(keysym), ..) => self.find(keysym).ok_or_else(unknown),
            (None, Some(character), None) => self.character(character),
            _ => Err(unknown()),
        }
    }

    /// Looks in the first two columns, without and with Shift, where the keys of one hand are.
    fn find(&self, keysym: Keysym) -> Option<Key> {
        let rows = || self.keysyms.chunks_exact(self.per_code.max(1)).zip(self.first..=u8::MAX);
        let column = |shift: bool| {
            rows()
                .find(|(row, _)| row.get(usize::from(shift)) == Some(&keysym.raw()))
                .map(|(_, code)| Key { code, shift })
        };
        column(false).or_else(|| column(true))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Keycodes 8..=12: Shift, Control, a and A, 1 and !, and a key with nothing on it.
    fn keyboard() -> Keyboard {
        let shift = Keysym::Shift_L.raw();
        let keysyms = vec![shift, 0, Keysym::Control_L.raw(), 0, 0x61, 0x41, 0x31, 0x21, 0, 0];
        Keyboard { first: 8, per_code: 2, keysyms }
    }

    #[test]
    fn a_character_of_the_second_column_needs_shift() {
        assert_eq!(keyboard().character('a').unwrap(), Key { code: 10, shift: false });
        assert_eq!(keyboard().character('!').unwrap(), Key { code: 11, shift: true });
    }

    #[test]
    fn a_chord_holds_its_modifiers_and_shift_once() {
        assert_eq!(keyboard().chord("ctrl+a").unwrap(), [9, 10]);
        assert_eq!(keyboard().chord("A").unwrap(), [8, 10]);
        assert_eq!(keyboard().chord("Shift+A").unwrap(), [8, 10]);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let message = |chord: &str| keyboard().chord(chord).unwrap_err().to_string();
        assert!(
            message("hyper+a").starts_with("`hyper` in `hyper+a` is not a modifier"),
            "{}",
            message("hyper+a")
        );
        for key in ["", "f13", "ctrl+", "q"] {
            assert!(message(key).starts_with("the keyboard has no key `"), "{}", message(key));
        }
    }
}
