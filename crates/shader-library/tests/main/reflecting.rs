//! Reflection of valid modules.

use crate::shader;
use shader_library::{Access, Dimension, GlobalKind, Location, Sample, Stage};

const EVERYTHING: &str = "
struct Light { position: vec3<f32>, flux: vec3<f32> }
struct Lights { count: u32, lights: array<Light> }
struct Settings { scale: f32, offset: vec2<f32> }

var<uniform> settings: Settings;
var<uniform> matrix: mat4x4<f32>;
var<storage> lights: Lights;
var<storage, read_write> counters: array<atomic<u32>, 4>;
var<storage, read> points: array<vec3<f32>>;
var plain: texture_2d<f32>;
var sampled: texture_2d_array<f32>;
var cube: texture_cube<f32>;
var cubes: texture_cube_array<f32>;
var volume: texture_3d<f32>;
var line: texture_1d<f32>;
var ids: texture_2d<u32>;
var signed: texture_2d<i32>;
var depth: texture_depth_2d_array;
var samples: texture_multisampled_2d<f32>;
var image: texture_storage_2d<rgba16float, write>;
var history: texture_storage_2d_array<r32uint, read_write>;
var smooth_: sampler;
var compare: sampler_comparison;
var<workgroup> shared_: f32;
var<private> own: f32;
";

#[test]
fn every_kind_of_resource() {
    let text = format!(
        "{EVERYTHING}
        @fragment fn shade(@builtin(position) p: vec4<f32>) -> @location(0) vec4<f32> {{
            return textureSample(sampled, smooth_, p.xy, 0) + textureLoad(plain, vec2<u32>(), 0);
        }}"
    );
    let shader = shader(&text);
    insta::with_settings!({ prepend_module_to_snapshot => false, omit_expression => true }, {
        let lines: Vec<String> =
            shader.interface.globals.iter().map(|g| format!("{} {}: {:?}", g.binding, g.name, g.kind)).collect();
        insta::assert_snapshot!("globals", lines.join("\n"));
    });
    let kind = |name: &str| &shader.interface.global(name).unwrap().1.kind;
    let texture = |dimension, sample| GlobalKind::Texture { dimension, sample, multisampled: false };
    assert_eq!(*kind("sampled"), texture(Dimension::D2Array, Sample::Float { sampled: true }));
    assert_eq!(*kind("plain"), texture(Dimension::D2, Sample::Float { sampled: false }));
    assert_eq!(*kind("depth"), texture(Dimension::D2Array, Sample::Depth));
    assert_eq!(*kind("signed"), texture(Dimension::D2, Sample::Sint));
    let history = GlobalKind::StorageTexture {
        dimension: Dimension::D2Array,
        format: "r32uint",
        access: Access::ReadWrite,
    };
    assert_eq!(*kind("history"), history);
    let GlobalKind::Storage { writable: false, layout } = kind("lights") else {
        panic!("{:?}", kind("lights"))
    };
    assert_eq!((layout.size, layout.element.clone()), (16, Some(("Light".to_owned(), 32))));
}

#[test]
fn bindings_follow_names_and_override_those_written() {
    let shader = shader(
        "@group(2) @binding(7) var<storage> zebra: array<u32>;
        var<storage, read_write> ant: array<u32>;
        @group(0) @binding(0) var<storage> mouse: array<u32>;
        @compute @workgroup_size(1) fn main() { ant[0] = zebra[0] + mouse[0]; }",
    );
    let bound: Vec<_> = shader.interface.globals.iter().map(|g| (g.name.as_str(), g.binding)).collect();
    assert_eq!(bound, [("ant", 0), ("mouse", 1), ("zebra", 2)]);
    for (_, variable) in shader.module.global_variables.iter() {
        let (_, global) = shader.interface.global(variable.name.as_ref().unwrap()).unwrap();
        let binding = variable.binding.unwrap();
        assert_eq!((binding.group, binding.binding), (0, global.binding));
    }
}

