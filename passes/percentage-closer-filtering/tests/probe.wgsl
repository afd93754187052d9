// Writes what the module of a port Visibility returns, one thread per receiver, beside what a bilinear lookup of four texels
// answers by itself.

#import "paraboloid.wgsl"
#import "paraboloid-lookup.wgsl"
#import interface "visibility"

struct Settings {
    visibility_tile: u32,
    visibility_depth_bias: f32,
    visibility_slope_bias: f32,
}

struct Receiver {
    position: vec3<f32>,
    light: u32,
    normal: vec3<f32>,
    pad: f32,
}

var<uniform> settings: Settings;
var<storage, read> receivers: array<Receiver>;
var<storage, read> lights: VirtualLights;
var<storage, read_write> answers: array<vec4<f32>>;

/// The four nearest texels, weighted after the test, of an atlas with one map a layer.
fn bilinear(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let tile = settings.visibility_tile;
    let lookup = paraboloid_lookup(light, at, normal, tile, settings.visibility_depth_bias, settings.visibility_slope_bias);
    if lookup.behind {
        return 0.0;
    }
    let origin = tile_origin(index, 1u, 1u, tile);
    let last = vec2(f32(tile - 1u));
    let corner = floor(lookup.position - 0.5);
    let weight = lookup.position - 0.5 - corner;
    let low = vec2<u32>(clamp(corner, vec2(0.0), last));
    let high = vec2<u32>(clamp(corner + 1.0, vec2(0.0), last));
    var seen = array<f32, 4>();
    for (var i = 0u; i < 4u; i++) {
        let texel = select(low, high, vec2(i % 2u, i / 2u) == vec2(1u));
        let stored = textureLoad(visibility_atlas, origin.xy + texel, origin.z, 0).x;
        seen[i] = select(0.0, 1.0, is_seen(lookup, texel, tile, stored));
    }
    let rows = mix(vec2(seen[0], seen[2]), vec2(seen[1], seen[3]), weight.x);
    return mix(rows.x, rows.y, weight.y);
}

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&answers) {
        return;
    }
    let receiver = receivers[id.x];
    let light = lights.lights[receiver.light];
    let lookup = paraboloid_lookup(
        light,
        receiver.position,
        receiver.normal,
        settings.visibility_tile,
        settings.visibility_depth_bias,
        settings.visibility_slope_bias,
    );
    answers[id.x] = vec4(
        visibility(receiver.light, light, receiver.position, receiver.normal),
        bilinear(receiver.light, light, receiver.position, receiver.normal),
        lookup.position,
    );
}
