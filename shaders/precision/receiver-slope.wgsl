// The depth bias of a lookup in a paraboloid map, by the angle between the receiver's normal and the direction to the light.

#import "paraboloid-lookup.wgsl"
#import "inputs/directions.wgsl"
#import "scene.wgsl"

struct Given {
    local: vec3<f32>,
    normal: vec3<f32>,
    scene_info: SceneInfo,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let direction = normalize(vec3(u.x - 0.5, u.y - 0.5, 0.3 + u.z));
    return Given(3.0 * direction, direction_beside(-direction, magnitude, u.w), SceneInfo());
}

/// [magnitude: 1e-5 to 1.5, angle between normal and light [rad]]
fn probe(given: Given) -> vec4<f32> {
    let lookup = paraboloid_lookup_in_frame(ON_SURFACE, given.local, given.normal, 64u, 0.0, 1.0);
    return vec4(lookup.bias, lookup.position, lookup.distance);
}
