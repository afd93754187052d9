// Density of the directions that visible microfacet normals reflect to, near its peak, by alpha.

#import "scatter.wgsl"
#import "inputs/directions.wgsl"

struct Given {
    toward: vec3<f32>,
    to_light: vec3<f32>,
    alpha: f32,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let toward = direction_beside(vec3(0.0, 0.0, 1.0), 1.4 * u.x, u.y);
    let half_way = direction_beside(vec3(0.0, 0.0, 1.0), 3.0 * u.z * magnitude, u.w);
    return Given(toward, 2.0 * dot(half_way, toward) * half_way - toward, magnitude);
}

/// [magnitude: 1e-3 to 1, alpha]
/// [option: GLOSSY true]
fn probe(given: Given) -> vec4<f32> {
    return vec4(visible_normal_density(given.toward, given.to_light, given.alpha), 0.0, 0.0, 0.0);
}
