// Every form of a member that Rust and WGSL share.

struct Inner {
    a: u32,
    b: vec3f,
}

struct Outer {
    a: f32,
    b: vec2<i32>,
    c: vec3u,
    d: Inner,
    e: mat2x2<f32>,
    f: mat3x3f,
    g: mat4x2<f32>,
    h: array<u32, 3>,
    i: array<vec4<f32>, 2u>,
    j: array<Inner, 2>,
    k: i32
}

struct Rows {
    count: u32,
    rows: array<vec3<f32>>,
}
