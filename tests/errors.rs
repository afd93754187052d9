//! The codes of errors: each means one thing, and the table that is kept lists all of them.

use data_file::Code;
use std::collections::BTreeSet;
use std::path::Path;

/// The letter of codes that belong together, a heading, and what to know of them.
const SECTIONS: [(char, &str, &str); 6] = [
    (
        'E',
        "Text of any file, and pipelines",
        "Examples are in `crates/frame-graph/tests/broken`; the whole text of each, as it is shown, is in \
         `crates/frame-graph/tests/snapshots`.",
    ),
    ('C', "Scenes", "Examples are in `crates/scene/tests/broken` and `crates/scene/tests/snapshots`."),
    ('S', "Shaders", "Examples are in `crates/shader-library/tests`."),
    ('L', "Linking shaders to a pipeline", "Examples are in `tests/linking.rs`."),
    ('T', "Studies", "Examples are in `crates/study/tests/broken` and `crates/study/tests/snapshots`."),
    (
        'W',
        "Warnings and notes",
        "With these, everything runs. `lightloom check` prints all of them; `render`, `graph` and `study` print warnings, \
         W002 and W004, on standard error.",
    ),
];

/// Returns every code there is.
fn all() -> impl Iterator<Item = &'static Code> {
    let lists = [
        data_file::codes::CODES,
        frame_graph::codes::CODES,
        scene::codes::CODES,
        shader_library::codes::CODES,
        pass::codes::CODES,
        study::codes::CODES,
    ];
    lists.into_iter().flatten().copied()
}

/// Returns the table of all codes in Markdown, as kept in `ERRORS.md`.
fn table() -> String {
    let mut text = String::from("# Errors\n\nEvery error in a file has one of these codes.\n");
    for (letter, title, about) in SECTIONS {
        text.push_str(&format!("\n## {title}\n\n{about}\n\n| code | meaning |\n|---|---|\n"));
        let mut codes: Vec<&Code> = all().filter(|code| code.code.starts_with(letter)).collect();
        codes.sort_by_key(|code| code.code);
        for code in codes {
            text.push_str(&format!("| {} | {} |\n", code.code, code.meaning));
        }
    }
    text
}

#[test]
fn no_code_means_two_things() {
    let mut seen = BTreeSet::new();
    for code in all() {
        assert!(seen.insert(code.code), "{} is given twice", code.code);
        let (letter, number) = code.code.split_at(1);
        assert!(
            SECTIONS.iter().any(|(known, ..)| letter.starts_with(*known))
                && number.len() == 3
                && number.parse::<u32>().is_ok(),
            "{}",
            code.code
        );
        assert!(code.meaning.ends_with('.'), "{}: {}", code.code, code.meaning);
    }
    assert!(seen.len() > 80, "{} codes", seen.len());
}

#[test]
fn the_table_of_codes_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../crates/data-file/ERRORS.md");
    if std::env::var_os("INSTA_UPDATE").is_some_and(|update| update == "always") {
        std::fs::write(&path, table()).expect("the table is written");
    }
    let kept = std::fs::read_to_string(path).expect("the table is there");
    assert_eq!(kept, table(), "run the tests with INSTA_UPDATE=always");
}
