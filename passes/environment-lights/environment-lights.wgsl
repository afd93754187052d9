// Puts virtual lights infinitely far for the light of the environment: their light is direct light. [ISM §5.1]

#output lights: VirtualLights(count: settings.count) // N lights; all are dark where no light arrives.

#import "algorithms/scaled.wgsl"
#import "dispatch.wgsl"
#import "environment-samples.wgsl"
#import "light-projection.wgsl"
#import "sobol.wgsl"

struct Settings {
    /// Number N of virtual lights (ISM §5.1: 1,024). Shadows are softer with more; the time for shadows and gathering rises with N.
    /// [default: 1024, min: 1, max: 2097152]
    count: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read_write> lights: VirtualLights;

@compute @workgroup_size(64)
fn environment_lights(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.count {
        return;
    }
    if index == 0u {
        lights.count = settings.count;
    }
    var light: VirtualLight;
    light.normal = vec3(0.0, 0.0, 1.0);
    light.kind = INFINITELY_FAR;
    if environment_is_sampled() {
        let sample = sample_environment(sobol2_bits_of(index, settings.seed));
        light.normal = -sample.direction;
        light.flux = weights_of(sample.radiance / (sample.density * f32(settings.count)));
    }
    light.position = 0.5 * (scene_info.bounds_min + scene_info.bounds_max) - far_reach() * light.normal;
    lights.lights[index] = light;
}
