//! Members of outputs that are resources of an input, handed on under other facts.

use super::kinds::{MemoryFiles, TestPassTypes, traits};
use frame_graph::plan::Plan;
use frame_graph::{
    Change, CompileOptions, Diagnostics, FrameState, LinkContext, Overrides, SceneBindings, Value, compile,
    link, resolve,
};

pub(super) fn plan_with(passes: &str, outputs: &str, options: &CompileOptions) -> Result<Plan, Diagnostics> {
    let text = format!("Pipeline(passes: {{ {passes} }}, outputs: {{ {outputs} }})");
    let resolved = resolve("p.ron", &MemoryFiles::new(&[("p.ron", &text)]), &Overrides::default())?;
    let context = LinkContext { frame: (64, 64), traits: traits() };
    compile(&link(&resolved, &TestPassTypes::new(), &context)?, options)
}

pub(super) fn plan(passes: &str, outputs: &str) -> Plan {
    plan_with(passes, outputs, &CompileOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// The resources that an input of a pass reads, by name.
fn read<'p>(plan: &'p Plan, pass: &str, input: &str) -> Vec<&'p str> {
    let pass = &plan.passes[plan.pass(pass).unwrap().0 as usize];
    let input = pass.inputs.iter().find(|i| i.port == *input).unwrap();
    input.members.iter().map(|(_, id)| plan.resources[id.0 as usize].name.as_str()).collect()
}

const CHAIN: &str = r#"
    "view": Pass(kind: "gbuffer"),
    "first": Pass(kind: "relay", in: { "view": "view" }),
    "second": Pass(kind: "remotion", in: { "view": "first" }),
    "third": Pass(kind: "relay", in: { "view": "second" }, set: { "bias": 0.25 }),
    "lights": Pass(kind: "lights", in: { "view": "third" }),
    "gather": Pass(kind: "gather", in: { "view": "second", "lights": "lights" }),
"#;

/// Through several hand-ons a reader gets the resources of those who made them, each member its own, and the
/// facts of the last; lifetimes reach to the last reader by any name, and nothing is made twice.
#[test]
fn a_reader_gets_what_was_made_under_other_names() {
    let plan = plan(CHAIN, r#""image": "gather""#);
    let members = ["view.view.depth", "view.view.normal", "second.seen.motion"];
    assert_eq!(read(&plan, "lights", "view"), members);
    assert_eq!(read(&plan, "third", "view"), members);
    assert_eq!(read(&plan, "first", "view"), ["view.view.depth", "view.view.normal", "view.view.motion"]);
    let lights = &plan.passes[plan.pass("lights").unwrap().0 as usize];
    assert_eq!(lights.inputs[0].facts.get("bias"), Some(&Value::F32(0.25)));
    let gather = plan.pass("gather").unwrap();
    let depth = &plan.resources[plan.resource("view.view.depth").unwrap().0 as usize];
    assert_eq!((depth.lifetime.1, depth.readers.last()), (gather.0, Some(&gather)));
    assert_eq!(plan.resource("third.seen.depth"), plan.resource("view.view.depth"));
    assert!(plan.resources.iter().all(|r| !r.name.starts_with("first.") && !r.name.starts_with("third.")));
}

#[test]
fn what_hands_on_is_shown() {
    let plan = plan(CHAIN, r#""image": "gather", "view": "third""#);
    assert!(plan.to_text().contains("hands on third.seen.depth = view.view.depth"));
    let dot = plan.to_dot();
    let index = |name: &str| {
        let line = dot.lines().find(|line| line.contains(&format!("[ id=\"{name}\""))).expect("a node");
        line.trim().split_once(' ').expect("an index").0
    };
    for reader in ["lights", "out.view"] {
        assert!(dot.contains(&format!(" {} -> {} [", index("third"), index(reader))), "{dot}");
    }
    assert!(plan.to_svg().contains("hands on"));
    let json = plan.to_json();
    let third = json["passes"].as_array().unwrap().iter().find(|pass| pass["name"] == "third").unwrap();
    assert_eq!(third["outputs"][0]["hands_on"]["motion"], "second.seen.motion");
}

/// A pass that only hands on has no work. Its readers run when what it hands on is new.
#[test]
fn versions_are_those_of_what_is_handed_on() {
    let plan = plan(CHAIN, r#""image": "gather""#);
    let mut state = FrameState::new(&plan);
    let mut run = |scene_bindings| {
        let schedule = state.begin(&plan, &Change { scene_bindings, ..Change::default() });
        let ran = plan.passes.iter().zip(&schedule.runs).filter(|(_, ran)| **ran);
        ran.map(|(pass, _)| pass.name.to_string()).collect::<Vec<_>>()
    };
    assert_eq!(run(SceneBindings::NONE), ["view", "second", "lights", "gather"]);
    assert_eq!(run(SceneBindings::NONE), Vec::<String>::new());
    assert_eq!(run(SceneBindings::CAMERA), ["view", "second", "lights", "gather"]);
    assert_eq!(run(SceneBindings::LIGHTS), ["lights", "gather"]);
}

#[test]
fn what_is_handed_on_can_be_kept_switched_off_and_culled() {
    let keep = CompileOptions { keep: vec!["third.seen.depth".into()], ..CompileOptions::default() };
    let kept = plan_with(CHAIN, r#""image": "gather""#, &keep).unwrap_or_else(|e| panic!("{e}"));
    assert!(kept.resources[kept.resource("view.view.depth").unwrap().0 as usize].persistent);
    // What nobody reads is culled with what hands it on.
    let culled = plan(CHAIN, r#""depth": "first.depth""#);
    let names: Vec<&str> = culled.passes.iter().map(|pass| pass.name.as_str()).collect();
    assert_eq!(names, ["view", "first"]);
    assert_eq!(culled.outputs[0].from, "first.seen.depth");
    // Off, its input goes on in its place.
    let off = r#"in: { "view": "first" }, when: "false", off: Input("view"))"#;
    let through = plan(&CHAIN.replace(r#"in: { "view": "first" })"#, off), r#""image": "gather""#);
    assert_eq!(read(&through, "lights", "view")[2], "view.view.motion");
}

#[test]
fn the_past_of_what_is_handed_on_is_the_past_of_what_was_made() {
    let with = |other: &str| {
        format!(
            r#"{CHAIN} "blur": Pass(kind: "blur", in: {{ "irradiance": "gather", "view": "prev third" }}),
            "other": Pass(kind: "blur", in: {{ "irradiance": "gather", "view": {other} }}),"#
        )
    };
    let outputs = r#""a": "blur", "b": "other""#;
    let plan = plan(&with(r#""view""#), outputs);
    let names: Vec<&str> =
        plan.histories.iter().map(|h| plan.resources[h.resource.0 as usize].name.as_str()).collect();
    assert_eq!(names, ["view.view.depth", "view.view.normal", "second.seen.motion"]);
}

#[test]
fn the_past_is_not_handed_on() {
    let passes = r#""view": Pass(kind: "gbuffer"), "old": Pass(kind: "relay", in: { "view": "prev view" })"#;
    let error = plan_with(passes, r#""d": "old.depth""#, &CompileOptions::default()).unwrap_err();
    assert_eq!(error.0[0].code, "E038");
    assert!(error.to_string().contains("hands on its input `view`, which is a `prev` link"), "{error}");
}
