//! The tables, to the letter.

use super::fake::{Fake, done, plan, run, study};
use std::fs;

#[test]
fn tables_are_tidy_and_ordered() {
    let sweep = "vary: Grid({ \"lights\": [16, 64] }), seeds: 2, measures: [\"rmse\"], reference: Pipeline(pipeline: \"truth\")";
    let (folder, ran) = done(&plan(study(sweep)));
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let values = [("16", 1, "0.09375"), ("16", 2, "0.03125"), ("64", 1, "0.0234375"), ("64", 2, "0.0078125")];
    let rows = values.iter().zip(&ran.results.cells).map(|((lights, seed, value), cell)| {
        let (key, reference) = (&cell.key, cell.images.reference.as_deref().unwrap());
        let host = &cell.node.host;
        format!("box,fast,{lights},{seed},rmse,{value},W/(m² sr),done,,,{key},images/{key}.exr,{reference},images/{key}-flip.png,{host},paper and pencil\n")
    });
    assert_eq!(
        read("cells.csv"),
        "scene,pipeline,lights,seed,measure,value,unit,outcome,chosen,note,key,image,reference,flip,node,adapter\n"
            .to_owned()
            + &rows.collect::<String>()
    );
    for cell in &ran.results.cells {
        assert!(folder.path().join(format!("cells/{}.json", cell.key)).is_file());
        assert!(folder.path().join(format!("images/{}.exr", cell.key)).is_file());
        assert!(folder.path().join(cell.images.reference.as_ref().unwrap()).is_file());
    }
    // Two values a and b: mean (a + b) / 2, interval t · |a − b| / 2 with t = 12.7062 for one degree of freedom.
    let summary = read("summary.csv");
    let rows: Vec<Vec<&str>> = summary.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows[0].join(","), "scene,pipeline,lights,measure,unit,seeds,mean,half_width_95,adapter");
    assert_eq!((rows[1][6], rows[2][6]), ("0.0625", "0.015625"));
    let half: f64 = rows[1][7].parse().unwrap();
    assert!((half - 12.7062 * 0.03125).abs() < 1e-4, "{half}");
    assert_eq!(rows.len(), 1 + 2 * ran.results.study.measures.len(), "seeds are one row");
}

#[test]
fn a_failed_cell_has_the_first_line_of_its_diagnostic() {
    let folder = tempfile::tempdir().unwrap();
    let mut results =
        run(&plan(study("measures: [\"gpu-ms\"]")), &mut Fake::default(), folder.path()).unwrap().results;
    let error = "error[X001]: the device was lost\n  ┌─ fast.ron:1:1, \"here\"\n".to_owned();
    results.cells[0].outcome = study::Outcome::Failed { error };
    study::write_tables(&results, folder.path()).unwrap();
    let table = fs::read_to_string(folder.path().join("cells.csv")).unwrap();
    assert!(table.contains(",failed: error[X001]: the device was lost,,,"), "{table}");
    assert!(!table.contains("fast.ron"), "{table}");
}
