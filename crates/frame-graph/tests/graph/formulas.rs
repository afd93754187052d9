//! Values of settings and sizes that are worked out from parameters.

use super::kinds::{MemoryFiles, TestPassTypes, traits};
use frame_graph::plan::Plan;
use frame_graph::{CompileOptions, LinkContext, Overrides, ResourceDesc, Value, compile, link, resolve};
use proptest::prelude::*;

const PART: &str = r#"Pipeline(
    inputs: { "view": "GBuffer" },
    parameters: { "count": U32(default: 1) },
    passes: { "lights": Pass(kind: "lights", in: { "view": "in.view" }, set: { "count": "2 * $count + 1" }) },
    outputs: { "lights": "lights" },
)"#;

fn text(set: &str) -> String {
    format!(
        r#"Pipeline(
            parameters: {{ "lights": U32(default: 100), "share": F32(default: 0.25), "mode": Text(default: "gauss"), "fine": Bool(default: true) }},
            passes: {{
                "view": Pass(kind: "gbuffer"),
                "noise": Pass(kind: "noise"),
                "blur": Pass(kind: "blur", in: {{ "irradiance": "noise" }}, set: {{ {set} }}),
                "part": Sub(file: "part.ron", in: {{ "view": "view" }}, set: {{ "count": "$lights * 4" }}),
                "full": Pass(kind: "fullscreen", shader: "a.wgsl", set: {{ "strength": "min($share * 2, 1)" }},
                    out: {{ "out": Out(size: ("max($lights, 128)", "($lights + 1) / 2")) }}),
                "like": Pass(kind: "fullscreen", shader: "a.wgsl", in: {{ "x": "full" }},
                    out: {{ "out": Out(size: "like(x) * ($lights / 50) / max(2, 4)") }}),
            }},
            outputs: {{ "blur": "blur", "lights": "part", "like": "like" }},
        )"#
    )
}

fn plan(text: &str, overrides: &[(&str, Value)]) -> (Plan, String) {
    let files = MemoryFiles::new(&[("main.ron", text), ("part.ron", PART)]);
    let overrides = overrides.iter().map(|(path, value)| ((*path).to_owned(), value.clone())).collect();
    let resolved = resolve("main.ron", &files, &Overrides(overrides)).unwrap_or_else(|e| panic!("{e}"));
    let context = LinkContext { frame: (64, 64), traits: traits() };
    let graph = link(&resolved, &TestPassTypes::new(), &context).unwrap_or_else(|e| panic!("{e}"));
    (compile(&graph, &CompileOptions::default()).unwrap(), resolved.to_ron(&TestPassTypes::new(), true))
}

fn setting(plan: &Plan, pass: &str, setting: &str) -> Value {
    plan.passes[plan.pass(pass).unwrap().0 as usize].settings.get(setting).unwrap().clone()
}

fn size(plan: &Plan, resource: &str) -> (u32, u32) {
    match &plan.resources[plan.resource(resource).unwrap().0 as usize].desc {
        ResourceDesc::Texture(texture) => texture.size,
        ResourceDesc::Buffer(_) => panic!("{resource} is a buffer"),
    }
}

