// The mean of all samples so far.

#import "progress.wgsl"

struct Settings {
    samples_size: vec2<u32>,
}

var<uniform> settings: Settings;
var samples_image: texture_2d<f32>;
var samples_direct: texture_2d<f32>;
var samples_indirect: texture_2d<f32>;
var samples_irradiance: texture_2d<f32>;
var<storage, read> samples_progress: Progress;
var image: texture_storage_2d<rgba32float, write>;
var direct: texture_storage_2d<rgba32float, write>;
var indirect: texture_storage_2d<rgba32float, write>;
var irradiance: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn mean(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= settings.samples_size) {
        return;
    }
    let part = 1.0 / f32(max(samples_progress.step, 1u));
    let reflected_once = textureLoad(samples_direct, id.xy, 0) * part;
    let seen = reflected_once.a;
    textureStore(image, id.xy, vec4(textureLoad(samples_image, id.xy, 0).rgb * part, seen));
    textureStore(direct, id.xy, vec4(reflected_once.rgb, seen));
    textureStore(indirect, id.xy, vec4(textureLoad(samples_indirect, id.xy, 0).rgb * part, seen));
    textureStore(irradiance, id.xy, textureLoad(samples_irradiance, id.xy, 0) * part);
}
