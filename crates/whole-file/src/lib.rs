//! Files that are whole or absent: written under another name in the same folder, and given their own once they are on
//! disk. Whoever reads a file while it is written, or after the program was killed, finds the one before or the new one.
//!
//! A file that a killed program left half written is removed by the next program of the same machine that writes into the
//! folder: a file that is being written is locked by its writer, and the system ends that lock with the process. On network
//! file systems (NFS) no lock is asked, since whoever asks may wait for ever for a lock manager that is not there; elsewhere a lock
//! may hold on one machine only. The name of an unfinished file has that of its machine. Those of others, and on a network file
//! system all, are removed after a day.
//!
//! `tempfile` names and replaces the files. The rest is ours, since crates for whole files (`atomic-write-file`,
//! `atomicwrites`) lack it: links are followed, devices and pipes are written to instead of replaced, read-only files
//! are refused, leftovers are removed, and another program can write the unfinished file by its path.

mod target;

use std::collections::HashSet;
use std::fs::{File, TryLockError};
use std::io::{self, Seek as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};
use std::time::Duration;
use target::Target;
use tempfile::NamedTempFile;

/// Beginning and end of the names of files that are being written.
const NAME: (&str, &str) = (".lightloom-", ".part");

/// The beginning of the names of those of this machine.
static OWN: LazyLock<String> = LazyLock::new(|| {
    let host = gethostname::gethostname().to_string_lossy().into_owned();
    let host = host.replace(|c: char| !c.is_ascii_alphanumeric(), "_");
    format!("{}{host}-", NAME.0)
});

/// The age from which an unfinished file about which no lock tells is one that was left. Clocks differ by less.
const LEFT: Duration = Duration::from_secs(24 * 60 * 60);

/// The number of times that a new file is made because another process took the last one for a leftover.
const TRIES: u32 = 16;

/// A file that is being written. Dropped before it is finished, it leaves nothing.
#[derive(Debug)]
pub struct Unfinished {
    written: Written,
    path: PathBuf,
}

/// The file that holds the bytes until they are whole.
#[derive(Debug)]
enum Written {
    /// A file beside the one that it becomes.
    Beside(NamedTempFile),
    /// A file without a name, whose bytes are sent to a device or pipe at the end: nothing can take the place of these.
    Elsewhere(File),
}

impl Unfinished {
    /// Begins a file that is to be at `path`. It gets the permissions of the file that it replaces; a new one may be read
    /// by anyone whom the umask lets. A link stays, and what it leads to is replaced. A device or pipe stays too, and
    /// is sent the bytes once they are all there. In the first call for a folder, what killed programs left there is
    /// removed.
    ///
    /// # Errors
    /// No file can be made in the folder, or `path` is a folder or a read-only file.
    pub fn of(path: &Path) -> io::Result<Unfinished> {
        let (path, permissions) = match target::of(path)? {
            Target::New(path) => (path, None),
            Target::File(path, permissions) => (path, Some(permissions)),
            Target::Device(path) => {
                return Ok(Unfinished { written: Written::Elsewhere(tempfile::tempfile()?), path });
            }
        };
        let folder = folder_of(&path);
        sweep_once(folder);
        let file = locked(folder)?;
        if let Some(permissions) = permissions {
            // Where a system does not allow it, the file is one that the umask lets others read.
            let _ = file.as_file().set_permissions(permissions);
        }
        Ok(Unfinished { written: Written::Beside(file), path })
    }

    /// Returns the file to write into.
    pub fn file(&self) -> &File {
        match &self.written {
            Written::Beside(file) => file.as_file(),
            Written::Elsewhere(file) => file,
        }
    }

    /// Returns the path of the file that is written into, for another program that writes it; `None` where it has none
    /// because it is for a device or pipe.
    pub fn beside(&self) -> Option<&Path> {
        match &self.written {
            Written::Beside(file) => Some(file.path()),
            Written::Elsewhere(_) => None,
        }
    }

