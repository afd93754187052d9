// Cumulative sums of TCAS §4.2, one workgroup a segment: first along the rows of all importance maps, then
// along the last column of each map, then over the maps.
//
// A segment is summed in units of a power of two near its greatest part, so neither weights of 1e30 nor of
// 1e-30 leave the range of f32; its total goes to the next stage with that exponent.

/// Segments are the rows of the importance map; else runs of `parts`.
#option ROWS false

#import "prefix-sum.wgsl"

#if ROWS
var importance: texture_2d_array<f32>;
var row_cdf: texture_storage_2d_array<r32float, write>;

fn segment_length() -> u32 {
    return textureDimensions(importance).x;
}

fn segment(group: vec3<u32>) -> u32 {
    return group.z * textureDimensions(importance).y + group.y;
}

fn part(group: vec3<u32>, i: u32) -> Scaled {
    return Scaled(weight_of(textureLoad(importance, vec2(i, group.y), group.z, 0).r), 0);
}

fn store(group: vec3<u32>, i: u32, sum: f32) {
    textureStore(row_cdf, vec2(i, group.y), group.z, vec4(sum));
}
#else
struct Settings {
    segment_length: u32,
}

var<uniform> settings: Settings;
var<storage, read> parts: array<Scaled>;
var<storage, read_write> cdf: array<f32>;

fn segment_length() -> u32 {
    return settings.segment_length;
}

fn segment(group: vec3<u32>) -> u32 {
    return group.y;
}

fn part(group: vec3<u32>, i: u32) -> Scaled {
    return parts[group.y * settings.segment_length + i];
}

fn store(group: vec3<u32>, i: u32, sum: f32) {
    cdf[group.y * settings.segment_length + i] = sum;
}
#endif

/// [segments] Sum of each segment.
var<storage, read_write> totals: array<Scaled>;

@compute @workgroup_size(256)
fn cumulate(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let length = segment_length();
    var greatest = NO_MAGNITUDE;
    for (var i = thread; i < length; i += SCAN_SIZE) {
        greatest = max(greatest, magnitude(part(group, i)));
    }
    let exponent = i32(workgroup_max(thread, f32(greatest)));

    var before = 0.0;
    for (var first = 0u; first < length; first += SCAN_SIZE) {
        let i = first + thread;
        var value = 0.0;
        if i < length {
            value = in_units(part(group, i), exponent);
        }
        let sums = prefix_sum(thread, value);
        if i < length {
            store(group, i, before + sums.x);
        }
        before += sums.y;
    }
    if thread == 0u {
        totals[segment(group)] = Scaled(before, exponent);
    }
}
