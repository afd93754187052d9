// Passes of the tests of the harness, an entry point each.

#import "frame.wgsl"

struct Settings {
    past_age: u32,
    past_reset: u32,
    step: u32,
}

struct State {
    sum: u32,
    age: u32,
    reset: u32,
    index: u32,
}

var<uniform> settings: Settings;
var<storage, read> past: State;
var<storage, read_write> state: State;

/// Counts on from the history buffer, and writes its facts.
@compute @workgroup_size(1)
fn count_on() {
    state = State(past.sum + settings.step, settings.past_age, settings.past_reset, frame.index);
}

var<storage, read_write> visits: array<atomic<u32>>;

/// Counts how often each place is visited by a thread whose built-ins agree.
@compute @workgroup_size(8, 4, 2)
fn visit(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) index: u32,
) {
    let of_group = all(id == group * vec3<u32>(8u, 4u, 2u) + local);
    if of_group && index == (local.z * 4u + local.y) * 8u + local.x {
        atomicAdd(&visits[(id.z * groups.y * 4u + id.y) * groups.x * 8u + id.x], 1u);
    }
}

struct Arrivals {
    count: atomic<u32>,
    threads: array<u32>,
}

var<storage, read_write> arrivals: Arrivals;

/// Notes the threads in the order in which they come.
@compute @workgroup_size(64)
fn arrive(@builtin(global_invocation_id) id: vec3<u32>) {
    arrivals.threads[atomicAdd(&arrivals.count, 1u)] = id.x;
}
