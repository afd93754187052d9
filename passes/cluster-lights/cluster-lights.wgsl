// Groups virtual lights into clusters, each of which becomes an area light. [Dong et al. 2009; ACRSM §3.2.5, Eq. 3.7]
//
// This is k-means over positions and normals. Per iteration `assign` gives each light to the nearest cluster, `settle` ends the iterations where none changed, and
// `update` moves the clusters. A sum has one order, so the bits do not depend on that of threads.

#input lights: VirtualLights // The lights to group.
#output clusters: VirtualLights(count: min(settings.count, lights.count)) // An area light for each cluster.
#output owners: Owners(count: lights.count) // The cluster of each light.

#option METRIC squared one_of [squared, linear] // How far a light is from a cluster. squared: the weighted sum of the
    // squared distance and the squared chord between normals, which no iteration increases. linear: the weighted sum of the
    // distance and the angle (ACRSM Eq. 3.7).

#import "dispatch.wgsl"
#import "horizon.wgsl"
#import "owners.wgsl"
#import "scene.wgsl"
#import "virtual-lights.wgsl"

struct Settings {
    lights_count: u32,
    clusters_count: u32,
    // The most is what a thread of `assign` can loop over in one dispatch.
    /// The most clusters; there are no more than lights. More: smaller area lights, but more maps and time. [default: 64, min: 1,
    /// max: 32768]
    count: u32,
    /// The most iterations. Those after the one in which no light changed its cluster have no work. [default: 32, min: 1, max:
    /// 256]
    iterations: u32,
    /// Weight of the distance between positions, in units of the scene's extent. Larger: clusters are smaller, but
    /// normals differ more within them. [default: 1.0, min: 0.0]
    position_weight: f32,
    /// Weight of the difference of normals. Larger: clusters are flatter, but larger. [default: 0.1, min: 0.0]
    normal_weight: f32,
}

var<uniform> settings: Settings;
var<storage, read> lights: VirtualLights;
/// Centres between iterations, and area lights in the end.
var<storage, read_write> clusters: VirtualLights;
var<storage, read_write> owners: array<u32>;
/// The number of lights that changed their cluster in an iteration. [scratch]
var<storage, read_write> changes: atomic<u32>;
/// Workgroups of `assign` and then of `update`, three numbers each. [scratch]
var<storage, read_write> dispatches: array<u32, 6>;

/// Threads of a workgroup.
const GROUP: u32 = 256u;

fn light_count() -> u32 {
    return min(lights.count, settings.lights_count);
}

fn cluster_count() -> u32 {
    return min(light_count(), settings.clusters_count);
}

/// Whether a light emits: one that does not has no meaningful position.
fn is_lit(light: VirtualLight) -> bool {
    return any(light.flux > vec3(0.0));
}

/// One thread per light: it has no cluster yet. The first centres are lights at equal steps, the same in every frame.
// DEVIATION(first-centres): the paper does not say which.
@compute @workgroup_size(GROUP)
fn seed(row: Row) {
    let i = index_in(row, GROUP);
    let n = light_count();
    let k = cluster_count();
    if i < settings.lights_count {
        owners[i] = select(0u, NO_OWNER, i < n);
    }
    if i < k {
        // Light i n / k, without the product, which may exceed 32 bits.
        let first = lights.lights[i * (n / k) + i * (n % k) / k];
        clusters.lights[i] = VirtualLight(first.position, 0.0, first.normal, first.texel, vec3(0.0), ON_SURFACE);
    } else if i < settings.clusters_count {
        clusters.lights[i] = VirtualLight(vec3(0.0), 0.0, vec3(0.0, 0.0, 1.0), 0u, vec3(0.0), ON_SURFACE);
    }
    if i == 0u {
        clusters.count = k;
        clusters.pad0 = 0u;
        clusters.pad1 = 0u;
        clusters.pad2 = 0u;
        atomicStore(&changes, 0u);
        let of_lights = folded((n + GROUP - 1u) / GROUP);
        let of_clusters = folded(k);
        dispatches = array(of_lights.x, of_lights.y, 1u, of_clusters.x, of_clusters.y, 1u);
    }
}

/// Weights of the differences of positions and normals, for positions in metres.
fn weights() -> vec2<f32> {
    let scale = 1.0 / max(scene_info.extent, 1e-18);
#if METRIC == squared
    return vec2(settings.position_weight * scale * scale, settings.normal_weight);
#else
    return vec2(settings.position_weight * scale, settings.normal_weight);
#endif
}

