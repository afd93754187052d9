// The mean of all samples so far, with the share of them that saw something as alpha.

struct Settings {
    samples_size: vec2<u32>,
}

var<uniform> settings: Settings;
var samples_image: texture_2d<f32>;
var samples_direct: texture_2d<f32>;
var samples_indirect: texture_2d<f32>;
var samples_irradiance: texture_2d<f32>;
var image: texture_storage_2d<rgba32float, write>;
var direct: texture_storage_2d<rgba32float, write>;
var indirect: texture_storage_2d<rgba32float, write>;
var irradiance: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn mean(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= settings.samples_size) {
        return;
    }
    let reflected_once = textureLoad(samples_direct, id.xy, 0);
    let seen = reflected_once.a;
    textureStore(image, id.xy, vec4(textureLoad(samples_image, id.xy, 0).rgb, seen));
    textureStore(direct, id.xy, reflected_once);
    textureStore(indirect, id.xy, vec4(textureLoad(samples_indirect, id.xy, 0).rgb, seen));
    textureStore(irradiance, id.xy, textureLoad(samples_irradiance, id.xy, 0));
}
