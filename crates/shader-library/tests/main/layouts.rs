//! The CPU's structs against the shader's, and uniforms filled by name.

use crate::{library, shader};
use data_file::Value;
use shader_library::{Request, StructLayout, write_struct};

fn cpu() -> StructLayout {
    let members = [
        ("position", "vec3<f32>", 0, 12),
        ("area", "f32", 12, 4),
        ("normal", "vec3<f32>", 16, 12),
        ("index", "u32", 28, 4),
    ];
    StructLayout::new("VirtualLight", 32, &members)
}

const SHADER: &str = "
struct VirtualLight { position: vec3<f32>, area: f32, normal: vec3<f32>, index: u32 }
var<storage> lights: array<VirtualLight>;
@compute @workgroup_size(1) fn main() { _ = lights[0].area; }
";

#[test]
fn equal_layouts_agree() {
    let absent = StructLayout { name: "Absent".to_owned(), ..cpu() };
    shader(SHADER).check_layout(&[cpu(), absent], "gpu.rs").unwrap_or_else(|errors| panic!("{errors}"));
}

#[test]
fn other_layouts_are_shown_side_by_side() {
    let text = SHADER.replace("area: f32, normal: vec3<f32>", "normal: vec3<f32>, area: f32, weight: f32");
    let files = [("main.wgsl", "#import \"lights.wgsl\"\n"), ("lights.wgsl", &text)];
    let shader = library(&files).load(&Request::new("main.wgsl")).unwrap();
    let errors = shader.check_layout(&[cpu()], "crates/pass/src/lights.rs").unwrap_err();
    insta::with_settings!({ prepend_module_to_snapshot => false, omit_expression => true }, {
        insta::assert_snapshot!("layouts", errors.to_string());
    });
    for broken in ["area: u32", "area_: f32", "@size(8) area: f32"] {
        let shader = crate::shader(&SHADER.replace("area: f32", broken).replace("_ = lights[0].area", ""));
        assert!(shader.check_layout(&[cpu()], "gpu.rs").is_err(), "{broken}");
    }
    let padded = StructLayout { size: 48, ..cpu() };
    assert!(crate::shader(SHADER).check_layout(&[padded], "gpu.rs").is_err(), "other strides");
}

const UNIFORM: &str = "
struct Frame { time: f32, seed: u32, shift: i32, size: vec2<u32>, eye: vec3<f32>, on: u32, color: vec4<f32>, tail: f32, cell: vec2<i32> }
var<uniform> frame: Frame;
@compute @workgroup_size(1) fn main() { _ = frame.time; }
";

fn value(name: &str) -> Option<Value> {
    Some(match name {
        "time" => Value::U32(2),
        "seed" => Value::U32(u32::MAX),
        "shift" => Value::I32(-3),
        "size" => Value::Vector(vec![640.0, 480.0]),
        "eye" => Value::Vector(vec![1.0, 2.0, 3.0]),
        "on" => Value::Bool(true),
        "color" => Value::Vector(vec![0.25, 0.5, 0.75, 1.0]),
        "tail" => Value::F32(9.5),
        "cell" => Value::Vector(vec![-1.0, 7.0]),
        _ => return None,
    })
}

#[test]
fn a_uniform_is_filled_where_wgsl_reads_it() {
    let shader = shader(UNIFORM);
    let layout = shader.interface.layout("Frame").unwrap();
    let bytes = write_struct(layout, &value).unwrap();
    // Offsets by the rules of the WGSL specification, §14.4: alignment 8 for vec2, 16 for vec3 and vec4.
    let mut expected = [0_u8; 80];
    let mut put = |at: usize, word: [u8; 4]| expected[at..at + 4].copy_from_slice(&word);
    put(0, 2.0_f32.to_le_bytes());
    put(4, u32::MAX.to_le_bytes());
    put(8, (-3_i32).to_le_bytes());
    put(16, 640_u32.to_le_bytes());
    put(20, 480_u32.to_le_bytes());
    for (i, x) in [1.0_f32, 2.0, 3.0].into_iter().enumerate() {
        put(32 + 4 * i, x.to_le_bytes());
    }
    put(44, 1_u32.to_le_bytes());
    for (i, x) in [0.25_f32, 0.5, 0.75, 1.0].into_iter().enumerate() {
        put(48 + 4 * i, x.to_le_bytes());
    }
    put(64, 9.5_f32.to_le_bytes());
    put(72, (-1_i32).to_le_bytes());
    put(76, 7_i32.to_le_bytes());
    assert_eq!(bytes, expected);
    assert_eq!(layout.size, 80);
}

#[test]
fn what_is_missing_or_does_not_fit_is_listed() {
    let shader = shader(UNIFORM);
    let layout = shader.interface.layout("Frame").unwrap();
    let error = write_struct(layout, &|name| match name {
        "time" | "tail" => None,
        "seed" => Some(Value::I32(-1)),
        "eye" => Some(Value::Vector(vec![1.0, 2.0])),
        "size" => Some(Value::Vector(vec![0.5, 1.0])),
        "on" => Some(Value::F32(1.0)),
        other => value(other),
    })
    .unwrap_err();
    assert_eq!(error.missing, ["time", "tail"]);
    insta::with_settings!({ prepend_module_to_snapshot => false, omit_expression => true }, {
        insta::assert_snapshot!("uniform", error.to_string());
    });
}
