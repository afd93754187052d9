//! WGSL at the extremes: what is too deep or too long for naga is refused before naga sees it, and fast.

use crate::library;
use proptest::prelude::*;
use shader_library::{Define, Library, Request};
use std::path::Path;
use std::time::Duration;

/// Far more than any of them takes, and far less than what grows with the square of a megabyte.
const LIMIT: Duration = Duration::from_secs(20);

/// Statements in an entry point that has some variables.
fn entry(statements: &str) -> String {
    format!(
        "@compute @workgroup_size(1) fn main() {{\nvar a = 1u; var b = true; var v = vec4<f32>(); \
         var list = array<u32, 4>();\n{statements}\n}}\n"
    )
}

/// The errors of a file, as shown, found on a thread of the usual stack; empty for a shader.
fn errors(text: String) -> String {
    mutation::within(LIMIT, move || {
        let errors = library(&[("main.wgsl", &text)]).load(&Request::new("main.wgsl")).err();
        errors.map_or_else(String::new, |errors| errors.to_string())
    })
}

/// A name, what makes a text of such a length, and a part of the error.
type Chain<'a> = (&'a str, &'a dyn Fn(usize) -> String, &'a str);

#[test]
fn chains_that_overflow_the_stack_of_naga_are_refused_at_their_place() {
    let operators = "operators or branches in each other";
    let nested = "brackets are nested deeper";
    let chains: [Chain<'_>; 19] = [
        ("sum", &|n| entry(&format!("a = a{};", "+a".repeat(n))), operators),
        ("and", &|n| entry(&format!("b = b{};", "&&b".repeat(n))), operators),
        ("not", &|n| entry(&format!("b = {}b;", "!".repeat(n))), operators),
        ("negate", &|n| entry(&format!("a = {}a;", "~".repeat(n))), operators),
        ("member", &|n| entry(&format!("v = v{};", ".xyzw".repeat(n))), operators),
        ("index", &|n| entry(&format!("a = list{};", "[0]".repeat(n))), operators),
        ("pointer", &|n| entry(&format!("{}a = 1u;", "*".repeat(n))), operators),
        ("else", &|n| entry(&format!("if b {{}} {}", "else if b {}\n".repeat(n))), operators),
        (
            "sums in sums",
            &|n| entry(&format!("a = {}a{};", "a+a+a+a+(".repeat(n / 4), ")".repeat(n / 4))),
            nested,
        ),
        ("parentheses", &|n| entry(&format!("a = {}a{};", "(".repeat(n), ")".repeat(n))), nested),
        ("calls", &|n| entry(&format!("a = {}a{};", "max(1u, ".repeat(n), ")".repeat(n))), nested),
        ("indices", &|n| entry(&format!("a = {}0{};", "list[".repeat(n), "]".repeat(n))), nested),
        ("blocks", &|n| entry(&format!("{}{}", "{".repeat(n), "}".repeat(n))), nested),
        ("loops", &|n| entry(&format!("{}{}", "loop { if b { break; }\n".repeat(n), "}".repeat(n))), nested),
        ("types", &|n| format!("var<private> x: {}u32{};", "array<".repeat(n), ", 1>".repeat(n)), nested),
        ("unclosed", &|n| "(".repeat(n), nested),
        (
            "constants",
            &|n| {
                (0..n).map(|i| format!("const c{i} = c{};\n", i + 1)).collect::<String>()
                    + &format!("const c{n} = 1;")
            },
            "declarations",
        ),
        (
            "functions",
            &|n| {
                (0..n).map(|i| format!("fn f{i}() {{ f{}(); }}\n", i + 1)).collect::<String>()
                    + &format!("fn f{n}() {{}}")
            },
            "declarations",
        ),
        ("statements", &|n| entry(&"a = a + 1u;\n".repeat(n)), "statements"),
    ];
    for (name, text, expected) in chains {
        let long = errors(text(100_000));
        assert!(long.contains("error[S013]") && long.contains(expected), "{name}: {long}");
        assert!(long.contains("main.wgsl:") && long.contains('^') && long.len() < 3000, "{name}: {long}");
        // What a person may write is given to naga, which says whatever it says.
        let short = errors(text(24));
        assert!(!short.contains("S013"), "{name}: {short}");
    }
}

