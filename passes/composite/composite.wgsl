// All light that a pixel receives: direct light, indirect light times the surface's reflectance, glossy light, and
// emission.

#option DIRECT false // whether `direct` is connected
#option INDIRECT false // whether `indirect` is connected
#option GLOSSY false // whether `glossy` is connected
#option EMISSION false // whether the G-buffer has the member `emission`
#option INDIRECT_RADIANCE true // whether `indirect_radiance` is read

#import "color.wgsl"

struct Settings {
    view_size: vec2<u32>,
}

var<uniform> settings: Settings;
var view_depth: texture_2d<f32>;
var view_albedo: texture_2d<f32>;
#if EMISSION
var view_emission: texture_2d<f32>;
#endif
#if DIRECT
var direct: texture_2d<f32>;
#endif
#if INDIRECT
var indirect: texture_2d<f32>;
#endif
#if GLOSSY
var glossy: texture_2d<f32>;
#endif
var image: texture_storage_2d<rgba32float, write>;
#if INDIRECT_RADIANCE
var indirect_radiance: texture_storage_2d<rgba32float, write>;
#endif

@compute @workgroup_size(8, 8)
fn composite(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= settings.view_size) {
        return;
    }
    let seen = select(0.0, 1.0, textureLoad(view_depth, id.xy, 0).x > 0.0);
    var reflected = vec3(0.0);
#if INDIRECT
    reflected += textureLoad(view_albedo, id.xy, 0).rgb / PI * textureLoad(indirect, id.xy, 0).rgb;
#endif
#if GLOSSY
    reflected += textureLoad(glossy, id.xy, 0).rgb;
#endif
#if INDIRECT_RADIANCE
    textureStore(indirect_radiance, id.xy, vec4(reflected, seen));
#endif
    var total = reflected;
#if DIRECT
    total += textureLoad(direct, id.xy, 0).rgb;
#endif
#if EMISSION
    total += textureLoad(view_emission, id.xy, 0).rgb;
#endif
    textureStore(image, id.xy, vec4(total, seen));
}
