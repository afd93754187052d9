//! The file that holds what overrides change.

use super::kinds::{MemoryFiles, TestPassTypes};
use super::whole::{BASE, SHADOWS};
use frame_graph::{Overrides, Resolved, Value, resolve, variant};

/// A sub-graph with a parameter that comes from outside.
const LOOP: &str = r#"Pipeline(
    parameters: { "radius": F32(default: 2), "wide": U32(default: 8) },
    passes: {
        "noise": Pass(kind: "noise"),
        "loop": Sub(file: "step.ron", in: { "irradiance": "noise" }, set: { "radius": "$radius" }),
        "last": Pass(kind: "blur", in: { "irradiance": "loop" }, set: { "radius": "$wide * 2.0" }),
    },
    outputs: { "image": "last" },
)"#;

const STEP: &str = r#"Pipeline(
    parameters: { "radius": F32() },
    inputs: { "irradiance": "Irradiance" },
    passes: { "blur": Pass(kind: "blur", in: { "irradiance": "in.irradiance" }, set: { "radius": "$radius" }) },
    outputs: { "soft": "blur" },
)"#;

fn files(variant: &str) -> MemoryFiles {
    MemoryFiles::new(&[
        ("base.ron", BASE),
        ("parts/shadows.ron", SHADOWS),
        ("loop.ron", LOOP),
        ("step.ron", STEP),
        ("saved.ron", variant),
    ])
}

fn resolved(path: &str, variant: &str, overrides: &Overrides) -> Resolved {
    resolve(path, &files(variant), overrides).unwrap_or_else(|errors| panic!("{errors}\n{variant}"))
}

/// The text, and whether it resolves to all values that the base has with the overrides.
fn saved(base: &str, about: &str, overrides: &[(&str, Value)]) -> String {
    let overrides = overrides.iter().map(|(path, value)| ((*path).to_owned(), value.clone()));
    let overrides = Overrides(overrides.collect());
    let kinds = TestPassTypes::new();
    let text = variant(base, about, &resolved(base, "", &Overrides::default()), &kinds, &overrides);
    let values = |resolved: Resolved| {
        let settable = resolved.settable(&kinds).into_iter();
        settable.map(|s| (s.path, s.value.convert(s.setting.ty))).collect::<Vec<_>>()
    };
    let found = values(resolved("saved.ron", &text, &Overrides::default()));
    assert_eq!(found, values(resolved(base, "", &overrides)), "{text}");
    text
}

/// The patches of the text, as they are written.
fn patches(base: &str, overrides: &[(&str, Value)]) -> String {
    let text = saved(base, "", overrides);
    let patch = text.split_once("    patch: [").map_or("", |(_, rest)| rest.split_once("],\n)").unwrap().0);
    patch.to_owned()
}

#[test]
fn one_or_two_changes_are_five_lines() {
    let overrides = [("count", Value::U32(512)), ("filter.radius", Value::F32(2.5))];
    let expected = "Pipeline(
    extends: \"base.ron\",
    about: \"More lights, and \\\"sharper\\\"\",
    patch: [Set(\"count\", 512), Set(\"filter.radius\", 2.5)],
)
";
    assert_eq!(saved("base.ron", "More lights, and \"sharper\"", &overrides), expected);
}

#[test]
fn many_changes_are_below_each_other() {
    let overrides = [
        ("filter.mode", Value::Text("gauss".into())),
        ("filter.weights", Value::Vector(vec![0.25, 0.75])),
        ("filter.offset", Value::I32(-3)),
        ("view.motion", Value::Bool(false)),
    ];
    let expected = "Pipeline(
    extends: \"base.ron\",
    patch: [
        Set(\"filter.mode\", \"gauss\"),
        Set(\"filter.weights\", (0.25, 0.75)),
        Set(\"filter.offset\", -3),
        Set(\"view.motion\", false),
    ],
)
";
    assert_eq!(saved("base.ron", "", &overrides), expected);
}

#[test]
fn values_of_the_base_are_left_out() {
    let own = [
        ("count", Value::U32(256)),
        ("filter.radius", Value::U32(4)),
        ("lights.mode", Value::Text("uniform".into())),
        ("shadows.map", Value::U32(64)),
        ("shadows/splat.map", Value::U32(64)),
    ];
    assert_eq!(saved("base.ron", "", &own), "Pipeline(\n    extends: \"base.ron\",\n)\n");
    let again = [("count", Value::U32(7)), ("filter.radius", Value::F32(1.0)), ("count", Value::U32(256))];
    assert_eq!(patches("base.ron", &again), "Set(\"filter.radius\", 1.0)");
    let twice = [("count", Value::U32(7)), ("filter.radius", Value::F32(1.0)), ("count", Value::U32(9))];
    assert_eq!(patches("base.ron", &twice), "Set(\"filter.radius\", 1.0), Set(\"count\", 9)");
}

#[test]
fn values_of_the_base_stay_where_another_change_would_reach_them() {
    // The setting takes its value from the parameter that changes.
    let pinned = [("count", Value::U32(7)), ("lights.count", Value::U32(256))];
    assert_eq!(patches("base.ron", &pinned), "Set(\"count\", 7), Set(\"lights.count\", 256)");
    let computed = [("wide", Value::U32(3)), ("last.radius", Value::F32(16.0))];
    assert_eq!(patches("loop.ron", &computed), "Set(\"wide\", 3), Set(\"last.radius\", 16.0)");
    let inner = [("map", Value::U32(32)), ("shadows.map", Value::U32(64))];
    assert_eq!(patches("base.ron", &inner), "Set(\"map\", 32), Set(\"shadows.map\", 64)");
    // A plain change of one setting reaches nothing else.
    let apart = [("last.offset", Value::I32(2)), ("last.radius", Value::F32(16.0))];
    assert_eq!(patches("loop.ron", &apart), "Set(\"last.offset\", 2)");
}
