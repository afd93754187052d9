//! The names of a file, and what a position of it takes, as an editor asks for them.

use data_file::grammar::Cursor;
use frame_graph::Source;
use frame_graph::description::{SymbolKind, Wanted, parse, wanted};

/// Every name is found at its own bytes, those of parameters behind their `$`.
#[test]
fn names_are_found_at_their_places() {
    let text = r#"Pipeline(
    parameters: { "lights": U32(default: 8) },
    passes: { "a": Pass(kind: "noise", set: { "count": "$lights" }), "b": Pass(kind: "noise", set: { "count": "$lights" }) },
    outputs: { "image": "a" },
)"#;
    let symbols = parse(Source::new("x.ron", text)).expect("it is a pipeline").symbols();
    for symbol in &symbols {
        assert_eq!(&text[symbol.place.start as usize..symbol.place.end as usize], &*symbol.name);
    }
    let parameters: Vec<u32> = symbols
        .iter()
        .filter(|symbol| symbol.kind == SymbolKind::Parameter)
        .map(|symbol| symbol.place.start)
        .collect();
    let wanted: Vec<u32> = text.match_indices("lights").map(|(at, _)| at as u32).collect();
    assert_eq!(parameters, wanted);
}

/// Within a form that takes no names, nothing of the form around it is offered.
#[test]
fn a_form_hides_what_is_around_it() {
    let at_end = |text: &str| wanted(&Cursor::new(text, text.len()), text);
    assert_eq!(at_end(r#"Pipeline(passes: { "b": Pass(in: { "x": ""#), Some(Wanted::Link));
    assert_eq!(at_end(r#"Pipeline(passes: { "b": Pass(in: History(""#), None);
    assert_eq!(at_end(r#"Pipeline(outputs: Out(facts: ""#), None);
}
