//! Imports and variants.

use crate::{errors_of, library};
use data_file::{Files, Source};
use shader_library::{Define, DiskFiles, GlobalKind, Library, MemoryFiles, Overlay, Request};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock, Weak};

const MAIN: &str = "@compute @workgroup_size(1) fn main() { _ = ";

fn main_calling(calls: &str) -> String {
    format!("{MAIN}{calls}; }}\n")
}

#[test]
fn an_import_is_looked_for_beside_the_file_and_then_in_the_roots() {
    let text =
        format!("#import \"random.wgsl\"\n#import \"near.wgsl\"\n{}", main_calling("random() + near()"));
    let library = library(&[
        ("passes/a/a.wgsl", &text),
        ("passes/a/near.wgsl", "#import \"../b/other.wgsl\"\nfn near() -> f32 { return other(); }"),
        ("near.wgsl", "not this one"),
        ("passes/b/other.wgsl", "fn other() -> f32 { return 2.0; }"),
        ("shaders/random.wgsl", "fn random() -> f32 { return 1.0; }"),
    ]);
    let shader = library.load(&Request::new("passes/a/a.wgsl")).unwrap();
    let files = ["passes/a/a.wgsl", "shaders/random.wgsl", "passes/a/near.wgsl", "passes/b/other.wgsl"];
    assert_eq!(shader.files(), files);
}

#[test]
fn a_diamond_and_a_cycle_hold_each_file_once() {
    let text = format!("#import \"left.wgsl\"\n#import \"right.wgsl\"\n{}", main_calling("left() + right()"));
    let library = library(&[
        ("main.wgsl", &text),
        ("left.wgsl", "#import \"base.wgsl\"\nfn left() -> f32 { return base(); }"),
        (
            "right.wgsl",
            "#import \"./base.wgsl\"\n#import \"main.wgsl\"\nfn right() -> f32 { return base(); }",
        ),
        ("base.wgsl", "#import \"right.wgsl\"\nfn base() -> f32 { return 1.0; }"),
    ]);
    let shader = library.load(&Request::new("main.wgsl")).unwrap();
    assert_eq!(shader.text().matches("fn base").count(), 1);
    assert_eq!(shader.text().matches("fn right").count(), 1);
    assert_eq!(shader.text().matches("fn main").count(), 1);
}

#[test]
fn an_interface_is_the_module_that_the_caller_names() {
    let main = format!("#import interface \"visibility\"\n{}", main_calling("visibility()"));
    let library = library(&[
        ("gather.wgsl", &main),
        ("none.wgsl", "fn visibility() -> f32 { return 1.0; }"),
        ("rays/rays.wgsl", "#import \"trace.wgsl\"\nfn visibility() -> f32 { return trace(); }"),
        ("rays/trace.wgsl", "fn trace() -> f32 { return 0.5; }"),
    ]);
    let none = library.load(&Request::new("gather.wgsl").module("visibility", "none.wgsl")).unwrap();
    let rays = library.load(&Request::new("gather.wgsl").module("visibility", "rays/rays.wgsl")).unwrap();
    assert_eq!(none.files(), ["gather.wgsl", "none.wgsl"]);
    assert_eq!(rays.files(), ["gather.wgsl", "rays/rays.wgsl", "rays/trace.wgsl"]);
    assert_ne!(none.hash, rays.hash);
    let outline = library.outline(&Request::new("gather.wgsl")).unwrap();
    assert_eq!(outline.interfaces.iter().collect::<Vec<_>>(), ["visibility"]);
}

const VARIANTS: &str = "\
#option GLOSSY false // adds the glossy lobe
#option TAPS 1 one_of [1, 4, 9]
#option FILTER box
#if GLOSSY && TAPS != 1
const chosen = 1u;
#elif (!GLOSSY || TAPS == 1) && FILTER == gauss
const chosen = 2u;
#elif FILTER == \"box\"
const chosen = 3u;
#else
const chosen = 4u;
#endif
@compute @workgroup_size(chosen) fn main() { var a: array<f32, TAPS>; a[0] = select(0.0, 1.0, GLOSSY); }
";

