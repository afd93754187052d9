// Sums over a workgroup of 256 threads, and numbers with an exponent of their own, so that no sum overflows.
//
// Every thread of the workgroup must call these functions, in uniform control flow.

const SCAN_SIZE: u32 = 256u;

/// value · 2^exponent: for sums of numbers of which f32 holds each but not all together.
struct Scaled {
    /// Zero, or in [1, 2^24).
    value: f32,
    exponent: i32,
}

/// Magnitude of zero: below that of any number.
const NO_MAGNITUDE: i32 = -1000000;

var<workgroup> scan_values: array<f32, SCAN_SIZE>;
var<workgroup> scan_whole_values: array<u32, SCAN_SIZE>;

/// What can be summed as a weight: NaN and what is negative count as 0, infinity as the greatest number.
fn weight_of(x: f32) -> f32 {
    let bits = bitcast<u32>(x);
    if bits > 0x7f800000u { // negative, or NaN of either sign
        return 0.0;
    }
    return bitcast<f32>(min(bits, 0x7f7fffffu));
}

/// x · 2^exponent for x ≥ 0, exact unless the result is denormal. Two factors, since 2^-127 is denormal itself.
fn times_power_of_two(x: f32, exponent: i32) -> f32 {
    let all = clamp(exponent, -252, 252);
    let part = all / 2;
    return x * bitcast<f32>(u32(part + 127) << 23u) * bitcast<f32>(u32(all - part + 127) << 23u);
}

/// e with 2^e ≤ x < 2^(e+1) for a weight x; -127 for what is denormal.
fn magnitude(x: Scaled) -> i32 {
    if x.value == 0.0 {
        return NO_MAGNITUDE;
    }
    return i32(bitcast<u32>(x.value) >> 23u) - 127 + x.exponent;
}

/// The value of x in units of 2^exponent.
fn in_units(x: Scaled, exponent: i32) -> f32 {
    return times_power_of_two(x.value, x.exponent - exponent);
}

fn add_scaled(a: Scaled, b: Scaled) -> Scaled {
    let exponent = max(magnitude(a), magnitude(b));
    return Scaled(in_units(a, exponent) + in_units(b, exponent), exponent);
}

/// Inclusive prefix sum in x, and the sum of the whole workgroup in y, of values ≥ 0.
///
/// Sklansky's scheme (1960): the upper half of each block adds the last sum of its lower half. For numbers that
/// are not negative the sums are monotone in spite of rounding, since adding the same number to two others
/// keeps their order, and a value of zero gives exactly the sum before it. A cumulative distribution so made
/// never has an interval of negative width, nor one of positive width for a weight of zero. (Hillis and Steele's
/// scheme sums neighbours in different orders and has neither property.)
fn prefix_sum(thread: u32, value: f32) -> vec2<f32> {
    scan_values[thread] = value;
    workgroupBarrier();
    for (var width = 1u; width < SCAN_SIZE; width *= 2u) {
        if (thread & width) != 0u {
            scan_values[thread] += scan_values[(thread & ~(width - 1u)) - 1u];
        }
        workgroupBarrier();
    }
    let sums = vec2(scan_values[thread], scan_values[SCAN_SIZE - 1u]);
    workgroupBarrier();
    return sums;
}

/// The same of whole numbers, modulo 2³².
fn prefix_sum_u32(thread: u32, value: u32) -> vec2<u32> {
    scan_whole_values[thread] = value;
    workgroupBarrier();
    for (var width = 1u; width < SCAN_SIZE; width *= 2u) {
        if (thread & width) != 0u {
            scan_whole_values[thread] += scan_whole_values[(thread & ~(width - 1u)) - 1u];
        }
        workgroupBarrier();
    }
    let sums = vec2(scan_whole_values[thread], scan_whole_values[SCAN_SIZE - 1u]);
    workgroupBarrier();
    return sums;
}

/// The greatest value of the workgroup.
fn workgroup_max(thread: u32, value: f32) -> f32 {
    scan_values[thread] = value;
    workgroupBarrier();
    for (var width = SCAN_SIZE / 2u; width > 0u; width /= 2u) {
        if thread < width {
            scan_values[thread] = max(scan_values[thread], scan_values[thread + width]);
        }
        workgroupBarrier();
    }
    let greatest = scan_values[0];
    workgroupBarrier();
    return greatest;
}

/// The sum of the workgroup.
fn workgroup_sum(thread: u32, value: Scaled) -> Scaled {
    let exponent = i32(workgroup_max(thread, f32(magnitude(value))));
    return Scaled(prefix_sum(thread, in_units(value, exponent)).y, exponent);
}
