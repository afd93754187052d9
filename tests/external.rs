//! External programs as rows of a study: scripts that do what is asked, and scripts that do not.

use crate::adapter::root;
use crate::program::{Done, Folder, command_of_tree, wait_for};
use metrics::{Display, Image};
use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// A script that hands over a picture: arguments are the file to write, and the seed.
const SCRIPT: &str =
    "#!/bin/sh\necho by hand\ncp \"$(dirname \"$0\")/picture.exr\" \"$1\"\necho lightloom: ms 12.5\n";

fn study(folder: &Path, arguments: &[&str]) -> Done {
    Done::of(command_of_tree(folder).arg("study").args(arguments))
}

/// A folder with a script, a picture of one level, and a study of these rows.
fn folder(size: (usize, usize), rows: &str, rest: &str) -> Option<Folder> {
    let text = format!(
        "Study(scenes: [\"cornell-box\"], pipelines: [{rows}], size: (16, 12), budget: Frames(2), {rest})"
    );
    let folder = Folder::with_gpu(&[("study.ron", &text), ("render.sh", SCRIPT)])?;
    picture(&folder.at("picture.exr"), size);
    fs::set_permissions(folder.at("render.sh"), fs::Permissions::from_mode(0o755)).unwrap();
    Some(folder)
}

fn picture(path: &Path, (width, height): (usize, usize)) {
    let image = Image::new(width, height, vec![[0.5, 0.5, 0.5, 1.0]; width * height]).unwrap();
    image.write(path, Display::AS_IS, None).unwrap();
}

const MEAN: &str = "seeds: 3, measures: [\"mean\", \"gpu-ms\"]";

#[test]
fn an_external_program_is_a_row() {
    let rows = "External(name: \"mine\", command: \"./render.sh {out} {seed}\", limit: 60)";
    let Some(folder) = folder((16, 12), rows, MEAN) else { return };
    study(&folder, &["study.ron", "-o", "out"])
        .failure(1, &["`./render.sh {out} {seed}`; `--allow-external` allows it"]);
    assert!(!folder.at("out").exists(), "nothing has run");
    let allowed = ["study.ron", "--allow-external"];
    study(&folder, &[&allowed[..], &["-o", "out"]].concat()).success();
    let results = ::study::Results::read(&folder.at("out")).unwrap();
    assert_eq!(results.cells.len(), 3);
    for cell in &results.cells {
        assert_eq!((cell.measures["mean"], cell.measures["gpu-ms"]), (Some(0.5), Some(12.5)));
        assert_eq!(cell.passes[0].pass, "stated time");
        let provenance: serde_json::Value = serde_json::from_str(&cell.provenance).unwrap();
        assert_eq!(provenance["external"], "./render.sh {out} {seed}");
        assert_eq!((&provenance["exit status"], &provenance["time"]), (&0.into(), &"stated time".into()));
        assert!(provenance["last lines"].as_str().unwrap().starts_with("by hand"), "{provenance}");
    }
    let image = folder.name(&format!("out/{}", results.cells[0].images.image.as_deref().unwrap()));
    Done::of(command_of_tree(&folder).args(["rerun", &image]))
        .failure(1, &["was rendered by another program", "`./render.sh {out} {seed}`"]);
    assert!(fs::read_to_string(folder.at("out/report.html")).unwrap().contains("stated time"));
    assert!(results.study.command.contains("--allow-external"), "{}", results.study.command);

    // Parts give the same table, and what is finished does not run again until the script changes.
    for part in ["1", "2"] {
        let shard = format!("{part}/2");
        study(&folder, &[&allowed[..], &["-o", part, "--shard", &shard]].concat()).success();
    }
    study(&folder, &["merge", "1", "2", "-o", "all"]).success();
    assert_eq!(folder.read("all/cells.csv"), folder.read("out/cells.csv"));
    let again = |out: &str| study(&folder, &[&allowed[..], &["-o", out]].concat()).success();
    again("out").says(&["3 of 3 cells are finished already"]);
    folder.write("render.sh", &SCRIPT.replace("12.5", "2.5"));
    fs::set_permissions(folder.at("render.sh"), fs::Permissions::from_mode(0o755)).unwrap();
    again("out").says(&["3 cells in the folder belong to another version"]);
    let results = ::study::Results::read(&folder.at("out")).unwrap();
    assert_eq!(results.cells[0].measures["gpu-ms"], Some(2.5));
}

