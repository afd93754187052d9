// Clears the maps that are to be rendered again.

#import "paraboloid.wgsl"

struct Settings {
    visibility_size: vec2<u32>,
    visibility_tile: u32,
    visibility_columns: u32,
    visibility_rows: u32,
    layer: u32,
}

var<uniform> settings: Settings;
var<storage, read> moved: array<u32>;
var<storage, read> begins: array<u32>;

/// Two triangles for each map.
@vertex
fn square(@builtin(vertex_index) vertex: u32, @builtin(instance_index) map: u32) -> @builtin(position) vec4<f32> {
    let tile = settings.visibility_tile;
    let index = moved[begins[settings.layer] + map];
    let origin = tile_origin(index, settings.visibility_columns, settings.visibility_rows, tile).xy;
    // 0 1 2, 2 1 3: bit 0 is right, bit 1 is down.
    let corner = select(vertex, select(vertex - 2u, 5u - vertex, vertex < 5u), vertex >= 3u);
    let at = vec2<f32>(origin + tile * vec2(corner & 1u, corner >> 1u));
    return vec4(vec2(2.0, -2.0) * at / vec2<f32>(settings.visibility_size) + vec2(-1.0, 1.0), 0.0, 1.0);
}

@fragment
fn nothing() -> @location(0) f32 {
    return NOTHING;
}
