// The position that a pixel sees at a depth, relative to the camera, which is as far from the origin; and the depth as it is stored.

#import "camera.wgsl"
#import "inputs/directions.wgsl"

struct Given {
    camera: Camera,
    pixel: vec2<u32>,
    depth: f32,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let back = unit_direction(u.zw);
    let right = direction_beside(back, 1.5707963, u.x);
    let up = cross(back, right);
    var camera: Camera;
    camera.world_from_view = mat4x4(vec4(right, 0.0), vec4(up, 0.0), vec4(back, 0.0), vec4(0.0, 0.0, 0.0, 1.0));
    camera.near = 0.01;
    camera.half_extent = vec2(1.0, 0.5625);
    camera.size = vec2(1920.0, 1080.0);
    return Given(camera, vec2<u32>(u.xy * camera.size), magnitude);
}

/// [magnitude: 1e-2 to 1e6, depth [m]]
/// [compared: vector]
fn probe(given: Given) -> vec4<f32> {
    return vec4(position_from_depth(given.pixel, vec2<u32>(given.camera.size), given.depth), 0.0);
}
