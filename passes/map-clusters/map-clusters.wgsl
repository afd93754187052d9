// Assigns each texel of a reflective shadow map to the nearest cluster. [ACRSM §4.6, Eq. 4.4-4.5]
//
// Of the clusters in whose window it lies, a texel takes the nearest one, where normals and importance count as distances too. A
// workgroup lists the clusters whose windows meet its tile, in the order of their indices, so that of
// equally near ones each texel takes the first.

#input clusters: Clusters // The clusters; only those that are alive take texels.
#input rsm: ReflectiveShadowMap // The texels to assign.
#input importance: Importance optional like rsm // In [0, 1]; without it, all texels have the same.
#output map: ClusterMap(count: clusters.count, window: settings.window) // The cluster of each texel.

#option NORMAL_DISTANCE cosine one_of [cosine, angle] // What counts as the distance of two normals. cosine: 1 - |cos| (ACRSM Eq.
    // 4.4), by which the two sides of a thin wall are no distance apart. angle: the angle in units of half a turn (Eq. 3.7), by
    // which they are as far apart as can be.
#option IMPORTANCE false // whether importance counts
#option FLUX false internal // whether flux counts

#import "algorithms/workgroup.wgsl"
#import "cluster-count.wgsl"
#import "clustering.wgsl"
#import "color.wgsl"
#import "scene.wgsl"
#if IMPORTANCE
#import interface "importance"
#endif

struct Settings {
    /// Side of the square of texels around a cluster that it may take, in its own layer; 0 is the whole layer. Larger: more
    /// time, here and for the averages, with the square. Smaller: texels that no window reaches belong to no cluster, and few
    /// clusters cannot cover the map. ACRSM has 64 to 256. [default: 128, min: 0, max: 8192, unit: "px"]
    window: u32,
    // Here, the weights sum to 1. DEVIATION(weights): the thesis has none.
    /// Weight of the distance between a texel and the cluster's centre, as a fraction of the scene's extent. The weights are
    /// divided by their sum. Larger: cells are rounder, and go around edges. [default: 0.4, min: 0.0, max: 1.0]
    position_weight: f32,
    /// Weight of the distance between normals, see `normal_distance`. Larger: fewer cells go around edges, but clusters pass an
    /// edge less readily where the light moves over it. [default: 0.3, min: 0.0, max: 1.0]
    normal_weight: f32,
    /// Weight of the difference of importance, which should be in [0, 1]; without an input `importance` it is 0. Larger: a cell
    /// has texels of more similar importance. [default: 0.3, min: 0.0, max: 1.0]
    importance_weight: f32,
    /// Weight of the distance between fluxes, that of the texel and that at the centre. Above 0: cells follow texture and
    /// shadow edges, and waver from frame to frame where albedo has fine structure (ACRSM §4.6). [default: 0.0, min: 0.0, max:
    /// 1.0]
    flux_weight: f32,
    /// The clusters that this dispatch takes: `begin` to `end`.
    begin: u32,
    end: u32,
    /// 1 for the dispatch that takes the last clusters.
    last: u32,
}

var<uniform> settings: Settings;
var rsm_position: texture_2d_array<f32>;
var rsm_normal: texture_2d_array<f32>;
#if FLUX
var rsm_flux: texture_2d_array<f32>;
#endif
var map: texture_storage_2d_array<r32uint, write>;
/// The nearest cluster of each texel in the dispatches before: the bits of its distance, and its index. [scratch, count:
/// rsm.width * rsm.height * rsm.layers * min(parts - 1, 1)]
var<storage, read_write> nearest: array<vec2<u32>>;

/// Side of a workgroup, which has GROUP_SIZE threads.
const SIDE: u32 = 16u;
/// Texels per thread along each side of a tile, SIDE apart: each cluster is read once for all of them.
const SPAN: u32 = 2u;

/// The clusters of a chunk whose windows meet the tile: position and importance,
var<workgroup> listed_places: array<vec4<f32>, GROUP_SIZE>;
/// normal,
var<workgroup> listed_normals: array<vec3<f32>, GROUP_SIZE>;
#if FLUX
/// flux of the texel at the centre,
var<workgroup> listed_fluxes: array<vec3<f32>, GROUP_SIZE>;
#endif
/// index, and the part of the tile that is in the window.
var<workgroup> listed_indices: array<vec2<u32>, GROUP_SIZE>;

