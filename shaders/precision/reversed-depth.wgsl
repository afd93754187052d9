// Distance along the viewing axis from a depth in the reversed depth buffer, by that distance.

#import "camera.wgsl"

struct Given {
    camera: Camera,
    at: vec3<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    var camera: Camera;
    camera.near = 0.01;
    camera.clip_from_world = mat4x4(
        vec4(1.0, 0.0, 0.0, 0.0),
        vec4(0.0, 1.7777778, 0.0, 0.0),
        vec4(0.0, 0.0, 0.0, -1.0),
        vec4(0.0, 0.0, camera.near, 0.0),
    );
    return Given(camera, magnitude * vec3(u.xy - 0.5, -1.0));
}

/// [magnitude: 1e-2 to 1e30, distance [m]]
fn probe(given: Given) -> vec4<f32> {
    let clip = camera.clip_from_world * vec4(given.at, 1.0);
    return vec4(clip.z / clip.w, camera.near / (clip.z / clip.w), 0.0, 0.0);
}
