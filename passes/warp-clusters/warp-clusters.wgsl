// Warps the seeds of clusters to where a reflective shadow map is important. [ACRSM §4.5, Alg. 5.3]
//
// Each part of the map gets as many seeds as its share of the importance (hierarchical warping, Clarberg et al. 2005). They
// descend a pyramid of sums of importance over squares of texels, each twice as wide as those of the finer level. A level has as
// few squares as cover the map: what would lie beyond its edges is 0. Sums are `Scaled`, and not f32: the sum of 512² texels of
// 1e34 leaves the range of f32.

#input clusters: Clusters // Clusters, of which some are seeds or were placed by a split.
#input rsm: ReflectiveShadowMap // The texels that clusters consist of.
#input importance: Importance like rsm // What the number of seeds at a texel is proportional to.
#output warped: Clusters(count: clusters.count) // The same, with seeds at texels and what lies there.

#import "algorithms/scaled.wgsl"
#import "clusters.wgsl"
#import "dispatch.wgsl"
#import "random.wgsl"
#import interface "importance"

struct Settings {
    clusters_count: u32,
    /// The level that is summed, 1 or more; of `warp`, the level of one square.
    level: u32,
    /// Levels of the pyramid that a seed descends from the whole map; 0 is all, down to a texel. Within a square of the last of
    /// them seeds stay as even as they are. Fewer: seeds follow the importance less closely, and may fall to texels without any.
    /// [default: 0, min: 0, max: 15]
    levels: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read> clusters: Clusters;
var rsm_position: texture_2d_array<f32>;
var rsm_normal: texture_2d_array<f32>;
var rsm_flux: texture_2d_array<f32>;
/// The sums, level by level.
var<storage, read_write> pyramid: array<Scaled>;
var<storage, read_write> warped: Clusters;

/// Returns columns and rows of a level; level 0 is the texels.
fn size_at(level: u32) -> vec2<u32> {
    return (textureDimensions(rsm_position) + (1u << level) - 1u) >> vec2(level);
}

/// Returns the place in `pyramid` of the first sum of a level ≥ 1. Sums of texels are not stored: they are their importance.
fn begin_of(level: u32) -> u32 {
    var begin = 0u;
    for (var finer = 1u; finer < level; finer++) {
        let size = size_at(finer);
        begin += size.x * size.y * textureNumLayers(rsm_position);
    }
    return begin;
}

fn place_of(level: u32, layer: u32, square: vec2<u32>) -> u32 {
    let size = size_at(level);
    return begin_of(level) + (layer * size.y + square.y) * size.x + square.x;
}

/// Returns the importance of a texel; NaN and what is negative count as 0.
fn importance_of_texel(layer: u32, texel: vec2<u32>) -> f32 {
    // DEVIATION(unlit): at a texel that the light does not reach, there is nothing to sample.
    if textureLoad(rsm_position, texel, layer, 0).w == 0.0 {
        return 0.0;
    }
    return weight_of(importance(layer, texel));
}

/// Returns the sum over a square of any level; 0 beyond the edges.
fn sum_at(level: u32, layer: u32, square: vec2<u32>) -> Scaled {
    if any(square >= size_at(level)) {
        return Scaled(0.0, 0);
    }
    if level == 0u {
        return scaled_weight(importance_of_texel(layer, square));
    }
    return pyramid[place_of(level, layer, square)];
}

/// Sums the squares of a level from those of the finer one: a thread for each, where z is the layer.
@compute @workgroup_size(8, 8)
fn sum(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= size_at(settings.level)) {
        return;
    }
    let finer = settings.level - 1u;
    let first = 2u * id.xy;
    pyramid[place_of(settings.level, id.z, id.xy)] = add_scaled(
        add_scaled(sum_at(finer, id.z, first), sum_at(finer, id.z, first + vec2(1u, 0u))),
        add_scaled(sum_at(finer, id.z, first + vec2(0u, 1u)), sum_at(finer, id.z, first + vec2(1u))),
    );
}

/// Less than 1, as random numbers are.
const GREATEST: f32 = 0.99999994;

struct Choice {
    index: u32,
    /// Where the number lies in the part of [0, 1) that chooses this, itself in [0, 1): as even as the number was.
    rest: f32,
}

/// Chooses one of two by a number in [0, 1), in proportion to their sums, which are not both 0.
fn choose(number: f32, first: Scaled, second: Scaled) -> Choice {
    let unit = max(magnitude(first), magnitude(second));
    let widths = vec2(in_units(first, unit), in_units(second, unit));
    let sought = number * (widths.x + widths.y);
    // What has no width is never chosen, however the sum is rounded.
    if widths.y == 0.0 || sought < widths.x {
        return Choice(0u, min(sought / widths.x, GREATEST));
    }
    return Choice(1u, clamp((sought - widths.x) / widths.y, 0.0, GREATEST));
}

