//! Files that changed, gathered until they are quiet.

use shader_library::Watcher;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::{Duration, Instant, SystemTime};

/// How long no file may change before they are read: a checkout of a hundred files is one reload.
const QUIET: Duration = Duration::from_millis(12);

/// How long files that change all the time are waited for.
const PATIENCE: Duration = Duration::from_secs(2);

/// Watches the files of a session.
pub(super) struct Files {
    folders: Vec<PathBuf>,
    watcher: Option<Watcher>,
    /// The one before, and since when: what it has not told yet would be lost with it.
    before: Option<(Watcher, Instant)>,
}

/// Longer than a watcher holds a change back.
const SETTLED: Duration = Duration::from_millis(300);

/// Files that changed.
pub(super) struct Saved {
    /// Their paths.
    pub(super) files: BTreeSet<PathBuf>,
    /// When the last of them was written, as far as the system says.
    pub(super) at: Option<SystemTime>,
}

impl Files {
    /// Watches nothing yet.
    pub(super) fn new() -> Files {
        Files { folders: Vec::new(), watcher: None, before: None }
    }

    /// Watches these folders from now on; what is wrong with that is returned.
    pub(super) fn watch(&mut self, mut folders: Vec<PathBuf>) -> Result<(), String> {
        folders.sort();
        folders.dedup();
        if folders == self.folders {
            return Ok(());
        }
        let watcher = Watcher::new(&folders).map_err(|error| format!("{error}: {}", error.source))?;
        self.before = self.watcher.replace(watcher).map(|before| (before, Instant::now()));
        self.folders = folders;
        Ok(())
    }

    /// Returns what has changed since the last call, without waiting.
    fn changed(&mut self) -> BTreeSet<PathBuf> {
        let watchers = self.watcher.iter_mut().chain(self.before.iter_mut().map(|(watcher, _)| watcher));
        let changed = watchers.flat_map(Watcher::changed).collect();
        self.before.take_if(|(_, since)| since.elapsed() > SETTLED);
        changed
    }

    /// Returns what has changed since the last call; `None` where nothing has. Waits only for files that are still being
    /// written.
    pub(super) fn saved(&mut self) -> Option<Saved> {
        let mut files = self.changed();
        if files.is_empty() {
            return None;
        }
        let begun = Instant::now();
        loop {
            std::thread::sleep(QUIET);
            let more = self.changed();
            if more.is_empty() || begun.elapsed() > PATIENCE {
                files.extend(more);
                break;
            }
            files.extend(more);
        }
        let written = |file: &PathBuf| std::fs::metadata(file).and_then(|data| data.modified()).ok();
        let at = files.iter().filter_map(written).max();
        Some(Saved { files, at })
    }
}
