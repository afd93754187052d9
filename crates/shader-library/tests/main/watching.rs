//! Saves as editors make them.

use shader_library::Watcher;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Returns what changes until `wanted` has, or until it should long have.
fn changes_until(watcher: &mut Watcher, wanted: &Path) -> BTreeSet<PathBuf> {
    let deadline = Instant::now() + Duration::from_secs(300);
    let mut changed = BTreeSet::new();
    while !changed.contains(wanted) && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(5));
        changed.extend(watcher.changed());
    }
    assert!(changed.contains(wanted), "{} in {changed:?}", wanted.display());
    changed
}

#[test]
fn every_way_to_save_is_seen() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::create_dir(root.join("deep")).unwrap();
    let (plain, deep) = (root.join("plain.wgsl"), root.join("deep/deep.wgsl"));
    fs::write(&plain, "1").unwrap();
    fs::write(&deep, "1").unwrap();
    let mut watcher = Watcher::new(&[root]).unwrap();
    assert!(watcher.changed().is_empty());

    fs::write(&plain, "2").unwrap();
    let changed = changes_until(&mut watcher, &plain);
    assert!(!changed.contains(&deep));

    // As most editors save: a new file renamed over the old one.
    let temporary = root.join("deep/.deep.wgsl.swp");
    fs::write(&temporary, "2").unwrap();
    fs::rename(&temporary, &deep).unwrap();
    let changed = changes_until(&mut watcher, &deep);
    assert!(!changed.contains(&root.join("deep")), "folders are not files: {changed:?}");

    // As others do: the old file renamed away, a new one written.
    fs::rename(&plain, root.join("plain.wgsl~")).unwrap();
    fs::write(&plain, "3").unwrap();
    changes_until(&mut watcher, &plain);

    let made = root.join("new/new.wgsl");
    fs::create_dir(root.join("new")).unwrap();
    fs::write(&made, "1").unwrap();
    changes_until(&mut watcher, &made);

    fs::remove_file(&made).unwrap();
    changes_until(&mut watcher, &made);
}

#[test]
fn many_quick_saves_end_with_the_last() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.ron");
    fs::write(&file, "").unwrap();
    let mut watcher = Watcher::new(&[folder.path()]).unwrap();
    for i in 0..50 {
        fs::write(&file, i.to_string()).unwrap();
    }
    changes_until(&mut watcher, &file);
    assert_eq!(fs::read_to_string(&file).unwrap(), "49");
}

#[test]
fn a_folder_that_is_not_there_is_an_error() {
    let error = Watcher::new(&["/no/such/folder"]).err().expect("no such folder");
    assert_eq!(error.to_string(), "cannot watch `/no/such/folder`");
}
