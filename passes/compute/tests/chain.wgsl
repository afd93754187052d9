// Entry points hand results to each other: sums of groups in a buffer of their own, and a picture that another reads.

#import "dispatch.wgsl"

#option SQUARED false // whether the mean is squared

struct Settings {
    /// How often 1 is added to the sum. [default: 3, max: 100]
    rounds: u32,
    round: u32,
    numbers_count: u32,
}

var<uniform> settings: Settings;
var<storage, read> numbers: array<f32>;
/// The sum of a group of 64, then of all. [scratch]
var<storage, read_write> sums: array<f32, 16>;
/// The mean in every texel. [scratch]
var mean: texture_storage_2d<rgba16float, write>;
/// [reads: mean]
var mean_before: texture_2d<f32>;
var picture: texture_storage_2d<rgba32float, write>;

var<workgroup> part: array<f32, 64>;

/// One thread per number. [threads: elements(numbers)]
@compute @workgroup_size(64)
fn add(row: Row) {
    let local = row.local;
    let i = index_in(row, 64u);
    var number = 0.0;
    if i < settings.numbers_count {
        number = numbers[i];
    }
    part[local] = number;
    workgroupBarrier();
    if local == 0u {
        var sum = 0.0;
        for (var k = 0u; k < 64u; k++) {
            sum += part[k];
        }
        sums[i / 64u] = sum;
    }
}

/// [threads: 1]
@compute @workgroup_size(1)
fn add_groups() {
    for (var k = 1u; k < 16u; k++) {
        sums[0] += sums[k];
    }
}

/// Adds 0, 1, 2 … [threads: (1, 1, 1), repeat: rounds]
@compute @workgroup_size(1)
fn count() {
    sums[0] += f32(settings.round);
}

@compute @workgroup_size(8, 8)
fn spread(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(mean)) {
        return;
    }
    textureStore(mean, id.xy, vec4(sums[0] / f32(settings.numbers_count)));
}

@compute @workgroup_size(8, 8)
fn show(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(picture)) {
        return;
    }
    var value = textureLoad(mean_before, id.xy / 2u, 0).x;
    if SQUARED {
        value *= value;
    }
    textureStore(picture, id.xy, vec4(value, vec2<f32>(id.xy), 1.0));
}
