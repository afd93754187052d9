// A vector in the frame about a normal and back, by how near the normal is to -z or to the plane z = 0.

#import "tangent-frame.wgsl"

struct Given {
    near_pole: vec3<f32>,
    near_equator: vec3<f32>,
    vector: vec3<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let around = 6.283185307 * u.x;
    let angle = magnitude * (0.5 + 0.5 * u.y);
    let flat = vec2(cos(around), sin(around));
    let pole = vec3(flat * sin(angle), -cos(angle));
    let equator = vec3(flat * cos(angle), select(-1.0, 1.0, u.y < 0.5) * sin(angle));
    return Given(pole, equator, vec3(u.zw - 0.5, 0.5));
}

/// [magnitude: 1e-8 to 1.5, angle to -z, and to the plane z = 0 [rad]]
/// [compared: vector]
fn probe(given: Given) -> vec4<f32> {
    let a = given.vector * frame_from_normal(given.near_pole);
    let b = given.vector * frame_from_normal(given.near_equator);
    return vec4(a.xy, b.xy);
}
