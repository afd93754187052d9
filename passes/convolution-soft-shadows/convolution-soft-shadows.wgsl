// Softens shadow-map lookups by prefiltered images of a series of the depth test. [Annen et al. 2007, 2008; ACRSM §3.1.2,
// §3.2.5]
//
// The basis images of an atlas of distance maps are made level by level: each texel is the mean over those that it covers of
// its own map. [ACRSM Eq. 3.3-3.5]
//
// A lookup takes an iteration for each pair of terms: the search loads two pairs of each order, and so does the kernel.

#input maps: Visibility with atlas without basis // An atlas of depth maps.
#output visibility: Visibility(
    count: maps.columns * maps.rows * maps.layers * map_words,
    tile: maps.tile,
    columns: maps.columns,
    rows: maps.rows,
    depth_bias: maps.depth_bias,
    slope_bias: maps.slope_bias,
    order: settings.order,
    levels: map_levels,
    attenuation: settings.attenuation,
    offset: settings.offset,
    search: settings.search,
    nearest: settings.nearest,
    stride: map_words,
    iterations: 2 * settings.order * (settings.search + 1),
) hands on maps module "lookup.wgsl" // The same atlas, with its basis images and soft lookups.
#exact maps: pass visibility-ray-traced // A ray for each light and pixel.

#import "basis.wgsl"
#import "paraboloid.wgsl"

struct Settings {
    /// Orders M of the expansion. More: nearer blockers and receivers are distinguished, but memory and time grow in
    /// proportion. Annen et al. 2007 have 4 to 16. [default: 4, min: 1, max: 16]
    order: u32,
    /// The most levels above the maps, up to the one that has a single texel. Fewer: less wide penumbrae, but hardly
    /// less memory; 0 looks up four texels of the maps alone. [default: 13, min: 0, max: 13]
    levels: u32,
    /// The attenuation of high orders: a_k = exp(-attenuation ((2k - 1) / (2M))²). Smaller: the expansion rings, by
    /// 9 % at 0 and by 1 % at 1.5. Larger: its step is wider, so that light leaks in near blockers. [default: 1.5, min: 0.0,
    /// max: 4.0]
    attenuation: f32,
    /// The bias of the comparison towards the light, in depths of 1 / M. Smaller: surfaces shadow themselves. Larger:
    /// blockers near the receiver are found less. [default: 0.6, min: 0.0, max: 0.9]
    offset: f32,
    /// Searches for blockers, of which each narrows the region to the penumbra that the one before found. More: walls
    /// beside the receiver darken it less. [default: 2, min: 1, max: 8]
    search: u32,
    /// Least height of a blocker above the light's plane that is looked for, as a share of the receiver's. It bounds the
    /// region of the search and the penumbra, to (1 - n) / n of the light's radius. Smaller: wider penumbrae of
    /// blockers near the light; but more blockers are found that hide nothing. [default: 0.5, min: 0.01, max: 1.0]
    nearest: f32,
    maps_tile: u32,
    maps_columns: u32,
    maps_rows: u32,
    /// Words of a map.
    visibility_stride: u32,
    /// The level that is made.
    level: u32,
}

var<uniform> settings: Settings;
var maps_atlas: texture_2d_array<f32>;
var<storage, read_write> visibility_basis: array<u32>;

/// Height above the light's plane [m] of what a map stores.
fn stored_height(map: u32, texel: vec2<u32>) -> f32 {
    let tile = settings.maps_tile;
    let origin = tile_origin(map, settings.maps_columns, settings.maps_rows, tile);
    let distance = textureLoad(maps_atlas, origin.xy + texel, origin.z, 0).x;
    let centre = texel_centre(texel, tile);
    let r2 = dot(centre, centre);
    return select(NOTHING, distance * max(1.0 - r2, 0.0) / (1.0 + r2), distance < NOTHING);
}

/// The texel that stands for one below the horizon, where a map holds nothing: its mirror image above, and a texel further
/// in, so that its centre is above too.
// DEVIATION(mirror): the paper's maps are full.
fn above_rim(texel: vec2<u32>) -> vec2<u32> {
    let tile = settings.maps_tile;
    let centre = texel_centre(texel, tile);
    let r2 = dot(centre, centre);
    let mirrored = vec2<u32>(tile_position(centre * ((1.0 - 2.0 / f32(tile)) / max(r2, 1.0)), tile));
    return select(texel, mirrored, r2 > 1.0);
}