#[test]
fn conditions_choose_by_the_values_of_options() {
    let library = library(&[("main.wgsl", VARIANTS)]);
    let size = |request: &Request| library.load(request).unwrap().interface.entries[0].workgroup_size[0];
    let base = Request::new("main.wgsl");
    assert_eq!(size(&base), 3);
    assert_eq!(size(&base.clone().define("GLOSSY", true)), 3);
    assert_eq!(size(&base.clone().define("GLOSSY", true).define("TAPS", 4)), 1);
    assert_eq!(size(&base.clone().define("FILTER", "gauss")), 2);
    assert_eq!(size(&base.clone().define("FILTER", "tent")), 4);
}

#[test]
fn variants_are_all_combinations_that_make_a_difference() {
    let library = library(&[("main.wgsl", VARIANTS)]);
    let outline = library.outline(&Request::new("main.wgsl")).unwrap();
    assert_eq!(outline.options[0].doc, "adds the glossy lobe");
    assert_eq!(outline.options[1].values(), [Define::Int(1), Define::Int(4), Define::Int(9)]);
    assert_eq!(outline.options[2].values(), [Define::from("box"), Define::from("gauss")]);
    let variants = library.variants(&Request::new("main.wgsl")).unwrap();
    assert_eq!(variants.len(), 2 * 3 * 2);
    for variant in &variants {
        library.load(variant).unwrap_or_else(|errors| panic!("{errors}"));
    }
    let fixed = library.variants(&Request::new("main.wgsl").define("TAPS", 4)).unwrap();
    assert_eq!(fixed.len(), 2 * 2);
    assert!(fixed.iter().all(|request| request.defines["TAPS"] == Define::Int(4)));
}

#[test]
fn an_option_that_only_one_branch_declares_varies_only_there() {
    let library = library(&[
        (
            "main.wgsl",
            "#option SHADOWS false\n#if SHADOWS\n#import \"shadows.wgsl\"\n#endif\n@compute @workgroup_size(1) fn main() {}",
        ),
        ("shadows.wgsl", "#option SOFT false\n#if SOFT\n#endif\n"),
    ]);
    assert_eq!(library.variants(&Request::new("main.wgsl")).unwrap().len(), 3);
    let errors = errors_of(
        &[("main.wgsl", "#option SHADOWS false\n@compute @workgroup_size(1) fn main() {}")],
        &Request::new("main.wgsl").define("SHADOW", true),
    );
    assert!(errors.contains("did you mean `SHADOWS`?"), "{errors}");
}

#[test]
fn the_outline_of_a_shader_without_its_modules_takes_their_options() {
    let library = library(&[("main.wgsl", "#import interface \"i\"\n"), ("i.wgsl", "#option SOFT false\n")]);
    let request = Request::new("main.wgsl").define("SOFT", true);
    assert!(library.outline(&request).unwrap().options.is_empty());
    assert_eq!(library.outline(&request.module("i", "i.wgsl")).unwrap().options.len(), 1);
}

#[test]
fn a_chain_of_imports_without_end_is_an_error() {
    let files: Vec<_> = (0..5000)
        .map(|i| (format!("{i}.wgsl"), format!("#import \"{}.wgsl\"\nconst c{i} = 1;\n", i + 1)))
        .collect();
    let library = Library::new(Arc::new(MemoryFiles::new(files)));
    let errors = library.load(&Request::new("0.wgsl")).unwrap_err().to_string();
    assert!(errors.contains("imports are nested more than 64 deep"), "{errors}");
}

#[test]
fn imports_in_a_branch_not_taken_are_not_read() {
    let text = "#option FAR false\n#if FAR\n#import \"absent.wgsl\"\n#if UNKNOWN\n#endif\n#else\nfn here() {}\n#endif\n@compute @workgroup_size(1) fn main() { here(); }";
    let library = library(&[("main.wgsl", text)]);
    assert!(library.load(&Request::new("main.wgsl")).is_ok());
    let far = library.load(&Request::new("main.wgsl").define("FAR", true)).unwrap_err().to_string();
    assert!(far.contains("absent.wgsl") && far.contains("UNKNOWN"), "{far}");
}

