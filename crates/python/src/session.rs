//! What the renderers of a process share: files, and a device for each adapter.

use crate::error::raise;
use anyhow::{Result, bail};
use pyo3::prelude::*;
use renderer::{Assets, Catalog, Gpu};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// The process that opened the first device. A device does not survive `fork`: its driver's threads are not there.
static OWNER: OnceLock<u32> = OnceLock::new();

/// The devices, by the adapter that was asked for; never closed, since a process ends with them.
static DEVICES: Mutex<BTreeMap<Option<String>, Gpu>> = Mutex::new(BTreeMap::new());

/// Pipelines, shaders and scenes.
static CATALOG: Mutex<Option<Arc<Catalog>>> = Mutex::new(None);

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns whether this process was made by `fork` from one that had opened a device.
pub(crate) fn is_forked() -> bool {
    OWNER.get().is_some_and(|owner| *owner != std::process::id())
}

/// Refuses a process that was made by `fork` from one that had opened a device: it would wait for threads that it has not.
pub(crate) fn check_process() -> Result<()> {
    if is_forked() {
        bail!(
            "this process was forked from one that had opened a device, which does not survive that; start processes that \
             render by `multiprocessing.get_context(\"spawn\")`, or open the first renderer after the fork"
        );
    }
    Ok(())
}

/// Returns the device of an adapter, named by its place in [`adapters`] or a part of its name; the first where none is named.
/// All renderers on it share it, and the pipelines of their shaders.
pub(crate) fn device(adapter: Option<String>) -> Result<Gpu> {
    OWNER.get_or_init(std::process::id);
    check_process()?;
    let mut devices = lock(&DEVICES);
    // A device that is gone never comes back.
    if let Some(gpu) = devices.get(&adapter).filter(|gpu| gpu.check().is_ok()) {
        return Ok(gpu.clone());
    }
    let gpu = match &adapter {
        Some(wanted) => Gpu::open_adapter(wanted)?,
        None => Gpu::open()?,
    };
    Ok(devices.entry(adapter).insert_entry(gpu.with_shared_pipelines()).get().clone())
}

/// Returns pipelines, shaders and scenes: those of the tree around the working folder at the first use, or of the folder that
/// was set.
pub(crate) fn catalog() -> Arc<Catalog> {
    let mut catalog = lock(&CATALOG);
    let found = || std::env::current_dir().ok().and_then(|folder| Assets::find_root(&folder));
    Arc::clone(catalog.get_or_insert_with(|| with_root(found())))
}

/// Takes files from a folder first, and then those that are built in; `None` for the latter alone.
pub(crate) fn set_root(root: Option<PathBuf>) {
    *lock(&CATALOG) = Some(with_root(root));
}

fn with_root(root: Option<PathBuf>) -> Arc<Catalog> {
    Arc::new(Catalog::new(Assets::new(root)))
}

/// Returns the names of the adapters, with the one first that is taken where none is named.
#[pyfunction]
pub(crate) fn adapters(py: Python<'_>) -> PyResult<Vec<String>> {
    OWNER.get_or_init(std::process::id);
    check_process().map_err(|error| raise(py, &error))?;
    Ok(py.detach(Gpu::adapters).into_iter().map(|adapter| adapter.name).collect())
}
