//! Files that changed, gathered until they are quiet.

use shader_library::{Watcher, files_under};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// The time without changes after which files are read: a checkout of a hundred files is one reload.
const QUIET: Duration = Duration::from_millis(12);

/// The same after more than [`MANY`] changes: somebody checks out a branch.
const QUIET_OF_MANY: Duration = Duration::from_millis(150);

/// The number of files that an editor saves at once.
const MANY: usize = 4;

/// The longest time for which files that change all the time are waited for.
const PATIENCE: Duration = Duration::from_secs(10);

/// Watches the files of a session.
pub(super) struct Files {
    folders: Vec<PathBuf>,
    watcher: Option<Watcher>,
    /// The watcher before, and the time of its replacement: changes that it has not reported yet would be lost with it.
    before: Option<(Watcher, Instant)>,
    /// The time of the last request for changes. A file that is read later may be written before its folder is watched.
    asked: SystemTime,
    /// Files that were written before their folder was watched, and have not been reported.
    missed: BTreeSet<PathBuf>,
}

/// The greatest difference by which the times of a file system are behind the clock.
const COARSE: Duration = Duration::from_millis(20);

/// Longer than a watcher holds a change back.
const SETTLED: Duration = Duration::from_millis(300);

/// Git's folder for a work tree that begins here: `.git`, or what the file of that name says.
fn git_folder(root: &Path) -> Option<PathBuf> {
    let git = root.join(".git");
    if git.is_dir() {
        return Some(git);
    }
    let text = std::fs::read_to_string(&git).ok()?;
    Some(root.join(text.strip_prefix("gitdir:")?.trim()))
}

/// When a file was written, as far as the system says.
fn written(file: &Path) -> Option<SystemTime> {
    std::fs::metadata(file).and_then(|data| data.modified()).ok()
}

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
        Files {
            folders: Vec::new(),
            watcher: None,
            before: None,
            asked: SystemTime::now(),
            missed: BTreeSet::new(),
        }
    }

    /// Watches these folders from now on; what is wrong with that is returned. What was written in a new one since changes
    /// were last asked for counts as changed: it may have been read before.
    pub(super) fn watch(&mut self, mut folders: Vec<PathBuf>) -> Result<(), String> {
        folders.sort();
        folders.dedup();
        if folders == self.folders {
            return Ok(());
        }
        let watcher = Watcher::new(&folders).map_err(|error| format!("{error}: {}", error.source))?;
        self.before = self.watcher.replace(watcher).map(|before| (before, Instant::now()));
        let since = self.asked - COARSE;
        let is_new = |file: &PathBuf| written(file).is_some_and(|written| written >= since);
        let unseen = folders.iter().filter(|folder| !self.folders.contains(folder));
        self.missed.extend(unseen.flat_map(|folder| files_under(folder)).filter(is_new));
        self.folders = folders;
        Ok(())
    }

    /// Whether git is about to write more files: it holds the lock of its index from the first to the last.
    fn git_writes(&self) -> bool {
        let locked =
            |folder: &PathBuf| folder.ancestors().find_map(git_folder).map(|git| git.join("index.lock"));
        self.folders.first().and_then(locked).is_some_and(|lock| lock.exists())
    }

    /// Returns what has changed since the last call, without waiting.
    fn changed(&mut self) -> BTreeSet<PathBuf> {
        self.asked = SystemTime::now();
        let watchers = self.watcher.iter_mut().chain(self.before.iter_mut().map(|(watcher, _)| watcher));
        let mut changed = std::mem::take(&mut self.missed);
        changed.extend(watchers.flat_map(Watcher::changed));
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
        let mut checkout = false;
        loop {
            // The last files are reported after git has ended.
            let locked = self.git_writes();
            checkout |= locked;
            std::thread::sleep(if checkout || files.len() > MANY { QUIET_OF_MANY } else { QUIET });
            let more = self.changed();
            let done = more.is_empty() && !locked && !self.git_writes();
            files.extend(more);
            if done || begun.elapsed() > PATIENCE {
                break;
            }
        }
        let at = files.iter().filter_map(|file| written(file)).max();
        Some(Saved { files, at })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Waits for a save; panics after some seconds.
    fn wait(files: &mut Files) -> Saved {
        let begun = Instant::now();
        loop {
            if let Some(saved) = files.saved() {
                return saved;
            }
            assert!(begun.elapsed() < Duration::from_secs(300), "no change was seen");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    #[test]
    fn a_checkout_is_one_change() {
        let root = tempfile::tempdir().unwrap();
        let (git, shaders) = (root.path().join(".git"), root.path().join("shaders"));
        std::fs::create_dir_all(&git).unwrap();
        std::fs::create_dir_all(&shaders).unwrap();
        let mut files = Files::new();
        files.watch(vec![shaders.clone()]).unwrap();
        let lock = git.join("index.lock");
        std::fs::write(&lock, "").unwrap();
        let (lock, folder) = (lock.clone(), shaders.clone());
        let checkout = std::thread::spawn(move || {
            for number in 0..12 {
                std::fs::write(folder.join(format!("{number}.wgsl")), "// text").unwrap();
                // Far longer than a single save is waited for.
                std::thread::sleep(Duration::from_millis(60));
            }
            std::fs::remove_file(lock).unwrap();
        });
        let saved = wait(&mut files);
        checkout.join().unwrap();
        assert_eq!(saved.files.len(), 12);
        assert!(saved.at.is_some());
        assert!(files.saved().is_none());
    }

    #[test]
    fn what_was_saved_while_other_folders_are_watched_is_not_lost() {
        let root = tempfile::tempdir().unwrap();
        let (a, b) = (root.path().join("a"), root.path().join("b"));
        std::fs::create_dir_all(&a).unwrap();
        std::fs::create_dir_all(&b).unwrap();
        let mut files = Files::new();
        files.watch(vec![a.clone()]).unwrap();
        std::fs::write(a.join("x"), "x").unwrap();
        files.watch(vec![a.clone(), b]).unwrap();
        assert!(wait(&mut files).files.contains(&a.join("x")));
    }

    #[test]
    fn what_was_written_before_its_folder_is_watched_is_not_lost() {
        let root = tempfile::tempdir().unwrap();
        let (old, new) = (root.path().join("old"), root.path().join("new"));
        for file in [&old, &new] {
            std::fs::write(file, "x").unwrap();
        }
        let long_ago = SystemTime::now() - Duration::from_secs(60);
        std::fs::File::options().write(true).open(&old).unwrap().set_modified(long_ago).unwrap();
        let mut files = Files::new();
        std::fs::write(&new, "y").unwrap();
        files.watch(vec![root.path().to_owned()]).unwrap();
        assert_eq!(files.saved().map(|saved| saved.files), Some(BTreeSet::from([new])));
        assert!(files.saved().is_none());
    }
}
