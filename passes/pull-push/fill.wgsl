// Push to the finest level: the filled maps, laid out as an atlas. It is a dispatch and not a draw: processors for computing alone
// have few units that rasterise, and others store as fast as they draw. [ISM §3.2]

#option PYRAMID true internal // whether there is a level above the maps

#import "combine.wgsl"

struct Settings {
    visibility_tile: u32,
    visibility_columns: u32,
    visibility_rows: u32,
    /// The first map of the dispatch; what is bound of maps and of pyramids begins with it.
    first_map: u32,
    /// The number of maps. The atlas has room for more, where nothing is.
    maps: u32,
    /// Side of a map at level 1 [px].
    coarse_side: u32,
    push_threshold: f32,
}

var<uniform> settings: Settings;
var<storage, read> depth: array<u32>;
/// The pyramids of a window, which begin with level 1.
var<storage, read> level_1: array<f32>;
var visibility_atlas: texture_storage_2d_array<r32float, write>;

fn coarse(map: u32, x: u32, y: u32) -> f32 {
    let side = settings.coarse_side;
    let value = level_1[((map - settings.first_map) * side + y) * side + x];
    return select(NOTHING, value, max(x, y) < side);
}

/// The distance in a texel of a map.
fn filled(map: u32, texel: vec2<u32>) -> f32 {
    if map >= settings.maps {
        return NOTHING;
    }
    let side = settings.visibility_tile;
    // +∞ is a hole.
    let own = min(bitcast<f32>(depth[((map - settings.first_map) * side + texel.y) * side + texel.x]), NOTHING);
#if PYRAMID
    let threshold = settings.push_threshold * scene_info.extent;
    if is_final(own, threshold) {
        return own;
    }
    let p = parents(texel);
    let values = vec4(coarse(map, p.x, p.y), coarse(map, p.z, p.y), coarse(map, p.x, p.w), coarse(map, p.z, p.w));
    return pushed(own, values, threshold);
#else
    return own;
#endif
}

/// One thread per texel; z counts maps from the first of this dispatch.
@compute @workgroup_size(8, 8)
fn fill(@builtin(global_invocation_id) id: vec3<u32>) {
    let tile = settings.visibility_tile;
    if any(id.xy >= vec2(tile)) {
        return;
    }
    let map = settings.first_map + id.z;
    let origin = tile_origin(map, settings.visibility_columns, settings.visibility_rows, tile);
    textureStore(visibility_atlas, origin.xy + id.xy, origin.z, vec4(filled(map, id.xy)));
}
