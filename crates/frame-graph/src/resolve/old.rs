//! Words that pipelines no longer have, and what to write in their place.

use crate::codes;
use data_file::Diagnostics;

const WRITE_OUT: &str = "write the passes out, each with a `when:`, as docs/examples/a-trous-filter.ron does";
const REPLACEMENT: &str = "write `off: Input(\"port\")`, or name another pass: `off: \"pass.port\"`";
const ONE_FILE: &str =
    "write `Sub(inputs: …, in: …, passes: …, outputs: …)`, as `lightloom resolve` prints a sub-graph";

/// Words of the grammar.
const WORDS: &[(&str, &str)] = &[
    (
        "Prev",
        "write the link as \"prev pass.port\", and at the pass that makes it `history: (reset: […], rest: 64)`",
    ),
    ("repeat", WRITE_OUT),
    ("carry", WRITE_OUT),
    ("index", WRITE_OUT),
    ("Black", REPLACEMENT),
    ("Color", REPLACEMENT),
    ("init", "leave it out: a history buffer begins as zero"),
    ("Optional", "name the interface alone, and let each use link the input"),
    ("I32", "use `U32`, or `F32` for numbers below zero"),
    ("connected", "use a parameter of type `Bool`, which the use sets"),
    ("Group", ONE_FILE),
    ("Removed", "leave the pass out"),
    ("keep", "leave it out"),
    ("feed", "leave it out"),
];

/// Passes of shipped pipelines that have another name or are elsewhere.
const PASSES: &[(&str, &str)] = &[
    ("lights/promise", "`lights/promise` is `lights/radiosity` now"),
    ("lights/crowding", "`lights/crowding` is `lights/density` now"),
    ("lights/spread", "`lights/spread` is `lights/sample_density` now"),
    ("lights/replace", "`lights/replace` is `lights/replacement` now"),
    ("lights/emit", "`lights/emit` is `lights/vpls` now"),
    ("placement", "docs/examples/placement.ron adds this pass to a pipeline"),
    ("shadow_term", "parts/acrsm-shadow-term.ron, and others, add this sub-graph to a pipeline"),
];

/// Adds what to write instead to errors at such a word.
pub(super) fn explain(mut errors: Diagnostics) -> Diagnostics {
    for error in &mut errors.0 {
        let Some(span) = error.labels.first().map(|label| &label.span) else { continue };
        let Some(word) = span.source.text.get(span.start as usize..span.end as usize) else { continue };
        let instead = if error.code == codes::PATH.code {
            let path = word.trim_matches('"');
            let is_in = |pass: &str| path.strip_prefix(pass).is_some_and(|rest| rest.starts_with(['.', '/']));
            PASSES.iter().find(|(pass, _)| is_in(pass))
        } else {
            let word = word.trim_matches(|c: char| !c.is_alphanumeric());
            WORDS.iter().find(|(old, _)| *old == word)
        };
        if let Some((_, instead)) = instead {
            error.notes.insert(0, (*instead).to_owned());
        }
    }
    errors
}
