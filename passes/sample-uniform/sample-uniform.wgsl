// Samples virtual lights uniformly from the texels of a reflective shadow map. [TCAS §6.2]
//
// All texels of all layers are equally likely; every frame takes the same Halton sequence.

#input rsm: ReflectiveShadowMap // The texels to sample.
#output lights: VirtualLights(count: settings.count) // N lights; those from empty texels are dark.
#exact lights: instead trace-photons(count: settings.count, bounces: 1, albedo: 'textured') // Photons, where they meet surfaces.

#option LOBES false // Whether the lights say what their surfaces reflect specularly, for `gather-glossy`; where the scene is glossy.
#option RSM_SPECULAR false // whether the map has the member `specular`

#import "dispatch.wgsl"
#import "random.wgsl"
#import "rsm-light.wgsl"
#if LOBES && RSM_SPECULAR
#import "rsm-lobe.wgsl"
#endif

struct Settings {
    /// Number N of virtual lights. Error falls as N^-½; the time for shadows and gathering rises with N. [default: 1024,
    /// min: 1, max: 2097152]
    count: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read_write> lights: VirtualLights;
#if LOBES && RSM_SPECULAR
var<storage, read_write> lights_lobes: array<VirtualLobe>;
#endif

@compute @workgroup_size(64)
fn sample(row: Row) {
    let light = index_in(row, 64u);
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
#if LOBES && RSM_SPECULAR
    let lobe = lobe_from_texel(texel.x, texel.y, texel.z, weight);
    lights.lights[light] = with_lobe(lights.lights[light], lobe);
    lights_lobes[light] = lobe;
#endif
}
