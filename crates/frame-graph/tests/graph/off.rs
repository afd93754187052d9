//! What stands in place of passes and sub-graphs that are off, where that is another link.

use super::kinds::{MemoryFiles, TestPassTypes, traits};
use frame_graph::plan::{Fate, Plan};
use frame_graph::{
    CompileOptions, Diagnostics, LinkContext, Overrides, Resolved, Traits, Value, compile, link, resolve,
};

/// Exact maps in a still scene, imperfect ones where it is glossy, else those of the floor.
const MAPS: &str = r#"Pipeline(
    parameters: { "exact": Bool(default: true) },
    passes: {
        "image": Pass(kind: "gather", in: { "view": "view", "lights": "lights", "visibility": "exact" }),
        "exact": Pass(kind: "shadows", in: { "lights": "lights" }, when: "$exact", off: "imperfect"),
        "imperfect": Pass(kind: "shadows", in: { "lights": "many" }, when: "scene.glossy", off: "floor.atlas", set: { "map": 32 }),
        "floor": Pass(kind: "shadows", in: { "lights": "lights" }, set: { "map": 16 }),
        "lights": Pass(kind: "lights", in: { "view": "view" }),
        "many": Pass(kind: "lights", in: { "view": "view" }),
        "view": Pass(kind: "gbuffer"),
    },
    outputs: { "image": "image" },
)"#;

const PART: &str = r#"Pipeline(
    inputs: { "view": "GBuffer", "other": "Irradiance" },
    passes: {
        "noise": Pass(kind: "noise", when: "scene.glossy", off: "in.other"),
        "blur": Pass(kind: "blur", in: { "irradiance": "noise" }),
    },
    outputs: { "soft": "blur", "view": "in.view" },
)"#;

fn resolved(text: &str, overrides: &[(&str, Value)]) -> Resolved {
    let files = MemoryFiles::new(&[("main.ron", text), ("part.ron", PART)]);
    let overrides = overrides.iter().map(|(path, value)| ((*path).to_owned(), value.clone()));
    resolve("main.ron", &files, &Overrides(overrides.collect())).unwrap_or_else(|e| panic!("{e}"))
}

fn try_plan(resolved: &Resolved, glossy: bool) -> Result<Plan, Diagnostics> {
    let mut traits: Traits = traits();
    traits.values.insert("glossy".into(), Value::Bool(glossy));
    let graph = link(resolved, &TestPassTypes::new(), &LinkContext { frame: (64, 64), traits })?;
    compile(&graph, &CompileOptions::default())
}

fn plan(text: &str, overrides: &[(&str, Value)], glossy: bool) -> Plan {
    try_plan(&resolved(text, overrides), glossy).unwrap_or_else(|e| panic!("{e}"))
}

fn read(plan: &Plan, pass: &str, input: &str) -> String {
    let pass = &plan.passes[plan.pass(pass).expect("the pass runs").0 as usize];
    let input = pass.inputs.iter().find(|i| i.port == *input).expect("the input is linked");
    plan.resources[input.members[0].1.0 as usize].name.to_string()
}

fn names(plan: &Plan) -> Vec<&str> {
    let mut names: Vec<&str> = plan.passes.iter().map(|pass| pass.name.as_str()).collect();
    names.sort_unstable();
    names
}

fn instead<'p>(plan: &'p Plan, pass: &str) -> &'p str {
    match &plan.fates.iter().find(|(name, _)| name == pass).expect("a pass").1 {
        Fate::Off { instead, .. } => instead,
        other => panic!("`{pass}` is {other}"),
    }
}

#[test]
fn another_pass_stands_in_place_and_is_needed_only_then() {
    let off = ("exact", Value::Bool(false));
    let exact = plan(MAPS, &[], false);
    assert_eq!(read(&exact, "image", "visibility"), "exact.atlas");
    assert_eq!(names(&exact), ["exact", "image", "lights", "view"]);
    let imperfect = plan(MAPS, std::slice::from_ref(&off), true);
    assert_eq!(read(&imperfect, "image", "visibility"), "imperfect.atlas");
    assert_eq!(names(&imperfect), ["image", "imperfect", "lights", "many", "view"]);
    assert_eq!(instead(&imperfect, "exact"), "`imperfect.atlas`");
    // Through a second pass that is off.
    let floor = plan(MAPS, &[off], false);
    assert_eq!(read(&floor, "image", "visibility"), "floor.atlas");
    assert_eq!(names(&floor), ["floor", "image", "lights", "view"]);
    assert_eq!(instead(&floor, "exact"), "`floor.atlas`, which `imperfect` leads to");
    assert_eq!(instead(&floor, "imperfect"), "`floor.atlas`");
}

