// Casts rays from points in view to lights that are unseen. Of the points that reach a light, the one with the least index
// counts, in whatever order they come. [SMC-IR §3.2.2]

#option MASKED false // whether triangles do not count where alpha is below their material's cutoff
#option TEXTURED false // whether any material of the scene has a texture

#import "dispatch.wgsl"
#import "random.wgsl"
#import "surface-segment.wgsl"
#import "verify.wgsl"

struct Settings {
    points_count: u32,
    /// The points that cast rays: the first of them.
    // DEVIATION(casters): the paper does not say how many do.
    casters: u32,
    /// Rays V of a point in a round, to different lights. More: fewer lights count as unseen that are seen. [default: 16, min: 1, max: 1024]
    rays_per_point: u32,
    /// Number of the round.
    round_number: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
var<storage, read> verified: SurfacePoints;
var<storage, read> unseen: array<u32>;
var<storage, read> round: Round;
var<storage, read_write> claims: array<atomic<u32>>;

@compute @workgroup_size(64)
fn cast_rays(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = row_index(group, groups, local, 64u);
    if index >= min(settings.casters, settings.points_count) {
        return;
    }
    let point = points.points[index];
    if point.triangle == NO_TRIANGLE || round.unseen == 0u {
        return;
    }
    let key = hash2(hash2(settings.seed, points.header.iteration), settings.round_number);
    // DEVIATION(distinct): a random first one and those after it, V different lights.
    let first = hash2(key, index) % round.unseen;
    for (var ray = 0u; ray < min(settings.rays_per_point, round.unseen); ray++) {
        let light = unseen[(first + ray) % round.unseen];
        // A point with a lower index has reached it: this one would change nothing.
        if atomicLoad(&claims[light]) > index && see_each_other(point, verified.points[light]) {
            atomicMin(&claims[light], index);
        }
    }
}