/// A part of the tile in one number: corners, in six bits each.
fn pack(part: Window) -> u32 {
    return part.low.x | (part.low.y << 6u) | (part.high.x << 12u) | (part.high.y << 18u);
}

/// Whether a packed part of the tile has this texel of it.
fn part_holds(packed: u32, local: vec2<u32>) -> bool {
    let low = vec2(packed, packed >> 6u) & vec2(63u);
    let high = vec2(packed >> 12u, packed >> 18u) & vec2(63u);
    return all(local >= low) && all(local < high);
}

/// What a cluster is compared by: the mean of its texels; before it has any, that of the texel where it was seeded, since what
/// seeds are dealt by may be another importance.
fn importance_of(cluster: Cluster) -> f32 {
#if IMPORTANCE
    if cluster.texels == 0u {
        return weight_of(importance(cluster.layer, vec2<u32>(cluster.uv)));
    }
#endif
    return weight_of(cluster.importance);
}

/// Lists those of the clusters from `first` to before `end` that can take texels of the tile, at most GROUP_SIZE, and
/// returns how many there are. All threads of the workgroup must call it.
fn list_chunk(thread: u32, first: u32, end: u32, tile: Window, layer: u32) -> u32 {
    let index = first + thread;
    var part = Window(vec2(0u), vec2(0u));
    var cluster: Cluster;
    if index < end {
        cluster = clusters.clusters[index];
        let window = window_of(cluster.uv, settings.window, textureDimensions(rsm_position));
        if cluster.state == CLUSTER_ALIVE && cluster.layer == layer && is_finite(cluster.position) {
            part.low = clamp(window.low, tile.low, tile.high) - tile.low;
            part.high = clamp(window.high, tile.low, tile.high) - tile.low;
        }
    }
    let meets = all(part.low < part.high);
    let ranks = prefix_sum_u32(thread, select(0u, 1u, meets));
    if meets {
        let at = ranks.x - 1u;
        listed_places[at] = vec4(cluster.position, importance_of(cluster));
        listed_normals[at] = direction_of(cluster.normal);
#if FLUX
        listed_fluxes[at] = flux_of(cluster.centre_flux);
#endif
        listed_indices[at] = vec2(index, pack(part));
    }
    workgroupBarrier();
    return ranks.y;
}

/// Distance of two normals in [0, 1]; 1 where one of them is none. [ACRSM Eq. 4.4]
fn normal_distance(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let cosine = dot(a, b);
#if NORMAL_DISTANCE == angle
    if all(a == vec3(0.0)) || all(b == vec3(0.0)) {
        return 1.0;
    }
    return atan2(length(cross(a, b)), cosine) / PI;
#else
    return 1.0 - min(abs(cosine), 1.0);
#endif
}

#if FLUX
/// Distance of two fluxes in [0, 1]; 0 where both are dark. [ACRSM Eq. 3.8]
fn flux_distance(a: vec3<f32>, b: vec3<f32>) -> f32 {
    // DEVIATION(flux-distance): relative to both, so that it needs no unit.
    let greatest = max(max(max(a.r, a.g), a.b), max(max(b.r, b.g), b.b));
    if greatest == 0.0 {
        return 0.0;
    }
    let difference = a / greatest - b / greatest;
    return dot(difference, difference) / (dot(a / greatest, a / greatest) + dot(b / greatest, b / greatest));
}
#endif

/// A texel that looks for its cluster.
struct Mapped {
    texel: vec2<u32>,
    is_inside: bool,
    lit: bool,
    position: vec3<f32>,
    normal: vec3<f32>,
#if IMPORTANCE
    importance: f32,
#endif
#if FLUX
    flux: vec3<f32>,
#endif
    /// Bits of the least distance, and the cluster. They are compared as bits, of which a NaN has more than any number.
    best: vec2<u32>,
}

