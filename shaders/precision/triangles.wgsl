// Normal and area of a triangle whose third vertex is near the line of the other two, given its edges.

#import "triangle.wgsl"
#import "inputs/directions.wgsl"

struct Given {
    a: vec3<f32>,
    b: vec3<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let along = unit_direction(u.xy);
    let b = direction_beside(along, magnitude, u.w) * (0.2 + u.z);
    return Given(along, b);
}

/// [magnitude: 1e-6 to 1, ratio of height to length]
/// [compared: vector]
fn probe(given: Given) -> vec4<f32> {
    return normal_and_area(given.a, given.b);
}