#[test]
fn directives_in_comments_are_comments() {
    let text = "/* /* #import \"a.wgsl\" */\n#import \"b.wgsl\"\n*/\n// #import \"c.wgsl\"\n// /*\n\u{a0}#option TAPS 3\n@compute @workgroup_size(TAPS) fn main() {}";
    let library = library(&[("main.wgsl", text)]);
    let shader = library.load(&Request::new("main.wgsl")).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(shader.interface.entries[0].workgroup_size, [3, 1, 1]);
}

#[test]
fn directives_of_wgsl_may_stand_below_options_but_not_below_code() {
    let text =
        "#option A true\ndiagnostic(off, derivative_uniformity);\n@compute @workgroup_size(1) fn main() {}";
    assert!(library(&[("main.wgsl", text)]).load(&Request::new("main.wgsl")).is_ok());
}

#[test]
fn an_enable_line_of_any_file_goes_before_all_code() {
    let query = "const A = 1u;\nenable wgpu_ray_query; // ä\nvar scene: acceleration_structure;\n/*\nenable f16;\n*/\n#if false_option\nenable f16;\n#endif\nfn kind() -> u32 {\n    var query: ray_query;\n    rayQueryInitialize(&query, scene, RayDesc(0u, 255u, 0.0, 1.0, vec3(0.0), vec3(1.0)));\n    return rayQueryGetCommittedIntersection(&query).kind;\n}";
    let main = "#option false_option false\n#import \"a.wgsl\"\n#import \"b.wgsl\"\n@compute @workgroup_size(1) fn main() { _ = kind() + a; }";
    let again = "enable wgpu_ray_query; // ä\nconst a = 1u;";
    let library = library(&[("main.wgsl", main), ("a.wgsl", again), ("b.wgsl", query)]);
    let shader = library.load(&Request::new("main.wgsl")).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(shader.text().matches("enable wgpu").count(), 1, "{}", shader.text());
    assert_eq!(shader.interface.globals[0].kind, GlobalKind::AccelerationStructure);
    for (what, place) in
        [("enable wgpu", "a.wgsl:1:1"), ("var query", "b.wgsl:11:5"), ("_ = kind", "main.wgsl:4:41")]
    {
        let at = shader.text().find(what).unwrap() as u32;
        assert_eq!(shader.place(at..at + 1).unwrap().to_string(), place);
    }
}

#[test]
fn a_byte_order_mark_and_carriage_returns_are_no_trouble() {
    let text = "\u{feff}#import \"a.wgsl\"\r\n#option A 2\r\n#if A == 2\r\n@compute @workgroup_size(a) fn main() {}\r\n#endif\r\n";
    let library = library(&[("main.wgsl", text), ("a.wgsl", "\u{feff}const a = 7;")]);
    let shader = library.load(&Request::new("main.wgsl")).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(shader.interface.entries[0].workgroup_size, [7, 1, 1]);
}

#[test]
fn places_lead_back_through_imports() {
    let main = "#import \"a.wgsl\"\n@compute @workgroup_size(1) fn main() { _ = a(); }";
    let library = library(&[("main.wgsl", main), ("a.wgsl", "// ä\nfn a() -> f32 { return 1.0; }")]);
    let shader = library.load(&Request::new("main.wgsl")).unwrap();
    for (what, place) in [("return 1.0", "a.wgsl:2:17"), ("_ = a()", "main.wgsl:2:41")] {
        let at = shader.text().find(what).unwrap() as u32;
        let span = shader.place(at..at + what.len() as u32).unwrap();
        assert_eq!(span.to_string(), place);
        assert_eq!(&span.source.text[span.start as usize..span.end as usize], what);
    }
}

/// A file of which another thread writes and reports a new text as soon as it is first read.
struct Changing(OnceLock<Weak<Library>>, AtomicBool);

impl Files for Changing {
    fn read(&self, path: &str) -> Option<Arc<Source>> {
        let is_first = !self.1.swap(true, Ordering::Relaxed);
        let size = if is_first { 1 } else { 2 };
        let text = format!("@compute @workgroup_size({size}) fn main() {{}}");
        if let Some(library) = self.0.get().and_then(Weak::upgrade).filter(|_| is_first) {
            library.invalidate(&[path]);
        }
        Some(Source::new(path, text))
    }

