//! The tables, to the letter.

use super::fake::{Fake, plan, run, study};
use std::fs;

#[test]
fn tables_are_tidy_and_ordered() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = "vary: Grid({ \"lights\": [16, 64] }), seeds: 2, measures: [\"rmse\"], reference: Pipeline(pipeline: \"truth\")";
    let ran = run(&plan(study(sweep)), &mut Fake::default(), folder.path()).unwrap();
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(
        read("cells.csv"),
        "scene,pipeline,lights,seed,measure,value,unit,outcome,chosen,note\n\
         box,fast,16,1,rmse,0.09375,W/(m² sr),done,,\n\
         box,fast,16,2,rmse,0.03125,W/(m² sr),done,,\n\
         box,fast,64,1,rmse,0.0234375,W/(m² sr),done,,\n\
         box,fast,64,2,rmse,0.0078125,W/(m² sr),done,,\n"
    );
    // Two values a and b: mean (a + b) / 2, interval t · |a − b| / 2 with t = 12.7062 for one degree of freedom.
    let summary = read("summary.csv");
    let rows: Vec<Vec<&str>> = summary.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows[0].join(","), "scene,pipeline,lights,measure,unit,seeds,mean,half_width_95");
    assert_eq!((rows[1][6], rows[2][6]), ("0.0625", "0.015625"));
    let half: f64 = rows[1][7].parse().unwrap();
    assert!((half - 12.7062 * 0.03125).abs() < 1e-4, "{half}");
    assert_eq!(ran.results.rows().len(), 2);
}
