// Distance and barycentric coordinates of a ray's hit of a triangle, by how far it is in its own lengths.

#import "ray-tracing.wgsl"
#import "inputs/directions.wgsl"

struct Given {
    origin: vec3<f32>,
    direction: vec3<f32>,
    a: vec3<f32>,
    b: vec3<f32>,
    c: vec3<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let direction = unit_direction(u.xy);
    let normal = direction_beside(direction, 1.2 * u.z, u.w);
    let edge = direction_beside(normal, 1.5707963, fract(64.0 * u.w));
    let other = cross(normal, edge);
    // The ray hits it at a third of both edges.
    let hit = direction * magnitude;
    let a = hit - (edge + other) / 3.0;
    return Given(vec3(0.0), direction, a, a + edge, a + other);
}

/// [magnitude: 0.1 to 1e5, distance over the length of the edges]
fn probe(given: Given) -> vec4<f32> {
    var hit = Hit(FAR, NO_HIT, vec2(0.0));
    let item = BvhItem(
        vec4(bitcast<vec3<u32>>(given.a), 0u),
        vec4(bitcast<vec3<u32>>(given.b), 0u),
        vec4(bitcast<vec3<u32>>(given.c), 0u),
    );
    bvh_triangle(bvh_ray(given.origin, given.direction), item, 0.0, &hit);
    return vec4(hit.distance, hit.barycentrics, 1.0 - hit.barycentrics.x - hit.barycentrics.y);
}
