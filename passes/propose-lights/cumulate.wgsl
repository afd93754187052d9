// Sums the luminance of the flux of virtual lights one after the other, for a choice in proportion to it: one workgroup.

#import "algorithms/segmented-scan.wgsl"
#import "color.wgsl"
#import "virtual-lights.wgsl"

var<storage, read> lights: VirtualLights;
/// Sum of the lights up to each, in units of its own.
var<storage, read_write> power_sums: array<f32>;

fn segment_length() -> u32 {
    return arrayLength(&power_sums);
}

fn segment_weight(segment: vec3<u32>, i: u32) -> Scaled {
    if i >= min(lights.count, arrayLength(&lights.lights)) {
        return Scaled(0.0, 0);
    }
    return scaled_weight(luminance(lights.lights[i].flux));
}

fn segment_store(segment: vec3<u32>, i: u32, sum: f32) {
    power_sums[i] = sum;
}

fn segment_total(segment: vec3<u32>, sum: Scaled) {}
