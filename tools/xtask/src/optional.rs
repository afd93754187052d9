//! Programs that tests of the whole program drive, and skip where they are missing: a browser, an X server.

use crate::packages::{Consent, Need, missing};

/// Programs and libraries of the system that some tests drive.
#[derive(Clone, Copy, Debug)]
struct Optional {
    is_there: fn() -> bool,
    need: Need,
}

static OPTIONALS: &[Optional] = &[
    Optional {
        is_there: has_browser,
        need: Need {
            question: "The reports of studies are tested in a browser, and there is none. Install Chromium (by apt-get)?",
            packages: &["chromium"],
        },
    },
    Optional {
        is_there: has_window,
        need: Need {
            question: "The window is tested on an X server without a screen. Install Xvfb, xdotool and the libraries of a \
                       window, of which some are missing (by apt-get)?",
            packages: WINDOW,
        },
    },
];

/// Names under which Chromium goes; as the test of the report looks for it.
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// The server, what drives a window on it, and what winit loads when a window is opened; each brings the others that it
/// needs.
const WINDOW: &[&str] = &["xvfb", "xdotool", "libx11-xcb1", "libxcursor1", "libxi6", "libxkbcommon-x11-0"];

/// Installs what is missing and agreed to. The tests that need it say so and do nothing without, so that it cannot be
/// had is no failure.
pub fn ensure(consent: Consent) {
    for optional in OPTIONALS {
        if !(optional.is_there)()
            && let Err(error) = optional.need.install(consent)
        {
            eprintln!("warning: {error:#}");
        }
    }
}

fn has_browser() -> bool {
    std::env::var_os("CHROME").is_some() || BROWSERS.iter().any(|name| is_on_path(name))
}

/// Where there is no apt-get no library is looked for: nothing would be installed.
fn has_window() -> bool {
    ["Xvfb", "xdotool"].into_iter().all(is_on_path) && missing(WINDOW).is_empty()
}

fn is_on_path(program: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(program).is_file())
}