/// Each cell in a process of its own gives what one process gives; one that hangs is killed, with the program that it runs.
#[test]
fn cells_run_in_processes_of_their_own() {
    let rows = "\"ism\", External(name: \"mine\", command: \"./render.sh {out} {seed}\", limit: 600)";
    let Some(folder) = folder((16, 12), rows, "seeds: 2, measures: [\"mean\"]") else { return };
    let run = |out: &str, more: &[&str]| {
        let small = ["--set", "lights=16", "--set", "map=16", "--set", "rsm.size=32"];
        study(&folder, &[&["study.ron", "--allow-external", "-o", out], &small[..], more].concat())
    };
    run("one", &[]).success();
    run("apart", &["--isolated", "600"]).success();
    assert_eq!(folder.read("one/cells.csv"), folder.read("apart/cells.csv"));
    run("apart", &["--isolated", "600"]).success().says(&["4 of 4 cells are finished already"]);
    run("apart", &["--isolated", "600", "--shard", "1/2"]).failure(2, &["cannot be used with"]);

    folder.write("render.sh", "#!/bin/sh\nsleep 60\n");
    fs::set_permissions(folder.at("render.sh"), fs::Permissions::from_mode(0o755)).unwrap();
    run("apart", &["--isolated", "1"]).failure(1, &["2 cells failed", "the process did not end within 1 s"]);
    let results = ::study::Results::read(&folder.at("apart")).unwrap();
    let done = results.cells.iter().filter(|cell| cell.outcome == ::study::Outcome::Done);
    assert_eq!(done.map(|cell| cell.pipeline.as_str()).collect::<Vec<_>>(), ["ism", "ism"]);
}

#[test]
fn programs_that_fail_are_reported_and_the_others_run() {
    let rows = [
        ("fails", "sh -c 'echo out of memory >&2; exit 3'"),
        ("hangs", "sleep 600"),
        ("nothing", "echo done"),
        ("other size", "cp big.exr"),
        ("no picture", "cp render.sh"),
        ("is not there", "./no-such-renderer"),
        ("is right", "./render.sh"),
    ];
    let rows: String = rows
        .iter()
        .map(|(name, command)| {
            format!("External(name: {name:?}, command: \"{command} {{out}}\", limit: 2), ")
        })
        .collect();
    let rows = rows.replace("sleep 600 {out}", "sh -c 'sleep 600' {out}");
    let Some(folder) = folder((16, 12), &rows, "measures: [\"mean\"]") else { return };
    picture(&folder.at("big.exr"), (17, 12));
    let done = study(&folder, &["study.ron", "-o", "out", "--allow-external", "--json"]);
    let json = done.failure(1, &["6 cells failed"]).json();
    let failed = json["failed"].as_array().unwrap();
    let errors: Vec<&str> = failed.iter().map(|cell| cell["error"].as_str().unwrap()).collect();
    let words = [
        "the command ended with exit status: 3: out of memory",
        "the process did not end within 2 s",
        "the command ended without `out-0001.exr`, which it was to write",
        "the command wrote a picture of 17x12 pixels; expected 16x12",
        "expected an EXR picture",
        "cannot start `./no-such-renderer`",
    ];
    for (error, word) in errors.iter().zip(words) {
        assert!(error.contains(word), "no `{word}` in: {error}");
    }
    let results = ::study::Results::read(&folder.at("out")).unwrap();
    assert_eq!(results.cells[6].measures["mean"], Some(0.5));
}