    fn list(&self) -> Vec<String> {
        Vec::new()
    }
}

#[test]
fn a_shader_that_changes_while_it_is_read_is_not_kept() {
    let files = Arc::new(Changing(OnceLock::new(), AtomicBool::new(false)));
    let library = Arc::new(Library::new(files.clone()));
    files.0.set(Arc::downgrade(&library)).unwrap();
    let request = Request::new("a.wgsl");
    let size = || library.load(&request).unwrap().interface.entries[0].workgroup_size[0];
    assert_eq!((size(), size()), (1, 2));
}

#[test]
fn a_change_of_a_file_touches_the_requests_that_read_it_or_missed_it() {
    let files = Arc::new(MemoryFiles::new([
        ("a.wgsl", "#import \"lib.wgsl\"\n@compute @workgroup_size(n) fn main() {}"),
        ("b.wgsl", "@compute @workgroup_size(1) fn main() {}"),
        ("c.wgsl", "#import \"later.wgsl\"\n@compute @workgroup_size(later) fn main() {}"),
        ("shaders/lib.wgsl", "const n = 1;"),
    ]));
    let library = Library::new(files.clone()).with_roots(["", "shaders"]);
    let [a, b, c] = ["a.wgsl", "b.wgsl", "c.wgsl"].map(Request::new);
    let size = |request: &Request| library.load(request).unwrap().interface.entries[0].workgroup_size[0];
    let first = library.load(&a).unwrap();
    assert!(library.load(&b).is_ok() && library.load(&c).is_err());
    assert!(Arc::ptr_eq(&first, &library.load(&a).unwrap()), "made once");

    files.set("shaders/lib.wgsl", "const n = 2;");
    assert_eq!(size(&a), 1, "kept until it is invalidated");
    assert_eq!(library.invalidate(&["shaders/lib.wgsl"]), std::slice::from_ref(&a));
    assert_eq!(size(&a), 2);

    // A file that comes before the one that was read, and one that was missing.
    files.set("lib.wgsl", "const n = 3;");
    files.set("shaders/later.wgsl", "const later = 4;");
    assert_eq!(library.invalidate(&["lib.wgsl", "shaders/later.wgsl"]), [a.clone(), c.clone()]);
    assert_eq!((size(&a), size(&c)), (3, 4));
    assert!(library.invalidate(&["unrelated.wgsl"]).is_empty());
}

#[test]
fn the_hash_is_of_the_composed_text() {
    let hash = |text: &str| library(&[("main.wgsl", text)]).load(&Request::new("main.wgsl")).unwrap().hash;
    let a = "@compute @workgroup_size(1) fn main() {}\n";
    assert_eq!(hash(a), hash(a));
    assert_eq!(hash(a), hash(&format!("#option X some\n#if X == other\nbroken\n#endif\n{a}")));
    assert_ne!(hash(a), hash("@compute @workgroup_size(2) fn main() {}\n"));
}

#[test]
fn files_on_disk_lie_over_those_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("shaders")).unwrap();
    std::fs::write(folder.path().join("shaders/n.wgsl"), "const n = 5;").unwrap();
    std::fs::write(folder.path().join("secret.wgsl"), "").unwrap();
    let memory = MemoryFiles::new([
        ("main.wgsl", "#import \"shaders/n.wgsl\"\n@compute @workgroup_size(n) fn main() {}"),
        ("shaders/n.wgsl", "const n = 1;"),
    ]);
    let disk = DiskFiles::new(folder.path());
    let files = Overlay(vec![Arc::new(disk), Arc::new(memory)]);
    let inner = DiskFiles::new(folder.path().join("shaders"));
    let library = Library::new(Arc::new(files));
    let shader = library.load(&Request::new("main.wgsl")).unwrap();
    assert_eq!(shader.interface.entries[0].workgroup_size[0], 5);
    assert_eq!(library.files().list(), ["main.wgsl", "secret.wgsl", "shaders/n.wgsl"]);
    let outside = Library::new(Arc::new(inner)).load(&Request::new("../secret.wgsl"));
    assert!(outside.is_err(), "no path leads out of the folder");
}
