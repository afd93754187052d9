//! Which cells a study has.

use super::fake::{parse, plan, study};
use frame_graph::Source;
use study::{AxisValue, Edits, Plan};

const MORE: &str = "measures: [\"gpu-ms\"]";

#[test]
fn times_without_warm_up_are_warned_about() {
    let told = |more: &str| plan(study(more)).notes.to_string();
    assert!(told("measures: [\"gpu-ms\"], warm_up: 0").contains("warning[T017]: times without warm-up"));
    assert_eq!(told("measures: [\"gpu-ms\"]"), "");
    assert_eq!(told("measures: [\"energy\"], warm_up: 0, reference: Picture(\"a.exr\")"), "");
}

/// Pipeline, axes and seed of each cell.
fn cells(plan: &Plan) -> Vec<String> {
    plan.cells
        .iter()
        .map(|cell| {
            let axes: Vec<String> = cell.axes.iter().map(|(name, value)| format!("{name}={value}")).collect();
            let request = &cell.request;
            format!(
                "{} {} {}x{} s{}",
                request.pipeline,
                axes.join(" "),
                request.size.0,
                request.size.1,
                request.seed
            )
        })
        .collect()
}

#[test]
fn a_grid_has_every_combination_and_pairs_have_rows() {
    let grid = plan(study(&format!("vary: Grid({{ \"lights\": [16, 64], \"map\": [32, 64] }}), {MORE}")));
    assert_eq!(
        cells(&grid),
        ["16 map=32", "16 map=64", "64 map=32", "64 map=64"].map(|axes| format!("fast lights={axes} 8x4 s0"))
    );
    let paired = plan(study(&format!("vary: Paired({{ \"lights\": [16, 64], \"map\": [32, 64] }}), {MORE}")));
    assert_eq!(cells(&paired), ["fast lights=16 map=32 8x4 s0", "fast lights=64 map=64 8x4 s0"]);
    let both = format!(
        "vary: [Grid({{ \"size\": [(8, 4), (16, 8)] }}), Paired({{ \"lights\": [1, 2] }})], seeds: 2, {MORE}"
    );
    let both = plan(study(&both));
    assert_eq!(both.cells.len(), 8);
    assert_eq!(cells(&both)[5], "fast lights=1 size=16x8 16x8 s2");
    assert_eq!(both.axes[0].unit, "px");
    assert_eq!(both.axes[1].doc, "Number of lights");
}

