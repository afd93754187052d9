// The light of the environment where no surface is seen.

#import "camera.wgsl"
#import "environment.wgsl"
#import "fullscreen.wgsl"

struct Settings {
    view_size: vec2<u32>,
}

var<uniform> settings: Settings;
var view_depth: texture_2d<f32>;

@fragment
fn view_sky(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    if textureLoad(view_depth, vec2<u32>(at.xy), 0).x > 0.0 {
        discard;
    }
    return vec4(environment_radiance(pixel_ray(at.xy - 0.5, settings.view_size)), 1.0);
}
