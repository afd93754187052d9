//! Sees to it that there is a browser for the tests of reports.

use crate::packages::{Consent, has_apt, install, os_release};
use anyhow::Result;

const QUESTION: &str =
    "The reports of studies are tested in a browser, and there is none. Install Chromium (by apt-get)?";

/// Names under which Chromium goes; as the test of the report looks for it.
const NAMES: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// Installs Chromium where there is no browser and that is agreed to. Without one the tests that need it say so and
/// do nothing, so that it cannot be had is no failure.
pub fn ensure(consent: Consent) -> Result<()> {
    if is_there() || !has_apt(&os_release()) || !consent.to(QUESTION)? {
        return Ok(());
    }
    if let Err(error) = install("chromium") {
        eprintln!("warning: {error:#}");
    }
    Ok(())
}

fn is_there() -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::var_os("CHROME").is_some()
        || std::env::split_paths(&path).any(|folder| NAMES.iter().any(|name| folder.join(name).is_file()))
}
