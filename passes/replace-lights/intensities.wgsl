// Intensities of lights and candidates, radiosity over density, as whole numbers of the same order. [SMC-IR Eq. 6]

#import "algorithms/scaled.wgsl"
#import "color.wgsl"
#import "dispatch.wgsl"
#import "keys.wgsl"
#import "point-radiosity.wgsl"
#import "surface-points.wgsl"
#import "virtual-lights.wgsl"

struct Settings {
    candidates_count: u32,
}

var<uniform> settings: Settings;
var<storage, read> lights: SurfacePoints;
var<storage, read> intensities: VirtualLights;
/// By slot: bits of the intensity, and VALID; NO_KEY where there is no light.
var<storage, read_write> light_keys: array<u32>;
var<storage, read> candidates: SurfacePoints;
var<storage, read> radiosity: PointRadiosities;
var<storage, read> density: array<f32>;
/// Bits of the intensity of each candidate; NO_KEY where there is none.
var<storage, read_write> candidate_keys: array<u32>;

/// The key of the light in a slot.
fn light_key(slot: u32) -> u32 {
    // There may have been another number of lights, or none.
    if slot >= min(lights.header.count, intensities.count) {
        return NO_KEY;
    }
    let point = lights.points[slot];
    if point.triangle == NO_TRIANGLE {
        return NO_KEY;
    }
    // A flux is radiosity over density, shared out over all lights.
    let intensity = weight_of(luminance(intensities.lights[slot].flux) * f32(settings.candidates_count));
    return bitcast<u32>(intensity) | select(0u, VALID, point.mark == 0u);
}

@compute @workgroup_size(64)
fn rank(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = row_index(group, groups, local, 64u);
    if index >= settings.candidates_count {
        return;
    }
    light_keys[index] = light_key(index);
    var key = NO_KEY;
    if candidates.points[index].triangle != NO_TRIANGLE && density[index] > 0.0 {
        key = bitcast<u32>(weight_of(luminance(radiosity.radiosities[index].radiosity) / density[index]));
    }
    candidate_keys[index] = key;
}
