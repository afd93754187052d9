//! What `lightloom --version` says: enough for a report of a fault.

use executor::Gpu;

/// Returns the version, the commit that a release was built from, the features, and the adapters of this machine.
pub(crate) fn long() -> String {
    let commit = option_env!("LIGHTLOOM_COMMIT").unwrap_or("no release");
    let features = [
        ("window", cfg!(feature = "window")),
        ("desktop", cfg!(feature = "desktop")),
        ("native-rays", cfg!(feature = "native-rays")),
        ("tracy", cfg!(feature = "tracy")),
    ];
    let with: Vec<&str> = features.iter().filter(|(_, is_on)| *is_on).map(|(name, _)| *name).collect();
    let adapters: Vec<String> = Gpu::adapters().iter().map(executor::describe).collect();
    let or_none = |list: Vec<String>| if list.is_empty() { "none".to_owned() } else { list.join("; ") };
    format!(
        "{}\ncommit: {commit}\nfeatures: {}\nadapters: {}",
        env!("CARGO_PKG_VERSION"),
        or_none(with.into_iter().map(str::to_owned).collect()),
        or_none(adapters)
    )
}
