//! Sub-graphs that are repeated.

use super::kinds::{MemoryFiles, TestPassTypes, traits};
use frame_graph::plan::Plan;
use frame_graph::{
    CompileOptions, Diagnostics, LinkContext, Overrides, Resolved, Value, compile, link, resolve,
};

const STEP: &str = r#"Pipeline(
    parameters: { "radius": F32(default: 1) },
    inputs: { "irradiance": "Irradiance", "view": Optional("GBuffer"), "before": Optional("Irradiance") },
    passes: {
        "old": Pass(kind: "blur", in: { "irradiance": "in.before" }, when: "connected(irradiance)", off: "in.irradiance"),
        "blur": Pass(kind: "blur", in: { "irradiance": "in.irradiance", "view": "in.view" }, set: { "radius": "$radius" }),
        "mix": Pass(kind: "mix", in: { "a": "blur", "b": "blur" }),
    },
    outputs: { "soft": "blur", "mixed": "mix" },
)"#;

/// A sub-graph that repeats another.
const OUTER: &str = r#"Pipeline(
    parameters: { "n": U32(default: 2) },
    inputs: { "irradiance": "Irradiance" },
    passes: { "inner": Sub(file: "step.ron", in: { "irradiance": "in.irradiance" }, repeat: "$n", carry: { "irradiance": "soft" }) },
    outputs: { "soft": "inner.soft" },
)"#;

fn text(more: &str, outputs: &str) -> String {
    format!(
        r#"Pipeline(
            parameters: {{ "n": U32(default: 3) }},
            passes: {{
                "view": Pass(kind: "gbuffer"),
                "noise": Pass(kind: "noise"),
                "loop": Sub(file: "step.ron", in: {{ "irradiance": "noise", "view": "view" }}, repeat: "$n", carry: {{ "irradiance": "soft" }}{more}),
            }},
            outputs: {{ {outputs} }},
        )"#
    )
}

fn resolved(text: &str, overrides: &[(&str, Value)]) -> Result<Resolved, Diagnostics> {
    let files = MemoryFiles::new(&[("main.ron", text), ("step.ron", STEP), ("outer.ron", OUTER)]);
    let overrides = overrides.iter().map(|(path, value)| ((*path).to_owned(), value.clone()));
    resolve("main.ron", &files, &Overrides(overrides.collect()))
}

fn try_plan(text: &str, overrides: &[(&str, Value)]) -> Result<Plan, Diagnostics> {
    let context = LinkContext { frame: (64, 64), traits: traits() };
    let graph = link(&resolved(text, overrides)?, &TestPassTypes::new(), &context)?;
    compile(&graph, &CompileOptions::default())
}

fn plan(text: &str, overrides: &[(&str, Value)]) -> Plan {
    try_plan(text, overrides).unwrap_or_else(|e| panic!("{e}"))
}

fn names(plan: &Plan) -> Vec<&str> {
    plan.passes.iter().map(|pass| pass.name.as_str()).collect()
}

fn read(plan: &Plan, pass: &str, input: &str) -> String {
    let pass = &plan.passes[plan.pass(pass).expect("the pass runs").0 as usize];
    let input = pass.inputs.iter().find(|i| i.port == *input).expect("the input is linked");
    plan.resources[input.members[0].1.0 as usize].name.to_string()
}

fn radii(plan: &Plan) -> Vec<f32> {
    let blurs = plan.passes.iter().filter(|pass| pass.name.ends_with("/blur"));
    blurs
        .map(|pass| pass.settings.get("radius").and_then(Value::as_f32).expect("a blur has a radius"))
        .collect()
}

