//! The codes of errors: each means one thing, and the table that is kept lists all of them.

use data_file::codes::{all, table};
use data_file::{Diagnostic, Diagnostics, Severity, Source, Span};
use std::collections::BTreeSet;
use std::path::Path;

#[test]
fn no_code_means_two_things() {
    let mut seen = BTreeSet::new();
    for code in all() {
        assert!(seen.insert(code.code), "{} is given twice", code.code);
        let (letter, number) = code.code.split_at(1);
        assert!(
            "ECSLTW".contains(letter) && number.len() == 3 && number.parse::<u32>().is_ok(),
            "{}",
            code.code
        );
        assert!(code.meaning.ends_with('.'), "{}: {}", code.code, code.meaning);
    }
    assert!(seen.len() > 80, "{} codes", seen.len());
}

#[test]
fn the_table_of_codes_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("ERRORS.md");
    if std::env::var_os("INSTA_UPDATE").is_some_and(|update| update == "always") {
        std::fs::write(&path, table()).expect("the table is written");
    }
    let kept = std::fs::read_to_string(path).expect("the table is there");
    assert_eq!(kept, table(), "run the tests with INSTA_UPDATE=always");
}

#[test]
fn programs_are_told_code_severity_and_places() {
    let source = Source::new("a.ron", "Pipeline(\n    x: 1,\n)");
    let span = Span { source, start: 14, end: 15 };
    let error = Diagnostic::new(all().next().expect("there are codes"), "it is wrong")
        .label(span, "here")
        .note("mend it");
    let json = Diagnostics::from(error.clone()).to_json();
    let expected = r#"[{"code":"E001","severity":"error","message":"it is wrong","file":"a.ron","line":2,"column":5,"labels":[{"file":"a.ron","line":2,"column":5,"end_line":2,"end_column":6,"message":"here"}],"help":["mend it"]}]"#;
    assert_eq!(json.to_string(), expected);
    let warning = Diagnostic { severity: Severity::Warning, ..error };
    assert!(Diagnostics::from(warning).to_string().starts_with("warning[E001]: it is wrong"));
}
