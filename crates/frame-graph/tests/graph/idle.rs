//! Inherited passes that nothing needs.

use super::kinds::{MemoryFiles, TestPassTypes, traits};
use frame_graph::plan::{Fate, Plan};
use frame_graph::{CompileOptions, Diagnostics, LinkContext, Overrides, compile, link, resolve};

const BASE: &str = r#"Pipeline(
    passes: {
        "view": Pass(kind: "gbuffer"),
        "lights": Pass(kind: "lights", in: { "view": "view" }),
        "gather": Pass(kind: "gather", in: { "view": "view", "lights": "lights" }),
        "blur": Pass(kind: "blur", in: { "irradiance": "gather" }),
        "shown": Pass(kind: "mix", in: { "a": "gather", "b": "blur" }),
        "other": Pass(kind: "blur", in: { "irradiance": "gather" }),
        "image": Pass(kind: "composite", in: { "indirect": "blur" }),
    },
    outputs: { "image": "image" },
)"#;

fn plan(variant: &str, keep: &[&str]) -> Result<Plan, Diagnostics> {
    let variant = format!("Pipeline(extends: \"base.ron\", {variant})");
    let files = MemoryFiles::new(&[("base.ron", BASE), ("variant.ron", &variant)]);
    let resolved = resolve("variant.ron", &files, &Overrides::default())?;
    let context = LinkContext { frame: (64, 64), traits: traits() };
    let keep = keep.iter().map(|name| (*name).to_owned()).collect();
    let options = CompileOptions { keep, ..CompileOptions::default() };
    compile(&link(&resolved, &TestPassTypes::new(), &context)?, &options)
}

#[test]
fn an_inherited_pass_that_nothing_needs_does_not_bind_a_variant() {
    let changed = r#"patch: [ Replace("gather", Pass(kind: "pair")), Replace("blur", Pass(kind: "blur", in: { "irradiance": "gather.b" })) ]"#;
    let found = plan(changed, &["other"]).err().map(|errors| errors.to_string()).unwrap_or_default();
    assert!(found.contains("does not fit this pipeline, and was left out: `other`"), "{found}");
    let plan_of_image = plan(changed, &[]).unwrap_or_else(|errors| panic!("{errors}"));
    let fate = |name: &str| &plan_of_image.fates.iter().find(|(pass, _)| pass == name).unwrap().1;
    for name in ["shown", "other"] {
        assert!(matches!(fate(name), Fate::Off { why, .. } if why.starts_with("left out")), "{name}");
    }
    assert!(matches!(fate("image"), Fate::Kept { .. }));
}

#[test]
fn only_the_passes_that_do_not_fit_are_left_out() {
    let changed = r#"patch: [
        Replace("blur", Pass(kind: "pair")),
        Replace("image", Pass(kind: "composite", in: { "indirect": "blur.a" })),
    ]"#;
    let plan = plan(changed, &["other"]).unwrap_or_else(|errors| panic!("{errors}"));
    assert!(plan.pass("other").is_some());
}

#[test]
fn what_is_needed_or_is_the_files_own_binds() {
    let needed = r#"patch: [ Replace("gather", Pass(kind: "pair")) ]"#;
    let errors = plan(needed, &[]).err().map(|errors| errors.to_string()).unwrap_or_default();
    assert!(errors.contains("E032") && errors.contains("blur"), "{errors}");
    let own = r#"passes: { "mine": Pass(kind: "mix", in: { "a": "gather.nosuch", "b": "blur" }) }"#;
    let errors = plan(own, &[]).err().map(|errors| errors.to_string()).unwrap_or_default();
    assert!(errors.contains("E031"), "{errors}");
}
