//! One failing cell, a reference that fails, a full disk, two runs on one folder.

use super::fake::{Fake, done, parse, plan, run, study, told};
use metrics::{Display, Image};
use std::path::PathBuf;
use std::time::Duration;
use study::{
    CellRun, End, Failure, Laboratory, Observed, Occluded, Outcome, Plan, RunOptions, RunRequest, Step,
};

fn of(text: &str) -> Plan {
    plan(parse(text))
}

fn error(outcome: &Outcome) -> &str {
    match outcome {
        Outcome::Failed { error } => error,
        Outcome::Done => "",
    }
}

#[test]
fn a_cell_that_fails_leaves_the_others() {
    let plan =
        of("Study(scenes: [\"box\"], pipelines: [\"broken\", \"nan\", \"fast\"], size: (8, 4), seeds: [1],
        measures: [\"rel-mse\", \"gpu-ms\"], reference: Pipeline(pipeline: \"truth\"))");
    let (folder, ran) = done(&plan);
    assert_eq!((ran.run, ran.failed), (3, 2));
    let cells = &ran.results.cells;
    assert_eq!(error(&cells[0].outcome), "the device was lost");
    assert_eq!(error(&cells[1].outcome), "1 of 32 pixels of frame 1 are NaN or infinite");
    // What is not a matter of pixels is measured.
    assert_eq!((cells[1].measures["rel-mse"], cells[1].measures["gpu-ms"]), (None, Some(2.64)));
    assert!(cells[1].images.image.is_some(), "the picture shows where");
    assert_eq!(cells[2].outcome, Outcome::Done);
    let table = std::fs::read_to_string(folder.path().join("cells.csv")).unwrap();
    assert!(table.contains("failed: the device was lost") && !table.contains("NaN,"), "{table}");
    // Failed cells run again, the other does not.
    let mut lab = Fake::default();
    assert_eq!(run(&plan, &mut lab, folder.path()).unwrap().run, 2);
}

/// Runs cells in other "processes": one writes no record, one crashes, one takes too long, and one does its work.
struct Processes {
    own: Fake,
    plan: Plan,
    folder: PathBuf,
}

impl Laboratory for Processes {
    fn adapter(&self) -> String {
        self.own.adapter()
    }

    fn identity(&mut self, request: &RunRequest) -> Result<u128, Failure> {
        self.own.identity(request)
    }

    fn run(
        &mut self,
        _: &RunRequest,
        _: &mut dyn FnMut(Observed) -> Result<(), Failure>,
        _: &mut dyn FnMut(Step),
    ) -> Result<CellRun, Failure> {
        panic!("no cell runs in this process");
    }

    fn apart(&mut self, cell: usize) -> Option<Result<(), Failure>> {
        Some(match cell {
            0 => Ok(()),
            1 => Err(Failure::Crashed("it ended with signal: 9".to_owned())),
            2 => Err(Failure::TimedOut(Duration::from_secs(3))),
            _ => {
                let shard = format!("cells:{0}-{0}/{1}", cell + 1, self.plan.cells.len()).parse();
                let options = RunOptions { shard: Some(shard.unwrap()), ..RunOptions::default() };
                told(&self.plan, &mut self.own, &self.folder, &options);
                Ok(())
            }
        })
    }

    fn occluded(&mut self, scene: &str, frame: u32) -> Result<Occluded, Failure> {
        self.own.occluded(scene, frame)
    }
}

#[test]
fn a_process_that_ends_takes_its_cell_alone() {
    let of = || {
        of("Study(scenes: [\"box\"], pipelines: [\"fast\"], size: (8, 4), seeds: 4, measures: [\"gpu-ms\"])")
    };
    let folder = tempfile::tempdir().unwrap();
    let mut lab = Processes { own: Fake::default(), plan: of(), folder: folder.path().to_owned() };
    let ran = study::run(&of(), &mut lab, folder.path(), &RunOptions::default(), &mut |_| {}).unwrap();
    assert_eq!((ran.run, ran.failed), (4, 3));
    let errors: Vec<&str> = ran.results.cells.iter().map(|cell| error(&cell.outcome)).collect();
    let expected = [
        "the process crashed: it wrote no record of the cell",
        "the process crashed: it ended with signal: 9",
        "the process did not end within 3 s",
        "",
    ];
    assert_eq!(errors, expected);
    let ends: Vec<End> = ran.results.cells.iter().map(|cell| cell.end).collect();
    assert_eq!(ends[..3], [End::Crashed, End::Crashed, End::TimedOut]);
    assert_eq!(ran.results.cells[3].measures["gpu-ms"], Some(2.64));
    // In this process what failed runs, and what was done does not run again.
    assert_eq!(run(&of(), &mut Fake::default(), folder.path()).unwrap().run, 3);
}

#[test]
fn a_reference_that_fails_is_told_once() {
    let folder = tempfile::tempdir().unwrap();
    let text = "Study(scenes: [\"box\"], pipelines: [\"fast\"], size: (8, 4), seeds: 3,
        measures: [\"rel-mse\", \"gpu-ms\"], reference: Pipeline(pipeline: \"truth\"))";
    let mut lab = Fake { no_truth: true, ..Fake::default() };
    let lines = told(&of(text), &mut lab, folder.path(), &RunOptions::default());
    let notes: Vec<&String> = lines.iter().filter(|line| line.starts_with("note")).collect();
    assert_eq!(notes, ["note the reference of box at 8x4 failed: the device was lost"]);
    assert_eq!(lab.ran.len(), 4, "the reference is tried once, the cells are timed");
    let results = study::Results::read(folder.path()).unwrap();
    for cell in &results.cells {
        assert!(error(&cell.outcome).contains("the reference of box at 8x4 failed"));
        assert_eq!((cell.measures["rel-mse"], cell.measures["gpu-ms"]), (None, Some(2.64)));
    }
    assert_eq!(results.study.references[0].error, "the device was lost");
    // Errors alone: nothing is run for them.
    let mut lab = Fake { no_truth: true, ..Fake::default() };
    let errors_only = of(&text.replace(", \"gpu-ms\"", ""));
    assert_eq!(run(&errors_only, &mut lab, folder.path()).unwrap().failed, 3);
    assert_eq!(lab.ran.len(), 1);
    // Once it can be made, all is.
    assert_eq!(run(&of(text), &mut Fake::default(), folder.path()).unwrap().failed, 0);
}

#[test]
fn a_picture_that_does_not_fit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let with = |name: &str| {
        let file = folder.path().join(name).to_string_lossy().replace('\\', "/");
        of(&format!(
            "Study(scenes: [\"box\"], pipelines: [\"fast\"], size: (8, 4), seeds: [2],
            measures: [\"rmse\"], reference: Picture({file:?}))"
        ))
    };
    let picture = |name: &str, width: usize, value: f32| {
        let pixels = vec![[value, value, value, 1.0]; width * 4];
        Image::new(width, 4, pixels).unwrap().write(folder.path().join(name), Display::AS_IS, None).unwrap();
    };
    picture("small.exr", 4, 2.0);
    picture("nan.exr", 8, f32::NAN);
    picture("good.exr", 8, 2.0);
    for (name, why) in [
        ("small.exr", "the reference is 4x4, the frames are 8x4"),
        ("nan.exr", "32 of 32 pixels of the reference are NaN or infinite"),
        ("absent.exr", "absent.exr: No such file"),
    ] {
        let ran = run(&with(name), &mut Fake::default(), &folder.path().join("out")).unwrap();
        assert!(error(&ran.results.cells[0].outcome).contains(why), "{:?}", ran.results.cells[0].outcome);
    }
    let ran = run(&with("good.exr"), &mut Fake::default(), &folder.path().join("out")).unwrap();
    assert_eq!(ran.results.cells[0].measures["rmse"], Some(0.5 / 64.0));
}

#[test]
fn a_folder_has_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(study("measures: [\"gpu-ms\"]"));
    let inner = plan.clone();
    let mut refused = String::new();
    study::run(&plan, &mut Fake::default(), folder.path(), &RunOptions::default(), &mut |_| {
        if refused.is_empty() {
            refused = run(&inner, &mut Fake::default(), folder.path()).unwrap_err().to_string();
        }
    })
    .unwrap();
    let process = format!("process {} since 20", std::process::id());
    assert!(refused.contains("another run works here") && refused.contains(&process), "{refused}");
    run(&plan, &mut Fake::default(), folder.path()).expect("it is free again");
}

/// What a disk refuses ends the run with the name of the file; what was finished stays.
#[test]
fn a_refusing_disk_is_named_and_loses_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(study("vary: Grid({ \"lights\": [1, 2, 3] }), measures: [\"gpu-ms\"]"));
    let images = folder.path().join("images");
    let mut ended = 0;
    let error =
        study::run(&plan, &mut Fake::default(), folder.path(), &RunOptions::default(), &mut |event| {
            if let study::Event::Ended { .. } = event {
                ended += 1;
                if ended == 2 {
                    std::fs::remove_dir_all(&images).unwrap();
                    std::fs::write(&images, "in the way").unwrap();
                }
            }
        })
        .unwrap_err()
        .to_string();
    assert!(error.contains("images/"), "{error}");
    std::fs::remove_file(&images).unwrap();
    let mut lab = Fake::default();
    assert_eq!(run(&plan, &mut lab, folder.path()).unwrap().run, 1);
}
