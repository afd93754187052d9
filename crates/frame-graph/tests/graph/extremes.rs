//! Pipelines at the extremes: large and simple, many of everything, files elsewhere, and good ones with edits. Each is
//! compiled or refused, fast.

use super::kinds::{MemoryFiles, TestPassTypes, files, traits};
use frame_graph::{CompileOptions, Diagnostics, LinkContext, Overrides, Source, compile, link, resolve};
use proptest::prelude::*;
use std::time::Duration;

const LIMIT: Duration = Duration::from_secs(20);

/// The errors of a text that stands beside other files.
fn errors(text: String, mut files: MemoryFiles) -> Option<Diagnostics> {
    files.0.insert("x.ron".into(), Source::new("x.ron", text));
    let context = LinkContext { frame: (1920, 1080), traits: traits() };
    let run = || -> Result<(), Diagnostics> {
        let resolved = resolve("x.ron", &files, &Overrides::default())?;
        let again = resolved.to_ron(&TestPassTypes::new(), true);
        let graph = link(&resolved, &TestPassTypes::new(), &context)?;
        compile(&graph, &CompileOptions::default())?;
        drop(again);
        Ok(())
    };
    run().err()
}

fn shown(text: String) -> String {
    mutation::within(LIMIT, move || {
        errors(text, MemoryFiles::default()).map_or_else(String::new, |e| e.to_string())
    })
}

#[test]
fn large_files_of_one_piece_are_refused_fast() {
    for (piece, text) in mutation::large(1 << 20) {
        let errors = shown(text.to_string());
        assert!(errors.contains("x.ron:") && errors.len() < 200_000, "{piece:?}: {errors}");
    }
    for piece in ["Pipeline(a: ", "Pipeline(passes: {\"a\": Pass(kind: ", "Pipeline(passes: Pipeline("] {
        for text in [piece.repeat(10_000), format!("{}{}", piece.repeat(10_000), ")".repeat(10_000))] {
            let errors = shown(text);
            assert!(errors.contains("nested deeper than 64"), "{piece}: {errors}");
        }
    }
}

#[test]
fn many_of_everything_are_reported_fast() {
    let passes: String = (0..20_000)
        .map(|i| format!("\"p{i}\": Pass(kind: \"no{i}\", in: {{\"a\": \"q{i}.x\"}}),\n"))
        .collect();
    let parameters: String = (0..20_000).map(|i| format!("\"a{i}\": U32(default: {i}),\n")).collect();
    let outputs: String = (0..20_000).map(|i| format!("\"o{i}\": \"p{i}.y\",\n")).collect();
    let patches: String = (0..20_000).map(|i| format!("Remove(\"r{i}\"),\n")).collect();
    let texts = [
        format!("Pipeline(passes: {{{passes}}}, outputs: {{{outputs}}})"),
        format!("Pipeline(parameters: {{{parameters}}}, passes: {{}}, outputs: {{{outputs}}})"),
        format!("Pipeline(extends: \"base.ron\", patch: [{patches}])"),
        format!("Pipeline(passes: {{}}, outputs: {{{}}})", "\"o\": \"p.y\",\n".repeat(50_000)),
        format!(
            "Pipeline(passes: {{\"a\": Pass(kind: \"x\", when: \"{}true\")}}, outputs: {{}})",
            "!".repeat(500_000)
        ),
        format!(
            "Pipeline(passes: {{\"a\": Pass(kind: \"x\", when: \"{}\")}}, outputs: {{}})",
            "1+".repeat(500_000)
        ),
        format!(
            "Pipeline(passes: {{\"a\": Pass(kind: \"x\", in: {{\"a\": \"{}\"}})}}, outputs: {{}})",
            "a/".repeat(500_000)
        ),
    ];
    for text in texts {
        let start = text[..60].to_owned();
        let errors = shown(text);
        assert!(errors.contains("x.ron:") && errors.len() < 300_000, "{start}: {} bytes", errors.len());
    }
}

#[test]
fn pipelines_name_no_files_outside_of_their_folders() {
    let cases = [
        "Pipeline(extends: \"FILE\", patch: [])",
        "Pipeline(passes: { \"a\": Sub(file: \"FILE\") }, outputs: {})",
        "Pipeline(passes: { \"a\": Pass(kind: \"compute\", shader: \"FILE\") }, outputs: {})",
        "Pipeline(extends: \"FILE\", patch: [Insert(name: \"a\", pass: Pass(kind: \"x\"), between: (\"a.b\", \"c.d\"))])",
    ];
    for case in cases {
        for file in ["/etc/passwd", "../b.ron", "../../../../etc/passwd", "parts/../../x"] {
            let reported = shown(case.replace("FILE", file));
            assert!(
                reported.contains("error[E010]: the file `") && reported.contains("`--root`"),
                "{case}: {reported}"
            );
            assert!(
                reported.contains("x.ron:1:") && !reported.contains("there is no pipeline file"),
                "{case}: {reported}"
            );
        }
        let reported = shown(case.replace("FILE", "parts/../b.ron"));
        assert!(!reported.contains("`--root`"), "{case}: {reported}");
    }
}

/// The pipelines of this tree, and those that show errors.
fn good() -> Vec<String> {
    let all =
        ["../../pipelines", "tests/broken"].map(|folder| files(folder).0.into_values()).into_iter().flatten();
    let mut texts: Vec<String> = all.map(|source| source.text.clone()).collect();
    texts.push(super::whole::BASE.to_owned());
    texts.push(super::whole::SHADOWS.to_owned());
    texts.sort();
    texts
}

proptest! {
    #![proptest_config(mutation::config(400))]

    #[test]
    fn pipelines_with_edits(text in mutation::texts(good())) {
        let reported = mutation::within(LIMIT, move || {
            let all = files("../../pipelines");
            errors(text, all).map(|errors| (errors.to_string(), errors))
        });
        if let Some((text, errors)) = reported {
            prop_assert!(!text.is_empty());
            for error in &errors.0 {
                for label in &error.labels {
                    let span = &label.span;
                    prop_assert!(span.source.text.get(span.start as usize..span.end as usize).is_some(), "{error:?}");
                }
            }
        }
    }
}
