//! The text of every error: code, file, line, column, caret, nearest name.

use crate::{errors_of, library};
use shader_library::Request;

/// Asserts that the errors of `main.wgsl` read as stored under `name`.
fn check(name: &str, files: &[(&str, &str)], request: Request) {
    insta::with_settings!({ prepend_module_to_snapshot => false, omit_expression => true }, {
        insta::assert_snapshot!(name, errors_of(files, &request));
    });
}

/// One file, without options.
fn check_text(name: &str, text: &str) {
    check(name, &[("main.wgsl", text)], Request::new("main.wgsl"));
}

const ENTRY: &str = "@compute @workgroup_size(1) fn main() {}\n";

#[test]
fn files() {
    check("no_shader", &[("passes/gather/gather.wgsl", ENTRY)], Request::new("passes/gather/gater.wgsl"));
    let files = [("main.wgsl", "\n  #import \"randm.wgsl\"\n"), ("shaders/random.wgsl", "")];
    check("no_import", &files, Request::new("main.wgsl"));
    let files = [("main.wgsl", "#import \"../../etc.wgsl\"\n")];
    check("import_out_of_the_root", &files, Request::new("main.wgsl"));
    let files = [("main.wgsl", "#import interface \"visibility\"\n"), ("rays.wgsl", "")];
    check("no_module", &files, Request::new("main.wgsl"));
    check("no_module_but_a_near_one", &files, Request::new("main.wgsl").module("visibilty", "rays.wgsl"));
    check("no_file_of_a_module", &files, Request::new("main.wgsl").module("visibility", "ray.wgsl"));
    let files = [
        ("main.wgsl", "#import \"a.wgsl\""),
        ("a.wgsl", "#import \"b.wgsl\""),
        ("b.wgsl", "\n#import \"c.wgsl\""),
    ];
    check("no_import_of_an_import", &files, Request::new("main.wgsl"));
}

#[test]
fn directives() {
    check_text("unknown_directive", "#include \"a.wgsl\"\n#imprt \"a.wgsl\"\n# \n#endfi");
    check_text(
        "import_without_path",
        "#import\n#import random\n#import interface\n#import \"a.wgsl\n#import \"a\" b",
    );
    check_text("odd_characters", "#if ä$\n#endif\n#option A 12px\n#option 3 true\n#option true false");
    check_text(
        "what_is_exact",
        "#exact\n#exact maps\n#exact maps: rays\n#exact maps: pas visibility-ray-traced\n#exact a: pass\n#exact b: input\n\
         #exact c: set(clamp 0)\n#exact d: set(clamp: 0) and more\n#exact e: input view\n#exact e: input view // twice",
    );
    check_text("if_without_end", "#option A true\n#if A\n  #if !A\n#endif\n");
    check_text("end_without_if", "#endif\n#else\n#elif A\n");
    check_text("two_elses", "#option A true\n#if A\n#else\n#else\n#elif A\n#endif\n");
    check_text(
        "unfinished_condition",
        "#option A true\n#if A &&\n#endif\n#if (A\n#endif\n#if A ==\n#endif\n#if A = true\n#endif",
    );
    check_text("nested_too_deeply", &format!("#if {}A\n#endif", "(".repeat(1000)));
    check_text("comment_without_end", "fn a() {}\n  /* one /* two */\n#import \"a.wgsl\"");
}

#[test]
fn options() {
    check_text("undeclared_option", "#option GLOSSY true\n#if GLOSY\n#elif SHADOWS\n#endif");
    check_text("comparison_of_types", "#option TAPS 4\n#if TAPS\n#elif TAPS == many\n#endif");
    check_text("impossible_comparison", "#option TAPS 4 one_of [1, 4]\n#if TAPS == 9\n#endif");
    check_text(
        "options_badly_declared",
        "#option A 4 one_of [1, 2]\n#option B box one_of [box, 2]\n#option C\n#option D 1 one_of []\n#option E 1 one_of 1",
    );
    check_text(
        "options_badly_chosen",
        "#option A a one_of [a, b] auto c where T\n#option B a one_of [a, b] auto b\n#option C a auto",
    );
    let files =
        [("main.wgsl", "#option A 1\n#import \"a.wgsl\"\n"), ("a.wgsl", "\n#option A 1\n#option A 2\n")];
    check("option_declared_twice", &files, Request::new("main.wgsl"));
    let files = [(
        "main.wgsl",
        "#option TAPS 4 one_of [1, 4]\n#option GLOSSY false\n@compute @workgroup_size(1) fn main() {}",
    )];
    check("unknown_define", &files, Request::new("main.wgsl").define("TAP", 4));
    check("define_of_another_type", &files, Request::new("main.wgsl").define("GLOSSY", 1));
    check("define_not_listed", &files, Request::new("main.wgsl").define("TAPS", 5));
    check("define_without_options", &[("main.wgsl", ENTRY)], Request::new("main.wgsl").define("TAPS", 5));
}

