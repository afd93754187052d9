// The sum of f over the proposals of all chains, for the weights `none`: these are the first N M elements of the
// sequence, whichever chain has which. A sum over proposals, not over the map.

#import "proposal.wgsl"

struct Settings {
    count: u32,
    steps: u32,
    seed: u32,
    parts: u32,
}

var<uniform> settings: Settings;
/// [parts]
var<storage, read> parts: array<Scaled>;
/// [parts] from proposals, one from those.
var<storage, read_write> sums: array<Scaled>;

@compute @workgroup_size(256)
fn add_proposals(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    var own = Scaled(0.0, 0);
    for (var i = group.x * SCAN_SIZE + thread; i < settings.count * settings.steps; i += groups.x * SCAN_SIZE) {
        own = add_scaled(own, Scaled(proposal(i + 1u, settings.seed).importance, 0));
    }
    let sum = workgroup_sum(thread, own);
    if thread == 0u {
        sums[group.x] = sum;
    }
}

@compute @workgroup_size(256)
fn add_parts(@builtin(local_invocation_index) thread: u32) {
    var own = Scaled(0.0, 0);
    for (var i = thread; i < settings.parts; i += SCAN_SIZE) {
        own = add_scaled(own, parts[i]);
    }
    let sum = workgroup_sum(thread, own);
    if thread == 0u {
        sums[0] = sum;
    }
}
