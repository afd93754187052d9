// Counts points and finds the box around them, by algorithms/reduce.wgsl: all that it asks for but the elements and what takes the
// result.

#import "algorithms/reduce.wgsl"
#import "algorithms/summary.wgsl"

alias Reduced = Summary;

var<workgroup> shared_summaries: array<Summary, GROUP_SIZE>;

/// Returns the summary of no points.
fn reduce_identity() -> Summary {
    return Summary(vec3(3.0e38), 0u, vec3(-3.0e38), 0u);
}

/// Returns the summary of the points of both.
fn reduce_both(a: Summary, b: Summary) -> Summary {
    return Summary(min(a.low, b.low), a.count + b.count, max(a.high, b.high), 0u);
}

/// Returns the summary of what the threads of a workgroup bring; all of them call it.
fn reduce_workgroup(thread: u32, own: Summary) -> Summary {
    shared_summaries[thread] = own;
    workgroupBarrier();
    for (var width = GROUP_SIZE / 2u; width > 0u; width /= 2u) {
        if thread < width {
            shared_summaries[thread] = reduce_both(shared_summaries[thread], shared_summaries[thread + width]);
        }
        workgroupBarrier();
    }
    let all = shared_summaries[0];
    workgroupBarrier();
    return all;
}
