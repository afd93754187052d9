// Marks the lights that no point in view reaches, as far as mailboxes and a few rays show. [SMC-IR §3.2.2]
//
// Lights and mailboxes follow the scene, and lights whose mailbox the camera sees are settled. In each round, points in view
// cast rays to the lights that are unseen: of the points that reach a light, the one with the least index becomes its mailbox,
// in whatever order they come.

#input points: SurfacePoints // Points that the camera sees.
#input lights: SurfacePoints // The lights of the frame before.
#input mailboxes: SurfacePoints // For each light, a point in view that it reached.
#output verified: SurfacePoints(count: lights.count) // The lights where they are now; marked are those that reach nothing in
    // view, and counted.
#output witnesses: SurfacePoints(count: lights.count) // The mailboxes where they are now, or others in their place.

#option MASKED false // whether triangles do not count where alpha is below their material's cutoff
#option TEXTURED false // whether any material of the scene has a texture
#option MOVING_GEOMETRY false // whether geometry moves, so that something may come between a light and its mailbox

#import "algorithms/compact.wgsl"
#import "camera.wgsl"
#import "dispatch.wgsl"
#import "random.wgsl"
#import "ray-tracing.wgsl"
#import "surface-point.wgsl"
#import "surface-segment.wgsl"

struct Settings {
    points_count: u32,
    lights_count: u32,
    /// Rounds in a frame. More: fewer lights count as unseen that are seen; a round after the last unseen light costs nothing.
    /// [default: 2, min: 0, max: 16]
    rounds: u32,
    // DEVIATION(casters): the paper does not say how many points cast rays.
    /// The most points that cast rays in a round: the first of them. More: fewer lights count as unseen that are seen, and more
    /// time where some are. [default: 2048, min: 1, max: 2097152]
    casters: u32,
    /// Rays V of a point in a round, to different lights. More: fewer lights count as unseen that are seen. [default: 16, min:
    /// 1, max: 1024]
    rays_per_point: u32,
    seed: u32,
}

/// The lights that are unseen, and how the next round is dispatched.
struct Round {
    workgroups_x: u32,
    workgroups_y: u32,
    workgroups_z: u32,
    /// The number of unseen lights.
    unseen: u32,
    /// The number of the round, from 1.
    number: u32,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
var<storage, read> lights: SurfacePoints;
var<storage, read> mailboxes: SurfacePoints;
var<storage, read_write> verified: SurfacePoints;
var<storage, read_write> witnesses: SurfacePoints;
/// The state of each light: UNSEEN, SETTLED, or the index of the point that reached it. [scratch, count: lights.count]
var<storage, read_write> claims: array<atomic<u32>>;
/// The lights that are unseen. [scratch, count: lights.count]
var<storage, read_write> unseen: array<u32>;
/// The next round. [scratch, cleared]
var<storage, read_write> round: Round;
/// The round that is dispatched. [reads: round]
var<storage, read> dispatched: Round;

/// A light that no point in view has reached so far.
const UNSEEN: u32 = 0xffffffffu;
/// A light that needs no point: it is known to be reached, or is not there.
const SETTLED: u32 = 0xfffffffeu;

/// Threads of a workgroup.
const GROUP: u32 = 64u;

/// The points that cast rays.
fn casters() -> u32 {
    return min(settings.casters, min(points.header.count, settings.points_count));
}

/// Whether the camera sees a point.
fn is_in_view(point: SurfacePoint) -> bool {
    let clip = camera.clip_from_world * vec4(point.position, 1.0);
    // w is the depth. The comparison fails for what is no number.
    if !(clip.w > camera.near && all(abs(clip.xy) <= vec2(clip.w))) {
        return false;
    }
    let to_camera = camera.position - point.position;
    if dot(point.normal, to_camera) <= 0.0 {
        return false;
    }
    let way = offset_origin(point.position, point.normal) - camera.position;
    return !occluded(camera.position, way, camera.near / clip.w, 1.0);
}

/// Lets lights and their mailboxes follow the scene, and settles the lights whose mailbox the camera sees.
@compute @workgroup_size(GROUP)
fn follow(row: Row) {
    let index = index_in(row, GROUP);
    if index >= settings.lights_count {
        return;
    }
    var light = no_point();
    var mailbox = no_point();
    // Without history there is nothing.
    if index < min(lights.header.count, mailboxes.header.count) {
        light = followed(lights.points[index]);
        mailbox = followed(mailboxes.points[index]);
    }
    var claim = SETTLED;
    if light.triangle != NO_TRIANGLE {
        var is_seen = mailbox.triangle != NO_TRIANGLE && is_in_view(mailbox);
#if MOVING_GEOMETRY
        is_seen = is_seen && see_each_other(light, mailbox);
#endif
        claim = select(UNSEEN, SETTLED, is_seen);
    }
    verified.points[index] = light;
    witnesses.points[index] = mailbox;
    atomicStore(&claims[index], claim);
}

fn scan_length() -> u32 {
    return settings.lights_count;
}

fn compact_keeps(i: u32) -> bool {
    return atomicLoad(&claims[i]) == UNSEEN;
}

fn compact_move(i: u32, place: u32) {
    unseen[place] = i;
}

fn compact_count(count: u32) {
    // Nothing runs where no light is unseen.
    let workgroups = (casters() + GROUP - 1u) / GROUP;
    round = Round(select(0u, workgroups, count > 0u), 1u, 1u, count, round.number + 1u);
}

/// Casts rays from points in view to lights that are unseen.
@compute @workgroup_size(GROUP)
fn cast_rays(row: Row) {
    let index = index_in(row, GROUP);
    if index >= casters() {
        return;
    }
    let point = points.points[index];
    if point.triangle == NO_TRIANGLE || dispatched.unseen == 0u {
        return;
    }
    let key = hash2(hash2(settings.seed, points.header.iteration), dispatched.number - 1u);
    // DEVIATION(distinct): a random first one and those after it, V different lights.
    let first = hash2(key, index) % dispatched.unseen;
    for (var ray = 0u; ray < min(settings.rays_per_point, dispatched.unseen); ray++) {
        let light = unseen[(first + ray) % dispatched.unseen];
        // A point with a lower index has reached it: this one would change nothing.
        if atomicLoad(&claims[light]) > index && see_each_other(point, verified.points[light]) {
            atomicMin(&claims[light], index);
        }
    }
}

/// Gives lights that were reached the point that reached them as their mailbox.
@compute @workgroup_size(GROUP)
fn settle(row: Row) {
    let index = index_in(row, GROUP);
    if index >= settings.lights_count {
        return;
    }
    let claim = atomicLoad(&claims[index]);
    if claim < SETTLED {
        witnesses.points[index] = points.points[claim];
        atomicStore(&claims[index], SETTLED);
    }
}

/// Marks the lights that are unseen after all rounds.
@compute @workgroup_size(GROUP)
fn finish(row: Row) {
    let index = index_in(row, GROUP);
    if index < settings.lights_count {
        verified.points[index].mark = select(0u, 1u, atomicLoad(&claims[index]) == UNSEEN);
    }
    if index == 0u {
        verified.header = SurfacePointsHeader(settings.lights_count, points.header.iteration, round.unseen, 0u);
        witnesses.header = SurfacePointsHeader(settings.lights_count, points.header.iteration, 0u, 0u);
    }
}
