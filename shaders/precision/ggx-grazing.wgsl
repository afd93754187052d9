// Microfacet reflection at grazing angles, by the cosine of the light.

#import "ggx.wgsl"

struct Given {
    normal: vec3<f32>,
    to_light: vec3<f32>,
    to_camera: vec3<f32>,
    roughness: f32,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let z = magnitude * (0.5 + 0.5 * u.x);
    let along = sqrt(max(1.0 - z * z, 0.0));
    let view = 0.01 + 0.9 * u.z;
    let aside = sqrt(1.0 - view * view);
    let turn = 3.0 * u.y;
    return Given(vec3(0.0, 0.0, 1.0), vec3(along, 0.0, z), vec3(aside * cos(turn), aside * sin(turn), view), 0.1 + 0.9 * u.w);
}

/// [magnitude: 1e-6 to 1, cosine between normal and light]
fn probe(given: Given) -> vec4<f32> {
    return vec4(ggx(given.normal, given.to_light, given.to_camera, vec3(0.04, 0.5, 1.0), given.roughness), 0.0);
}