fn slot_of(texel: vec2<u32>, layer: u32) -> u32 {
    let size = textureDimensions(rsm_position);
    return (layer * size.y + texel.y) * size.x + texel.x;
}

fn mapped(texel: vec2<u32>, layer: u32) -> Mapped {
    let size = textureDimensions(rsm_position);
    // Outside the map, any texel will do: nothing comes of it.
    let place = min(texel, size - 1u);
    let position = textureLoad(rsm_position, place, layer, 0);
    var found: Mapped;
    found.texel = texel;
    found.is_inside = all(texel < size);
    found.lit = found.is_inside && is_lit(position);
    found.position = position.xyz;
    found.normal = direction_of(textureLoad(rsm_normal, place, layer, 0).xyz);
#if IMPORTANCE
    found.importance = weight_of(importance(layer, place));
#endif
#if FLUX
    found.flux = flux_of(textureLoad(rsm_flux, place, layer, 0).rgb);
#endif
    found.best = vec2(0xffffffffu, NO_CLUSTER);
    if settings.begin > 0u {
        found.best = nearest[slot_of(place, layer)];
    }
    return found;
}

/// A cluster of the list.
struct Listed {
    /// Position and importance.
    place: vec4<f32>,
    normal: vec3<f32>,
#if FLUX
    flux: vec3<f32>,
#endif
}

fn listed_at(i: u32) -> Listed {
    var listed: Listed;
    listed.place = listed_places[i];
    listed.normal = listed_normals[i];
#if FLUX
    listed.flux = listed_fluxes[i];
#endif
    return listed;
}

/// Distance of a texel to a cluster. [ACRSM Eq. 4.4-4.5]
fn distance_to(cluster: Listed, own: Mapped) -> f32 {
    let apart = length(own.position - cluster.place.xyz);
    var distance = settings.position_weight * apart / max(scene_info.extent, 1e-30);
    distance += settings.normal_weight * normal_distance(cluster.normal, own.normal);
#if IMPORTANCE
    distance += settings.importance_weight * abs(cluster.place.w - own.importance);
#endif
#if FLUX
    distance += settings.flux_weight * flux_distance(cluster.flux, own.flux);
#endif
    return distance;
}

/// Finds the nearest cluster of each texel of a tile. A cluster takes an iteration, and one more for each texel of a thread, and a chunk
/// of them a few more. [threads: ((rsm.width + SPAN - 1) / SPAN, (rsm.height + SPAN - 1) / SPAN, rsm.layers), items: clusters.count,
/// iterations: 2 + SPAN * SPAN]
@compute @workgroup_size(SIDE, SIDE)
fn map_texels(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let corner = group.xy * SIDE * SPAN;
    let tile = Window(corner, min(corner + SIDE * SPAN, textureDimensions(rsm_position)));
    var texels: array<Mapped, SPAN * SPAN>;
    var lit = false;
    for (var t = 0u; t < SPAN * SPAN; t++) {
        texels[t] = mapped(corner + local.xy + SIDE * vec2(t % SPAN, t / SPAN), group.z);
        lit |= texels[t].lit;
    }
    let end = min(cluster_count(), settings.end);
    for (var first = settings.begin; first < end; first += GROUP_SIZE) {
        let listed = list_chunk(thread, first, end, tile, group.z);
        for (var i = 0u; i < select(0u, listed, lit); i++) {
            let index = listed_indices[i];
            let cluster = listed_at(i);
            for (var t = 0u; t < SPAN * SPAN; t++) {
                if texels[t].lit && part_holds(index.y, texels[t].texel - corner) {
                    let bits = bitcast<u32>(distance_to(cluster, texels[t])) & 0x7fffffffu;
                    if bits < texels[t].best.x {
                        texels[t].best = vec2(bits, index.x);
                    }
                }
            }
        }
    }
    for (var t = 0u; t < SPAN * SPAN; t++) {
        if texels[t].is_inside && settings.last == 0u {
            nearest[slot_of(texels[t].texel, group.z)] = texels[t].best;
        }
        if texels[t].is_inside && settings.last != 0u {
            textureStore(map, texels[t].texel, group.z, vec4(texels[t].best.y));
        }
    }
}
