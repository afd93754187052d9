// Moves each cluster of texels of a reflective shadow map to the mean of its texels. [ACRSM §4.7]
//
// The rectangle that holds a cluster's texels is found first; then one workgroup per cluster goes through it. All sums have one order:
// a thread takes every 256th texel of the rectangle, sums them by parts of 64, and workgroup_sum4 adds up the threads.

#input clusters: Clusters // The clusters as their texels were mapped.
#input map: ClusterMap like rsm // The cluster of each texel.
#input rsm: ReflectiveShadowMap // What the texels hold.
#input importance: Importance optional like rsm // Averaged too; without it, each texel has 1.
#output averaged: Clusters(count: clusters.count) // The clusters around the means of their texels.

#option AREA texels one_of [texels, disk] // What the area of a cluster is. texels: the sum of the areas of its texels. disk: that
    // of the circle around its centre through its farthest texel (ACRSM §4.7), which is 1.5 to 2 times as large for cells that
    // fit together, and grows with a single texel.
#option IMPORTANCE false // whether importance is averaged
#option NORMAL_MAPPED false // whether any material of the scene has a normal map

#import "algorithms/workgroup.wgsl"
#import "cluster-count.wgsl"
#import "clustering.wgsl"
#import "color.wgsl"
#import "dispatch.wgsl"
#if NORMAL_MAPPED
#import "octahedron.wgsl"
#endif
#if IMPORTANCE
#import interface "importance"
#endif

var map: texture_2d_array<u32>;
var rsm_position: texture_2d_array<f32>;
var rsm_normal: texture_2d_array<f32>;
var rsm_flux: texture_2d_array<f32>;
var<storage, read_write> averaged: Clusters;
/// The rectangle of each cluster's texels, as four numbers that grow from 0: the distances of its left, upper, right and lower side from
/// the opposite side of the layer. [scratch, count: 4 * clusters.count, cleared]
var<storage, read_write> sides: array<atomic<u32>>;

/// Finds the rectangles. A thread a texel, most of which lie within what others have found, and only read.
@compute @workgroup_size(16, 16)
fn enclose(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(map);
    if any(id.xy >= size) {
        return;
    }
    let index = textureLoad(map, id.xy, id.z, 0).x;
    if index >= cluster_count() || clusters.clusters[index].layer != id.z {
        return;
    }
    let distances = vec4(size - id.xy, id.xy + 1u);
    for (var side = 0u; side < 4u; side++) {
        if atomicLoad(&sides[4u * index + side]) < distances[side] {
            atomicMax(&sides[4u * index + side], distances[side]);
        }
    }
}

/// The rectangle that holds a cluster's texels.
fn rectangle_of(index: u32, size: vec2<u32>) -> Window {
    let before_low = vec2(atomicLoad(&sides[4u * index]), atomicLoad(&sides[4u * index + 1u]));
    let high = vec2(atomicLoad(&sides[4u * index + 2u]), atomicLoad(&sides[4u * index + 3u]));
    return Window(min(size - before_low, high), high);
}

/// Texel i of a rectangle, row by row.
fn texel_of(rectangle: Window, i: u32) -> vec2<u32> {
    let width = rectangle.high.x - rectangle.low.x;
    return rectangle.low + vec2(i % width, i / width);
}

/// Sums over texels. Places are offsets from the old centre: far from the origin, their own sum would round
/// away what differs.
struct Sums {
    /// Position [m], importance.
    place: vec4<f32>,
    /// Normal, area [m²].
    surface: vec4<f32>,
    /// Flux [W], number of texels.
    flux: vec4<f32>,
    /// Place in the layer [texels].
    uv: vec4<f32>,
#if NORMAL_MAPPED
    /// What a normal map adds to the normal, times the luminance of the flux [W].
    bend: vec4<f32>,
#endif
}

