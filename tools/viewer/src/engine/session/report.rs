//! Reports errors and messages in the window and in the terminal.

use super::Session;
use crate::engine::Publisher;
use crate::engine::model::{Published, Trouble};
use renderer::RenderError;
use std::time::Instant;

impl Session {
    pub(super) fn trouble(&self, of: &'static str, error: &RenderError, publisher: &Publisher) {
        self.trouble_until(of, error, None, publisher);
    }

    pub(super) fn trouble_until(
        &self,
        of: &'static str,
        error: &RenderError,
        until: Option<Instant>,
        publisher: &Publisher,
    ) {
        let text = error.to_string();
        let mut again = false;
        publisher.with(|published| {
            let same = |trouble: &&Trouble| trouble.of == of && trouble.text == text;
            again = published.troubles.iter().find(same).is_some_and(Trouble::stands);
            if again {
                return;
            }
            published.troubles.retain(|trouble| trouble.of != of);
            published.troubles.push(Trouble { of, text: text.clone(), until });
            published.say(text.clone(), true);
        });
        // An error of every frame is reported once.
        if !again {
            crate::terminal::complain(format_args!("{of}: {text}"));
        }
    }

    pub(super) fn clear(&self, of: &str, publisher: &Publisher) {
        publisher.with(|published| published.troubles.retain(|trouble| trouble.of != of));
    }
}

/// Adds a message, in the terminal too if it is an error.
pub(super) fn report(publisher: &Publisher, text: &str, error: bool) {
    if error {
        crate::terminal::complain(text);
    }
    publisher.with(|published: &mut Published| published.say(text.to_owned(), error));
}
