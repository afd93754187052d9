// Composes the picture: direct, indirect and glossy light and emission, linear and for a screen. [tone mapping: Reinhard et
// al. 2002, Eq. 3-4; Hable 2010; Narkowicz 2015]

#input view: GBuffer // The surfaces: albedo, and emission where it has it.
#input direct: Radiance optional like view // Direct light.
#input indirect: Irradiance optional like view // Indirect irradiance, reflected here by the albedo.
#input glossy: Radiance optional like view // Indirect light that surfaces reflect specularly.
#output image: Radiance // All light.
#output indirect_radiance: Radiance // Neither direct nor emitted: albedo/π × irradiance + glossy.
#output display: Display // All light, for a screen.

#option DIRECT false // whether `direct` is linked
#option INDIRECT false // whether `indirect` is linked
#option GLOSSY false // whether `glossy` is linked
#option VIEW_EMISSION false // whether the G-buffer has the member `emission`
#option INDIRECT_RADIANCE true // whether `indirect_radiance` is read

#import "color.wgsl"

struct Settings {
    view_size: vec2<u32>,
}

var<uniform> settings: Settings;
var view_depth: texture_2d<f32>;
var view_albedo: texture_2d<f32>;
#if VIEW_EMISSION
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
#if VIEW_EMISSION
    total += textureLoad(view_emission, id.xy, 0).rgb;
#endif
    textureStore(image, id.xy, vec4(total, seen));
}
