//! Documentation, constants and refusals. The tests of `interfaces` compare layouts with naga's.

use super::*;

#[test]
fn documentation_is_read() {
    let source = "// no doc\n/// A ray.\n/// Of light.\nstruct Ray { /// Start [m].\n origin: vec3f, // no doc\n far: f32 }";
    let ray = read_struct(source, "Ray", &BTreeMap::new()).unwrap();
    assert_eq!(ray.docs, ["A ray.", "Of light."]);
    assert_eq!(
        (ray.members[0].docs.as_slice(), ray.members[1].docs.as_slice()),
        (&["Start [m].".to_owned()][..], &[][..])
    );
}

#[test]
fn constants_are_read() {
    let source = "fn f() { const A = 1u; }\n/// Doc.\nconst A: u32 = 0xffu;\nconst B = 64u;\nconst C = -2i;\nconst D = 3f;\n\
                  const E: f32 = 1.5e3;";
    let read = |name| read_const(source, name).map(|found| format!("{}: {}", found.ty, found.value)).unwrap();
    assert_eq!(
        ["A", "B", "C", "D", "E"].map(read),
        ["u32: 0xff", "u32: 64", "i32: -2", "f32: 3.0", "f32: 1.5e3"]
    );
    assert_eq!(read_const(source, "A").unwrap().docs, ["Doc."]);
}

#[test]
fn other_forms_are_refused_with_their_line() {
    let structure = |source: &str| read_struct(source, "S", &BTreeMap::new()).map(|_| ()).unwrap_err();
    let constant = |source: &str| read_const(source, "C").map(|_| ()).unwrap_err();
    let a_type = "a scalar, a vector, a matrix, an array or a struct that is listed before";
    for (error, line, message) in [
        (structure("struct T {}\n"), 1, "there is no `struct S`"),
        (structure("struct S {\n  a: T,\n}"), 2, &format!("expected {a_type}; found `T`")),
        (structure("struct S {\n  a: vec5<f32>,\n}"), 2, &format!("expected {a_type}; found `vec5`")),
        (structure("struct S {\n\n  @size(16) a: u32,\n}"), 3, "expected a name; found `@`"),
        (structure("struct S {\n  a: u32\n  b: u32,\n}"), 3, "expected `,` or `}`; found `b`"),
        (structure("struct S {\n  a: vec2<bool>,\n}"), 2, "expected `f32`, `u32` or `i32`; found `bool`"),
        (structure("struct S {\n  a: array<u32, N>,\n}"), 2, "expected the number of elements; found `N`"),
        (
            structure("struct S { a: array<u32>, b: u32 }"),
            1,
            "expected `}` after an array that is sized at run time; found `b`",
        ),
        (structure("struct S {\n  a: u32,\n"), 2, "expected a name; found the end of the file"),
        (constant("const C = B;"), 1, "expected a literal of the type u32, i32 or f32; found `;`"),
        (constant("const C = 1u + 2u;"), 1, "expected a literal of the type u32, i32 or f32; found `+`"),
        (constant("const C = 64;"), 1, "expected a literal of the type u32, i32 or f32; found `;`"),
    ] {
        assert_eq!((error.line, error.message.as_str()), (line, message));
    }
}
