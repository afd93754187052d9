// Multiplies radiance by a gain.

#input radiance: Radiance // What is multiplied.
#output image: Radiance // The product, as large as `radiance`; alpha is kept.

struct Settings {
    image_size: vec2<u32>,
    /// What the radiance is multiplied by. [default: 1.0, min: 0.0, max: 1000000.0]
    gain: f32,
}

var<uniform> settings: Settings;
var radiance: texture_2d<f32>;
var image: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn scale(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= settings.image_size) {
        return;
    }
    let texel = textureLoad(radiance, id.xy, 0);
    textureStore(image, id.xy, vec4(settings.gain * texel.rgb, texel.a));
}
