//! A bound on what a scene may become, which follows from the size of its files.

use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The bytes that files of any size may become: five million vertices, or sixteen textures of 2048 × 2048.
const FREE: u64 = 256 << 20;

/// The further bytes for each byte of the files. The best compression of a picture is 1000 : 1, and a mesh that is
/// placed a thousand times is a forest; a file of a few KB that asks for gigabytes is neither.
const PER_BYTE: u64 = 1024;

/// Counts the bytes that the files of a scene ask for, in lists of numbers, textures and placed meshes.
#[derive(Debug)]
pub(crate) struct Budget {
    files: Cell<u64>,
    most: Cell<u64>,
    taken: Cell<u64>,
    /// The files that were counted.
    seen: RefCell<BTreeSet<PathBuf>>,
}

impl Default for Budget {
    /// Creates the budget of a scene of which nothing has been read.
    fn default() -> Budget {
        Budget { files: Cell::new(0), most: Cell::new(FREE), taken: Cell::new(0), seen: RefCell::default() }
    }
}

impl Budget {
    /// Counts a file, once however often it is read.
    pub(crate) fn file(&self, path: &Path, bytes: usize) {
        let path = path.canonicalize().unwrap_or_else(|_| path.into());
        if self.seen.borrow_mut().insert(path) {
            self.text(bytes);
        }
    }

    /// Counts a text that was read.
    pub(crate) fn text(&self, bytes: usize) {
        self.files.set(self.files.get().saturating_add(bytes as u64));
        self.grant((bytes as u64).saturating_mul(PER_BYTE));
    }

    /// Allows further bytes, for geometry that the program generates.
    pub(crate) fn grant(&self, bytes: u64) {
        self.most.set(self.most.get().saturating_add(bytes));
    }

    /// Returns the bytes that were taken.
    #[cfg(test)]
    pub(crate) fn taken(&self) -> u64 {
        self.taken.get()
    }

    /// Counts `count` things of `size` bytes before they are allocated.
    ///
    /// # Errors
    /// Bytes beyond the bound: what the files ask for, and the bound.
    pub(crate) fn take(&self, count: usize, size: usize) -> Result<(), String> {
        let bytes = (count as u64).saturating_mul(size as u64);
        let taken = self.taken.get().saturating_add(bytes);
        if taken > self.most.get() {
            let mib = |bytes: u64| bytes.div_ceil(1 << 20);
            return Err(format!(
                "it asks for {} MiB; the {} KiB of files read so far may become {} MiB in all, of which {} are taken",
                mib(bytes),
                self.files.get().div_ceil(1 << 10),
                mib(self.most.get()),
                mib(self.taken.get()),
            ));
        }
        self.taken.set(taken);
        Ok(())
    }
}
