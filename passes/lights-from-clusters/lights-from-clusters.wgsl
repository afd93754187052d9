// Makes a virtual light of each cluster of texels of a reflective shadow map. [ACRSM §4.3, §5.3.3]
//
// All of them together have the flux of the map.

#input clusters: Clusters // The clusters, averaged.
#input rsm: ReflectiveShadowMap optional // Its texels, for lights at the place of one.
#output lights: VirtualLights(count: clusters.count) // A light per cluster, dark without texels.
#exact lights: instead trace-photons(count: 1024, bounces: 1, albedo: 'textured') // Photons, where they meet surfaces.

#option AREA true // Whether lights have the area of their clusters, by which `gather` bounds what is near; otherwise they are points.
#option ENERGY texels one_of [texels, centre] // The source of the flux of a light, before all are scaled to the flux of the map. texels: that of all its texels. centre: that of the texel at its centre, as many times as it has texels (ACRSM §4.7); where albedo is textured, a light then has the color of one place.
#option PLACE mean one_of [mean, texel] // The position of a light. mean: at the mean of its texels (ACRSM §4.7), which lies within or before the surfaces where a cluster goes around an edge. texel: on a surface, at the texel that is nearest to the mean place in the map.

#option NORMAL_MAPPED false // whether any material of the scene has a normal map

#import "algorithms/sum-vec4.wgsl"
#import "cluster-count.wgsl"
#import "clustering.wgsl"
#import "rsm-light.wgsl"

/// The flux of all lights before they are scaled [W]. [scratch]
var<storage, read_write> unscaled: vec4<f32>;
var<storage, read_write> lights: VirtualLights;

/// The flux of a light before it is scaled.
fn unscaled_flux(cluster: Cluster) -> vec3<f32> {
    if cluster.texels == 0u {
        return vec3(0.0);
    }
#if ENERGY == centre
    return flux_of(cluster.centre_flux * f32(cluster.texels));
#else
    return flux_of(cluster.flux);
#endif
}

fn reduce_length() -> u32 {
    return cluster_count();
}

fn reduce_element(i: u32) -> vec4<f32> {
    return vec4(unscaled_flux(clusters.clusters[i]), 0.0);
}

fn reduce_store(result: vec4<f32>) {
    unscaled = result;
}

/// The scale of a channel of all lights; 0 where none of them has any of it.
fn scale_of(whole: f32, of_lights: f32) -> f32 {
    if of_lights > 0.0 {
        return whole / of_lights;
    }
    return 0.0;
}

@compute @workgroup_size(64)
fn make_lights(row: Row) {
    let i = index_in(row, 64u);
    let count = arrayLength(&lights.lights);
    if i == 0u {
        lights.count = count;
        lights.pad0 = 0u;
        lights.pad1 = 0u;
        lights.pad2 = 0u;
    }
    if i >= count {
        return;
    }
    var cluster: Cluster;
    if i < cluster_count() {
        cluster = clusters.clusters[i];
    }
    if cluster.texels == 0u {
        lights.lights[i] = dark_light(NO_TEXEL);
        return;
    }
    let whole = flux_of(clusters.header.map_flux);
    let sum = unscaled;
    // DEVIATION(scale): the texels that no cluster took shine too.
    let scale = vec3(scale_of(whole.r, sum.r), scale_of(whole.g, sum.g), scale_of(whole.b, sum.b));
    // Sums near the end of the range of f32 give infinite scales.
    let flux = min(flux_of(unscaled_flux(cluster) * scale), vec3(1e37));
#if AREA
    let area = weight_of(cluster.area);
#else
    let area = 0.0;
#endif
#if PLACE == texel
    let size = textureDimensions(rsm_position);
    let texel = vec2(cluster.texel % size.x, cluster.texel / size.x % size.y);
    let position = textureLoad(rsm_position, texel, cluster.layer, 0).xyz;
#else
    let position = cluster.position;
#endif
    var light = VirtualLight(position, area, cluster.normal, cluster.texel, flux, ON_SURFACE);
#if NORMAL_MAPPED
    light.kind = kind_of_bend(light.normal, cluster.bend);
    // Texels have the flux that leaves above their horizons.
    light.flux = min(light.flux / max(share_above_horizon(light), 1e-3), vec3(1e37));
#endif
    lights.lights[i] = light;
}