#[test]
fn what_is_let_through_leaves_naga_its_stack() {
    let texts = [
        entry(&format!("a = a{};", "+a".repeat(990))),
        entry(&format!("b = b{};", "&&b".repeat(490))),
        entry(&format!("b = {}b;", "!".repeat(990))),
        entry(&format!("if b {{}} {}", "else if b {}\n".repeat(490))),
        entry(&format!("a = {}a{};", "(".repeat(60), ")".repeat(60))),
        entry(&"a = a + 1u;\n".repeat(16_000)),
        entry(&format!("let x = array({});", "1u+1u,".repeat(20_000))),
        (0..4090).map(|i| format!("const c{i} = c{};\n", i + 1)).collect::<String>() + "const c4090 = 1;",
    ];
    for text in texts {
        let start = text[..60].to_owned();
        assert_eq!(errors(text), "", "{start}");
    }
}

#[test]
fn large_files_of_one_piece_are_refused_fast() {
    for (piece, text) in mutation::large(1 << 20) {
        let errors = errors(text.to_string());
        assert!(errors.len() < 200_000, "{piece:?}: {} bytes", errors.len());
        assert!(errors.is_empty() || errors.contains("main.wgsl:"), "{piece:?}: {errors}");
    }
    for line in
        ["#if A", "#import \"x.wgsl\"", "#option A true", "#endif", "#else", "enable f16;", "#option é"]
    {
        let errors = errors(format!("#option A true\n{}", format!("{line}\n").repeat(50_000)));
        assert!(errors.len() < 200_000, "{line}: {} bytes", errors.len());
        assert!(errors.is_empty() || errors.contains("main.wgsl:"), "{line}: {errors}");
    }
    let errors = errors((0..100_000).map(|i| format!("enable e{i};\n")).collect());
    assert!(errors.contains("main.wgsl:1:8"), "{errors}");
}

#[test]
fn a_file_that_many_lines_import_is_read_once() {
    let main = "#import \"large.wgsl\"\n".repeat(20_000) + &entry("");
    let large = "// a line\n".repeat(100_000);
    mutation::within(LIMIT, move || {
        library(&[("main.wgsl", &main), ("large.wgsl", &large)]).load(&Request::new("main.wgsl")).map(drop)
    })
    .expect("a shader");
}

#[test]
fn options_and_settings_without_number_are_refused() {
    let options: String = (0..1000).map(|i| format!("#option O{i} true\n")).collect();
    assert!(errors(options).contains("error[S013]: there are more than 256 options"));
    let values: Vec<String> = (0..1000).map(|i| i.to_string()).collect();
    let option = format!("#option A 1 one_of [{}]\n", values.join(", "));
    assert!(errors(option).contains("error[S013]: there are more than 256 values of an option"));
    let members: String = (0..20_000).map(|i| format!("/// Doc. [default: 1.0]\nm{i}: f32,\n")).collect();
    let text = format!("struct Settings {{\n{members}}}\nvar<uniform> settings: Settings;\n{}", entry(""));
    let told = mutation::within(LIMIT, move || {
        let library = library(&[("main.wgsl", &text)]);
        let early = library.settings(&Request::new("main.wgsl")).expect_err("too many").to_string();
        let late =
            library.load(&Request::new("main.wgsl")).expect("a shader").settings().expect_err("too many");
        (early, late.to_string())
    });
    for told in [told.0, told.1] {
        assert!(told.contains("error[S013]: there are more than 256 settings"), "{told}");
        assert!(told.contains("main.wgsl:515:1"), "{told}");
    }
}