#[test]
fn entries_use_what_they_and_their_callees_use() {
    let shader = shader(
        "var<storage> a: array<u32>;
        var<storage> b: array<u32>;
        var<storage, read_write> c: array<u32>;
        fn inner() -> u32 { return b[0]; }
        fn outer() -> u32 { return inner(); }
        @compute @workgroup_size(4, 2) fn first() { c[0] = outer(); }
        @compute @workgroup_size(8) fn second() { c[1] = a[0] + arrayLength(&a); }
        @compute @workgroup_size(1) fn third() {}",
    );
    let used: Vec<_> =
        shader.interface.entries.iter().map(|e| (e.name.as_str(), e.globals.as_slice())).collect();
    assert_eq!(used, [("first", &[1, 2][..]), ("second", &[0, 2]), ("third", &[])]);
    assert_eq!(shader.interface.entry("first").unwrap().workgroup_size, [4, 2, 1]);
}

#[test]
fn stages_take_and_give() {
    let shader = shader(
        "struct Vertex { @location(0) position: vec3<f32>, @location(3) uv: vec2<f32>, @builtin(vertex_index) i: u32 }
        struct Between { @builtin(position) clip: vec4<f32>, @location(0) uv: vec2<f32> }
        struct Targets { @location(0) color: vec4<f32>, @location(1) id: u32, @builtin(frag_depth) depth: f32 }
        @vertex fn vs(in: Vertex, @location(5) weight: f32) -> Between {
            return Between(vec4<f32>(in.position, weight), in.uv);
        }
        @fragment fn fs(in: Between) -> Targets { return Targets(vec4<f32>(in.uv, 0.0, 1.0), 3u, 0.5); }
        @fragment fn plain() -> @location(0) vec4<f32> { return vec4<f32>(); }",
    );
    let at = |location, name: &str, ty: &str| Location { location, name: name.to_owned(), ty: ty.to_owned() };
    let [vs, fs, plain] = &shader.interface.entries[..] else { panic!("three entries") };
    assert_eq!((vs.stage, fs.stage), (Stage::Vertex, Stage::Fragment));
    assert_eq!(vs.inputs, [at(0, "position", "vec3<f32>"), at(3, "uv", "vec2<f32>"), at(5, "weight", "f32")]);
    assert_eq!(vs.outputs, [at(0, "uv", "vec2<f32>")]);
    assert_eq!(fs.inputs, vs.outputs);
    assert_eq!(fs.outputs, [at(0, "color", "vec4<f32>"), at(1, "id", "u32")]);
    assert_eq!(plain.outputs, [at(0, "", "vec4<f32>")]);
}

#[test]
fn overrides_have_their_defaults_in_the_size_of_workgroups() {
    let shader = shader(
        "const base = 4u;
        override width: u32 = 2u * base;
        override height = 4;
        override needed: u32;
        @compute @workgroup_size(width, height * 2) fn a() {}
        @compute @workgroup_size(needed) fn b() {}",
    );
    assert_eq!(shader.interface.entry("a").unwrap().workgroup_size, [8, 8, 1]);
    assert_eq!(shader.interface.entry("b").unwrap().workgroup_size, [0, 1, 1]);
}

#[test]
fn structs_are_laid_out_as_wgsl_says() {
    let shader = shader(&format!("{EVERYTHING} @compute @workgroup_size(1) fn main() {{}}"));
    let settings = shader.interface.settings.as_ref().unwrap();
    let rows: Vec<_> =
        settings.members.iter().map(|m| (m.name.as_str(), m.ty.as_str(), m.offset, m.size)).collect();
    assert_eq!((rows, settings.size), (vec![("scale", "f32", 0, 4), ("offset", "vec2<f32>", 8, 8)], 16));
    let lights = shader.interface.layout("Lights").unwrap();
    assert_eq!((lights.members[1].offset, lights.members[1].size, lights.size), (16, 0, 16));
}
