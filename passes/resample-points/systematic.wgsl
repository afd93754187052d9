// Systematic sampling without replacement: the probability π of a point is its weight over the threshold, at most 1, and
// points are taken where the sums of π, shifted by one random number, pass a whole number. [Madow 1949]
//
// DEVIATION(systematic): the paper draws points in parallel, and again where a draw finds one that is taken (claim.wgsl).
//
// Sums are whole numbers in units of 2^-32, modulo 1: exact in any order, and nothing but their fraction matters.

#import "algorithms/scan.wgsl"
#import "random.wgsl"
#import "surface-points.wgsl"
#import "weights.wgsl"

struct Settings {
    points_count: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
var<storage, read> weights: array<Scaled>;
var<storage, read> threshold: Scaled;
/// [points] Sum of the probabilities of all points before one, and with it.
var<storage, read_write> sums: array<vec2<u32>>;
/// Sum of all.
var<storage, read_write> total: u32;
var<storage, read_write> taken: array<u32>;

/// The probability of a point [2^-32]; 0 where that is 1.
fn fraction(weight: Scaled) -> u32 {
    if weight.value == 0.0 || is_certain(weight, threshold) {
        return 0u;
    }
    let unit = magnitude(threshold);
    return u32(min(in_units(weight, unit) / in_units(threshold, unit), 0.99999994) * 0x1p32f);
}

fn scan_length() -> u32 {
    return settings.points_count;
}

fn scan_element(i: u32) -> u32 {
    return fraction(weights[i]);
}

fn scan_store(i: u32, before: u32, sum: u32) {
    sums[i] = vec2(before, sum);
}

fn scan_total(sum: u32) {
    total = sum;
}

/// The random number by which sums are shifted [2^-32]. Rounding leaves the sum of all a little above or below a whole number:
/// of the shifts, those are left out that would take a point more or fewer for it.
fn shift() -> u32 {
    let beyond = bitcast<i32>(total);
    let random = hash2(settings.seed, points.header.iteration);
    return bitcast<u32>(max(-beyond, 0)) + multiply_high(random, 0xffffffffu - u32(abs(beyond)));
}

/// Takes a point or not.
@compute @workgroup_size(GROUP_SIZE)
fn take(row: Row) {
    let i = index_in(row, GROUP_SIZE);
    if i >= settings.points_count {
        return;
    }
    let weight = weights[i];
    let sum = sums[i] + shift();
    let passes = sum.y < sum.x;
    taken[i] = select(0u, 1u, weight.value > 0.0 && (passes || is_certain(weight, threshold)));
}