#[test]
fn two_passes_may_each_stand_for_the_other() {
    let text =
        MAPS.replace("when: \"scene.glossy\", off: \"floor.atlas\"", "when: \"!$exact\", off: \"exact\"");
    for (exact, expected) in [(true, "exact.atlas"), (false, "imperfect.atlas")] {
        let plan = plan(&text, &[("exact", Value::Bool(exact))], false);
        assert_eq!(read(&plan, "image", "visibility"), expected);
    }
    // Each reads what the other makes, and its own where that is off: `exact` then waits for nothing.
    let text = r#"Pipeline(
        passes: {
            "b": Pass(kind: "pair", in: { "irradiance": "a" }),
            "a": Pass(kind: "noise", when: "scene.glossy", off: "c"),
            "c": Pass(kind: "blur", in: { "irradiance": "noise" }),
            "noise": Pass(kind: "noise"),
        },
        outputs: { "b": "b.a" },
    )"#;
    let plan = plan(text, &[], false);
    let order: Vec<&str> = plan.passes.iter().map(|pass| pass.name.as_str()).collect();
    assert_eq!(order, ["noise", "c", "b"]);
}

#[test]
fn a_link_stands_in_place_of_a_part_and_crosses_its_border() {
    let text = |when: &str| {
        format!(
            r#"Pipeline(
                passes: {{
                    "view": Pass(kind: "gbuffer"),
                    "second": Pass(kind: "gbuffer", set: {{ "motion": false }}),
                    "pair": Pass(kind: "pair"),
                    "part": Sub(file: "part.ron", in: {{ "view": "view", "other": "pair.b" }}, when: "{when}", off: "spare"),
                    "spare": Pass(kind: "noise"),
                    "soft": Pass(kind: "blur", in: {{ "irradiance": "part.soft" }}),
                }},
                outputs: {{ "soft": "soft" }},
            )"#
        )
    };
    let on = plan(&text("scene.textured"), &[], false);
    assert_eq!(read(&on, "soft", "irradiance"), "part/blur.irradiance");
    // `off: "in.other"` inside the part.
    assert_eq!(read(&on, "part/blur", "irradiance"), "pair.b");
    let off = plan(&text("scene.glossy"), &[], false);
    assert_eq!(read(&off, "soft", "irradiance"), "spare.irradiance");
    assert_eq!(names(&off), ["soft", "spare"]);
    // A member of an output of the sub-graph, from what stands in its place.
    let member = text("scene.glossy")
        .replace("off: \"spare\"", "off: \"second\"")
        .replace("outputs: { \"soft\": \"soft\" }", "outputs: { \"depth\": \"part.view.depth\" }")
        .replace("\"part.soft\"", "\"spare\"");
    let plan = plan(&member, &[], false);
    assert_eq!(plan.output("depth").unwrap().from, "second.view.depth");
}

#[test]
fn the_past_follows_the_link() {
    let text = r#"Pipeline(
        passes: {
            "a": Pass(kind: "noise", when: "scene.glossy", off: "b"),
            "b": Pass(kind: "noise"),
            "first": Pass(kind: "pair", in: { "irradiance": "prev a" }),
        },
        outputs: { "image": "first.a" },
    )"#;
    let plan = plan(text, &[], false);
    assert_eq!(plan.histories.len(), 1);
    assert_eq!(plan.resources[plan.histories[0].resource.0 as usize].name, "b.irradiance");
}

#[test]
fn the_flattened_file_keeps_the_link() {
    for glossy in [false, true] {
        let text = r#"Pipeline(
            passes: {
                "view": Pass(kind: "gbuffer"),
                "spare": Pass(kind: "noise"),
                "part": Sub(file: "part.ron", in: { "view": "view", "other": "spare" }, when: "scene.textured", off: "spare.irradiance"),
            },
            outputs: { "soft": "part.soft" },
        )"#;
        let first = resolved(text, &[]);
        let flat = first.to_ron(&TestPassTypes::new(), false);
        assert!(flat.contains("off: \"in.other\"") && flat.contains("off: \"spare.irradiance\""), "{flat}");
        let second = resolved(&flat, &[]);
        assert_eq!(flat, second.to_ron(&TestPassTypes::new(), false));
        assert_eq!(try_plan(&first, glossy).unwrap().id, try_plan(&second, glossy).unwrap().id);
    }
}
