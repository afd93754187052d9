// The angle between visible microfacet normals and the surface's normal, seen along it, by the random number that decides it.

#import "scatter.wgsl"

struct Given {
    alpha: f32,
    square: vec2<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    return Given(0.001 + 0.5 * u.x, vec2(u.y, magnitude * (0.5 + 0.5 * u.z)));
}

/// [magnitude: 1e-7 to 1, random number]
/// [option: GLOSSY true]
/// [compared: vector]
fn probe(given: Given) -> vec4<f32> {
    return vec4(visible_normal(vec3(0.0, 0.0, 1.0), given.alpha, given.square).xy, 0.0, 0.0);
}
