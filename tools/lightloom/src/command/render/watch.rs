//! Renders again at every save.

use crate::output::stderr;
use anyhow::{Context as _, Result};
use renderer::{Reload, Renderer};
use shader_library::Watcher;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The interval at which files are polled, too short to be noticed.
const INTERVAL: Duration = Duration::from_millis(50);

/// Calls `render` whenever files of the pipeline, its shaders or the scene have changed and are valid, until Ctrl-C. Errors
/// are printed, and the last good state stays.
pub(super) fn watch(
    renderer: &mut Renderer,
    mut render: impl FnMut(&mut Renderer) -> Result<()>,
) -> Result<()> {
    let ended = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&ended);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).context("Ctrl-C cannot be taken")?;
    let mut folders = renderer.watched_folders();
    let mut watcher = Watcher::new(&folders)?;
    stderr!("watching; Ctrl-C ends it");
    while !ended.load(Ordering::Relaxed) {
        std::thread::sleep(INTERVAL);
        let changed = watcher.changed();
        if changed.is_empty() {
            continue;
        }
        match renderer.reload(&changed) {
            Reload::Nothing => {}
            Reload::Done(_) => {
                if let Err(error) = render(renderer) {
                    stderr!("error: {error:#}");
                }
            }
            Reload::Failed(error) => stderr!("{error}"),
        }
        // Another text may take files of other folders.
        let now = renderer.watched_folders();
        if now != folders {
            watcher = Watcher::new(&now)?;
            folders = now;
        }
    }
    Ok(())
}
