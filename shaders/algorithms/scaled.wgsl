// Numbers with an exponent of their own, so that no sum of them leaves the range of f32.

#import "algorithms/workgroup.wgsl"

/// value · 2^exponent: for sums of numbers of which f32 holds each but not all together.
struct Scaled {
    /// Zero, or in [1, 2^24).
    value: f32,
    exponent: i32,
}

/// Magnitude of zero: below that of any number.
const NO_MAGNITUDE: i32 = -1000000;

/// Returns what can be summed as a weight: NaN and what is negative count as 0, infinity as the greatest number.
fn weight_of(x: f32) -> f32 {
    let bits = bitcast<u32>(x);
    if bits > 0x7f800000u { // negative, or NaN of either sign
        return 0.0;
    }
    return bitcast<f32>(min(bits, 0x7f7fffffu));
}

/// The same for each channel.
fn weights_of(color: vec3<f32>) -> vec3<f32> {
    return vec3(weight_of(color.r), weight_of(color.g), weight_of(color.b));
}

/// Returns a weight with its own exponent. A compiler may turn a s + b s into (a + b) s, which leaves the range of f32 where a
/// and b are in the same unit: of two numbers from here it cannot know that they are. What is denormal counts as 0, as it does
/// on GPUs that have no such numbers.
fn scaled_weight(x: f32) -> Scaled {
    let bits = bitcast<u32>(weight_of(x));
    if bits < 0x800000u {
        return Scaled(0.0, 0);
    }
    return Scaled(bitcast<f32>((bits & 0x7fffffu) | 0x3f800000u), i32(bits >> 23u) - 127);
}

/// Returns x · 2^exponent for x ≥ 0, exact unless the result is denormal. Two factors, since 2^-127 is denormal itself.
fn times_power_of_two(x: f32, exponent: i32) -> f32 {
    let all = clamp(exponent, -252, 252);
    let part = all / 2;
    return x * bitcast<f32>(u32(part + 127) << 23u) * bitcast<f32>(u32(all - part + 127) << 23u);
}

/// Returns e with 2^e ≤ x < 2^(e+1) for a weight x; -127 for what is denormal.
fn magnitude(x: Scaled) -> i32 {
    if x.value == 0.0 {
        return NO_MAGNITUDE;
    }
    return i32(bitcast<u32>(x.value) >> 23u) - 127 + x.exponent;
}

/// Returns the value of x in units of 2^exponent.
fn in_units(x: Scaled, exponent: i32) -> f32 {
    return times_power_of_two(x.value, x.exponent - exponent);
}

/// Returns the sum of two numbers, with the greater of their exponents.
fn add_scaled(a: Scaled, b: Scaled) -> Scaled {
    let exponent = max(magnitude(a), magnitude(b));
    return Scaled(in_units(a, exponent) + in_units(b, exponent), exponent);
}

/// Returns the sum of the workgroup.
fn workgroup_sum(thread: u32, value: Scaled) -> Scaled {
    let exponent = i32(workgroup_max(thread, f32(magnitude(value))));
    return Scaled(prefix_sum(thread, in_units(value, exponent)).y, exponent);
}
