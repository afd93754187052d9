// The Voronoi cells of lights in the domains of their sources: probes, each with the site that is nearest to it.
// [Laine et al. 2007]

#import "dispatch.wgsl"
#import "domain.wgsl"
#import "nearest-site.wgsl"
#import "sobol.wgsl"
#import "surface.wgsl"

/// Tells the probes from the first places of lights.
const PROBES: u32 = 0x7072u;

struct Settings {
    count: u32,
    probes: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read> shares: array<Share>;
var<storage, read_write> probes: array<Probe>;
/// [probes] The slot of the nearest site.
var<storage, read_write> owners: array<u32>;
var<storage, read_write> neighbours: array<Nearest>;

/// Finds the nearest site of each probe.
@compute @workgroup_size(64)
fn assign(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = row_index(group, groups, local, 64u);
    if index >= settings.count * settings.probes {
        return;
    }
    let share = shares[index / settings.probes];
    var probe = Probe(NOWHERE, NOTHING_NEAR);
    var owner = NO_SLOT;
    if share.source != NO_SOURCE {
        let seed = hash2(hash2(settings.seed, PROBES), share.source);
        let square = sobol2_of(index - share.first * settings.probes, seed);
        probe.place = place_of(scene_lights.lights[share.source], square);
        let nearest = nearest_site(probe.place, share, NO_SLOT);
        probe.distance = nearest.distance;
        owner = nearest.slot;
    }
    probes[index] = probe;
    owners[index] = owner;
}

/// Finds the nearest neighbour of each light.
@compute @workgroup_size(64)
fn separate(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let slot = row_index(group, groups, local, 64u);
    if slot >= settings.count {
        return;
    }
    var neighbour = Nearest(NOTHING_NEAR, NO_SLOT);
    if sites[slot].state >= SITE_KEPT {
        neighbour = nearest_site(sites[slot].place, shares[slot], slot);
    }
    neighbours[slot] = neighbour;
}
