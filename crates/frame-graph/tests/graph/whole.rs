//! From text to plan and frame.

use super::kinds::{MemoryFiles, TestPassTypes, traits};
use frame_graph::plan::Fate;
use frame_graph::{
    Change, CompileOptions, Diagnostics, FrameState, LinkContext, Overrides, Plan, Value, compile, link,
    resolve,
};

pub(super) const BASE: &str = r#"
Pipeline(
    about: "All the usual",
    paper: "ISM §3",
    parameters: { "count": U32(default: 256, min: 1, max: 4096), "map": U32(default: 64, one_of: [32, 64, 128]) },
    passes: {
        "view": Pass(kind: "gbuffer"),
        "lights": Pass(kind: "lights", in: { "view": "view" }, set: { "count": "$count" }),
        "shadows": Sub(file: "parts/shadows.ron", in: { "lights": "lights" }, set: { "map": "$map" }),
        "gather": Pass(kind: "gather", in: { "view": "view", "lights": "lights", "visibility": "shadows" }),
        "filter": Pass(kind: "blur", in: { "view": "view", "irradiance": "gather" }),
        "glossy": Pass(kind: "gather", in: { "view": "view", "lights": "lights" }, when: "scene.glossy && $count > 1", off: "filter"),
        "image": Pass(kind: "composite", in: { "indirect": "filter", "glossy": "glossy" }),
        "steady": Pass(kind: "accumulate", in: { "color": "image", "history": "prev steady" }, history: (reset: [Cut])),
        "unused": Pass(kind: "noise"),
    },
    outputs: { "image": "steady", "indirect": "filter", "depth": "view.depth" },
)"#;

pub(super) const SHADOWS: &str = r#"
Pipeline(
    about: "Maps of all lights",
    inputs: { "lights": "Lights" },
    parameters: { "map": U32(default: 32) },
    passes: { "splat": Pass(kind: "shadows", in: { "lights": "in.lights" }, set: { "map": "$map" }) },
    outputs: { "visibility": "splat" },
)"#;

pub(super) fn plan_of(files: &[(&str, &str)], path: &str) -> Result<Plan, Diagnostics> {
    let files = MemoryFiles::new(files);
    let resolved = resolve(path, &files, &Overrides::default())?;
    let context = LinkContext { frame: (1920, 1080), traits: traits() };
    compile(&link(&resolved, &TestPassTypes::new(), &context)?, &CompileOptions::default())
}

#[test]
fn a_whole_pipeline_compiles_and_runs() {
    let plan = plan_of(&[("base.ron", BASE), ("parts/shadows.ron", SHADOWS)], "base.ron")
        .unwrap_or_else(|e| panic!("{e}"));
    let names: Vec<&str> = plan.passes.iter().map(|pass| pass.name.as_str()).collect();
    assert_eq!(names, ["view", "lights", "shadows/splat", "gather", "filter", "image", "steady"]);
    let fate = |name: &str| &plan.fates.iter().find(|(n, _)| n == name).unwrap().1;
    assert_eq!(*fate("unused"), Fate::Culled { readers: vec![] });
    assert_eq!(
        *fate("glossy"),
        Fate::Off {
            why: "scene.glossy && ($count > 1) (scene.glossy = false, count = 256)".into(),
            instead: "`filter.irradiance`".into()
        }
    );
    assert_eq!(plan.histories.len(), 1);
    let mut state = FrameState::new(&plan);
    let first = state.begin(&plan, &Change::default());
    assert!(first.runs.iter().all(|run| *run));
    let second = state.begin(&plan, &Change::default());
    // Only the loop through the past goes on in a still scene.
    assert_eq!(second.runs, [false, false, false, false, false, false, true]);
    assert_eq!(second.histories[0].age, 1);
}

/// Parameters, those of sub-graphs, and settings of passes: each path is taken back with the value that it has.
#[test]
fn what_can_be_set_is_reported_by_its_path() {
    let files = MemoryFiles::new(&[("base.ron", BASE), ("parts/shadows.ron", SHADOWS)]);
    let base = resolve("base.ron", &files, &Overrides(vec![("map".into(), Value::U32(128))])).unwrap();
    let settable = base.settable(&TestPassTypes::new());
    let value = |path: &str| settable.iter().find(|found| found.path == path).map(|found| &found.value);
    assert_eq!(value("count"), Some(&Value::U32(256)));
    // What `$map` gives reaches the sub-graph, and the pass within it.
    assert_eq!(value("shadows.map"), Some(&Value::U32(128)));
    assert_eq!(value("shadows/splat.map"), Some(&Value::U32(128)));
    assert_eq!(value("splat.map"), None);
    for found in settable {
        assert!(found.setting.check(found.value.clone()).is_ok(), "{}", found.path);
        let again = resolve("base.ron", &files, &Overrides(vec![(found.path.clone(), found.value)]));
        assert!(again.is_ok(), "{}: {}", found.path, again.unwrap_err());
    }
}
