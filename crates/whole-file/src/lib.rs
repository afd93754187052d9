//! Files that are whole or absent: written under another name in the same folder, and given their own once they are on
//! disk. Whoever reads a file while it is written, or after the program was killed, finds the one before or the new one.
//!
//! What a killed program leaves half written is removed by the next that writes into the folder: a file that is being
//! written is locked by its writer, and the system ends that lock with the process.

use std::collections::HashSet;
use std::fs::{File, Permissions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use tempfile::NamedTempFile;

/// Beginning and end of the names of files that are being written.
const NAME: (&str, &str) = (".lightloom-", ".part");

/// A file that is being written. Dropped before it is finished, it leaves nothing.
#[derive(Debug)]
pub struct Part {
    file: NamedTempFile,
    path: PathBuf,
}

impl Part {
    /// Begins a file that is to be at `path`; anyone may read it whom the umask lets. In the first call for a folder, what
    /// killed programs left there is removed.
    ///
    /// # Errors
    /// Where no file can be made in the folder.
    pub fn of(path: &Path) -> io::Result<Part> {
        let folder = folder_of(path);
        sweep_once(folder);
        let mut builder = tempfile::Builder::new();
        builder.prefix(NAME.0).suffix(NAME.1);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = builder.tempfile_in(folder)?;
        // Where a system has no locks, what is left half written stays.
        let _ = file.as_file().try_lock();
        Ok(Part { file, path: path.to_owned() })
    }

    /// Returns the file to write into.
    pub fn file(&self) -> &File {
        self.file.as_file()
    }

    /// Gives the file other permissions than those of a new file.
    ///
    /// # Errors
    /// What the system says.
    pub fn set_permissions(&self, permissions: Permissions) -> io::Result<()> {
        self.file().set_permissions(permissions)
    }

    /// Gives the file its name, once it is on disk. A file of that name is replaced.
    ///
    /// # Errors
    /// What the system says; nothing is changed then.
    pub fn finish(self) -> io::Result<()> {
        self.file().sync_all()?;
        self.file.persist(&self.path).map_err(|error| error.error)?;
        Ok(())
    }

    /// Gives the file its name, once it is on disk, unless there is a file of that name.
    ///
    /// # Errors
    /// Where there is one, and what the system says; nothing is changed then.
    pub fn finish_new(self) -> io::Result<()> {
        self.file().sync_all()?;
        self.file.persist_noclobber(&self.path).map_err(|error| error.error)?;
        Ok(())
    }
}

/// Writes a file. One of that name is replaced once the new one is whole.
///
/// # Errors
/// What the system says; the file before stays then.
pub fn write(path: &Path, bytes: impl AsRef<[u8]>) -> io::Result<()> {
    let part = Part::of(path)?;
    part.file().write_all(bytes.as_ref())?;
    part.finish()
}

/// Writes a file that there is not yet.
///
/// # Errors
/// Where there is one of that name, and what the system says.
pub fn write_new(path: &Path, bytes: impl AsRef<[u8]>) -> io::Result<()> {
    let part = Part::of(path)?;
    part.file().write_all(bytes.as_ref())?;
    part.finish_new()
}

/// Removes what killed programs left half written in a folder.
pub fn sweep(folder: &Path) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if !(name.starts_with(NAME.0) && name.ends_with(NAME.1)) {
            continue;
        }
        let Ok(file) = File::options().write(true).open(entry.path()) else { continue };
        if file.try_lock().is_ok() {
            // A file that cannot be removed does no harm.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Sweeps a folder that this process has not written into before.
fn sweep_once(folder: &Path) {
    static SWEPT: Mutex<Option<HashSet<PathBuf>>> = Mutex::new(None);
    let Ok(folder) = folder.canonicalize() else { return };
    let mut swept = SWEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if swept.get_or_insert_with(HashSet::new).insert(folder.clone()) {
        sweep(&folder);
    }
}

/// The folder of a file; the working folder for a bare name.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_replaced_once_the_new_one_is_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write(&path, "before").unwrap();
        let part = Part::of(&path).unwrap();
        part.file().write_all(b"half").unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "before");
        drop(part);
        assert_eq!(names(folder.path()), ["a.txt"], "what was not finished leaves nothing");
        write(&path, "after").unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "after");
        assert!(write_new(&path, "never").is_err());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "after");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn what_a_killed_program_left_is_removed_and_what_is_being_written_is_not() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(".lightloom-killed.part"), "half").unwrap();
        std::fs::write(folder.path().join("notes.part"), "the user's").unwrap();
        let writing = Part::of(&folder.path().join("b.txt")).unwrap();
        assert_eq!(names(folder.path()).len(), 2, "what was left is gone: {:?}", names(folder.path()));
        sweep(folder.path());
        writing.file().write_all(b"whole").unwrap();
        writing.finish().unwrap();
        assert_eq!(names(folder.path()), ["b.txt", "notes.part"]);
    }

    #[test]
    fn a_folder_that_is_not_there_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        assert!(write(&folder.path().join("no/a.txt"), "").is_err());
    }
}
