// The Voronoi cells of lights in the domains of their sources: probes, each with the site that is nearest to it.
// [Laine et al. 2007]

#import "dispatch.wgsl"
#import "domain.wgsl"
#import "nearest-site.wgsl"
#import "sobol.wgsl"

/// Separates the probes from the first places of lights.
const PROBES: u32 = 0x7072u;

struct Settings {
    count: u32,
    probes: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read> shares: array<Share>;
/// [scratch, count: settings.count * settings.probes]
var<storage, read_write> probes: array<Probe>;
/// The slot of the site that is nearest to each probe. [scratch, count: settings.count * settings.probes]
var<storage, read_write> owners: array<u32>;
/// [scratch, count: settings.count]
var<storage, read_write> neighbours: array<Nearest>;

/// Probes of a thread, which loads each site once for all of them.
const TOGETHER: u32 = 4u;

/// Finds the nearest site of each probe; of equals, the first.
@compute @workgroup_size(64)
fn assign(row: Row) {
    let begin = TOGETHER * index_in(row, 64u);
    let all = settings.count * settings.probes;
    if begin >= all {
        return;
    }
    var places = mat4x3(NOWHERE, NOWHERE, NOWHERE, NOWHERE);
    var firsts = vec4(0u);
    var ends = vec4(0u);
    for (var k = 0u; k < TOGETHER; k++) {
        let index = min(begin + k, all - 1u);
        let share = shares[index / settings.probes];
        firsts[k] = share.first;
        ends[k] = share.end;
        if share.source != NO_SOURCE {
            let seed = hash2(hash2(settings.seed, PROBES), share.source);
            let square = sobol2_of(index - share.first * settings.probes, seed);
            places[k] = place_of(scene_lights.lights[share.source], square);
        }
    }
    let axes = transpose(places);
    var distances = vec4(NOTHING_NEAR);
    var nearest = vec4(NO_SLOT);
    // The slots of neighbouring sources follow each other.
    for (var i = firsts.x; i < min(ends.w, arrayLength(&sites)); i++) {
        let site = sites[i].place;
        let x = axes[0] - site.x;
        let y = axes[1] - site.y;
        let z = axes[2] - site.z;
        let distance = x * x + y * y + z * z;
        let is_nearer = (distance < distances) & (vec4(i) >= firsts) & (vec4(i) < ends);
        distances = select(distances, distance, is_nearer);
        nearest = select(nearest, vec4(i), is_nearer);
    }
    for (var k = 0u; k < min(TOGETHER, all - begin); k++) {
        probes[begin + k] = Probe(places[k], distances[k]);
        owners[begin + k] = nearest[k];
    }
}

/// Finds the nearest neighbour of each light.
@compute @workgroup_size(64)
fn separate(row: Row) {
    let slot = index_in(row, 64u);
    if slot >= settings.count {
        return;
    }
    var neighbour = Nearest(NOTHING_NEAR, NO_SLOT);
    if sites[slot].state >= SITE_KEPT {
        neighbour = nearest_site(sites[slot].place, shares[slot], slot);
    }
    neighbours[slot] = neighbour;
}
