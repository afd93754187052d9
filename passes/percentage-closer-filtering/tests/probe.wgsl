// Writes what the module of a port Visibility returns, one thread per receiver, beside what a bilinear lookup of four texels
// answers by itself.

#import "paraboloid.wgsl"
#import "paraboloid-lookup.wgsl"
#import interface "visibility"

struct Settings {
    visibility_tile: u32,
    visibility_depth_bias: f32,
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
    let lookup = paraboloid_lookup(light, at, normal, tile, settings.visibility_depth_bias);
    if lookup.behind {
        return 0.0;
    }
    let origin = tile_origin(index, 1u, 1u, tile);
    let last = vec2(f32(tile - 1u));
    let corner = floor(lookup.position - 0.5);
    let weight = lookup.position - 0.5 - corner;
    let low = origin.xy + vec2<u32>(clamp(corner, vec2(0.0), last));
    let high = origin.xy + vec2<u32>(clamp(corner + 1.0, vec2(0.0), last));
    let stored = vec4(
        textureLoad(visibility_atlas, low, origin.z, 0).x,
        textureLoad(visibility_atlas, vec2(high.x, low.y), origin.z, 0).x,
        textureLoad(visibility_atlas, vec2(low.x, high.y), origin.z, 0).x,
        textureLoad(visibility_atlas, high, origin.z, 0).x,
    );
    let seen = select(vec4(0.0), vec4(1.0), vec4(lookup.nearest) <= stored);
    let rows = mix(seen.xz, seen.yw, weight.x);
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
    );
    answers[id.x] = vec4(
        visibility(receiver.light, light, receiver.position, receiver.normal),
        bilinear(receiver.light, light, receiver.position, receiver.normal),
        lookup.position,
    );
}