    /// Gives the file its name, once it is on disk. A file of that name is replaced.
    ///
    /// # Errors
    /// The error of the system; nothing is changed then.
    pub fn finish(self) -> io::Result<()> {
        match self.written {
            Written::Beside(file) => {
                file.as_file().sync_all()?;
                file.persist(&self.path).map_err(|error| error.error)?;
                sync_folder(&self.path);
                Ok(())
            }
            Written::Elsewhere(mut file) => {
                file.rewind()?;
                io::copy(&mut file, &mut File::options().write(true).open(&self.path)?)?;
                Ok(())
            }
        }
    }

    /// Gives the file its name, once it is on disk, unless there is a file of that name.
    ///
    /// # Errors
    /// There is one; or the error of the system. Nothing is changed then.
    pub fn finish_new(self) -> io::Result<()> {
        let Written::Beside(file) = self.written else { return Err(io::ErrorKind::AlreadyExists.into()) };
        file.as_file().sync_all()?;
        file.persist_noclobber(&self.path).map_err(|error| error.error)?;
        sync_folder(&self.path);
        Ok(())
    }
}

/// Returns whether files in a folder may be locked: not on NFS, where whoever asks may wait for ever.
pub fn has_locks(folder: &Path) -> bool {
    #[cfg(target_os = "linux")]
    {
        // `NFS_SUPER_MAGIC` of linux/magic.h.
        const NFS: u64 = 0x6969;
        rustix::fs::statfs(folder).map_or(true, |system| system.f_type as u64 != NFS)
    }
    #[cfg(not(target_os = "linux"))]
    {
        let _ = folder;
        true
    }
}

/// Makes a file and locks it, where files may be locked.
fn locked(folder: &Path) -> io::Result<NamedTempFile> {
    let has_locks = has_locks(folder);
    for _ in 0..TRIES {
        let mut builder = tempfile::Builder::new();
        builder.prefix(OWN.as_str()).suffix(NAME.1);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = builder.tempfile_in(folder)?;
        if !has_locks {
            return Ok(file);
        }
        // Between its creation and its lock another process may have swept it away, or is about to. Where a system has no
        // locks, nothing is swept.
        match file.as_file().try_lock() {
            Err(TryLockError::WouldBlock) => {}
            Ok(()) if !file.path().exists() => {}
            Ok(()) | Err(TryLockError::Error(_)) => return Ok(file),
        }
    }
    Err(io::Error::other("other processes remove each file that is begun"))
}

/// Writes the names of a folder to disk, where the system lets a folder be opened for that.
fn sync_folder(path: &Path) {
    if cfg!(unix)
        && let Ok(folder) = File::open(folder_of(path))
    {
        // The file is whole and has its name; whether that name would outlast a power cut is not worth an error.
        let _ = folder.sync_all();
    }
}

/// Writes a file. One of that name is replaced once the new one is whole.
///
/// # Errors
/// The error of the system; the file before stays then.
pub fn write(path: &Path, bytes: impl AsRef<[u8]>) -> io::Result<()> {
    let part = Unfinished::of(path)?;
    part.file().write_all(bytes.as_ref())?;
    part.finish()
}

/// Writes a file that there is not yet.
///
/// # Errors
/// There is one of that name; or the error of the system.
pub fn write_new(path: &Path, bytes: impl AsRef<[u8]>) -> io::Result<()> {
    let part = Unfinished::of(path)?;
    part.file().write_all(bytes.as_ref())?;
    part.finish_new()
}

/// Removes the files that killed programs of this machine left half written in a folder, and those of others that are more
/// than a day old; on a network file system, all that are more than a day old.
pub fn sweep(folder: &Path) {
    sweep_by(folder, has_locks(folder));
}

/// Removes the files that killed programs left, by their locks if there are any.
fn sweep_by(folder: &Path, has_locks: bool) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if !(is_file && name.starts_with(NAME.0) && name.ends_with(NAME.1)) {
            continue;
        }
        let Ok(file) = File::options().write(true).open(entry.path()) else { continue };
        let age = || entry.metadata().ok()?.modified().ok()?.elapsed().ok();
        let is_told = has_locks && name.starts_with(OWN.as_str());
        if !is_told && age().is_none_or(|age| age < LEFT) {
            continue;
        }
        if !has_locks || file.try_lock().is_ok() {
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

/// Returns the folder of a file; the working folder for a bare name.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests;
