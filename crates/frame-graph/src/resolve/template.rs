//! A file to begin a variant with.

use super::print::{quoted, value};
use super::{Resolved, Settable};
use crate::port::PassTypes;
use data_file::ValueType;
use std::fmt::Write as _;

/// Returns the file of a variant that changes nothing yet: what can be changed stands in comments, each of which is right
/// where it becomes a line of its own. `base` is the name or path of a file, as `extends` takes it, and `resolved` what it
/// resolves to.
pub fn template(base: &str, resolved: &Resolved, kinds: &dyn PassTypes) -> String {
    let settable = resolved.settable(kinds);
    let (parameters, settings): (Vec<&Settable>, Vec<&Settable>) =
        settable.iter().partition(|settable| !settable.path.contains('.'));
    let mut text = format!(
        "Pipeline(\n    extends: {},\n    about: {},\n",
        quoted(base),
        quoted(&format!("{base}, changed"))
    );
    if !parameters.is_empty() {
        text += "    // Other defaults for the parameters of the base, or parameters of its own.\n    parameters: {\n";
        for parameter in parameters {
            let (path, setting) = (&parameter.path, &parameter.setting);
            let ty = match setting.ty {
                ValueType::Bool => "Bool",
                ValueType::F32 => "F32",
                ValueType::Text => "Text",
                _ => "U32",
            };
            let given = value(&parameter.value);
            let _ = writeln!(
                text,
                "        // {}: {ty}(default: {given}), // {}",
                quoted(path),
                first_sentence(&setting.doc)
            );
        }
        text += "    },\n";
    }
    text += "    // Changes, one after the other. The passes of the base, with their types:\n";
    for (name, kind) in resolved.passes() {
        let _ = writeln!(text, "    //   {name:<24} {kind}");
    }
    text += "    patch: [\n";
    let mut line = |change: &str, doc: &str| {
        let _ = writeln!(text, "        // {change}, // {}", first_sentence(doc));
    };
    for (name, _) in resolved.passes() {
        let of_pass =
            |settable: &&&Settable| settable.path.rsplit_once('.').map(|(pass, _)| pass) == Some(name);
        if let Some(one) = settings.iter().find(of_pass) {
            line(&format!("Set({}, {})", quoted(&one.path), value(&one.value)), &one.setting.doc);
        }
    }
    if let Some((name, kind)) = resolved.passes().find(|(_, kind)| kinds.takes_shader(kind) == Some(false)) {
        let change = format!("Replace({}, Pass(kind: {}))", quoted(name), quoted(kind));
        line(&change, "Links to inputs that the new pass type has too are kept.");
    }
    text += "        // Insert(name: …, pass: Pass(…), between: (…, …)) and Remove(…): docs/first-pipeline.md shows them.\n";
    text + "    ],\n)\n"
}

fn first_sentence(doc: &str) -> &str {
    doc.split_once(". ").map_or(doc, |(first, _)| first).trim_end_matches('.')
}
