// Puts the chosen candidates in place of the lights that give way. [SMC-IR Alg. 1, lines 13-16]

#import "dispatch.wgsl"
#import "keys.wgsl"
#import "progress.wgsl"
#import "surface-points.wgsl"

struct Settings {
    candidates_count: u32,
    warm_up: u32,
}

var<uniform> settings: Settings;
var<storage, read> lights: SurfacePoints;
var<storage, read> mailboxes: SurfacePoints;
var<storage, read> candidates: SurfacePoints;
var<storage, read> origins: SurfacePoints;
var<storage, read> newcomers: array<u32>;
var<storage, read> chosen: array<u32>;
var<storage, read> decision: Decision;
var<storage, read_write> replaced: SurfacePoints;
var<storage, read_write> witnesses: SurfacePoints;
var<storage, read_write> progress: Progress;

@compute @workgroup_size(64)
fn replace(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let slot = row_index(group, groups, local, 64u);
    if slot >= settings.candidates_count {
        return;
    }
    var light = no_point();
    var mailbox = no_point();
    let newcomer = newcomers[slot];
    if newcomer != NO_KEY {
        let candidate = chosen[newcomer];
        light = candidates.points[candidate];
        mailbox = origins.points[candidate];
    } else if slot < min(lights.header.count, mailboxes.header.count) {
        light = lights.points[slot];
        mailbox = mailboxes.points[slot];
    }
    light.mark = 0u;
    replaced.points[slot] = light;
    witnesses.points[slot] = mailbox;
    if slot == 0u {
        let iteration = candidates.header.iteration;
        replaced.header = SurfacePointsHeader(settings.candidates_count, iteration, decision.chosen, 0u);
        witnesses.header = SurfacePointsHeader(settings.candidates_count, iteration, 0u, 0u);
        let step = min(iteration + 1u, settings.warm_up);
        progress = Progress(step, settings.warm_up, 0.0, select(0u, 1u, step >= settings.warm_up));
    }
}