var<workgroup> farthest: array<f32, 64>;

/// The greatest height in each map. One workgroup a map.
@compute @workgroup_size(64)
fn measure(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let tile = settings.maps_tile;
    var far = 0.0;
    for (var i = thread; i < tile * tile; i += 64u) {
        let height = stored_height(group.z, vec2(i % tile, i / tile));
        far = select(far, max(far, height), height < NOTHING);
    }
    farthest[thread] = far;
    for (var half = 32u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if thread < half {
            farthest[thread] = max(farthest[thread], farthest[thread + half]);
        }
    }
    if thread == 0u {
        visibility_basis[group.z * settings.visibility_stride] = bitcast<u32>(farthest[0]);
    }
}

/// Where a texel of a level is.
fn index_of(map: u32, level: u32, texel: vec2<u32>) -> u32 {
    let side = level_side(settings.maps_tile, level);
    let begin = level_begin(settings.maps_tile, level, settings.order);
    return map * settings.visibility_stride + begin + (texel.y * side + texel.x) * texel_words(settings.order);
}

/// Level 1 from the maps. z is the map.
@compute @workgroup_size(8, 8)
fn transform(@builtin(global_invocation_id) id: vec3<u32>) {
    let tile = settings.maps_tile;
    if any(id.xy >= vec2(level_side(tile, 1u))) {
        return;
    }
    let far = bitcast<f32>(visibility_basis[id.z * settings.visibility_stride]);
    let corner = 2u * id.xy;
    let covered = min(vec2(2u), tile - corner);
    let texels = covered.x * covered.y;
    let share = 1.0 / f32(texels);
    var depths: array<f32, 4>;
    var turns: array<vec2<f32>, 4>;
    var steps: array<vec2<f32>, 4>;
    for (var i = 0u; i < texels; i++) {
        let texel = corner + vec2(i % covered.x, i / covered.x);
        let height = stored_height(id.z, above_rim(texel));
        depths[i] = depth_of_height(height, far, greatest_depth(settings.order, settings.offset));
        turns[i] = first_order(depths[i]);
        steps[i] = turned(turns[i], turns[i]);
    }
    let first = index_of(id.z, 1u, id.xy);
    let order = settings.order;
    for (var k = 0u; k < order; k++) {
        var plain = vec2(0.0);
        var weighted = vec2(0.0);
        for (var i = 0u; i < texels; i++) {
            plain += share * turns[i].yx;
            weighted += share * depths[i] * turns[i].yx;
            turns[i] = turned(turns[i], steps[i]);
        }
        visibility_basis[first + k] = pack2x16snorm(plain);
        visibility_basis[first + order + k] = pack2x16snorm(weighted);
    }
    visibility_basis[first + 2u * order] = bitcast<u32>(share * (depths[0] + depths[1] + depths[2] + depths[3]));
}

/// A level from the finer one. z is the map.
@compute @workgroup_size(8, 8)
fn halve(@builtin(global_invocation_id) id: vec3<u32>) {
    let level = settings.level;
    let tile = settings.maps_tile;
    if any(id.xy >= vec2(level_side(tile, level))) {
        return;
    }
    let corner = 2u * id.xy;
    let fine = level_side(tile, level - 1u);
    let covered = min(vec2(2u), fine - corner);
    // At the far edges, texels cover less of the map.
    let begin = corner << vec2(level - 1u);
    let middle = min(begin + (1u << (level - 1u)), vec2(tile));
    let near = vec2<f32>(middle - begin);
    let both = vec2<f32>(min(begin + (1u << level), vec2(tile)) - begin);
    let far_share = vec2(1.0) - near / both;
    let into = index_of(id.z, level, id.xy);
    let means = 2u * settings.order;
    var mean = 0.0;
    for (var word = 0u; word <= means; word++) {
        var sum = vec2(0.0);
        for (var i = 0u; i < covered.x * covered.y; i++) {
            let at = vec2(i % covered.x, i / covered.x);
            let shares = select(far_share, near / both, at == vec2(0u));
            let bits = visibility_basis[index_of(id.z, level - 1u, corner + at) + word];
            if word == means {
                mean += shares.x * shares.y * bitcast<f32>(bits);
            } else {
                sum += shares.x * shares.y * unpack2x16snorm(bits);
            }
        }
        visibility_basis[into + word] = select(pack2x16snorm(sum), bitcast<u32>(mean), word == means);
    }
}
