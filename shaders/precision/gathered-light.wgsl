// The geometry term of a virtual light at a receiver with what its bound removes, by distance.

#import "light-geometry.wgsl"
#import "inputs/directions.wgsl"

struct Given {
    scene_info: SceneInfo,
    light: VirtualLight,
    at: vec3<f32>,
    normal: vec3<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    var scene: SceneInfo;
    scene.extent = 1.0;
    scene.dense_extent = 1.0;
    let way = unit_direction(u.xy);
    let light = VirtualLight(vec3(0.0), 1e-5, direction_beside(way, 1.3 * u.z, u.w), 0u, vec3(1.0), ON_SURFACE);
    return Given(scene, light, magnitude * way, direction_beside(-way, 1.3 * u.w, u.z));
}

/// [magnitude: 1e-5 to 1e3, distance [extents of the scene]]
fn probe(given: Given) -> vec4<f32> {
    return vec4(light_geometry(given.light, given.at, given.normal, 0.01, 1.0), 0.0, 0.0);
}
