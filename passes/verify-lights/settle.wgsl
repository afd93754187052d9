// Gives lights that were reached the point that reached them as their mailbox, and marks the others. [SMC-IR §3.2.2]

#import "dispatch.wgsl"
#import "surface-points.wgsl"
#import "verify.wgsl"

struct Settings {
    lights_count: u32,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
var<storage, read> round: Round;
var<storage, read_write> verified: SurfacePoints;
var<storage, read_write> witnesses: SurfacePoints;
var<storage, read_write> claims: array<u32>;

@compute @workgroup_size(64)
fn settle(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = row_index(group, groups, local, 64u);
    if index < settings.lights_count && claims[index] < SETTLED {
        witnesses.points[index] = points.points[claims[index]];
        claims[index] = SETTLED;
    }
}

@compute @workgroup_size(64)
fn finish(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = row_index(group, groups, local, 64u);
    if index < settings.lights_count {
        verified.points[index].mark = select(0u, 1u, claims[index] == UNSEEN);
    }
    if index == 0u {
        verified.header = SurfacePointsHeader(settings.lights_count, points.header.iteration, round.unseen, 0u);
        witnesses.header = SurfacePointsHeader(settings.lights_count, points.header.iteration, 0u, 0u);
    }
}
