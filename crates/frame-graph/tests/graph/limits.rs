//! What is advised where a pass takes no more of something than so many.

use super::kinds::{MemoryFiles, TestPassTypes, traits};
use frame_graph::{Diagnostics, LinkContext, Overrides, link, resolve};

/// Lights that `splat` and `fill` limit, one after the other, and `other` beside them.
fn refused(count: u32, splat: &str, fill: &str, other: &str) -> Diagnostics {
    let text = format!(
        r#"Pipeline(
            passes: {{
                "view": Pass(kind: "gbuffer"),
                "lights": Pass(kind: "lights", in: {{ "view": "view" }}, set: {{ "count": {count} }}),
                "splat": Pass(kind: "splat", in: {{ "lights": "lights" }}{splat}),
                "fill": Pass(kind: "fill", in: {{ "maps": "splat"{fill} }}),
                {other}
            }},
            outputs: {{ "image": "fill" }},
        )"#
    );
    let files = MemoryFiles::new(&[("limits.ron", &text)]);
    let resolved = resolve("limits.ron", &files, &Overrides::default()).expect("it resolves");
    let context = LinkContext { frame: (64, 64), traits: traits() };
    link(&resolved, &TestPassTypes::new(), &context).err().unwrap_or_default()
}

/// The message of each error, with its advice.
fn reported(errors: &Diagnostics) -> Vec<(String, String)> {
    errors.0.iter().map(|error| (error.message.clone(), error.notes.join("; "))).collect()
}

#[test]
fn the_advice_is_a_value_that_every_pass_takes() {
    let errors = refused(2000, "", "", "");
    let message = "`splat`: 2000 maps are too many".to_owned();
    let advice = "take smaller maps, or at most 100 lights, since `fill` takes no more".to_owned();
    assert_eq!(reported(&errors), [(message, advice)]);
    // It is one that works, and no greater one does.
    assert!(refused(100, "", "", "").0.is_empty());
    assert_eq!(
        reported(&refused(101, "", "", "")),
        [("`fill`: 101 maps are too many".to_owned(), "at most 100 lights".to_owned())]
    );
}

#[test]
fn a_pass_beside_the_one_that_refuses_limits_as_well() {
    let beside = r#""beside": Pass(kind: "fill", in: { "maps": "lights" }, set: { "most": 50 })"#;
    let reported = reported(&refused(2000, "", "", beside));
    let advice: Vec<&str> = reported.iter().map(|(_, advice)| advice.as_str()).collect();
    assert_eq!(
        advice,
        ["take smaller maps, or at most 50 lights, since `beside` takes no more", "at most 50 lights"]
    );
}

#[test]
fn where_no_number_is_taken_none_is_advised() {
    let none = r#""beside": Pass(kind: "fill", in: { "maps": "splat" }, set: { "most": 0 })"#;
    let reported = reported(&refused(2000, "", "", none));
    assert_eq!(reported, [("`splat`: 2000 maps are too many".to_owned(), "take smaller maps".to_owned())]);
}

#[test]
fn a_fact_that_is_too_great_is_reported_before_sizes_are_known() {
    // The history buffer of the pass itself has no size yet when the pass is asked first.
    let reported = reported(&refused(101, "", r#", "past": "prev fill""#, ""));
    assert_eq!(reported, [("`fill`: 101 maps are too many".to_owned(), "at most 100 lights".to_owned())]);
}
