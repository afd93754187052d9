//! Which changes of WGSL are tried, and whose tests run for them.

use crate::tree;
use xtask::mutate_shaders::{Options, changes, draw, users};
use xtask::tree::Tree;

/// What is replaced in a text, and by what.
fn made(text: &str) -> Vec<(&str, String)> {
    changes(text).into_iter().map(|change| (&text[change.at], change.new)).collect()
}

fn is(found: &[(&str, String)], expected: &[(&str, &str)]) {
    let found: Vec<(&str, &str)> = found.iter().map(|(old, new)| (*old, &**new)).collect();
    assert_eq!(found, expected);
}

#[test]
fn operators_functions_components_indices_and_signs_are_changed() {
    is(&made("    let a = b + c;\n"), &[("+", "-")]);
    is(
        &made("    if a < b && c[i] >= d {\n"),
        &[("<", "<="), ("<", ">"), ("&&", "||"), ("i", "i + 1"), (">=", ">")],
    );
    is(&made("    x <<= min(p.y, q.zw);\n"), &[("min", "max"), ("y", "x")]);
    is(
        &made("    return select(-at.z, -(a), any(b)) - f();\n"),
        &[("-", ""), ("z", "x"), ("-", ""), ("any", "all"), ("-", "+")],
    );
}

#[test]
fn numbers_are_changed_to_others_of_their_type() {
    is(
        &made("    f(0, 3u, 0.0, 1.0, 1., 0.5f, 1e-6, 4294967295u, 0xffu, vec2u, e2);\n"),
        &[
            ("0", "1"),
            ("3u", "4u"),
            ("0.0", "1.0"),
            ("1.0", "0.0"),
            ("1.", "0.0"),
            ("0.5f", "0.625f"),
            ("1e-6", "1.25e-6"),
        ],
    );
}

#[test]
fn what_is_no_code_stays_as_it_is() {
    let declared = "// One - two.
#output maps: Maps( // The maps.
    size: (a + 1, 2),
) module \"a.wgsl\"
#option KEPT false
/* 1 + 2 */
struct Settings {
    /// [default: 1, max: 2]
    count: u32,
    @align(16) last: u32,
}
var<workgroup> all: array<u32, 4>;
@compute @workgroup_size(8, 8)
fn f(@builtin(position) at: array<f32, 3>) {
#if KEPT
    let a = bitcast<u32>(at[2]); // 3 + 4
#endif
}
";
    is(&made(declared), &[("2", "3")]);
}

const FILES: &[(&str, &str)] = &[
    ("Cargo.toml", "[workspace]\n"),
    ("crates/precision/Cargo.toml", "[package]\nname = \"precision\"\n"),
    ("crates/precision/tests/main.rs", "call(\"shaders/sobol.wgsl\");\ncall(\"passes/near/near.wgsl\");\n"),
    ("passes/near/Cargo.toml", "[package]\nname = \"near\"\n"),
    ("passes/near/near.wgsl", "#import \"sobol.wgsl\"\nfn f() -> f32 { return a - b; }\n"),
    ("passes/far/Cargo.toml", "[package]\nname = \"far\"\n"),
    ("passes/far/far.wgsl", "#import \"paths.wgsl\"\n"),
    ("passes/named/Cargo.toml", "[package]\nname = \"named\"\n"),
    ("passes/named/src/lib.rs", "module(\"shaders/paths.wgsl\");\n"),
    ("passes/other/Cargo.toml", "[package]\nname = \"other\"\n"),
    ("passes/other/other.wgsl", "fn f() -> u32 { return 1u + 2u; }\n"),
    ("shaders/paths.wgsl", "#import \"sobol.wgsl\"\n"),
    ("shaders/sobol.wgsl", "fn f() -> u32 { return 5u * 6u; }\n"),
];

#[test]
fn tests_that_name_a_file_run_before_those_that_import_it() {
    let folder = tree(FILES);
    let tree = Tree::read(folder.path()).unwrap();
    assert_eq!(users(&tree, "shaders/sobol.wgsl", 9), ["precision", "near", "far", "named"]);
    assert_eq!(users(&tree, "shaders/sobol.wgsl", 2), ["precision", "near"]);
    assert_eq!(users(&tree, "passes/far/far.wgsl", 9), ["far"]);
    assert_eq!(users(&tree, "passes/near/near.wgsl", 9), ["near", "precision"]);
}

#[test]
fn a_seed_draws_the_same_changes_each_time_and_none_twice() {
    let folder = tree(FILES);
    let tree = Tree::read(folder.path()).unwrap();
    let drawn = |seed, count, filter: &str| {
        let options = Options { seed, count, filter: filter.to_owned(), packages: 1, limit: 1 };
        let drawn = draw(&tree, &options).into_iter();
        drawn.map(|(file, change)| (file.path.clone(), change.at, change.new)).collect::<Vec<_>>()
    };
    let all = drawn(1, 99, "");
    assert_eq!(all.len(), 7);
    assert!(all.iter().enumerate().all(|(i, one)| !all[..i].contains(one)), "{all:?}");
    assert_eq!(all[..3], drawn(1, 3, ""));
    assert_ne!(all, drawn(2, 99, ""));
    assert!(drawn(1, 99, "other/").iter().all(|(path, ..)| path == "passes/other/other.wgsl"));
    assert_eq!(drawn(1, 99, "no such file"), []);
}
