// Virtual lights sampled uniformly over all texels of all layers, with the same Halton sequence in every frame:
// the uniform sampling of TCAS §6.2.

#import "dispatch.wgsl"
#import "random.wgsl"
#import "rsm-light.wgsl"

struct Settings {
    count: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read_write> lights: VirtualLights;

@compute @workgroup_size(64)
fn sample(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let light = row_index(group, groups, local, 64u);
    if light >= settings.count {
        return;
    }
    if light == 0u {
        lights.count = settings.count;
    }
    let size = vec3(textureNumLayers(rsm_flux), textureDimensions(rsm_flux));
    // The product with a number below 1 can round up to the size itself.
    let texel = min(vec3<u32>(halton3(light + 1u, settings.seed) * vec3<f32>(size)), size - 1u);
    // Φ = flux / (N p) with p = 1 / texels.
    let weight = f32(size.x) * f32(size.y) * f32(size.z) / f32(settings.count);
    lights.lights[light] = virtual_light_from_texel(texel.x, texel.y, texel.z, weight);
}
