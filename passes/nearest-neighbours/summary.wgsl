// Counts the points among which neighbours are searched, and finds the box around them.

#import "algorithms/reduce.wgsl"
#import "neighbourhood.wgsl"

alias Reduced = Summary;

struct Settings {
    among_count: u32,
}

var<uniform> settings: Settings;
var<storage, read> among: SurfacePoints;
/// [scratch]
var<storage, read_write> summary: Summary;

var<workgroup> shared_summaries: array<Summary, GROUP_SIZE>;

fn reduce_length() -> u32 {
    return min(among.header.count, settings.among_count);
}

fn reduce_element(i: u32) -> Summary {
    let point = among.points[i];
    if point.triangle == NO_TRIANGLE {
        return reduce_identity();
    }
    let position = point.position * units_per_metre();
    return Summary(position, 1u, position, 0u);
}

fn reduce_identity() -> Summary {
    return Summary(vec3(3.0e38), 0u, vec3(-3.0e38), 0u);
}

fn reduce_both(a: Summary, b: Summary) -> Summary {
    return Summary(min(a.low, b.low), a.count + b.count, max(a.high, b.high), 0u);
}

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

fn reduce_store(result: Summary) {
    summary = result;
}
