// Puts virtual lights on the surfaces that emit: their light is direct light. [ISM §5.1]

#output lights: VirtualLights(count: settings.count) // N lights; all are dark where nothing emits.
#lights

#option EMISSIVE false // whether any surface emits
#option MASKED false // whether triangles do not count where alpha is below their material's cutoff
#option TEXTURED false // whether any material of the scene has a texture

#import "algorithms/scaled.wgsl"
#import "color.wgsl"
#import "dispatch.wgsl"
#import "sobol.wgsl"
#import "virtual-lights.wgsl"
#if EMISSIVE
#import "emitters.wgsl"
#endif

struct Settings {
    /// Number N of virtual lights (ISM §5.1: 512). Shadows are softer with more; the time for shadows and gathering rises with N.
    /// [default: 512, min: 1, max: 2097152]
    count: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read_write> lights: VirtualLights;

#if EMISSIVE
fn interval_start(emitter: u32) -> u32 {
    return scene_emitters.emitters[emitter].for_photons;
}
#endif

/// The light of a place in the unit square, in fixed point: its first half is the one side of all emitters.
fn light_at(place: vec2<u32>) -> VirtualLight {
    var light: VirtualLight;
    light.normal = vec3(0.0, 0.0, 1.0);
#if EMISSIVE
    if !emitters_are_sampled() {
        return light;
    }
    let point = sample_emitter(vec2(place.x << 1u, place.y));
    // No light lies on what has no area now.
    if point.density == 0.0 {
        return light;
    }
    light.position = point.position;
    // Half of the density is on either side.
    light.area = weight_of(2.0 / point.density / f32(settings.count));
    light.normal = select(point.normal, -point.normal, place.x >= 0x80000000u);
    light.texel = point.triangle;
    light.flux = weights_of(point.radiance * (PI * light.area));
#endif
    return light;
}

@compute @workgroup_size(64)
fn emitter_lights(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.count {
        return;
    }
    if index == 0u {
        lights.count = settings.count;
    }
    lights.lights[index] = light_at(sobol2_bits_of(index, settings.seed));
}
