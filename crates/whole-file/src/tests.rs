//! Files that are replaced, links, devices, and what programs leave.

use super::*;
use std::sync::atomic::{AtomicBool, Ordering};

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
    let part = Unfinished::of(&path).unwrap();
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

/// Each new file is made in the folder of the old one, so that its name is given in one step.
#[test]
fn a_reader_finds_a_whole_file_at_any_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("row.json");
    let rows = ["a", "b"].map(|letter| letter.repeat(100_000));
    write(&path, &rows[0]).unwrap();
    assert_eq!(Unfinished::of(&path).unwrap().beside().unwrap().parent(), Some(folder.path()));
    let ended = AtomicBool::new(false);
    let reads = std::thread::scope(|scope| {
        let reader = scope.spawn(|| {
            let mut reads = 0;
            while !ended.load(Ordering::Relaxed) || reads < 100 {
                let row = std::fs::read_to_string(&path).unwrap();
                assert!(rows.contains(&row), "{} bytes, from {:?}", row.len(), row.get(..1));
                reads += 1;
            }
            reads
        });
        let written: io::Result<()> = (0..200).try_for_each(|count| write(&path, &rows[count % 2]));
        ended.store(true, Ordering::Relaxed);
        written.unwrap();
        reader.join().unwrap()
    });
    assert!(reads >= 100);
    assert_eq!(names(folder.path()), ["row.json"]);
}

#[test]
fn what_a_killed_program_left_is_removed_and_what_is_being_written_is_not() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(format!("{}killed.part", *OWN)), "half").unwrap();
    std::fs::write(folder.path().join("notes.part"), "the user's").unwrap();
    let writing = Unfinished::of(&folder.path().join("b.txt")).unwrap();
    assert_eq!(names(folder.path()).len(), 2, "what was left is gone: {:?}", names(folder.path()));
    sweep(folder.path());
    writing.file().write_all(b"whole").unwrap();
    writing.finish().unwrap();
    assert_eq!(names(folder.path()), ["b.txt", "notes.part"]);
}

/// Where no lock may be asked, this machine may be writing its file, too.
#[test]
fn without_locks_only_what_is_old_is_removed() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(format!("{}{name}.part", *OWN));
    for name in ["new", "old"] {
        std::fs::write(at(name), "half").unwrap();
    }
    let old = File::options().write(true).open(at("old")).unwrap();
    old.set_modified(std::time::SystemTime::now() - 2 * LEFT).unwrap();
    sweep_by(folder.path(), false);
    assert_eq!([at("new"), at("old")].map(|path| path.exists()), [true, false]);
    assert!(has_locks(folder.path()), "the folder of temporary files is on no network");
}

/// Between machines a lock may mean nothing: another machine may be writing its file.
#[test]
fn what_another_machine_writes_is_removed_once_it_is_old() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for name in [".lightloom-elsewhere-new.part", ".lightloom-elsewhere-old.part"] {
        std::fs::write(at(name), "half").unwrap();
    }
    let old = File::options().write(true).open(at(".lightloom-elsewhere-old.part")).unwrap();
    old.set_modified(std::time::SystemTime::now() - 2 * LEFT).unwrap();
    sweep(folder.path());
    assert_eq!(names(folder.path()), [".lightloom-elsewhere-new.part"]);
}

#[test]
fn a_folder_that_is_not_there_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    assert!(write(&folder.path().join("no/a.txt"), "").is_err());
}

/// Programs that begin at the same time in one folder take nothing from each other.
#[test]
fn what_is_just_begun_is_not_taken_for_what_was_left() {
    let folder = tempfile::tempdir().unwrap();
    let ended = AtomicBool::new(false);
    let begun = std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while !ended.load(Ordering::Relaxed) {
                    sweep(folder.path());
                }
            });
        }
        let begun: io::Result<Vec<_>> = (0..1000).map(|_| locked(folder.path())).collect();
        ended.store(true, Ordering::Relaxed);
        begun.unwrap()
    });
    let lost = begun.iter().filter(|file| !file.path().exists()).count();
    assert_eq!(lost, 0, "of {} files", begun.len());
}

#[test]
fn a_folder_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    std::fs::create_dir(&path).unwrap();
    assert_eq!(write(&path, "text").unwrap_err().kind(), io::ErrorKind::IsADirectory);
    assert_eq!(names(folder.path()), ["a"]);
}

#[test]
fn a_read_only_file_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    write(&path, "kept").unwrap();
    let mut permissions = std::fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&path, permissions).unwrap();
    assert_eq!(write(&path, "new").unwrap_err().kind(), io::ErrorKind::PermissionDenied);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "kept");
    assert_eq!(names(folder.path()), ["a.txt"]);
}

#[cfg(unix)]
mod unix {
    use super::*;
    use std::os::unix::fs::{FileTypeExt as _, PermissionsExt as _, symlink};
    use std::process::Command;

    fn pipe(path: &Path) {
        assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
    }

    fn mode(path: &Path) -> u32 {
        std::fs::metadata(path).unwrap().permissions().mode() & 0o777
    }

    #[test]
    fn a_file_keeps_its_permissions() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write(&path, "before").unwrap();
        for wanted in [0o600, 0o666] {
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(wanted)).unwrap();
            write(&path, "after").unwrap();
            assert_eq!(mode(&path), wanted);
        }
    }

    #[test]
    fn what_a_link_leads_to_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("deep")).unwrap();
        symlink("deep/a.txt", at("link")).unwrap();
        symlink("link", at("link to a link")).unwrap();
        // At first it leads to nothing.
        for text in ["first", "second"] {
            write(&at("link to a link"), text).unwrap();
            assert_eq!(std::fs::read_to_string(at("deep/a.txt")).unwrap(), text);
        }
        assert_eq!(names(folder.path()), ["deep", "link", "link to a link"]);
        assert!(at("link").is_symlink() && at("link to a link").is_symlink());
        assert!(write_new(&at("link"), "never").is_err());
        symlink("circle", at("circle")).unwrap();
        assert!(write(&at("circle"), "never").unwrap_err().to_string().contains("circle"));
    }

    /// With the rights of the superuser, a new file could take the place of `/dev/null`.
    #[test]
    fn a_pipe_or_device_is_written_to_and_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pipe");
        pipe(&path);
        let reader = std::thread::spawn({
            let path = path.clone();
            move || std::fs::read_to_string(path).unwrap()
        });
        let part = Unfinished::of(&path).unwrap();
        // Pictures are not written from their beginning to their end.
        let mut file = part.file();
        file.write_all(b"wait").unwrap();
        file.rewind().unwrap();
        file.write_all(b"text").unwrap();
        part.finish().unwrap();
        assert_eq!(reader.join().unwrap(), "text");
        assert!(write_new(&path, "never").is_err());
        assert!(std::fs::symlink_metadata(&path).unwrap().file_type().is_fifo());
        assert_eq!(names(folder.path()), ["pipe"]);

        let null = folder.path().join("null");
        symlink("/dev/null", &null).unwrap();
        write(&null, "text").unwrap();
        assert!(null.is_symlink() && std::fs::metadata(&null).unwrap().file_type().is_char_device());
    }

    /// Nobody reads from it, so that whoever opens it waits for ever.
    #[test]
    fn a_pipe_by_the_name_of_what_was_left_is_no_file() {
        let folder = tempfile::tempdir().unwrap();
        pipe(&folder.path().join(".lightloom-pipe.part"));
        write(&folder.path().join("a.txt"), "text").unwrap();
        assert_eq!(names(folder.path()), [".lightloom-pipe.part", "a.txt"]);
    }
}
