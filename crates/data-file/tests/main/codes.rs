//! Errors as programs read them.

use data_file::codes::SYNTAX;
use data_file::{Diagnostic, Diagnostics, Severity, Source, Span};

#[test]
fn json_has_code_severity_and_places() {
    let source = Source::new("a.ron", "Pipeline(\n    x: 1,\n)");
    let span = Span { source, start: 14, end: 15 };
    let error = Diagnostic::new(&SYNTAX, "it is wrong").label(span, "here").note("mend it");
    let json = Diagnostics::from(error.clone()).to_json();
    let expected = r#"[{"code":"E001","severity":"error","message":"it is wrong","file":"a.ron","line":2,"column":5,"labels":[{"file":"a.ron","line":2,"column":5,"end_line":2,"end_column":6,"message":"here"}],"help":["mend it"]}]"#;
    assert_eq!(json.to_string(), expected);
    let warning = Diagnostic { severity: Severity::Warning, ..error };
    assert!(Diagnostics::from(warning).to_string().starts_with("warning[E001]: it is wrong"));
}
