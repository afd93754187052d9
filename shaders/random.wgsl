// Random numbers: hashes for independent numbers, Halton's sequence for stratified ones. The seed of a pass is derived
// from the run's seed and the pass's name, so one seed gives one picture.

/// A permutation of 32 bits (PCG output hash, Jarzynski & Olano 2020).
fn hash(value: u32) -> u32 {
    let state = value * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

/// Returns a hash of two numbers, whose order matters.
fn hash2(a: u32, b: u32) -> u32 {
    return hash(a ^ hash(b + 0x9e3779b9u));
}

/// Returns a number in [0, 1) of the upper 24 bits: 1 is never reached.
fn unit_float(bits: u32) -> f32 {
    return f32(bits >> 8u) * (1.0 / 16777216.0);
}

/// The greatest number below 1.
const ALMOST_ONE: f32 = 0.99999994;

/// Upper 32 bits of the product: of random bits and a number, a random number below it.
fn multiply_high(a: u32, b: u32) -> u32 {
    let low = (a & 0xffffu) * (b & 0xffffu);
    let first = (a >> 16u) * (b & 0xffffu) + (low >> 16u);
    let second = (a & 0xffffu) * (b >> 16u) + (first & 0xffffu);
    return (a >> 16u) * (b >> 16u) + (first >> 16u) + (second >> 16u);
}

/// Element `index` of van der Corput's sequence of a prime base, in [0, 1) (Halton 1960). Digits are gathered in an
/// integer and divided once, so the error is that of three roundings; exact while base^digits < 2³².
fn radical_inverse(base: u32, index: u32) -> f32 {
    var rest = index;
    var reversed = 0u;
    var scale = 1u;
    let limit = 0xffffffffu / base;
    while rest > 0u && scale <= limit {
        reversed = reversed * base + rest % base;
        scale *= base;
        rest /= base;
    }
    return min(f32(reversed) / f32(scale), ALMOST_ONE);
}

/// The element of a sequence that item i of `count` takes in a sample of a picture, so that the items of all samples are one sequence:
/// their mean errs less than one of sequences that know nothing of each other. Items take turns, since elements whose places
/// differ by `count` are near each other.
fn element_of_sample(item: u32, count: u32, sample: u32) -> u32 {
    let turn = multiply_high(sample * 0x9e3779b9u, count);
    return sample * count + (item + turn) % count;
}

/// Element `index` of Halton's sequence in bases 2, 3, 5, shifted by the seed modulo 1; seed 0 gives the original.
fn halton3(index: u32, seed: u32) -> vec3<f32> {
    let plain = vec3(radical_inverse(2u, index), radical_inverse(3u, index), radical_inverse(5u, index));
    if seed == 0u {
        return plain;
    }
    let shift = vec3(unit_float(hash2(seed, 0u)), unit_float(hash2(seed, 1u)), unit_float(hash2(seed, 2u)));
    return min(fract(plain + shift), vec3(ALMOST_ONE));
}
