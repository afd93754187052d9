// Normal and area of a triangle, by the length of its edges.

#import "triangle.wgsl"
#import "inputs/directions.wgsl"

struct Given {
    a: vec3<f32>,
    b: vec3<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let along = unit_direction(u.xy);
    return Given(magnitude * along, magnitude * direction_beside(along, 0.3 + u.z, u.w));
}

/// [magnitude: 1e-18 to 1e18, length of an edge [m]]
/// [compared: vector]
fn probe(given: Given) -> vec4<f32> {
    let shape = normal_and_area(given.a, given.b);
    return vec4(shape.xyz, shape.w / dot(given.a, given.a));
}