#[test]
fn a_mirrored_picture_is_noted() {
    let rows = "External(name: \"mirrored\", command: \"cp mirrored.exr {out}\")";
    let rest = "measures: [\"rel-mse\", \"energy\"], reference: Picture(\"truth.exr\")";
    let Some(folder) = folder((16, 12), rows, rest) else { return };
    let pixel = |x: usize, y: usize| [if x < 5 && y < 9 { 3.0 } else { 0.1 * x as f32 }; 4];
    let place = |mirrored: bool, i: usize| pixel(if mirrored { 15 - i % 16 } else { i % 16 }, i / 16);
    for (name, mirrored) in [("mirrored.exr", true), ("truth.exr", false)] {
        let image = Image::new(16, 12, (0..192).map(|i| place(mirrored, i)).collect()).unwrap();
        image.write(folder.at(name), Display::AS_IS, None).unwrap();
    }
    study(&folder, &["study.ron", "-o", "out", "--allow-external"]).success();
    let results = ::study::Results::read(&folder.at("out")).unwrap();
    let note = "the picture may be of another camera: it fits the reference when mirrored left to right";
    assert_eq!(results.cells[0].notes, [note]);
}

/// Where the study is interrupted, the program ends with it; the next run goes on from there.
#[test]
fn an_interrupted_study_ends_its_program_and_goes_on() {
    let rows = "External(name: \"slow\", command: \"sh slow.sh {seed} {out}\")";
    let Some(folder) = folder((16, 12), rows, MEAN) else { return };
    folder.write(
        "slow.sh",
        "if [ \"$1\" != 1 ] && [ ! -e go ]; then sleep 600 & echo $! > part; mv part child; wait; fi\ncp picture.exr \"$2\"\n",
    );
    let mut child = command_of_tree(&folder)
        .args(["study", "study.ron", "-o", "out", "--allow-external"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    wait_for(&mut child, "the second cell", || folder.at("child").exists());
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    // What was killed may be left until its parent asks for it.
    let of_child = format!("/proc/{}/stat", folder.read("child").trim());
    let runs = || fs::read_to_string(&of_child).is_ok_and(|stat| !stat.contains(") Z "));
    let begun = Instant::now();
    while runs() {
        assert!(begun.elapsed() < Duration::from_secs(60), "a child of the program has gone on");
        std::thread::sleep(Duration::from_millis(5));
    }
    folder.write("go", "");
    study(&folder, &["study.ron", "-o", "out", "--allow-external"])
        .success()
        .says(&["1 of 3 cells are finished already"]);
}

/// A program that writes a sequence, as a row beside a pipeline where geometry, camera and light move.
#[test]
fn a_program_that_writes_sequences_is_a_row() {
    let program = Path::new(env!("CARGO_BIN_EXE_lightloom")).with_file_name("sequence");
    if !program.is_file() {
        return eprintln!("skipped: `cargo build -p sequence` builds the program");
    }
    let text = fs::read_to_string(root().join("examples/sequence/study.ron")).unwrap();
    assert!(text.contains("cargo run") || text.contains("target/release/sequence"), "{text}");
    let text = text.replace("../../target/release/sequence", &program.display().to_string());
    let Some(folder) = Folder::with_gpu(&[("study.ron", &text)]) else { return };
    let small = ["--size", "24x16", "--frames", "6", "--seeds", "1", "--set-reference", "samples=16"];
    let arguments = [&["study.ron", "-o", "out", "--allow-external"][..], &small].concat();
    study(&folder, &arguments).success();
    let results = ::study::Results::read(&folder.at("out")).unwrap();
    let of = |name: &str| results.cells.iter().find(|cell| cell.pipeline == name).unwrap();
    let (blended, own) = (of("blended"), of("ism-uniform"));
    for cell in [blended, own] {
        assert_eq!(cell.frames, 6, "{cell:?}");
        let energy = cell.measures["energy"].unwrap();
        assert!((0.6..1.6).contains(&energy), "{}: {energy}", cell.pipeline);
    }
    let change = |cell: &::study::Cell| cell.measures["tone-change"].unwrap();
    assert!(change(blended) < change(own), "blending hides flicker: {} and {}", change(blended), change(own));
    assert_eq!(blended.passes[0].pass, "stated time");
}

/// Returns a Python with Mitsuba, in a virtual environment in the folder for build outputs; `None`, said on stderr, where that
/// cannot be made.
pub(crate) fn python_with_mitsuba() -> Option<std::path::PathBuf> {
    let folder = root().join("target/mitsuba");
    let python = folder.join("bin/python");
    let succeeds = |command: &mut Command| {
        let done = command.stdout(Stdio::null()).stderr(Stdio::null()).status();
        done.is_ok_and(|status| status.success())
    };
    let is_there = || succeeds(Command::new(&python).args(["-c", "import mitsuba"]));
    let made = is_there()
        || (succeeds(Command::new("python3").args(["-m", "venv"]).arg(&folder))
            && succeeds(Command::new(&python).args([
                "-m",
                "pip",
                "install",
                "--retries",
                "1",
                "--timeout",
                "20",
                "mitsuba",
            ]))
            && is_there());
    if !made {
        eprintln!("skipped: Python cannot install Mitsuba in {}", folder.display());
    }
    made.then_some(python)
}

/// The study of Mitsuba in small: its picture is that of path tracing, but for noise.
#[test]
#[ignore = "slow"]
fn mitsuba_renders_what_path_tracing_renders() {
    if crate::adapter::gpu().is_none() {
        return;
    }
    let Some(python) = python_with_mitsuba() else { return };
    let text = fs::read_to_string(root().join("examples/mitsuba/equal-time.ron")).unwrap();
    let text = text.replace("../../out/mitsuba/bin/python", &python.display().to_string());
    let is_quick = |line: &&str| !["ism-invtm", "instant radiosity"].iter().any(|name| line.contains(name));
    let text = text.lines().filter(is_quick).collect::<Vec<_>>().join("\n");
    let folder = Folder::new(&[("mitsuba.ron", &text)]);
    fs::copy(root().join("examples/mitsuba/render.py"), folder.at("render.py")).unwrap();
    let arguments = ["mitsuba.ron", "-o", "out", "--allow-external", "--size", "32x24", "--ms", "1500"];
    let reference = ["--set-reference", "samples=1024"];
    study(
        &folder,
        &[
            &arguments[..],
            &["--seeds", "4", "--scene", "cornell-box", "--scene", "cornell-box-lights"],
            &reference,
        ]
        .concat(),
    )
    .success();
    let results = ::study::Results::read(&folder.at("out")).unwrap();
    for scene in ["cornell-box", "cornell-box-lights"] {
        let cells: Vec<&::study::Cell> =
            results.cells.iter().filter(|cell| cell.pipeline == "Mitsuba" && cell.scene == scene).collect();
        assert_eq!(cells.len(), 4);
        let energies: Vec<f64> = cells.iter().map(|cell| cell.measures["energy"].unwrap()).collect();
        let energy = ::study::Interval::of(&energies).unwrap();
        eprintln!("{scene}: energy {:.4} ± {:.4}", energy.mean, energy.half.unwrap());
        // By 128 samples and four seeds it is known to 0.011 (95 %); these are more where the machine is not slower.
        assert!((energy.mean - 1.0).abs() < 0.03, "{scene}: {energies:?}");
        for cell in cells {
            assert_eq!(cell.notes, Vec::<String>::new());
            assert_eq!(cell.passes[0].pass, "stated time");
            assert!(cell.measures["gpu-ms"].unwrap() >= 1500.0, "{cell:?}");
            assert!(cell.provenance.contains("\"software\":\"Mitsuba"), "{}", cell.provenance);
        }
    }
}
