//! Values that have no effect.

use super::kinds::MemoryFiles;
use frame_graph::{Overrides, Resolved, Value, resolve};

const BASE: &str = r#"Pipeline(
    parameters: { "radius": F32(default: 2.0), "count": U32(default: 4) },
    passes: {
        "view": Pass(kind: "gbuffer"),
        "lights": Pass(kind: "lights", in: { "view": "view" }, set: { "count": "$count" }),
        "gather": Pass(kind: "gather", in: { "view": "view", "lights": "lights" }),
        "blur": Pass(kind: "blur", in: { "irradiance": "gather" }, set: { "radius": "$radius" }),
        "image": Pass(kind: "composite", in: { "indirect": "blur" }),
    },
    outputs: { "image": "image" },
)"#;

fn resolved(variant: &str, overrides: &[(&str, u32)]) -> Resolved {
    let variant = format!("Pipeline(extends: \"base.ron\", {variant})");
    let files = MemoryFiles::new(&[("base.ron", BASE), ("variant.ron", &variant)]);
    let overrides = overrides.iter().map(|(path, value)| ((*path).to_owned(), Value::U32(*value)));
    resolve("variant.ron", &files, &Overrides(overrides.collect())).unwrap_or_else(|error| panic!("{error}"))
}

fn warnings(variant: &str) -> String {
    resolved(variant, &[]).warnings().to_string()
}

#[test]
fn a_new_parameter_that_nothing_uses_is_reported_with_the_nearest_name() {
    let found = warnings(r#"parameters: { "raduis": F32(default: 3.0) }"#);
    let place = "warning[W003]: nothing uses the parameter `raduis`";
    assert!(found.contains(place) && found.contains("variant.ron:1:45"), "{found}");
    assert!(found.contains("did you mean `radius`?"), "{found}");
    // Another default of an inherited parameter, and a new one that is used.
    assert_eq!(warnings(r#"parameters: { "radius": F32(default: 3.0) }"#), "");
    let used = r#"parameters: { "r": F32(default: 3.0) }, patch: [ Set("blur.radius", "$r") ]"#;
    assert_eq!(warnings(used), "");
    let in_switch = r#"parameters: { "on": Bool(default: true) },
        passes: { "more": Pass(kind: "noise", when: "$on", off: "blur") }"#;
    assert_eq!(warnings(in_switch), "");
}

#[test]
fn an_inherited_parameter_is_reported_where_the_file_sets_it_in_vain() {
    let replaced = r#"Replace("lights", Pass(kind: "lights"))"#;
    assert_eq!(warnings(&format!("patch: [ {replaced} ]")), "");
    let found = warnings(&format!(r#"patch: [ {replaced}, Set("count", 8) ]"#));
    assert!(found.contains("nothing uses the parameter `count`"), "{found}");
}

#[test]
fn a_value_that_a_later_patch_takes_away_is_reported() {
    let found = warnings(r#"patch: [ Set("lights.count", 8), Replace("lights", Pass(kind: "lights")) ]"#);
    assert!(
        found.contains("the value of `lights.count` has no effect: `lights` is patched after it"),
        "{found}"
    );
    let after = r#"patch: [ Replace("lights", Pass(kind: "lights")), Set("lights.count", 8) ]"#;
    assert_eq!(warnings(after), "");
}

#[test]
fn a_value_that_is_given_twice_is_reported() {
    let found = warnings(r#"patch: [ Set("lights.count", 8), Set("lights.count", 9) ]"#);
    assert!(found.contains("`lights.count` is set twice: the first value has no effect"), "{found}");
    assert_eq!(warnings(r#"patch: [ Set("lights.count", 8), Set("blur.radius", 9) ]"#), "");
    let given = resolved("patch: []", &[("count", 8), ("count", 9)]).warnings().to_string();
    assert!(given.contains("`count` is set twice"), "{given}");
    // From outside is another place than in the file.
    let both = resolved(r#"patch: [ Set("lights.count", 8) ]"#, &[("lights.count", 9)]);
    assert!(both.warnings().0.is_empty());
}
