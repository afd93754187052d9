// Makes one set of two sets of virtual lights, of two bounces or two kinds of source. [ISM §4.1]
//
// They alternate in proportion to their numbers, so any run of them, such as `gather` gives to a pixel, has its share of both.

#input first: VirtualLights // Lights of the one set, in their order.
#input second: VirtualLights // Lights of the other.
#output lights: VirtualLights(count: first.count + second.count) // All of them, each as it is; with lobes, where any has one.

#option FIRST_LOBES false // whether the first lights have the member `lobes`
#option SECOND_LOBES false // whether the second lights have the member `lobes`

#import "dispatch.wgsl"
#import "virtual-lights.wgsl"
#if FIRST_LOBES || SECOND_LOBES
#import "virtual-lobe.wgsl"
#endif

struct Settings {
    first_count: u32,
    second_count: u32,
}

var<uniform> settings: Settings;
var<storage, read> first: VirtualLights;
var<storage, read> second: VirtualLights;
var<storage, read_write> lights: VirtualLights;
#if FIRST_LOBES || SECOND_LOBES
var<storage, read_write> lights_lobes: array<VirtualLobe>;
#endif
#if FIRST_LOBES
var<storage, read> first_lobes: array<VirtualLobe>;
#endif
#if SECOND_LOBES
var<storage, read> second_lobes: array<VirtualLobe>;
#endif

/// i · part / whole, rounded down, for part ≤ whole < 2^30. The product may have more than 32 bits.
fn scaled_down(i: u32, part: u32, whole: u32) -> u32 {
    var quotient = 0u;
    var rest = 0u;
    for (var bit = 32u; bit > 0u; bit--) {
        rest = 2u * rest + extractBits(i, bit - 1u, 1u) * part;
        quotient = 2u * quotient + rest / whole;
        rest %= whole;
    }
    return quotient;
}

/// One thread per light. [threads: first.count + second.count]
@compute @workgroup_size(64)
fn join(row: Row) {
    let index = index_in(row, 64u);
    let of_second = min(second.count, settings.second_count);
    let all = min(first.count, settings.first_count) + of_second;
    if index == 0u {
        lights.count = all;
    }
    if index >= all {
        return;
    }
    let before = scaled_down(index, of_second, all);
#if FIRST_LOBES || SECOND_LOBES
    lights_lobes[index] = no_lobe();
#endif
    if scaled_down(index + 1u, of_second, all) > before {
        lights.lights[index] = second.lights[before];
#if SECOND_LOBES
        lights_lobes[index] = second_lobes[before];
#endif
    } else {
        lights.lights[index] = first.lights[index - before];
#if FIRST_LOBES
        lights_lobes[index] = first_lobes[index - before];
#endif
    }
}
