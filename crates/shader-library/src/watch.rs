//! Reports which files changed, without waiting.

use crate::files::files_under;
use notify_debouncer_full::notify::event::ModifyKind;
use notify_debouncer_full::notify::{self, EventKind, RecommendedWatcher, RecursiveMode};
use notify_debouncer_full::{DebounceEventResult, Debouncer, RecommendedCache, new_debouncer};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Long enough for an editor to write a file and rename it over the old one, short enough not to be felt.
const QUIET: Duration = Duration::from_millis(30);

/// Longer than any event is held back.
const SETTLED: Duration = Duration::from_secs(1);

/// Watches folders, with all that is in them.
pub struct Watcher {
    /// Kept because watching ends when it is dropped.
    _debouncer: Debouncer<RecommendedWatcher, RecommendedCache>,
    events: Receiver<DebounceEventResult>,
    roots: Vec<PathBuf>,
    /// Files that were found in new folders, and when. One that is removed before its own event is due has no event.
    found: Vec<(PathBuf, Instant)>,
}

/// A folder that cannot be watched.
#[derive(Debug, thiserror::Error)]
#[error("cannot watch `{}`", .path.display())]
pub struct WatchError {
    /// The folder.
    pub path: PathBuf,
    /// Why not.
    pub source: notify::Error,
}

impl Watcher {
    /// Watches `roots`, from now on.
    ///
    /// # Errors
    /// Where a root does not exist, or the system allows no more watches.
    pub fn new<P: AsRef<Path>>(roots: &[P]) -> Result<Self, WatchError> {
        let (sender, events) = channel();
        let roots: Vec<PathBuf> = roots.iter().map(|root| root.as_ref().to_owned()).collect();
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |source| WatchError { path, source }
        };
        // The receiver is gone only when the watcher is being dropped.
        let handler = move |result| drop(sender.send(result));
        let first = roots.first().map_or(Path::new(""), PathBuf::as_path);
        let mut debouncer = new_debouncer(QUIET, None, handler).map_err(failed(first))?;
        for root in &roots {
            debouncer.watch(root, RecursiveMode::Recursive).map_err(failed(root))?;
        }
        Ok(Watcher { _debouncer: debouncer, events, roots, found: Vec::new() })
    }

    /// Returns the files that were written, made, renamed (both names) or removed since the last call, each path
    /// beginning with its root as it was given. Never waits. Where the system lost track, all files there are.
    pub fn changed(&mut self) -> BTreeSet<PathBuf> {
        let mut changed = BTreeSet::new();
        for result in self.events.try_iter() {
            let events = match result {
                Ok(events) => events,
                Err(errors) => {
                    for error in errors {
                        tracing::warn!(%error, "watching files");
                    }
                    continue;
                }
            };
            for event in events {
                if event.need_rescan() {
                    changed.extend(self.roots.iter().flat_map(|root| files_under(root)));
                }
                let kind = event.kind;
                for path in event.event.paths {
                    match kind {
                        EventKind::Access(_) => {}
                        // A folder that is new here may have been filled before it was watched.
                        EventKind::Create(_) | EventKind::Modify(ModifyKind::Name(_)) if path.is_dir() => {
                            let files = files_under(&path);
                            self.found.extend(files.iter().map(|file| (file.clone(), Instant::now())));
                            changed.extend(files);
                        }
                        _ if path.is_dir() => {}
                        _ => {
                            changed.insert(path);
                        }
                    }
                }
            }
        }
        self.found.retain(|(file, at)| {
            let exists = file.exists();
            if !exists {
                changed.insert(file.clone());
            }
            exists && at.elapsed() < SETTLED
        });
        changed
    }
}
