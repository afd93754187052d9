// Prefix sums of weights, one workgroup a segment: `gpu_algorithms::segmented_scan` dispatches it.
//
// The shader that imports this file gives
//   fn segment_length() -> u32                          elements of each segment; from a uniform or the size of a texture
//   fn segment_weight(segment: vec3<u32>, i: u32) -> Scaled   element i; called twice
//   fn segment_store(segment: vec3<u32>, i: u32, sum: f32)    takes the sum of elements 0 to i
//   fn segment_total(segment: vec3<u32>, sum: Scaled)         takes the sum of all; called once, by one thread
//
// A segment is summed in units of a power of two near its greatest weight, so neither weights of 1e30 nor of 1e-30 leave
// the range of f32. Sums never fall, and a weight of zero leaves them as they are.

#import "algorithms/carried-sum.wgsl"
#import "algorithms/scaled.wgsl"

@compute @workgroup_size(GROUP_SIZE)
fn scan_segments(@builtin(workgroup_id) segment: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let length = segment_length();
    var greatest = NO_MAGNITUDE;
    for (var i = thread; i < length; i += GROUP_SIZE) {
        greatest = max(greatest, magnitude(segment_weight(segment, i)));
    }
    let exponent = i32(workgroup_max(thread, f32(greatest)));

    var before: CarriedSum;
    for (var first = 0u; first < length; first += GROUP_SIZE) {
        let i = first + thread;
        var value = 0.0;
        if i < length {
            value = in_units(segment_weight(segment, i), exponent);
        }
        let sums = prefix_sum(thread, value);
        if i < length {
            segment_store(segment, i, carried_sum(before, sums.x));
        }
        before = with_number(before, sums.y);
    }
    if thread == 0u {
        segment_total(segment, Scaled(carried_sum(before, 0.0), exponent));
    }
}
