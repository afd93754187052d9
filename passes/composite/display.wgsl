// The picture for a screen.

#import "tonemap.wgsl"

struct Settings {
    // DEVIATION(exposure): a setting, where Reinhard et al. derive it from the picture's mean.
    /// Brightness of `display`: each step doubles it. [default: 0.0, min: -40.0, max: 40.0, unit: "EV"]
    exposure: f32,
    // DEVIATION(white): one default for both curves that take it.
    /// The least exposed luminance that `display` shows as white, with `reinhard` and `filmic`. Larger: bright parts
    /// keep more detail, but the picture loses contrast. [default: 4.0, min: 0.01, max: 1000000.0, unit: "W/(m² sr)"]
    white: f32,
}

var<uniform> settings: Settings;
/// `image`, as composite.wgsl left it.
var radiance: texture_2d<f32>;
var display: texture_storage_2d<rgba8unorm, write>;

@compute @workgroup_size(8, 8)
fn show(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(radiance)) {
        return;
    }
    let seen = textureLoad(radiance, id.xy, 0).rgb;
    textureStore(display, id.xy, vec4(displayed(seen, settings.exposure, settings.white), 1.0));
}