/// The WGSL of this tree.
fn shipped(folder: &Path, found: &mut Vec<(String, String)>, root: &Path) {
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() && !path.ends_with("target") {
            shipped(&path, found, root);
        } else if path.extension().is_some_and(|extension| extension == "wgsl") {
            let name = path.strip_prefix(root).expect("below the root").to_string_lossy().replace('\\', "/");
            found.push((name, std::fs::read_to_string(&path).expect("a text")));
        }
    }
}

fn good() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut found = Vec::new();
    for folder in ["shaders", "passes", "crates/interfaces"] {
        shipped(&root.join(folder), &mut found, &root);
    }
    found.sort();
    found
}

/// Loads `main.wgsl` beside the files of this tree, with all that may be asked of it.
fn load_all(library: &Library) -> Vec<data_file::Diagnostics> {
    let request = Request::new("main.wgsl");
    let mut errors = Vec::new();
    for variant in library.variants(&request).into_iter().flatten().take(3).chain([request.clone()]) {
        match library.load(&variant) {
            Ok(shader) => {
                errors.extend(shader.settings().err());
                errors.extend(shader.attributes().err());
                if let Some(layout) = &shader.interface.settings {
                    let _ = shader_library::write_struct(layout, &|_| Some(data_file::Value::U32(1)));
                }
            }
            Err(refused) => errors.push(refused),
        }
    }
    errors.extend(library.settings(&request).err());
    errors.extend(library.outline(&request.define("A", Define::Bool(true))).err());
    errors
}

fn good_texts() -> impl Iterator<Item = String> {
    good().into_iter().map(|(_, text)| text)
}

#[test]
fn edits_of_what_a_shader_says_get_past_the_parser() {
    let files = good();
    let parses = |text: String| {
        let mut files: Vec<(&str, &str)> =
            files.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
        files.push(("main.wgsl", &text));
        library(&files).load(&Request::new("main.wgsl")).is_ok()
    };
    let taken = mutation::taken(&mutation::wgsl(good_texts()), 400, parses);
    assert!(3 * taken >= 400, "{taken} of 400");
}

proptest! {
    #![proptest_config(mutation::config(200))]

    #[test]
    fn shaders_of_this_tree_with_edits(text in prop_oneof![mutation::texts(good_texts()), mutation::wgsl(good_texts())]) {
        let all = mutation::within(LIMIT, move || {
            let mut files = good();
            files.push(("main.wgsl".to_owned(), text));
            let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
            load_all(&library(&files)).into_iter().map(|errors| (errors.to_string(), errors)).collect::<Vec<_>>()
        });
        for (text, errors) in all {
            prop_assert!(!text.is_empty());
            for error in &errors.0 {
                prop_assert_ne!(error.code, "S012", "naga panicked: {}", text);
                prop_assert!(!error.labels.is_empty(), "{}", text);
            }
        }
    }
}

#[test]
fn shaders_import_no_files_outside_of_their_folders() {
    let load = |import: &str| {
        let main = format!("#import \"{import}\"\n{}", entry(""));
        let files = [
            ("/elsewhere/mine/main.wgsl", main.as_str()),
            ("/elsewhere/mine/b.wgsl", ""),
            ("/elsewhere/b.wgsl", ""),
            ("/etc/b.wgsl", ""),
            ("shaders/c.wgsl", ""),
        ];
        let loaded = library(&files).load(&Request::new("/elsewhere/mine/main.wgsl"));
        loaded.err().map_or_else(String::new, |errors| errors.to_string())
    };
    for good in ["b.wgsl", "./b.wgsl", "x/../b.wgsl", "/elsewhere/mine/b.wgsl", "c.wgsl"] {
        assert_eq!(load(good), "", "{good}");
    }
    for bad in ["../b.wgsl", "/elsewhere/b.wgsl", "/etc/b.wgsl", "x/../../../etc/b.wgsl"] {
        let errors = load(bad);
        assert!(errors.contains("error[S001]: the file `") && errors.contains("`--root`"), "{bad}: {errors}");
        assert!(errors.contains("main.wgsl:1:9"), "{bad}: {errors}");
    }
}
