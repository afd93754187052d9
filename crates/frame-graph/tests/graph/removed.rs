//! What is lost with a pass that a patch removes, and what a comparison reports of it.

use super::kinds::{MemoryFiles, TestPassTypes, traits};
use super::whole::{BASE, SHADOWS};
use frame_graph::{LinkContext, Overrides, Resolved, Severity, diff, link, resolve};

const EMPTY_PART: &str = r#"Pipeline(extends: "parts/shadows.ron", patch: [ Remove("splat") ])"#;

fn resolved(variant: &str) -> Resolved {
    let variant = format!("Pipeline(extends: \"base.ron\", {variant})");
    let files = MemoryFiles::new(&[
        ("base.ron", BASE),
        ("parts/shadows.ron", SHADOWS),
        ("parts/empty.ron", EMPTY_PART),
        ("variant.ron", &variant),
    ]);
    resolve("variant.ron", &files, &Overrides::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn differences(variant: &str) -> Vec<String> {
    let (base, other) = (resolved("patch: []"), resolved(variant));
    diff(&base, &other, &TestPassTypes::new()).iter().map(ToString::to_string).collect()
}

#[test]
fn links_and_outputs_that_are_lost_are_reported() {
    let removed = resolved(r#"patch: [ Remove("filter") ]"#);
    let warnings = removed.warnings();
    let [warning] = &warnings.0[..] else { panic!("one warning: {warnings}") };
    assert_eq!((warning.code, warning.severity), ("W001", Severity::Warning));
    let text = warnings.to_string();
    for part in [
        "warning[W001]: `filter` was removed, and nothing stands in its place: the output `indirect` is lost",
        "variant.ron:1:47",
        "`image` is left without its input `indirect`",
        "the output `indirect` is lost",
    ] {
        assert!(text.contains(part), "no `{part}` in\n{text}");
    }
    let outputs: Vec<&str> = removed.outputs().map(|name| name.as_str()).collect();
    assert_eq!(outputs, ["image", "depth"]);
    // One file has what is left.
    let files = MemoryFiles::new(&[("flat.ron", &removed.to_ron(&TestPassTypes::new(), true))]);
    let again = resolve("flat.ron", &files, &Overrides::default()).unwrap_or_else(|error| panic!("{error}"));
    assert!(again.warnings().0.is_empty());
    assert!(again.outputs().eq(removed.outputs()));
}

#[test]
fn what_is_lost_through_a_sub_graph_is_reported_and_what_is_replaced_is_not() {
    let part = resolved(
        r#"patch: [ Replace("shadows", Sub(file: "parts/empty.ron", in: { "lights": "lights" })) ]"#,
    );
    let warnings = part.warnings();
    assert!(warnings.to_string().contains("`gather` is left without its input `visibility`"), "{warnings}");
    // No output is lost: that is no more than a note.
    assert_eq!(warnings.0[0].severity, Severity::Note);
    for kept in [
        "patch: []",
        r#"patch: [ Remove("unused") ]"#,
        r#"patch: [ Remove("glossy") ]"#,
        r#"patch: [ Insert(name: "soft", pass: Pass(kind: "blur"), between: ("gather", "filter")), Remove("soft") ]"#,
    ] {
        let warnings = resolved(kept).warnings();
        assert!(warnings.0.is_empty(), "{kept}: {warnings}");
    }
}

#[test]
fn a_comparison_shows_what_is_lost() {
    assert_eq!(
        differences(r#"patch: [ Remove("filter") ]"#),
        [
            "~ pass filter: blur → removed",
            "- link filter.view: \"view\"",
            "- link filter.irradiance: \"gather\"",
            "- link image.indirect: \"filter\"",
            "- output indirect: \"filter\"",
        ]
    );
}

#[test]
fn a_setting_at_its_default_is_no_difference() {
    assert_eq!(differences(r#"patch: [ Set("filter.radius", 4) ]"#), [""; 0]);
    assert_eq!(differences(r#"patch: [ Set("filter.radius", 2) ]"#), ["~ setting filter.radius: 4.0 → 2.0"]);
    // A parameter without a default is what the setting is that it is handed to.
    let inherited = r#"parameters: { "r": F32() }, patch: [ Set("filter.radius", "$r") ]"#;
    assert_eq!(differences(inherited), ["+ parameter r: inherited"]);
    let new = r#"passes: { "more": Pass(kind: "blur", in: { "irradiance": "gather" }, set: { "radius": 4, "offset": 1 }) }"#;
    assert_eq!(differences(new), ["+ pass more: blur", "+ setting more.offset: 1"]);
}

#[test]
fn differences_and_the_flattened_pipeline_are_reported_to_programs() {
    let (base, other) = (resolved("patch: []"), resolved(r#"patch: [ Set("filter.radius", 2) ]"#));
    let difference = diff(&base, &other, &TestPassTypes::new())[0].to_json();
    let expected = r#"{"kind":"setting","path":"filter.radius","before":"4.0","after":"2.0"}"#;
    assert_eq!(difference.to_string(), expected);
    let json = other.to_json(&TestPassTypes::new());
    let filter = json["passes"].as_array().unwrap().iter().find(|pass| pass["name"] == "filter").unwrap();
    assert_eq!(filter["kind"], "blur");
    let radius = &filter["settings"][0];
    assert_eq!((&radius["name"], &radius["value"]), (&"radius".into(), &2.into()));
    assert_eq!(radius["origin"].to_string(), r#"{"file":"variant.ron","line":1,"column":61}"#);
    assert_eq!(filter["links"][1]["from"], "gather");
    assert_eq!(filter["links"][1]["origin"]["file"], "base.ron");
    assert_eq!(json["ron"], other.to_ron(&TestPassTypes::new(), true));
}

/// A removed pass whose `off:` is an input leads to what that input read, which another patch may have removed too.
#[test]
fn what_off_leads_to_may_be_removed_too() {
    let extra = r#"passes: { "extra": Pass(kind: "noise") }"#;
    let read = r#"Replace("image", Pass(kind: "composite", in: { "glossy": "extra" }))"#;
    let soft = r#"Insert(name: "soft", pass: Pass(kind: "blur", off: Input("irradiance")), between: ("extra", "image.glossy"))"#;
    let linked = |patches: &str| {
        let resolved = resolved(&format!("{extra}, patch: [ {read}, {soft}, {patches} ]"));
        link(&resolved, &TestPassTypes::new(), &LinkContext { frame: (320, 200), traits: traits() })
            .map(|_| resolved.warnings().to_string())
    };
    let lost = "`image` is left without its input `glossy`";
    assert!(!linked(r#"Remove("soft")"#).expect("`image` reads the noise").contains(lost));
    for order in [r#"Remove("soft"), Remove("extra")"#, r#"Remove("extra"), Remove("soft")"#] {
        assert!(linked(order).expect("`image` reads nothing").contains(lost), "{order}");
    }
    let error = linked(r#"Remove("extra")"#).expect_err("a pass that stays has no input").to_string();
    assert!(error.contains("E043"), "{error}");
}