#[test]
fn settings_counts_and_sizes_follow_parameters() {
    let set = r#""radius": "$share * 8 + 1", "offset": "-($lights - 103) % 2", "mode": "$mode""#;
    let (plain, flat) = plan(&text(set), &[]);
    assert_eq!(setting(&plain, "blur", "radius"), Value::F32(3.0));
    assert_eq!(setting(&plain, "blur", "offset"), Value::I32(1));
    assert_eq!(setting(&plain, "blur", "mode"), Value::Text("gauss".into()));
    // The rest of a number that is not whole: 5.5 less 4.
    let (rest, _) = plan(&text(r#""radius": "$share * 22 % 4""#), &[]);
    assert_eq!(setting(&rest, "blur", "radius"), Value::F32(1.5));
    // Through a part: 2 · (100 · 4) + 1.
    assert_eq!(setting(&plain, "part/lights", "count"), Value::U32(801));
    assert_eq!(setting(&plain, "full", "strength"), Value::F32(0.5));
    // Whole numbers divide towards zero; what a size is divided by rounds up.
    assert_eq!(size(&plain, "full.out"), (128, 50));
    assert_eq!(size(&plain, "like.out"), (64, 25));
    assert!(
        flat.contains("\"count\": 801,  // part.ron:4:89: (2 * $count) + 1, count = 400 (main.ron:7:"),
        "{flat}"
    );

    let (more, _) = plan(&text(set), &[("lights", Value::U32(200))]);
    assert_eq!(setting(&more, "part/lights", "count"), Value::U32(1601));
    assert_eq!(size(&more, "full.out"), (200, 100));
    // What is given from outside comes last, as for plain values.
    let (given, _) = plan(&text(set), &[("part.count", Value::U32(5)), ("blur.radius", Value::U32(7))]);
    assert_eq!(setting(&given, "part/lights", "count"), Value::U32(11));
    assert_eq!(setting(&given, "blur", "radius"), Value::F32(7.0));
}

#[test]
fn dollars_in_plain_text_are_doubled() {
    let strange = |written: &str| {
        let text = text("").replace(r#"Text(default: "gauss")"#, &format!("Text(default: {written:?})"));
        let files = MemoryFiles::new(&[("main.ron", &text), ("part.ron", PART)]);
        let resolved = resolve("main.ron", &files, &Overrides::default()).unwrap_or_else(|e| panic!("{e}"));
        let settable = resolved.settable(&TestPassTypes::new());
        let value = settable.iter().find(|s| s.path == "mode").unwrap().value.clone();
        let plain = resolved.to_ron(&TestPassTypes::new(), false);
        let flat = MemoryFiles::new(&[("main.ron", &plain)]);
        let again = resolve("main.ron", &flat, &Overrides::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(plain, again.to_ron(&TestPassTypes::new(), false));
        value.as_text().unwrap().to_owned()
    };
    assert_eq!(strange("$$a"), "$a");
    assert_eq!(strange("$$lights * 2 + $b"), "$lights * 2 + $b");
    assert_eq!(strange("costs 3 $$"), "costs 3 $");
    assert_eq!(strange("$$$$a$$"), "$$a$");
}

#[test]
fn switches_reckon_too() {
    let with = |when: &str| {
        let switched =
            text("").replace("set: {  }", &format!("when: \"{when}\", off: Input(\"irradiance\")"));
        plan(&switched, &[]).0.pass("blur").is_some()
    };
    assert!(with("$lights * 4 - 1 == 399 && scene.point_lights + 1 > 2"));
    assert!(!with("max($lights, 3, scene.point_lights * 100) != 200"));
    assert!(with("-(0 - 3) * 2 == 6 && - 3 < 1 - 3"));
    // What is not asked is not reckoned: there are two point lights.
    assert!(!with("scene.point_lights != 2 && 1 / (scene.point_lights - 2) > 0"));
}

/// An expression as text, and its value by other means: `None` where it has none.
fn formula() -> impl Strategy<Value = (String, Option<i128>)> {
    let leaf = prop_oneof![
        (0..5000i128).prop_map(|n| (n.to_string(), Some(n))),
        Just(("$lights".to_owned(), Some(100))),
        Just(("-3".to_owned(), Some(-3))),
    ];
    leaf.prop_recursive(5, 24, 2, |inner| {
        (inner.clone(), inner, 0..7usize).prop_map(|((a, x), (b, y), op)| {
            let both = x.zip(y);
            let held = |n: i128| i64::try_from(n).is_ok().then_some(n);
            let (text, value) = match op {
                0 => (format!("({a}) + {b}"), both.map(|(x, y)| x + y)),
                1 => (format!("{a} - ({b})"), both.map(|(x, y)| x - y)),
                2 => (format!("({a})*({b})"), both.map(|(x, y)| x * y)),
                3 => (format!("({a}) / ({b})"), both.and_then(|(x, y)| x.checked_div(y))),
                4 => (format!("({a})%({b})"), both.and_then(|(x, y)| x.checked_rem(y))),
                5 => (format!("min({a}, {b})"), both.map(|(x, y)| x.min(y))),
                _ => (format!("-max({a},{b})"), both.map(|(x, y)| -x.max(y))),
            };
            (format!("({text})"), value.and_then(held))
        })
    })
}

proptest! {
    #[test]
    fn whole_numbers_stay_whole((written, expected) in formula()) {
        let text = format!(
            r#"Pipeline(
                parameters: {{ "lights": U32(default: 100), "unused": U32(default: 0) }},
                passes: {{ "sum": Pass(kind: "noise", set: {{ "n": "{written} + $unused" }}) }},
                outputs: {{ "image": "sum" }},
            )"#
        );
        let files = MemoryFiles::new(&[("main.ron", &text)]);
        let found = resolve("main.ron", &files, &Overrides::default());
        let whole = |n| u32::try_from(n).map(Value::U32).or_else(|_| i32::try_from(n).map(Value::I32)).ok();
        match expected.and_then(whole) {
            None => prop_assert!(found.is_err(), "{written}"),
            Some(value) => {
                let flat = found.unwrap_or_else(|e| panic!("{e}")).to_ron(&TestPassTypes::new(), true);
                prop_assert!(flat.contains(&format!("\"n\": {value},")), "{written}: {flat}");
            }
        }
    }
}
