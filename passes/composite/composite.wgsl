// Composes the picture: direct, indirect and glossy light and emission, linear and for a screen. [tone mapping: Reinhard et
// al. 2002, Eq. 3-4; Hable 2010; Narkowicz 2015]

#input view: GBuffer // The surfaces at each sample: albedo, and emission where it has it.
#input direct: Radiance optional like view // Direct light.
#input indirect: Irradiance optional like view // Indirect irradiance, reflected here by the albedo.
#input glossy: Radiance optional like view // Indirect light that surfaces reflect specularly.
#output image: Radiance(size: like(view) / view.supersampling) // All light.
#output direct_radiance: Radiance(size: like(view) / view.supersampling) // Direct light.
#output indirect_radiance: Radiance(size: like(view) / view.supersampling) // Neither direct nor emitted: albedo/π × irradiance + glossy.
#output display: Display(size: like(view) / view.supersampling) // All light, for a screen.

#option DIRECT false // whether `direct` is linked
#option INDIRECT false // whether `indirect` is linked
#option GLOSSY false // whether `glossy` is linked
#option VIEW_EMISSION false // whether the G-buffer has the member `emission`
#option DIRECT_RADIANCE true // whether `direct_radiance` is read
#option INDIRECT_RADIANCE true // whether `indirect_radiance` is read

#import "color.wgsl"

struct Settings {
    image_size: vec2<u32>,
    view_supersampling: u32,
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
#if DIRECT_RADIANCE
var direct_radiance: texture_storage_2d<rgba32float, write>;
#endif
#if INDIRECT_RADIANCE
var indirect_radiance: texture_storage_2d<rgba32float, write>;
#endif

/// The light of a sample, or the sum over several.
struct SampleLight {
    /// 1 where it sees a surface.
    seen: f32,
    direct: vec3<f32>,
    indirect: vec3<f32>,
    emitted: vec3<f32>,
}

@compute @workgroup_size(8, 8)
fn composite(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= settings.image_size) {
        return;
    }
    let side = settings.view_supersampling;
    var light: SampleLight;
    for (var i = 0u; i < side * side; i++) {
        let sample = light_at(id.xy * side + vec2(i % side, i / side));
        light.seen += sample.seen;
        light.direct += sample.direct;
        light.indirect += sample.indirect;
        light.emitted += sample.emitted;
    }
    let share = 1.0 / f32(side * side);
    let seen = light.seen * share;
    textureStore(image, id.xy, vec4((light.direct + light.indirect + light.emitted) * share, seen));
#if DIRECT_RADIANCE
    textureStore(direct_radiance, id.xy, vec4(light.direct * share, seen));
#endif
#if INDIRECT_RADIANCE
    textureStore(indirect_radiance, id.xy, vec4(light.indirect * share, seen));
#endif
}

fn light_at(sample: vec2<u32>) -> SampleLight {
    var light: SampleLight;
    light.seen = select(0.0, 1.0, textureLoad(view_depth, sample, 0).x > 0.0);
#if INDIRECT
    light.indirect += textureLoad(view_albedo, sample, 0).rgb / PI * textureLoad(indirect, sample, 0).rgb;
#endif
#if GLOSSY
    light.indirect += textureLoad(glossy, sample, 0).rgb;
#endif
#if DIRECT
    light.direct = textureLoad(direct, sample, 0).rgb;
#endif
#if VIEW_EMISSION
    light.emitted = textureLoad(view_emission, sample, 0).rgb;
#endif
    return light;
}
