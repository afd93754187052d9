//! Texts at the extremes: deep, long, and wrong all over. Each gives errors with places, and gives them fast.

use data_file::grammar::{parse, read};
use data_file::{Diagnostic, Diagnostics, MAX_TEXT, Source, Span, codes, nearest};
use std::sync::Arc;
use std::time::Duration;

/// Far more than any of them takes, and far less than what grows with the square of a megabyte.
const LIMIT: Duration = Duration::from_secs(10);

/// A grammar that looks at all there is.
#[derive(serde::Deserialize)]
struct Form {
    a: Vec<String>,
    b: Vec<String>,
}

fn anything(source: &Arc<Source>) -> Result<usize, Diagnostics> {
    read(source, 0, |_, Form { a, b }| a.len() + b.len())
}

fn errors(source: &Arc<Source>) -> Diagnostics {
    anything(source).expect_err("it is broken")
}

/// The errors as shown, and how many there are.
fn shown(text: String) -> (String, usize) {
    mutation::within(LIMIT, move || {
        let errors = errors(&Source::new("x.ron", text));
        (errors.to_string(), errors.0.len())
    })
}

#[test]
fn values_nested_too_deep_are_refused_at_their_place() {
    for open in ["(", "[", "{1: ", "A(", "A(a: ", "(a: ", "[A(", "Form(a: ["] {
        for times in [70, 100_000] {
            let (text, count) = shown(open.repeat(times));
            assert!(text.contains("error[E002]: values are nested deeper than 64"), "{open}: {text}");
            assert!(text.contains("x.ron:1:") && text.contains('^'), "{open}: {text}");
            assert!(count <= 2, "{open}: {text}");
        }
        let close: String = open
            .chars()
            .rev()
            .filter_map(|c| match c {
                '(' => Some(')'),
                '[' => Some(']'),
                '{' => Some('}'),
                _ => None,
            })
            .collect();
        let fits = 60 / close.len();
        let (text, _) = shown(format!("{}0{}", open.repeat(fits), close.repeat(fits)));
        assert!(!text.contains("E002"), "{open}: {text}");
    }
}

#[test]
fn large_texts_of_one_piece_are_refused_fast() {
    for (piece, text) in mutation::large(1 << 20) {
        let (text, count) = shown(text.to_string());
        assert!(text.contains("x.ron:"), "{piece:?}: {text}");
        assert!(count <= 1000 && text.len() < 200_000, "{piece:?}: {count} errors in {} bytes", text.len());
    }
}

#[test]
fn a_row_of_one_character_is_one_error() {
    let (text, count) = shown(format!("Form(a: [{}], b: [])", "\0".repeat(1000)));
    assert_eq!(count, 1, "{text}");
    assert!(text.contains("x.ron:1:10"), "{text}");
}

#[test]
fn a_text_longer_than_any_file_is_refused_unread() {
    let (text, count) = shown("[".repeat(MAX_TEXT + 1));
    assert_eq!((count, text.contains("the file is larger than 16 MiB")), (1, true), "{text}");
}

#[test]
fn of_errors_without_number_a_hundred_are_shown() {
    let wrong = format!("Form(a: [{}])", "1,\n".repeat(100_000));
    let (text, count) = shown(wrong);
    assert_eq!(count, 1000, "no more are kept");
    assert_eq!(text.matches("error[E005]").count(), 100);
    assert!(text.ends_with("and 900 more errors"), "{}", &text[text.len() - 200..]);
}

#[test]
fn fields_given_without_number_are_reported_fast() {
    let many: String = (0..50_000).map(|i| format!("x{i}: 1, ")).collect();
    let (text, _) = shown(format!("Form({many}{})", "a: [], ".repeat(50_000)));
    assert!(text.contains("has no field `x0`"), "{text}");
}

#[test]
fn of_a_long_line_a_part_is_shown_with_its_line_and_column() {
    let long = format!("Form(\n  a: [{}  7 {}],\n)", "\"é\", ".repeat(100_000), ", \"é\"".repeat(100_000));
    let errors = errors(&Source::new("x.ron", long));
    let (line, column) = errors.0[0].labels[0].span.line_column();
    let text = errors.to_string();
    assert_eq!((line, column), (2, 500_009));
    assert!(text.contains("x.ron:2:500009"), "{text}");
    assert!(text.contains("2 │") && text.contains(" 7 ") && text.contains('^'), "{text}");
    assert!(text.len() < 2000, "{} bytes", text.len());
}