/// Chooses a layer in the same way; each alike if all sums are 0.
// DEVIATION(layers): the paper has one map; here each light has layers, and they are chosen before rows and columns.
fn choose_layer(number: f32) -> Choice {
    let layers = textureNumLayers(rsm_position);
    var unit = NO_MAGNITUDE;
    for (var layer = 0u; layer < layers; layer++) {
        unit = max(unit, magnitude(sum_at(settings.level, layer, vec2(0u))));
    }
    if unit == NO_MAGNITUDE {
        let at = number * f32(layers);
        let layer = min(u32(at), layers - 1u);
        return Choice(layer, min(at - f32(layer), GREATEST));
    }
    var total = 0.0;
    for (var layer = 0u; layer < layers; layer++) {
        total += in_units(sum_at(settings.level, layer, vec2(0u)), unit);
    }
    // The product can round up to the total; below it, a layer is found, and it has a width.
    let sought = min(number * total, bitcast<f32>(bitcast<u32>(total) - 1u));
    var layer = 0u;
    var width = in_units(sum_at(settings.level, layer, vec2(0u)), unit);
    var before = 0.0;
    while before + width <= sought {
        before += width;
        layer++;
        width = in_units(sum_at(settings.level, layer, vec2(0u)), unit);
    }
    return Choice(layer, clamp((sought - before) / width, 0.0, GREATEST));
}

struct Place {
    layer: u32,
    /// [texels]
    uv: vec2<f32>,
}

/// The greatest number below one that is positive.
fn just_below(x: vec2<f32>) -> vec2<f32> {
    return bitcast<vec2<f32>>(bitcast<vec2<u32>>(x) - 1u);
}

/// Where a seed goes.
fn warp_seed(seed: vec2<f32>) -> Place {
    let chosen = choose_layer(seed.x);
    let layer = chosen.index;
    var rest = vec2(chosen.rest, seed.y);
    var square = vec2(0u);
    var level = settings.level;
    let bottom = select(level - min(settings.levels, level), 0u, settings.levels == 0u);
    // Without importance the square stays the whole layer, and the seed where it is.
    if magnitude(sum_at(level, layer, square)) != NO_MAGNITUDE {
        while level > bottom {
            level--;
            square *= 2u;
            // DEVIATION(descent): Algorithm 5.3 leaves ρ_q out of its percentages, and adds the place within a quadrant to
            // the seed and not to the quadrant's corner. This is what its sources do: of two rows one is chosen, then of the
            // row's two columns, and the rest of each number is spread over what was chosen.
            var left = sum_at(level, layer, square);
            var right = sum_at(level, layer, square + vec2(1u, 0u));
            let upper = add_scaled(left, right);
            let lower_left = sum_at(level, layer, square + vec2(0u, 1u));
            let lower_right = sum_at(level, layer, square + vec2(1u));
            let row = choose(rest.y, upper, add_scaled(lower_left, lower_right));
            if row.index == 1u {
                left = lower_left;
                right = lower_right;
            }
            let column = choose(rest.x, left, right);
            square += vec2(column.index, row.index);
            rest = vec2(column.rest, row.rest);
        }
    }
    let corner = square << vec2(level);
    // Squares at the edges reach beyond them.
    let size = min(vec2(1u << level), size_at(0u) - corner);
    let uv = vec2<f32>(corner) + rest * vec2<f32>(size);
    return Place(layer, min(uv, just_below(vec2<f32>(corner + size))));
}

fn is_lit(place: Place) -> bool {
    let texel = vec2<u32>(place.uv);
    let normal = textureLoad(rsm_normal, texel, place.layer, 0).xyz;
    return textureLoad(rsm_position, texel, place.layer, 0).w != 0.0 && dot(normal, normal) > 0.0;
}

/// A cluster that is nowhere.
fn waiting(generation: u32) -> Cluster {
    var cluster: Cluster;
    cluster.texel = NO_TEXEL;
    cluster.generation = generation;
    cluster.state = CLUSTER_TO_SEED;
    return cluster;
}

/// The cluster at a place, with what the map has there. Of an unlit texel there is nothing to be had: it waits to be seeded.
fn cluster_at(place: Place, generation: u32) -> Cluster {
    var cluster = waiting(generation);
    if !is_lit(place) {
        return cluster;
    }
    let texel = vec2<u32>(place.uv);
    let size = size_at(0u);
    cluster.position = textureLoad(rsm_position, texel, place.layer, 0).xyz;
    cluster.normal = normalize(textureLoad(rsm_normal, texel, place.layer, 0).xyz);
    cluster.flux = textureLoad(rsm_flux, texel, place.layer, 0).rgb;
    cluster.centre_flux = cluster.flux;
    cluster.texel = (place.layer * size.y + texel.y) * size.x + texel.x;
    cluster.uv = place.uv;
    cluster.layer = place.layer;
    cluster.state = CLUSTER_ALIVE;
    return cluster;
}

/// The cluster where a split has placed it, within the map; where its seed goes if nothing is lit there.
fn placed(index: u32, cluster: Cluster) -> Cluster {
    let uv = clamp(cluster.uv, vec2(0.0), just_below(vec2<f32>(size_at(0u))));
    let place = Place(min(cluster.layer, textureNumLayers(rsm_position) - 1u), uv);
    if is_lit(place) {
        return cluster_at(place, cluster.generation);
    }
    // Its own next element, as in `seed-clusters`: not a next one of all, which would depend on the order of threads.
    let element = settings.clusters_count * cluster.generation + index + 1u;
    return cluster_at(warp_seed(halton3(element, settings.seed).xy), cluster.generation + 1u);
}

@compute @workgroup_size(64)
fn warp(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.clusters_count {
        return;
    }
    var cluster = clusters.clusters[index];
    if cluster.state == CLUSTER_SEEDED {
        cluster = cluster_at(warp_seed(cluster.uv), cluster.generation);
    } else if cluster.state == CLUSTER_PLACED {
        cluster = placed(index, cluster);
    }
    warped.clusters[index] = cluster;
    if index == 0u {
        warped.header = clusters.header;
    }
}
