// Counts the lights that are not dark, and finds the box around those on surfaces.

#import "algorithms/reduce.wgsl"
#import "lit-lights.wgsl"

alias Reduced = Summary;

struct Settings {
    lights_count: u32,
}

var<uniform> settings: Settings;
var<storage, read> lights: VirtualLights;
/// [scratch]
var<storage, read_write> summary: Summary;

var<workgroup> shared_summaries: array<Summary, GROUP_SIZE>;

fn reduce_length() -> u32 {
    return min(lights.count, settings.lights_count);
}

fn reduce_element(i: u32) -> Summary {
    let light = lights.lights[i];
    var own = reduce_identity();
    if is_lit(light) {
        own.count = 1u;
        if light.kind != INFINITELY_FAR {
            own.low = light.position;
            own.high = light.position;
        }
    }
    return own;
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
