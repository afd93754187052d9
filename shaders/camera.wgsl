// The camera, and the way from a pixel to the world and back.
//
// View space is right-handed: x right, y up, the camera looks along -z. Depth here is the distance along the
// viewing axis [m], positive in front of the camera; 0 marks a pixel that sees nothing.

struct Camera {
    /// Clip space from world space: reversed z, far plane at infinity.
    clip_from_world: mat4x4<f32>,
    /// The same in the frame before.
    previous_clip_from_world: mat4x4<f32>,
    /// World space of the view's axes: columns are right, up, back, and position.
    world_from_view: mat4x4<f32>,
    /// World space [m].
    position: vec3<f32>,
    /// Distance of the near plane [m].
    near: f32,
    /// Half the width and height of the image plane at distance 1.
    half_extent: vec2<f32>,
    /// Size of the frame [px].
    size: vec2<f32>,
    /// Offset of the sample of each pixel from its centre [px, y down].
    jitter: vec2<f32>,
    pad: vec2<f32>,
}

var<uniform> camera: Camera;

/// World direction through a point of the image [px, y down], displaced as the samples of this frame are; with length 1
/// along the viewing axis.
fn view_ray(at_px: vec2<f32>) -> vec3<f32> {
    let ndc = vec2(2.0, -2.0) * (at_px + camera.jitter) / camera.size + vec2(-1.0, 1.0);
    let plane = ndc * camera.half_extent;
    return (camera.world_from_view * vec4(plane, -1.0, 0.0)).xyz;
}

/// World direction through the centre of a pixel of a view of `size` pixels, which may be smaller than the frame, or of more
/// samples; with length 1 along the viewing axis.
fn pixel_ray(pixel: vec2<f32>, size: vec2<u32>) -> vec3<f32> {
    return view_ray((pixel + 0.5) * camera.size / vec2<f32>(size));
}

/// Returns the change of `pixel_ray` from a pixel to the next on the right, and to the one below: in large views, the difference of
/// two rays has lost digits.
fn pixel_ray_steps(size: vec2<u32>) -> mat2x3<f32> {
    let step = 2.0 * camera.half_extent / vec2<f32>(size);
    return mat2x3(camera.world_from_view[0].xyz * step.x, camera.world_from_view[1].xyz * -step.y);
}

/// World position [m] of what the centre of a pixel of a view of `size` pixels sees at that depth.
fn position_from_depth(pixel: vec2<u32>, size: vec2<u32>, depth: f32) -> vec3<f32> {
    return camera.position + pixel_ray(vec2<f32>(pixel), size) * depth;
}
