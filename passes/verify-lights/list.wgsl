// Lists the lights that no point in view has reached so far, in one workgroup.

#import "algorithms/workgroup.wgsl"
#import "verify.wgsl"

struct Settings {
    lights_count: u32,
    /// Workgroups that cast rays in a round.
    workgroups: u32,
}

var<uniform> settings: Settings;
var<storage, read> claims: array<u32>;
var<storage, read_write> unseen: array<u32>;
var<storage, read_write> round: Round;

@compute @workgroup_size(GROUP_SIZE)
fn list(@builtin(local_invocation_index) thread: u32) {
    var before = 0u;
    for (var block = 0u; block < settings.lights_count; block += GROUP_SIZE) {
        let index = block + thread;
        let is_unseen = index < settings.lights_count && claims[index] == UNSEEN;
        let ranks = prefix_sum_u32(thread, select(0u, 1u, is_unseen));
        if is_unseen {
            unseen[before + ranks.x - 1u] = index;
        }
        before += ranks.y;
    }
    if thread == 0u {
        // Nothing runs where all lights are accounted for.
        round = Round(select(0u, settings.workgroups, before > 0u), 1u, 1u, before);
    }
}
