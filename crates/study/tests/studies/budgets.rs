//! Equal time, equal lights, equal frames.

use super::fake::{Fake, done, number, parse, plan, run, study};
use study::AxisValue;

#[test]
fn equal_time_is_searched_once_for_all_seeds() {
    let folder = tempfile::tempdir().unwrap();
    let text = "Study(scenes: [\"box\"], pipelines: [\"fast\", \"exact\"], size: (8, 4), seeds: 3, measures: [\"gpu-ms\"],
        budget: Time(ms: 12.0, by: \"lights\", frames: 4))";
    let timed = plan(parse(text));
    let mut lab = Fake::default();
    let ran = run(&timed, &mut lab, folder.path()).unwrap();
    for cell in &ran.results.cells {
        let ms = cell.measures["gpu-ms"].unwrap();
        assert!((ms / 12.0 - 1.0).abs() <= 0.05, "{ms} ms with {:?}", cell.chosen);
        assert!(cell.notes.is_empty());
    }
    let chosen = |index: usize| ran.results.cells[index].chosen["lights"].clone();
    assert_eq!((chosen(0), chosen(3)), (chosen(2), chosen(5)), "one figure for all seeds");
    assert_ne!(chosen(0), chosen(3));
    let probes = lab.ran.iter().filter(|request| request.frames == 3).count();
    assert!((2..=16).contains(&probes), "{probes} probes");
    assert_eq!(ran.results.study.budget, "12 ms a frame by `lights`, 4 frames");
    // A cell that is run again takes what its fellows took.
    std::fs::remove_file(folder.path().join(format!("cells/{}.json", ran.results.cells[1].key))).unwrap();
    let mut lab = Fake::default();
    let again = run(&timed, &mut lab, folder.path()).unwrap();
    assert_eq!(lab.ran.len(), 1, "no probes");
    assert_eq!(again.results.cells[1].chosen["lights"], chosen(0));
}

#[test]
fn a_budget_that_cannot_be_met_takes_the_nearest_and_says_so() {
    let (folder, ran) = done(&plan(study("measures: [\"gpu-ms\"], budget: Time(ms: 1.0, by: \"lights\")")));
    let cell = &ran.results.cells[0];
    assert_eq!(cell.chosen["lights"], AxisValue::Number(1.0));
    assert_eq!(cell.notes, ["1 ms cannot be met: with `lights` = 1 a frame takes 2.010 ms"]);
    let table = std::fs::read_to_string(folder.path().join("cells.csv")).unwrap();
    assert!(table.contains("lights=1,1 ms cannot be met"), "{table}");
}

#[test]
fn time_over_frames_and_equal_lights() {
    let folder = tempfile::tempdir().unwrap();
    // 2.64 ms a frame: four of them are 10.56.
    let ran = run(
        &plan(study("measures: [\"gpu-ms\"], budget: Time(ms: 10.0)")),
        &mut Fake::default(),
        folder.path(),
    );
    let cell = ran.unwrap().results.cells.remove(0);
    assert_eq!(cell.frames, 4);
    assert!((cell.measures["gpu-ms"].unwrap() - 10.56).abs() < 1e-9);
    let mut lab = Fake::default();
    run(&plan(study("measures: [\"gpu-ms\"], budget: Lights(100)")), &mut lab, folder.path()).unwrap();
    assert_eq!((number(&lab.ran[0], "lights", 0.0), lab.ran[0].frames), (100.0, 5));
}