#[test]
fn of_a_place_of_many_lines_the_first_is_shown() {
    let source = Source::new("x.ron", format!("first\n{}last", "\n".repeat(1 << 20)));
    let span = Span { end: source.text.len() as u32, start: 0, source };
    let text = mutation::within(LIMIT, move || {
        Diagnostics::from(Diagnostic::new(&codes::SYNTAX, "long").label(span, "")).to_string()
    });
    assert!(text.contains("first") && !text.contains("last"), "{text}");
    assert!(text.len() < 2000, "{} bytes", text.len());
}

#[test]
fn long_names_are_compared_with_nothing_and_quoted_in_part() {
    let (long, other) = ("x".repeat(1 << 20), "y".repeat(1 << 20));
    let (long, text) = mutation::within(LIMIT, move || {
        let error =
            Diagnostic::new(&codes::SYNTAX, "wrong").suggest("names", &long, [other.as_str(), &long, "b"]);
        assert_eq!(nearest(&long, [other.as_str(), &long]), None);
        (long, Diagnostics::from(error).to_string())
    });
    assert!(text.len() < 1000, "{} bytes", text.len());
    let (text, _) = shown(format!("Form(a: [], {long}: 1)"));
    assert!(text.contains("has no field `xxx") && text.len() < 2000, "{text}");
}

#[test]
fn among_names_without_number_the_nearest_is_still_found() {
    let names: Vec<String> = (0..100_000).map(|i| format!("name-{i}")).collect();
    let text = mutation::within(LIMIT, move || {
        let error = |_| {
            Diagnostic::new(&codes::SYNTAX, "wrong").suggest(
                "names",
                "nome-17",
                names.iter().map(String::as_str),
            )
        };
        Diagnostics((0..100).map(error).collect()).to_string()
    });
    assert!(text.contains("did you mean `name-17`?") && text.contains("and 99988 more"), "{text}");
}

#[test]
fn a_long_number_or_text_is_quoted_in_part() {
    for value in ["1".repeat(100_000) + "x", "\"y\"".replace('y', &"y".repeat(100_000)), "z".repeat(100_000)]
    {
        let (text, _) = shown(format!("Form(a: {value})"));
        assert!(text.contains('…') && text.len() < 2500, "{text}");
    }
}

#[test]
fn the_tree_keeps_what_stands_below_the_bound() {
    let source = Source::new("x.ron", format!("{}7{}", "[".repeat(65), "]".repeat(65)));
    let depth = parse(&source, 0, |_, mut node| {
        let mut depth = 0;
        while let Some(item) = node.items().first() {
            (node, depth) = (*item, depth + 1);
        }
        Some(depth)
    });
    assert_eq!(depth, Ok(65));
}

mod edited {
    use super::*;
    use proptest::prelude::*;

    const GOOD: &[&str] = &[
        "Form(a: [\"x\", \"y\"], b: [r#\"raw \"text\"\"#, \"\\u{e9}\\n\"])",
        "#![enable(implicit_some)]\n// comment\nForm(/* /* nested */ */ a: [A(b: {\"k\": (1, -2.5e3, 0xff)}), 'c', b\"d\"],)",
    ];

    proptest! {
        #![proptest_config(mutation::config(1000))]

        #[test]
        fn texts_give_a_value_or_errors_with_places(text in mutation::texts(GOOD.iter().copied())) {
            let source = Source::new("x.ron", text);
            let errors = mutation::within(LIMIT, move || {
                let errors = anything(&source).err();
                errors.map(|errors| (errors.to_string(), errors))
            });
            if let Some((text, errors)) = errors {
                prop_assert!(!text.is_empty() && text.len() < 500_000, "{} bytes", text.len());
                for error in &errors.0 {
                    prop_assert!(!error.labels.is_empty(), "{error:?}");
                    for Span { source, start, end } in error.labels.iter().map(|label| &label.span) {
                        prop_assert!(source.text.get(*start as usize..*end as usize).is_some(), "{error:?}");
                    }
                }
            }
        }
    }
}