/// Distance μ between a light and a cluster, from the differences of their positions and normals. [ACRSM Eq. 3.7]
// DEVIATION(squared): the paper's metric is `linear`, of which a mean is not the least sum.
// DEVIATION(extent): positions in units of the scene's extent, so that weights hold for scenes of any size.
fn difference(position: vec3<f32>, normal: vec3<f32>, weights: vec2<f32>) -> f32 {
#if METRIC == squared
    return weights.x * dot(position, position) + weights.y * dot(normal, normal);
#else
    let angle = 2.0 * asin(min(0.5 * length(normal), 1.0));
    return weights.x * length(position) + weights.y * angle;
#endif
}

var<workgroup> staged_positions: array<vec3<f32>, GROUP>;
var<workgroup> staged_normals: array<vec3<f32>, GROUP>;

/// One thread per light: the nearest cluster, of several the one with the lowest index.
@compute @workgroup_size(GROUP)
fn assign(row: Row) {
    let i = index_in(row, GROUP);
    let n = light_count();
    let k = cluster_count();
    let light = lights.lights[min(i, max(n, 1u) - 1u)];
    let weights = weights();
    var owner = 0u;
    var least = 3.4e38;
    for (var first = 0u; first < k; first += GROUP) {
        let own = min(first + row.local, k - 1u);
        staged_positions[row.local] = clusters.lights[own].position;
        staged_normals[row.local] = clusters.lights[own].normal;
        workgroupBarrier();
        for (var c = 0u; c < min(GROUP, k - first); c++) {
            let position = light.position - staged_positions[c];
            let distance = difference(position, light.normal - staged_normals[c], weights);
            if distance < least {
                least = distance;
                owner = first + c;
            }
        }
        workgroupBarrier();
    }
    if i < n && owners[i] != owner {
        owners[i] = owner;
        atomicAdd(&changes, 1u);
    }
}

/// Ends the iterations where no light changed its cluster.
@compute @workgroup_size(1)
fn settle() {
    if atomicLoad(&changes) == 0u {
        dispatches = array<u32, 6>();
    }
    atomicStore(&changes, 0u);
}

/// Sums over lights of a cluster.
struct Sums {
    /// Offsets from the old centre [m].
    position: vec3<f32>,
    /// The number of lights.
    count: f32,
    /// Offsets from the old normal.
    normal: vec3<f32>,
    /// [m²]
    area: f32,
    /// [W]
    flux: vec3<f32>,
}

fn both(a: Sums, b: Sums) -> Sums {
    return Sums(a.position + b.position, a.count + b.count, a.normal + b.normal, a.area + b.area, a.flux + b.flux);
}

var<workgroup> partial: array<Sums, GROUP>;

/// One workgroup per cluster: the mean of its lights that are lit, with the sums of their flux and area. A cluster without
/// any keeps its place and is dark.
@compute @workgroup_size(GROUP)
fn update(row: Row) {
    let index = group_in(row);
    let thread = row.local;
    let n = light_count();
    let old = clusters.lights[min(index, max(cluster_count(), 1u) - 1u)];
    var own = Sums();
    for (var i = thread; i < n; i += GROUP) {
        if owners[i] == index {
            let light = lights.lights[i];
            if is_lit(light) {
                let offset = light.position - old.position;
                let flux = light.flux * share_above_horizon(light);
                own = both(own, Sums(offset, 1.0, light.normal - old.normal, light.area, flux));
            }
        }
    }
    partial[thread] = own;
    workgroupBarrier();
    for (var width = GROUP / 2u; width > 0u; width /= 2u) {
        if thread < width {
            partial[thread] = both(partial[thread], partial[thread + width]);
        }
        workgroupBarrier();
    }
    if thread > 0u || index >= cluster_count() {
        return;
    }
    let sums = partial[0];
    var normal = old.normal;
    // The sum of normals; those that cancel each other leave the old one, as does a cluster of equal ones.
    let sum = sums.count * old.normal + sums.normal;
    if any(sums.normal != vec3(0.0)) && length(sum) > 1e-3 * sums.count {
        normal = normalize(sum);
    }
    let position = old.position + sums.position / max(sums.count, 1.0);
    let flux = min(sums.flux, vec3(1e37));
    clusters.lights[index] = VirtualLight(position, sums.area, normal, old.texel, flux, ON_SURFACE);
}
