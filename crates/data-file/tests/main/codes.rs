//! The codes of errors: each means one thing, and the table that is kept lists all of them.

use data_file::codes::{all, table};
use std::collections::BTreeSet;
use std::path::Path;

#[test]
fn no_code_means_two_things() {
    let mut seen = BTreeSet::new();
    for code in all() {
        assert!(seen.insert(code.code), "{} is given twice", code.code);
        let (letter, number) = code.code.split_at(1);
        assert!(
            "ECSLT".contains(letter) && number.len() == 3 && number.parse::<u32>().is_ok(),
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
