// Microfacet reflection of a light to the camera, for probes.

#import "ggx.wgsl"

struct Given {
    normal: vec3<f32>,
    to_light: vec3<f32>,
    to_camera: vec3<f32>,
    roughness: f32,
}

/// Returns the reflection by three values of the reflectance.
fn reflection(given: Given) -> vec4<f32> {
    return vec4(ggx(given.normal, given.to_light, given.to_camera, vec3(0.04, 0.5, 1.0), given.roughness), 0.0);
}
