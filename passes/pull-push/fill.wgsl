// Push to the finest level: the filled maps, laid out as an atlas. It is a draw and not a dispatch: rasterisers write
// images faster than storage textures are written, several times so on a CPU. [ISM §3.2]

#option PYRAMID true // whether there is a level above the maps

#import "combine.wgsl"

struct Settings {
    visibility_size: vec2<u32>,
    visibility_tile: u32,
    visibility_columns: u32,
    visibility_rows: u32,
    /// The first map that is drawn, and the first that is bound.
    first_map: u32,
    first_bound: u32,
    /// Side of a map at level 1 [px].
    coarse_side: u32,
    push_threshold: f32,
}

var<uniform> settings: Settings;
var<storage, read> depth: array<u32>;
/// The pyramid, which begins with level 1.
var<storage, read> level_1: array<f32>;

struct Tile {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) map: u32,
    /// First texel of the map.
    @location(1) @interpolate(flat) origin: vec2<u32>,
}

/// Two triangles per map.
@vertex
fn cover(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Tile {
    let map = settings.first_map + instance;
    // Bit v of each constant is the coordinate of vertex v, in two triangles that share a diagonal.
    let corner = (vec2(0x32u, 0x2cu) >> vec2(vertex)) & vec2(1u);
    let tile = settings.visibility_tile;
    let origin = tile_origin(map, settings.visibility_columns, settings.visibility_rows, tile).xy;
    let at = vec2<f32>(origin + corner * tile) / vec2<f32>(settings.visibility_size);
    return Tile(vec4(at * vec2(2.0, -2.0) + vec2(-1.0, 1.0), 0.0, 1.0), map, origin);
}

fn coarse(map: u32, x: u32, y: u32) -> f32 {
    let side = settings.coarse_side;
    let value = level_1[(map * side + y) * side + x];
    return select(NOTHING, value, max(x, y) < side);
}

@fragment
fn fill(in: Tile) -> @location(0) f32 {
    let texel = vec2<u32>(in.position.xy) - in.origin;
    let side = settings.visibility_tile;
    // +∞ is a hole.
    let own = min(bitcast<f32>(depth[((in.map - settings.first_bound) * side + texel.y) * side + texel.x]), NOTHING);
#if PYRAMID
    let threshold = settings.push_threshold * scene_info.extent;
    if is_final(own, threshold) {
        return own;
    }
    let p = parents(texel);
    let values = vec4(
        coarse(in.map, p.x, p.y),
        coarse(in.map, p.z, p.y),
        coarse(in.map, p.x, p.w),
        coarse(in.map, p.z, p.w),
    );
    return pushed(own, values, threshold);
#else
    return own;
#endif
}
