// Means over blocks of 8×8 texels, one thread per block; blocks at the far edges may be smaller.

var irradiance: texture_2d<f32>;
var means: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn mean(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(means)) {
        return;
    }
    let begin = id.xy * 8u;
    let end = min(begin + 8u, textureDimensions(irradiance));
    var sum = vec4(0.0);
    for (var y = begin.y; y < end.y; y++) {
        for (var x = begin.x; x < end.x; x++) {
            sum += textureLoad(irradiance, vec2(x, y), 0);
        }
    }
    let texels = (end - begin).x * (end - begin).y;
    textureStore(means, id.xy, sum / f32(max(texels, 1u)));
}
