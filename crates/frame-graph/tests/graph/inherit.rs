//! Parameters that are the whole value of a setting inherit what they do not say.

use super::kinds::{MemoryFiles, TestPassTypes, traits};
use frame_graph::{
    CompileOptions, Diagnostics, LinkContext, Overrides, PlanId, Resolved, Settable, Value, compile, link,
    resolve,
};

const PART: &str = r#"Pipeline(
    parameters: { "side": U32(max: 128), "count": U32(default: 7, doc: "Of the part") },
    inputs: { "view": "GBuffer" },
    passes: {
        "lights": Pass(kind: "lights", in: { "view": "in.view" }, set: { "count": "$count" }),
        "splat": Pass(kind: "shadows", in: { "lights": "lights" }, set: { "map": "$side" }),
    },
    outputs: { "visibility": "splat", "lights": "lights" },
)"#;

const MAIN: &str = r#"Pipeline(
    parameters: {
        "map": U32(),
        "many": U32(default: 256, doc: "Lights of the first"),
        "radius": F32(max: 8),
        "mode": Text(),
        "twice": U32(default: 3),
    },
    passes: {
        "view": Pass(kind: "gbuffer"),
        "lights": Pass(kind: "lights", in: { "view": "view" }, set: { "count": "$many", "mode": "$mode" }),
        "maps": Sub(file: "part.ron", in: { "view": "view" }, set: { "side": "$map", "count": "$twice * 2" }),
        "gather": Pass(kind: "gather", in: { "view": "view", "lights": "lights", "visibility": "maps.visibility" }),
        "blur": Pass(kind: "blur", in: { "irradiance": "gather" }, set: { "radius": "$radius" }),
    },
    outputs: { "image": "blur" },
)"#;

fn resolved(text: &str, overrides: &[(&str, Value)]) -> Result<Resolved, Diagnostics> {
    let files = MemoryFiles::new(&[("main.ron", text), ("part.ron", PART)]);
    let overrides = overrides.iter().map(|(path, value)| ((*path).to_owned(), value.clone()));
    resolve("main.ron", &files, &Overrides(overrides.collect()))
}

fn id(resolved: &Resolved) -> Result<PlanId, Diagnostics> {
    let context = LinkContext { frame: (64, 64), traits: traits() };
    let graph = link(resolved, &TestPassTypes::new(), &context)?;
    Ok(compile(&graph, &CompileOptions::default())?.id)
}

fn settable(resolved: &Resolved, path: &str) -> Settable {
    resolved.settable(&TestPassTypes::new()).into_iter().find(|s| s.path == path).expect("something to set")
}

#[test]
fn what_a_parameter_does_not_say_is_that_of_its_setting() {
    let base = resolved(MAIN, &[]).unwrap();
    let map = settable(&base, "map");
    // Through the sub-graph, whose own bound is tighter.
    assert_eq!((map.setting.min, map.setting.max), (Some(1.0), Some(128.0)));
    assert_eq!((&map.value, &map.setting.default), (&Value::U32(64), &Value::U32(64)));
    assert_eq!(settable(&base, "maps.side").setting.max, Some(128.0));
    let many = settable(&base, "many");
    assert_eq!((many.setting.min, many.setting.max, many.value), (Some(1.0), Some(65536.0), Value::U32(256)));
    assert_eq!(many.setting.doc, "Lights of the first");
    let radius = settable(&base, "radius");
    assert_eq!(
        (radius.setting.min, radius.setting.max, radius.value),
        (Some(0.0), Some(8.0), Value::F32(4.0))
    );
    assert_eq!(settable(&base, "mode").setting.one_of.len(), 2);
    // What goes into an expression is not the whole value.
    assert_eq!(settable(&base, "twice").setting.max, None);
    assert_eq!(settable(&base, "maps.count").value, Value::U32(6));
    // A value given to the setting itself changes nothing of what its parameter is.
    let given = resolved(MAIN, &[("blur.radius", Value::U32(2)), ("maps/splat.map", Value::U32(2))]).unwrap();
    assert_eq!(settable(&given, "radius").setting, radius.setting);
    assert_eq!(settable(&given, "map").setting, map.setting);
    for found in base.settable(&TestPassTypes::new()) {
        assert!(found.setting.check(found.value.clone()).is_ok(), "{}", found.path);
        let again = resolved(MAIN, &[(&*found.path, found.value)]);
        assert_eq!(id(&again.unwrap()).unwrap(), id(&base).unwrap(), "{}", found.path);
    }
}

#[test]
fn values_out_of_an_inherited_range_are_reported_where_they_are_given() {
    let error = id(&resolved(MAIN, &[("many", Value::U32(70_000))]).unwrap()).unwrap_err();
    let text = error.to_string();
    assert_eq!(error.0[0].code, "E024");
    assert!(text.contains("from 1 to 65536, and 70000 is not") && text.contains("--set:1:6"), "{text}");
}

#[test]
fn the_flattened_file_inherits_the_same() {
    for overrides in [&[][..], &[("map", Value::U32(32)), ("radius", Value::F32(1.5))]] {
        let first = resolved(MAIN, overrides).unwrap();
        let flat = first.to_ron(&TestPassTypes::new(), false);
        let second = resolved(&flat, &[]).unwrap_or_else(|e| panic!("{e}\n{flat}"));
        assert_eq!(flat, second.to_ron(&TestPassTypes::new(), false));
        assert_eq!(id(&first).unwrap(), id(&second).unwrap(), "{flat}");
        for path in ["map", "radius", "mode"] {
            assert_eq!(settable(&first, path).value, settable(&second, path).value);
        }
    }
}
