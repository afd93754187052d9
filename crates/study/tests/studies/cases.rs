//! Studies whose cells are no pictures.

use std::path::Path;
use study::{
    Cell, Failure, MeasureInfo, Outcome, PipelineRecord, Ran, Results, SceneRecord, StudyRecord, Words, keep,
    measure_cases,
};

/// Measures two cases, of which the second has a measure of its own or fails. The adapter is known after the first.
fn run(folder: &Path, fails: bool) -> Ran {
    let case = |name: &str| SceneRecord::case(name, format!("the case {name}"));
    let study = StudyRecord {
        name: "costs".to_owned(),
        words: Words { case: "figure".to_owned(), subject: "thing".to_owned() },
        scenes: vec![case("first"), case("second")],
        pipelines: vec![PipelineRecord::subject("all", "")],
        ..StudyRecord::default()
    };
    let cell = |measure: &str, value: f64| Cell {
        pipeline: "all".to_owned(),
        measures: [(measure.to_owned(), Some(value))].into(),
        ..Cell::default()
    };
    measure_cases(study, folder, &mut |study, case| match (case, fails) {
        (0, _) => {
            study.measures.push(MeasureInfo::new("ms", "ms", ""));
            Ok(vec![cell("ms", 2.0)])
        }
        (_, false) => {
            study.measures.push(MeasureInfo::new("mib", "mib", ""));
            study.adapter = "a device".to_owned();
            Ok(vec![cell("mib", 3.0)])
        }
        _ => Err(Failure::render("it <broke>")),
    })
    .unwrap()
}

#[test]
fn measures_of_cases_are_cells_of_one_adapter() {
    let folder = tempfile::tempdir().unwrap();
    let ran = run(folder.path(), false);
    assert_eq!((ran.run, ran.failed, ran.results.adapters()), (2, 0, vec!["a device"]));
    assert_eq!(ran.results, Results::read(folder.path()).unwrap());
    let [first, second] = &ran.results.cells[..] else { panic!("two cells") };
    assert_eq!((first.measures["ms"], first.measures["mib"]), (Some(2.0), None), "what another case has");
    assert_eq!((second.scene.as_str(), second.measures["mib"]), ("second", Some(3.0)));
    let page = std::fs::read_to_string(&study::report(&ran.results, folder.path()).unwrap()[0]).unwrap();
    assert!(page.contains("<h3>Figures</h3>") && page.contains("the case second"), "{page}");
    // What pictures have is left out, and so are columns of other cases.
    for absent in ["id=\"pictures\"", "id=\"references\"", "Warm-up", "0 × 0"] {
        assert!(!page.contains(absent), "{absent}");
    }
    let pages = study::publish(&[folder.path().to_owned()], &folder.path().join("pages")).unwrap();
    let text = std::fs::read_to_string(&pages[0]).unwrap();
    assert!(
        pages[0].ends_with("costs.md") && text.contains("| all |") && !text.contains("Frames of"),
        "{text}"
    );
    let tables = study::tables(&ran.results);
    let titles =
        |table: &report::Table| table.columns.iter().map(|column| column.title.clone()).collect::<Vec<_>>();
    assert_eq!(titles(&tables[0]), ["Thing", "Seeds", "ms"]);
    assert_eq!(titles(&tables[1]), ["Thing", "Seeds", "mib"]);
}

#[test]
fn a_case_that_fails_leaves_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let mut ran = run(folder.path(), true);
    assert_eq!((ran.run, ran.failed), (2, 1));
    let failed = &ran.results.cells[1];
    assert_eq!(failed.outcome, Outcome::Failed { error: "it <broke>".to_owned() });
    assert_eq!((failed.scene.as_str(), failed.pipeline.as_str()), ("second", "all"));
    let nameless = Cell { pipeline: String::new(), ..failed.clone() };
    assert_eq!([failed, &nameless].map(study::name_of), ["all on second, seed 0", "second, seed 0"]);
    let error = study::source(folder.path()).unwrap_err().to_string();
    assert!(error.contains("`costs` has no file"), "{error}");
    // What is added later is kept.
    ran.results.cells[0].details = "seen".into();
    keep(&ran.results, folder.path()).unwrap();
    assert_eq!(Results::read(folder.path()).unwrap(), ran.results);
    assert!(keep(&ran.results, &folder.path().join("elsewhere")).is_err());
}