#[test]
fn each_copy_takes_what_the_one_before_it_made() {
    let plan = plan(&text("", r#""soft": "loop.soft", "mixed": "loop.mixed""#), &[]);
    assert_eq!(names(&plan), ["view", "noise", "loop/0/blur", "loop/1/blur", "loop/2/blur", "loop/2/mix"]);
    assert_eq!(read(&plan, "loop/0/blur", "irradiance"), "noise.irradiance");
    assert_eq!(read(&plan, "loop/1/blur", "irradiance"), "loop/0/blur.irradiance");
    assert_eq!(read(&plan, "loop/2/blur", "irradiance"), "loop/1/blur.irradiance");
    // What is not carried goes into every copy.
    assert_eq!(read(&plan, "loop/2/blur", "view"), "view.view.depth");
    assert_eq!(plan.output("soft").unwrap().from, "loop/2/blur.irradiance");
}

#[test]
fn without_a_copy_what_is_carried_is_handed_through() {
    let none = ("n", Value::U32(0));
    let through = plan(&text("", r#""soft": "loop.soft""#), std::slice::from_ref(&none));
    assert_eq!(through.output("soft").unwrap().from, "noise.irradiance");
    assert_eq!(names(&through), ["noise"]);
    let error = try_plan(&text("", r#""mixed": "loop.mixed""#), &[none]).unwrap_err();
    assert_eq!(error.0[0].code, "E047", "{error}");
    // Whoever reads it may be off then.
    let reader = |when: &str| {
        let reads = format!(
            r#"[ "after": Pass(kind: "mix", in: {{ "a": "loop.mixed", "b": "noise" }}{when}), "loop": Sub"#
        );
        let text = text("", r#""after": "after""#).replace("\"loop\": Sub", reads.trim_start_matches("[ "));
        try_plan(&text, &[("n", Value::U32(0))])
    };
    assert_eq!(reader("").unwrap_err().0[0].code, "E047");
    assert_eq!(
        reader(r#", when: "$n > 0", off: "noise""#).unwrap().output("after").unwrap().from,
        "noise.irradiance"
    );
    // The sub-graph is checked all the same.
    let error =
        try_plan(&text(", set: { \"raduis\": 2 }", r#""soft": "loop.soft""#), &[("n", Value::U32(0))]);
    assert_eq!(error.unwrap_err().0[0].code, "E017");
}

#[test]
fn a_copy_knows_its_number() {
    let indexed = |more: &str| text(&format!(r#", index: "radius"{more}"#), r#""soft": "loop.soft""#);
    assert_eq!(radii(&plan(&indexed(""), &[])), [0.0, 1.0, 2.0]);
    // Said for a copy or for all, another value comes after.
    assert_eq!(radii(&plan(&indexed(""), &[("loop/1.radius", Value::F32(9.0))])), [0.0, 9.0, 2.0]);
    let unknown = text(r#", index: "raduis""#, r#""soft": "loop.soft""#);
    let error = try_plan(&unknown, &[]).unwrap_err();
    assert_eq!(error.0.len(), 1, "{error}");
    assert!(error.to_string().contains("radius"), "{error}");
    let single = unknown.replace(r#"repeat: "$n", carry: { "irradiance": "soft" }, "#, "");
    let error = resolved(&single, &[]).unwrap_err();
    assert!(error.to_string().contains("`index` needs `repeat`"), "{error}");
}

#[test]
fn values_reach_all_copies_or_one() {
    let soft = text(r#", set: { "radius": "$n * 2" }"#, r#""soft": "loop.soft""#);
    let with = |path: &str| radii(&plan(&soft, &[(path, Value::F32(9.0))]));
    assert_eq!(radii(&plan(&soft, &[])), [6.0, 6.0, 6.0]);
    assert_eq!(with("loop.radius"), [9.0, 9.0, 9.0]);
    assert_eq!(with("loop/blur.radius"), [9.0, 9.0, 9.0]);
    assert_eq!(with("loop/1/blur.radius"), [6.0, 9.0, 6.0]);
    assert_eq!(with("loop/2.radius"), [6.0, 6.0, 9.0]);
    // The later one wins, whichever it is.
    let both = [("loop/1/blur.radius", Value::U32(8)), ("loop/blur.radius", Value::U32(7))];
    assert_eq!(radii(&plan(&soft, &both)), [7.0, 7.0, 7.0]);
    let error = try_plan(&soft, &[("loop/3/blur.radius", Value::U32(1))]).unwrap_err();
    assert_eq!((error.0.len(), error.0[0].code), (1, "E017"), "{error}");
    // What can be set is told by paths that are taken back.
    let base = resolved(&soft, &[]).unwrap();
    let settable = base.settable(&TestPassTypes::new());
    for path in ["loop.radius", "loop/2/blur.radius"] {
        assert!(settable.iter().any(|s| s.path == path), "{path}");
    }
    for found in settable {
        assert!(resolved(&soft, &[(&*found.path, found.value)]).is_ok(), "{}", found.path);
    }
}

#[test]
fn parts_that_repeat_parts() {
    let text = r#"Pipeline(
        passes: {
            "noise": Pass(kind: "noise"),
            "loop": Sub(file: "outer.ron", in: { "irradiance": "noise" }, repeat: 2, carry: { "irradiance": "soft" }),
        },
        outputs: { "soft": "loop" },
    )"#;
    let nested = plan(text, &[]);
    let blurs = ["loop/0/inner/0/blur", "loop/0/inner/1/blur", "loop/1/inner/0/blur", "loop/1/inner/1/blur"];
    assert_eq!(names(&nested)[1..], blurs);
    assert_eq!(read(&nested, blurs[2], "irradiance"), "loop/0/inner/1/blur.irradiance");
    let set = [("loop/1/inner/0/blur.radius", Value::U32(5)), ("loop/inner/1.radius", Value::U32(3))];
    assert_eq!(radii(&plan(text, &set)), [1.0, 3.0, 5.0, 3.0]);
    // One of the inner ones has no copy: through it goes what comes in.
    assert_eq!(names(&plan(text, &[("loop/0.n", Value::U32(0))]))[1..], blurs[2..]);
}

#[test]
fn the_past_is_that_of_the_last_copy() {
    let text = text("", r#""soft": "loop.soft", "after": "after""#)
        .replace("\"view\": \"view\" }", "\"view\": \"view\", \"before\": Prev(port: \"loop.soft\", reset: [Cut]) }")
        .replace("\"loop\": Sub", "\"after\": Pass(kind: \"blur\", in: { \"irradiance\": Prev(port: \"loop.soft\", reset: [Cut]) }), \"loop\": Sub")
        .replace("\"soft\" }", "\"soft\", \"view\": \"view\" }")
        .replace(", \"view\": \"view\" }),", " }),");
    let plan = plan(&text, &[]);
    assert_eq!(plan.histories.len(), 1, "{}", plan.to_text());
    assert_eq!(plan.resources[plan.histories[0].resource.0 as usize].name, "loop/2/blur.irradiance");
}

#[test]
fn the_whole_is_switched_as_one() {
    let off = |off: &str| {
        let text = text(&format!(r#", when: "scene.glossy", off: {off}"#), r#""soft": "loop.soft""#);
        plan(&text, &[]).output("soft").unwrap().from.to_string()
    };
    assert_eq!(off(r#"Input("irradiance")"#), "noise.irradiance");
    assert_eq!(off("Black"), "loop/2/blur.irradiance");
    assert_eq!(off(r#""loop-2""#.replace("loop-2", "noise").as_str()), "noise.irradiance");
}

#[test]
fn the_flattened_file_of_copies_says_the_same() {
    for n in [0, 1, 4] {
        let text =
            text(r#", set: { "radius": 3 }, when: "scene.textured", off: Black"#, r#""soft": "loop.soft""#);
        let overrides = [("n", Value::U32(n))];
        let first = resolved(&text, &overrides).unwrap();
        let flat = first.to_ron();
        let second = resolved(&flat, &[]).unwrap_or_else(|e| panic!("{e}\n{flat}"));
        assert_eq!(first, second);
        assert_eq!(plan(&text, &overrides).id, plan(&flat, &[]).id, "{flat}");
    }
}

#[test]
fn copies_end_at_the_limit_of_passes() {
    for n in [70_000, u32::MAX] {
        let error = try_plan(&text("", r#""soft": "loop.soft""#), &[("n", Value::U32(n))]).unwrap_err();
        assert_eq!((error.0.len(), error.0[0].code), (1, "E013"), "{error}");
    }
    let text = r#"Pipeline(
        passes: { "noise": Pass(kind: "noise"), "loop": Sub(file: "outer.ron", in: { "irradiance": "noise" }, set: { "n": 60000 }, repeat: 60000) },
        outputs: { "soft": "loop" },
    )"#;
    let error = try_plan(text, &[]).unwrap_err();
    assert_eq!((error.0.len(), error.0[0].code), (1, "E013"), "{error}");
}