/// Returns the summand of a texel.
fn summand(texel: vec2<u32>, old: Cluster) -> Sums {
    let position = textureLoad(rsm_position, texel, old.layer, 0).xyz;
    let normals = textureLoad(rsm_normal, texel, old.layer, 0);
    let normal = direction_of(normals.xyz);
    let flux = textureLoad(rsm_flux, texel, old.layer, 0);
    let uv = vec2<f32>(texel) + 0.5 - old.uv;
#if IMPORTANCE
    let importance = weight_of(importance(old.layer, texel));
#else
    let importance = 1.0;
#endif
#if NORMAL_MAPPED
    var bend = vec4(0.0);
    if normals.w != 0.0 {
        bend = vec4(luminance(flux_of(flux.rgb)) * (direction_from_half_float(normals.w) - normal), 0.0);
    }
#endif
    return Sums(
        vec4(position - old.position, importance),
        vec4(normal, weight_of(flux.a)),
        vec4(flux_of(flux.rgb), 1.0),
        vec4(uv, 0.0, 0.0),
#if NORMAL_MAPPED
        bend,
#endif
    );
}

fn added(a: Sums, b: Sums) -> Sums {
    return Sums(
        a.place + b.place,
        a.surface + b.surface,
        a.flux + b.flux,
        a.uv + b.uv,
#if NORMAL_MAPPED
        a.bend + b.bend,
#endif
    );
}

/// Texels that a thread sums before it adds them to the others: in one run, small ones are lost beside the sum of many.
const PART: u32 = 64u;

/// Length of the mean of unit normals below which it has no direction: that of the rounding of half floats.
const LEAST_MEAN: f32 = 1e-3;

/// The centre that these sums of at least one texel give.
fn centre_of(sums: Sums, old: Cluster) -> Cluster {
    let texels = sums.flux.w;
    var centre = old;
    centre.position = old.position + sums.place.xyz / texels;
    centre.importance = sums.place.w / texels;
    let normal = sums.surface.xyz / texels;
    if length(normal) > LEAST_MEAN {
        centre.normal = normalize(normal);
    }
    centre.uv = old.uv + sums.uv.xy / texels;
    centre.flux = sums.flux.rgb;
#if NORMAL_MAPPED
    let power = luminance(centre.flux);
    centre.bend = select(vec3(0.0), sums.bend.xyz / power, power > 0.0);
#endif
    centre.texels = u32(texels);
    return centre;
}

var<workgroup> shared_nearest: array<vec2<u32>, GROUP_SIZE>;

/// The lesser of two pairs in lexical order.
fn lesser(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    return select(b, a, a.x < b.x || (a.x == b.x && a.y < b.y));
}

/// The least pair of the workgroup, in lexical order. All threads must call it.
fn workgroup_least(thread: u32, own: vec2<u32>) -> vec2<u32> {
    shared_nearest[thread] = own;
    workgroupBarrier();
    for (var width = GROUP_SIZE / 2u; width > 0u; width /= 2u) {
        if thread < width {
            shared_nearest[thread] = lesser(shared_nearest[thread], shared_nearest[thread + width]);
        }
        workgroupBarrier();
    }
    return shared_nearest[0];
}