#[test]
fn a_pipeline_without_an_optional_axis_runs_once() {
    let text = "Study(scenes: [\"box\"], pipelines: [\"fast\", Variant(name: \"slow\", pipeline: \"exact\", set: { \"lights\": 9 })],
        set: { \"lights\": 7 }, vary: Grid({ \"map\": Optional([32, 64]) }), measures: [\"gpu-ms\"], size: (8, 4))";
    let plan = plan(parse(text));
    assert_eq!(cells(&plan), ["fast map=32 8x4 s0", "fast map=64 8x4 s0", "exact  8x4 s0"]);
    // A variant's own value comes after those for all, an axis after both.
    let set = |index: usize| plan.cells[index].request.set.clone();
    let value = |name: &str, number: f64| (name.to_owned(), AxisValue::Number(number));
    assert_eq!(set(1), [value("lights", 7.0), value("map", 64.0)]);
    assert_eq!(set(2), [value("lights", 7.0), value("lights", 9.0)]);
    assert_eq!(plan.differences[0].lines, ["exact is not fast"]);
}

#[test]
fn all_pipelines_are_those_with_the_output() {
    let text = "Study(scenes: [\"box\"], pipelines: All(except: [\"broken\"]), output: \"image\", measures: [\"gpu-ms\"])";
    let plan = plan(parse(text));
    let names: Vec<&str> = plan.pipelines.iter().map(|pipeline| pipeline.name.as_str()).collect();
    // `truth` has no output `image`.
    assert_eq!(names, ["exact", "fast", "nan"]);
}

#[test]
fn the_command_line_changes_a_study() {
    let vary =
        format!("vary: Grid({{ \"lights\": [1, 2, 3], \"size\": [(8, 4), (16, 8)] }}), seeds: 5, {MORE}");
    let with = |edits: Edits| {
        let mut study = study(&vary);
        study.edit(&edits).unwrap();
        cells(&plan(study))
    };
    let size = Edits { size: Some((3, 2)), seeds: Some(1), ..Edits::default() };
    assert_eq!(with(size.clone()), ["fast lights=1 3x2 s1", "fast lights=2 3x2 s1", "fast lights=3 3x2 s1"]);
    let pin = |path: &str, value: f64| vec![(path.to_owned(), AxisValue::Number(value))];
    assert_eq!(with(Edits { set: pin("lights", 9.0), ..size.clone() }), ["fast lights=9 3x2 s1"]);
    assert_eq!(with(Edits { scenes: vec!["walk".to_owned()], ..size }).len(), 3);
    assert_eq!(
        with(Edits { quick: true, ..Edits::default() }),
        ["1 size=2x1 2x1", "1 size=4x2 4x2", "3 size=2x1 2x1", "3 size=4x2 4x2"]
            .map(|axes| format!("fast lights={axes} s1"))
    );
    let mut wrong = study(&vary);
    wrong.edit(&Edits { set: pin("lihgts", 9.0), ..Edits::default() }).unwrap();
    let errors = Plan::new(wrong, &super::fake::Shelf).unwrap_err().to_string();
    assert!(errors.contains("lihgts=9") && errors.contains("did you mean `lights`?"), "{errors}");
    // What a measure needs is looked at again.
    let frames = Edits { frames: Some(1), ..Edits::default() };
    let errors = study("measures: [\"tid\"]").edit(&frames).unwrap_err().to_string();
    assert!(errors.contains("`tid` needs at least 2 frames"), "{errors}");
    let lights = Edits { set: pin("lights", 9.0), ..Edits::default() };
    let errors = study("measures: [\"gpu-ms\"], budget: Lights(8)").edit(&lights).unwrap_err().to_string();
    assert!(errors.contains("the budget sets it as well"), "{errors}");
}

#[test]
fn runs_are_distinct_by_what_they_compile() {
    let seeds = plan(study(&format!("vary: Grid({{ \"lights\": [16, 64] }}), seeds: 3, {MORE}")));
    assert_eq!(seeds.cells.len(), 6);
    let runs = |plan: &Plan| -> Vec<String> {
        let runs = plan.distinct_runs().into_iter();
        runs.map(|run| format!("{} {:?}", run.pipeline, run.set.last().map(|(_, value)| value.to_string())))
            .collect()
    };
    assert_eq!(runs(&seeds), ["fast Some(\"16\")", "fast Some(\"64\")"]);
}

#[test]
fn names_mean_what_is_beside_the_study_and_keep_their_words() {
    let text = "Study(about: \"x\", scenes: [\"here\"], pipelines: [\"neighbour\"], output: \"indirect\", size: (8, 4), \
                budget: Frames(1), measures: [\"rel-mse\"], reference: Pipeline(pipeline: \"neighbour\"))";
    let found =
        plan(::study::parse(Source::new("mine/a.ron", text)).unwrap_or_else(|error| panic!("{error}")));
    for run in found.distinct_runs() {
        assert_eq!((&*run.scene, &*run.pipeline), ("box", "fast"));
    }
    assert_eq!(found.pipelines[0].name, "neighbour");
    assert_eq!(found.scenes[0].record.name, "here");
}

#[test]
fn a_name_that_could_mean_another_file_is_noted() {
    let study = |pipeline: &str, reference: &str| {
        let text = format!(
            "Study(about: \"x\", scenes: [\"here\"], pipelines: [\"{pipeline}\"], output: \"indirect\", size: (8, 4), \
             budget: Frames(1), measures: [\"rel-mse\"], reference: Pipeline(pipeline: \"{reference}\"))"
        );
        plan(::study::parse(Source::new("mine/a.ron", text)).unwrap_or_else(|error| panic!("{error}"))).notes
    };
    let notes = study("neighbour", "neighbour");
    assert_eq!(notes.0.len(), 2, "one at each place: {notes}");
    let told = notes.to_string();
    assert!(
        told.starts_with("note[W002]: `neighbour` means `fast`, and there is `pipelines/neighbour.ron` too"),
        "{told}"
    );
    assert!(told.contains("mine/a.ron:1:"), "{told}");
    assert!(study("fast", "exact").0.is_empty());
}
