// A random subset of what the camera sees, over which TCAS Eq. 1 estimates the importance of a virtual light.
// It is the same pixels in every frame, stratified.

#import "camera.wgsl"
#import "color.wgsl"
#import "dispatch.wgsl"
#import "random.wgsl"
#import "scene.wgsl"
#import "view-sample.wgsl"

struct Settings {
    view_samples: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var view_depth: texture_2d<f32>;
var view_normal: texture_2d<f32>;
var view_albedo: texture_2d<f32>;
var<storage, read_write> samples: array<ViewSample>;

@compute @workgroup_size(64)
fn pick(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = row_index(group, groups, local, 64u);
    if index >= settings.view_samples {
        return;
    }
    let size = textureDimensions(view_depth);
    let pixel = min(vec2<u32>(halton3(index + 1u, settings.seed).xy * vec2<f32>(size)), size - 1u);
    let depth = textureLoad(view_depth, pixel, 0).r;
    var picked = ViewSample();
    if depth > 0.0 {
        picked.position = to_extents(camera.position + pixel_ray(vec2<f32>(pixel), size) * depth);
        picked.normal = textureLoad(view_normal, pixel, 0).xyz;
        // DEVIATION(diffuse): the BRDF without its glossy part.
        let albedo = textureLoad(view_albedo, pixel, 0).rgb;
        picked.response = LUMINANCE * albedo / PI;
    }
    samples[index] = picked;
}
