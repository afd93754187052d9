// The change of a surface's height above the camera from pixel to pixel, by the height of the image.

#import "surface-around.wgsl"
#import "inputs/directions.wgsl"

struct Given {
    camera: Camera,
    pixel: vec2<u32>,
    size: vec2<u32>,
    normal: vec3<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let back = unit_direction(u.zw);
    let right = direction_beside(back, 1.5707963, u.x);
    let up = cross(back, right);
    let size = vec2(u32(magnitude * 1.5), u32(magnitude));
    var camera: Camera;
    camera.world_from_view = mat4x4(vec4(right, 0.0), vec4(up, 0.0), vec4(back, 0.0), vec4(0.0, 0.0, 0.0, 1.0));
    camera.half_extent = vec2(1.5, 1.0);
    camera.size = vec2<f32>(size);
    let pixel = vec2<u32>(u.xy * 0.9 * camera.size);
    return Given(camera, pixel, size, direction_beside(back, 1.3 * u.z, u.w));
}

/// [magnitude: 16 to 16384, height of the image [px]]
fn probe(given: Given) -> vec4<f32> {
    let around = surface_around(given.pixel, given.size, 1.0, given.normal);
    return vec4(around.slope, 0.0);
}
