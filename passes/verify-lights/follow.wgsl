// Lets lights and their mailboxes follow the scene, and asks which mailboxes the camera sees. [SMC-IR §3.2.2]

#option MASKED false // whether triangles do not count where alpha is below their material's cutoff
#option TEXTURED false // whether any material of the scene has a texture
#option MOVES false // whether geometry moves, so that something may come between a light and its mailbox

#import "camera.wgsl"
#import "dispatch.wgsl"
#import "ray-tracing.wgsl"
#import "surface-point.wgsl"
#import "surface-segment.wgsl"
#import "verify.wgsl"

struct Settings {
    lights_count: u32,
}

var<uniform> settings: Settings;
var<storage, read> lights: SurfacePoints;
var<storage, read> mailboxes: SurfacePoints;
var<storage, read_write> verified: SurfacePoints;
var<storage, read_write> witnesses: SurfacePoints;
var<storage, read_write> claims: array<u32>;

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

@compute @workgroup_size(64)
fn follow(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = row_index(group, groups, local, 64u);
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
#if MOVES
        is_seen = is_seen && see_each_other(light, mailbox);
#endif
        claim = select(UNSEEN, SETTLED, is_seen);
    }
    verified.points[index] = light;
    witnesses.points[index] = mailbox;
    claims[index] = claim;
}
