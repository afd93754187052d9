// Microfacet reflection at grazing angles, by the cosine of the light.

#import "inputs/reflection.wgsl"

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
    return reflection(given);
}
