// Visibility of discs by an atlas of paraboloid distance maps: blockers are looked for, and the lookups of a kernel as wide
// as the penumbra that they cast are averaged after the depth test. [Fernando 2005, ACRSM §5.3.3]

#import "atlas-lookup.wgsl"
#import "disc-shadow.wgsl"
#import "poisson-disc.wgsl"

struct VisibilityFacts {
    atlas: AtlasFacts,
    /// Taps that look for blockers.
    search: u32,
    /// Taps that are filtered.
    taps: u32,
    /// Least height of a blocker above the light's plane, as a share of the receiver's.
    nearest: f32,
}

var<uniform> visibility_facts: VisibilityFacts;

/// The result of a lookup.
struct Tap {
    seen: bool,
    /// Height above the light's plane of what is stored in the map [m].
    height: f32,
}

/// A lookup beside a receiver in the direction of `beside` [m], which is as high above the light's plane.
// DEVIATION(receiver-plane): the paper compares all taps with the receiver's depth.
fn look_up_beside(origin: vec3<u32>, receiver: vec3<f32>, plane_normal: vec3<f32>, beside: vec3<f32>) -> Tap {
    // What is tested is the receiver's plane, or its height where that is nearer: what lies behind either hides nothing.
    let plane_height = dot(plane_normal, receiver);
    let along = dot(plane_normal, beside);
    let meets = along * plane_height > 0.0;
    let at = beside * select(1.0, min(plane_height / along, 1.0), meets);
    let lookup = atlas_lookup_in_frame(at, plane_normal);
    let tile = visibility_facts.atlas.tile;
    let texel = texel_in_map(lookup.position, tile);
    let stored = stored_in_atlas(origin, texel);
    return Tap(is_seen(lookup, texel, tile, stored), stored * (at.z / lookup.distance));
}

fn visibility_by_map(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let facts = visibility_facts;
    let frame = frame_from_normal(light.normal);
    let receiver = (at - light.position) * frame;
    if receiver.z <= 0.0 {
        return 0.0;
    }
    let plane_normal = normal * frame;
    let origin = origin_in_atlas(index);
    let radius = disc_radius(light.area);
    if radius == 0.0 {
        return seen_once(atlas_lookup(light, at, normal), index);
    }

    // DEVIATION(nearest): the search is as wide as the penumbra of the nearest blockers that it is to find.
    let reach = search_radius(radius, facts.nearest);
    var sum = 0.0;
    var blockers = 0.0;
    for (var i = 0u; i < facts.search; i++) {
        let tap = look_up_beside(origin, receiver, plane_normal, receiver + vec3(reach * POISSON_DISC[i], 0.0));
        if !tap.seen {
            sum += tap.height;
            blockers += 1.0;
        }
    }
    if blockers == 0.0 {
        return 1.0;
    }

    // Half the width of the penumbra. [Fernando 2005; ACRSM Eq. 3.2]
    // DEVIATION(disc): of the scaled disc, where ACRSM scales a circle in the map.
    let blocker = max(sum / blockers, facts.nearest * receiver.z);
    let penumbra = penumbra_radius(radius, receiver.z, blocker);
    var seen = 0.0;
    for (var i = 0u; i < facts.taps; i++) {
        let tap = look_up_beside(origin, receiver, plane_normal, receiver + vec3(penumbra * POISSON_DISC[i], 0.0));
        seen += select(0.0, 1.0, tap.seen);
    }
    return seen / f32(facts.taps);
}
