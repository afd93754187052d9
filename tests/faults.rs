//! Faults of the system: a program that is killed, a disk that is full, files that cannot be replaced. What was finished
//! stays, what is half written never passes for whole, and the exit code and the message are right.

use crate::adapter::{gpu, root};
use crate::program::{Done, Folder, QUICK, command, wait_for};
use metrics::Image;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, SystemTime};

fn lightloom() -> Command {
    command(&root())
}

/// The names in a folder, in order.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn is_part(name: &str) -> bool {
    name.starts_with(".lightloom-") && name.ends_with(".part")
}

/// The pictures of a folder, each of which can be read.
fn pictures(folder: &Path) -> Vec<PathBuf> {
    let names = names(folder).into_iter().filter(|name| !is_part(name));
    let paths: Vec<PathBuf> = names.map(|name| folder.join(name)).collect();
    for path in &paths {
        Image::read(path).unwrap_or_else(|error| panic!("{error}"));
    }
    paths
}

#[test]
fn pictures_of_a_killed_program_are_whole_and_what_is_half_is_cleared() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    let pattern = folder.at("####.exr");
    let render = |frames: &str| {
        let mut command = lightloom();
        command.args(["render", "ism", "cornell-box", "--frames", frames, "-o"]).arg(&pattern).args(QUICK);
        command
    };
    // After the first picture of each, at whatever moment: over those of the one before.
    for _ in 0..3 {
        let first = pattern.with_file_name("0000.exr");
        let modified = || first.metadata().ok().map(|about| about.modified().unwrap());
        let before = modified();
        let mut child = render("100000").stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        wait_for(&mut child, "picture", || modified() != before);
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(!pictures(&folder).is_empty());
    }
    // As a program on another machine left it, which was killed in the middle of a file two days ago.
    let part = folder.at(".lightloom-killed.part");
    std::fs::write(&part, "half").unwrap();
    let days = Duration::from_secs(2 * 24 * 3600);
    File::options().write(true).open(&part).unwrap().set_modified(SystemTime::now() - days).unwrap();
    Done::of(&mut render("1")).success();
    assert!(!names(&folder).iter().any(|name| is_part(name)), "{:?}", names(&folder));
}

#[test]
fn a_trace_of_a_killed_program_does_not_pass_for_whole() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    let (trace, picture) = (folder.at("trace.json"), folder.at("0000.png"));
    let mut command = lightloom();
    command.args(["render", "ism", "cornell-box", "--frames", "100000", "-o"]);
    command.arg(folder.at("####.png")).args(QUICK).arg("--trace").arg(&trace);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    wait_for(&mut child, "picture", || picture.exists());
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!trace.exists());
    Done::of(lightloom().arg("scenes").arg("--trace").arg(&trace)).success();
    let whole = folder.read("trace.json");
    assert!(serde_json::from_str::<Vec<serde_json::Value>>(&whole).is_ok(), "{whole}");
    assert!(!names(&folder).iter().any(|name| is_part(name)), "{:?}", names(&folder));
}

/// Limits the size of files to 4 KiB, which stands for a full disk and needs no rights.
#[cfg(target_os = "linux")]
fn limited(arguments: &[&str]) -> Done {
    // Of 512 or of 1024 bytes by the shell.
    let script = "ulimit -f 4; exec \"$0\" \"$@\"";
    let mut command = Command::new("sh");
    command.args(["-c", script, env!("CARGO_BIN_EXE_lightloom")]).args(arguments);
    Done::of(command.current_dir(root()))
}

/// The file before stays, nothing half is left, and the message names the file.
#[cfg(target_os = "linux")]
#[test]
fn what_does_not_fit_on_the_disk_changes_nothing() {
    let folder = Folder::new(&[]);
    let (graph, trace) = (folder.at("graph.svg"), folder.at("trace.json"));
    let [graph_text, trace_text] = [&graph, &trace].map(|path| path.to_str().unwrap());
    for path in [&graph, &trace] {
        std::fs::write(path, "before").unwrap();
    }
    let mut cases: Vec<(Vec<&str>, &str)> = vec![
        (vec!["graph", "ism", "-o", graph_text], graph_text),
        (vec!["--trace", trace_text, "check", "ism-invtm", "tcas"], trace_text),
    ];
    let picture = folder.at("picture.pfm");
    let picture_text = picture.to_str().unwrap();
    if gpu().is_some() {
        Image::from_fn(1, 1, |_, _| [1.0; 4])
            .unwrap()
            .write(&picture, metrics::Display::AS_IS, None)
            .unwrap();
        let render = ["render", "ism", "cornell-box", "-o", picture_text, "--size", "64x64"];
        cases.push(([&render[..], &QUICK[2..]].concat(), picture_text));
    }
    let before = names(&folder);
    for (arguments, path) in cases {
        let length = Path::new(path).metadata().unwrap().len();
        limited(&arguments).failure(1, &[path, "File too large"]);
        assert_eq!(Path::new(path).metadata().unwrap().len(), length, "{path}");
        assert_eq!(names(&folder), before);
    }
}

/// Standard output is whole, or the exit code reports a failure.
#[cfg(target_os = "linux")]
#[test]
fn output_and_messages_on_a_full_disk_end_the_program_as_they_should() {
    let full = || std::fs::File::options().write(true).open("/dev/full").unwrap();
    let done = Done::of(lightloom().args(["passes", "--json"]).stdout(full()));
    done.failure(1, &["standard output cannot be written"]);
    for (arguments, code) in [(["passes", "gathr"], 1), (["check", "ism"], 0)] {
        let status = lightloom().args(arguments).stdout(Stdio::null()).stderr(full()).status().unwrap();
        assert_eq!(status.code(), Some(code), "{arguments:?}: {status:?}");
    }
    // A reader that has had enough is no fault.
    let mut child = lightloom().args(["passes", "--json"]).stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn a_folder_or_a_read_only_file_is_not_replaced() {
    let folder = Folder::new(&[]);
    let path = folder.at("graph.svg");
    let draw = || Done::of(lightloom().args(["graph", "ism", "-o"]).arg(&path));
    std::fs::create_dir(&path).unwrap();
    draw().failure(1, &["graph.svg was not written", "it is a folder"]);
    std::fs::remove_dir(&path).unwrap();
    std::fs::write(&path, "kept").unwrap();
    let mut permissions = path.metadata().unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&path, permissions).unwrap();
    draw().failure(1, &["the file is read-only"]);
    assert_eq!(folder.read("graph.svg"), "kept");
    assert_eq!(names(&folder), ["graph.svg"]);
}