#[test]
fn too_many_variants() {
    let options: String = (0..8).map(|i| format!("#option SWITCH_{i} false\n")).collect();
    let text = options + ENTRY;
    let error = library(&[("main.wgsl", &text)]).variants(&Request::new("main.wgsl")).unwrap_err();
    insta::with_settings!({ prepend_module_to_snapshot => false, omit_expression => true }, {
        insta::assert_snapshot!("too_many_variants", error.to_string());
    });
}

/// A main file that imports `middle.wgsl`, which imports the file with the error.
fn check_imported(name: &str, broken: &str) {
    let files = [
        (
            "main.wgsl",
            "#option GLOSSY true\n// naïve\n#import \"lib/middle.wgsl\"\n@compute @workgroup_size(1) fn main() { middle(); }\n",
        ),
        ("lib/middle.wgsl", "fn middle() { inner(); }\n#if GLOSSY\n  #import \"inner.wgsl\"\n#endif\n"),
        ("lib/inner.wgsl", broken),
    ];
    check(name, &files, Request::new("main.wgsl"));
}

#[test]
fn wgsl() {
    check_text("syntax", "@compute @workgroup_size(1) fn main() {\n    let a = 1.0\n}");
    check_text(
        "unknown_name",
        "@compute @workgroup_size(1) fn main() {\n    let ä = 1.0; let b = frst + ä;\n}",
    );
    check_text(
        "misspelt_name",
        "@compute @workgroup_size(1) fn main() {\n    let first = 1.0; // firs\n    _ = frst;\n}",
    );
    check_text(
        "misspelt_member",
        "struct S { past_age: f32 }\n@compute @workgroup_size(1) fn main() {\n    let s = S();\n    _ = s.past_ag;\n}",
    );
    check_imported("syntax_in_an_import", "// one\nfn inner() {\n    let ä = 1.0 let b = 2.0;\n}\n");
    check_imported("type_in_an_import", "fn inner() {\n    let a: vec3<f32> = vec2<f32>(1.0);\n}\n");
    check_imported(
        "validation_in_an_import",
        "var<workgroup> x: f32;\nfn inner() {\n    if x > 0.5 { workgroupBarrier(); }\n    let v = vec3<f32>();\n    _ = v + vec3<u32>();\n}\n",
    );
    check_imported("end_of_an_import", "fn inner() {");
    check_imported("declared_in_two_files", "fn inner() {}\nfn main() {}\n");
    check_imported("declared_as_an_option", "fn inner() {}\nconst GLOSSY = 1;\n");
}

#[test]
fn validation() {
    check_text(
        "uniform_with_bool",
        "struct S { a: f32, b: bool }\nvar<uniform> s: S;\n@compute @workgroup_size(1) fn main() { _ = s.a; }",
    );
    check_text(
        "missing_return",
        "fn f() -> f32 {\n    if true { return 1.0; }\n}\n@compute @workgroup_size(1) fn main() { _ = f(); }",
    );
    check_text(
        "store_to_read_only",
        "var<storage> a: array<u32>;\n@compute @workgroup_size(1) fn main() { a[0] = 1u; }",
    );
    check_text(
        "wrong_return",
        "fn f() -> f32 { return 1u; }\n@compute @workgroup_size(1) fn main() { _ = f(); }",
    );
    check_text(
        "wrong_operands",
        "@compute @workgroup_size(1) fn main() {\n    let m = mat3x3<f32>();\n    let v = vec2<f32>();\n    _ = m * v;\n    _ = 1.0f * 2u;\n}",
    );
    check_text(
        "brace_not_closed",
        "fn f() {\n    if true { }\n\n@compute @workgroup_size(1) fn main() { f(); }",
    );
    check_text("wrong_argument", "fn f(x: f32) {}\n@compute @workgroup_size(1) fn main() { f(1u); }");
    check_text("not_portable", "@compute @workgroup_size(1) fn main() { _ = subgroupAdd(1u); }");
    check_text(
        "barrier_in_a_fragment",
        "@fragment fn main() -> @location(0) vec4<f32> {\n    workgroupBarrier();\n    return vec4<f32>();\n}",
    );
    check_text("workgroup_of_nothing", "@compute @workgroup_size(0) fn main() {}");
}