@compute @workgroup_size(GROUP_SIZE)
fn average(row: Row) {
    let index = group_in(row);
    let thread = row.local;
    let size = textureDimensions(map);
    var old: Cluster;
    var rectangle = Window(vec2(0u), vec2(0u));
    if index < cluster_count() {
        old = clusters.clusters[index];
        if old.state == CLUSTER_ALIVE {
            rectangle = rectangle_of(index, size);
        }
    }
    let extent = rectangle.high - rectangle.low;
    let length = extent.x * extent.y;

    var sums: Sums;
    for (var first = thread; first < length; first += PART * GROUP_SIZE) {
        var part: Sums;
        let end = min(length, first + PART * GROUP_SIZE);
        for (var i = first; i < end; i += GROUP_SIZE) {
            let texel = texel_of(rectangle, i);
            if textureLoad(map, texel, old.layer, 0).x == index {
                part = added(part, summand(texel, old));
            }
        }
        sums = added(sums, part);
    }
    sums.place = workgroup_sum4(thread, sums.place);
    sums.surface = workgroup_sum4(thread, sums.surface);
    sums.flux = workgroup_sum4(thread, sums.flux);
    sums.uv = workgroup_sum4(thread, sums.uv);
#if NORMAL_MAPPED
    sums.bend = workgroup_sum4(thread, sums.bend);
#endif
    let has_texels = sums.flux.w > 0.0;

    var centre = centre_of(sums, old);
    var farthest2 = 0.0;
    var nearest = vec2(0xffffffffu);
    for (var i = thread; i < select(0u, length, has_texels); i += GROUP_SIZE) {
        let texel = texel_of(rectangle, i);
        if textureLoad(map, texel, old.layer, 0).x == index {
            let offset = textureLoad(rsm_position, texel, old.layer, 0).xyz - centre.position;
            farthest2 = max(farthest2, dot(offset, offset));
            let beside = vec2<f32>(texel) + 0.5 - centre.uv;
            // Numbers that are not negative are in the order of their bits.
            let bits = bitcast<u32>(dot(beside, beside));
            nearest = lesser(nearest, vec2(bits, (old.layer * size.y + texel.y) * size.x + texel.x));
        }
    }
    farthest2 = workgroup_max(thread, farthest2);
    nearest = workgroup_least(thread, nearest);
    if thread != 0u || index >= arrayLength(&averaged.clusters) {
        return;
    }
    if has_texels {
        centre.state = CLUSTER_ALIVE;
        centre.texel = nearest.y;
        centre.radius = sqrt(farthest2);
#if AREA == texels
        // DEVIATION(area): what its texels cover.
        centre.area = sums.surface.w;
#else
        centre.area = PI * farthest2;
#endif
        // DEVIATION(centre-texel): of a texel of its own; the mean itself can lie in another cell, or where nothing is lit.
        let texel = vec2(nearest.y % size.x, nearest.y / size.x % size.y);
        centre.centre_flux = flux_of(textureLoad(rsm_flux, texel, old.layer, 0).rgb);
        averaged.clusters[index] = centre;
    } else {
        averaged.clusters[index] = vanished(old);
    }
}

/// A cluster that has lost its texels: it is waiting for a seed.
fn vanished(old: Cluster) -> Cluster {
    var gone = old;
    gone.state = CLUSTER_TO_SEED;
    gone.texels = 0u;
    gone.texel = NO_TEXEL;
    gone.area = 0.0;
    gone.radius = 0.0;
    gone.flux = vec3(0.0);
    gone.centre_flux = vec3(0.0);
    return gone;
}

/// Returns what balancing makes equal for all clusters: area times importance. [ACRSM §4.8]
fn share_of(cluster: Cluster) -> f32 {
    return cluster.area * cluster.importance;
}

/// Writes the summary of all clusters, but for the flux of the map, which map-flux.wgsl adds. One workgroup.
@compute @workgroup_size(GROUP_SIZE)
fn summarise(@builtin(local_invocation_index) thread: u32) {
    let count = cluster_count();
    // Number of those with texels, of those that lost theirs, and the sum of shares.
    var tally = vec4(0.0);
    var flux = vec4(0.0);
    var greatest_area = 0.0;
    for (var i = thread; i < count; i += GROUP_SIZE) {
        let now = averaged.clusters[i];
        if now.texels > 0u {
            tally += vec4(1.0, 0.0, share_of(now), 0.0);
            flux += vec4(now.flux, 0.0);
            greatest_area = max(greatest_area, now.area);
        } else if clusters.clusters[i].state == CLUSTER_ALIVE {
            tally.y += 1.0;
        }
    }
    tally = workgroup_sum4(thread, tally);
    flux = workgroup_sum4(thread, flux);
    greatest_area = workgroup_max(thread, greatest_area);
    let mean = tally.z / max(tally.x, 1.0);

    // Squares of small differences between large numbers: only a second loop has their digits.
    var squares = vec4(0.0);
    for (var i = thread; i < count; i += GROUP_SIZE) {
        let now = averaged.clusters[i];
        if now.texels > 0u {
            let difference = share_of(now) - mean;
            squares.x += difference * difference;
        }
    }
    squares = workgroup_sum4(thread, squares);
    if thread == 0u {
        var header = clusters.header;
        header.alive = u32(tally.x);
        header.vanished = u32(tally.y);
        header.iteration++;
        header.greatest_area = greatest_area;
        header.mean_share = mean;
        header.share_variance = squares.x / max(tally.x, 1.0);
        header.mapped_flux = flux_of(flux.rgb);
        averaged.header = header;
    }
}
