// Samples virtual lights in proportion to an importance map by the inverse transform method. [TCAS §4.2, Fig. 2]
//
// Each light finds its texel in sums of the importance by three binary searches. In a picture that is a mean over frames, the numbers of
// each frame go on where those of the frame before end.

#input rsm: ReflectiveShadowMap // The texels to sample.
#input sums: ImportanceSums like rsm // Sums of what the probability of a texel is proportional to.
#output lights: VirtualLights(count: settings.count) // N lights; none where the importance is 0 everywhere.
#exact lights: instead trace-photons(count: settings.count, bounces: 1, albedo: 'textured') // Photons, where they meet surfaces.

#option LOBES false // Whether the lights say what their surfaces reflect specularly, for `gather-glossy`; where the scene is glossy.
#option RSM_SPECULAR false // whether the map has the member `specular`

#import "cumulative-choice.wgsl"
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
    /// Random numbers per light. 3: layer, row and column have one each. 2: the number that picks the layer is
    /// renormalised and picks the row too (Shirley & Wang 1991); flicker between frames is higher (TCAS Fig. 8).
    /// [default: 3, one_of: [3, 2]]
    dimensions: u32,
    seed: u32,
    sample: u32,
}

var<uniform> settings: Settings;
var sums_rows: texture_2d_array<f32>;
var<storage, read> sums_totals: array<f32>;
var<storage, read_write> lights: VirtualLights;
#if LOBES && RSM_SPECULAR
var<storage, read_write> lights_lobes: array<VirtualLobe>;
#endif

struct Distribution {
    /// LAYERS, ROWS or COLUMNS.
    stage: u32,
    layer: u32,
    row: u32,
}

const LAYERS: u32 = 0u;
const ROWS: u32 = 1u;
const COLUMNS: u32 = 2u;

/// Entry i of a cumulative distribution: of the layers, of a layer's rows, or of a row's columns.
fn cumulated(which: Distribution, i: u32) -> f32 {
    let height = textureDimensions(sums_rows).y;
    if which.stage == LAYERS {
        return sums_totals[textureNumLayers(sums_rows) * height + i];
    }
    if which.stage == ROWS {
        return sums_totals[which.layer * height + i];
    }
    return textureLoad(sums_rows, vec2(i, which.row), which.layer, 0).r;
}

@compute @workgroup_size(64)
fn draw(thread: Row) {
    let light = index_in(thread, 64u);
    if light >= settings.count {
        return;
    }
    let size = textureDimensions(sums_rows);
    let layers = textureNumLayers(sums_rows);
    let none = cumulated(Distribution(LAYERS, 0u, 0u), layers - 1u) == 0.0;
    if light == 0u {
        lights.count = select(settings.count, 0u, none);
    }
    if none {
        lights.lights[light] = dark_light(0u);
#if LOBES && RSM_SPECULAR
        lights_lobes[light] = no_lobe();
#endif
        return;
    }
    let numbers = halton3(element_of_sample(light, settings.count, settings.sample) + 1u, settings.seed);
    let two = settings.dimensions == 2u;
    // DEVIATION(least-probability): choose bounds it from below.
    let layer = choose(Distribution(LAYERS, 0u, 0u), layers, numbers.x);
    let row = choose(Distribution(ROWS, layer.index, 0u), size.y, select(numbers.y, layer.rest, two));
    let column = choose(Distribution(COLUMNS, layer.index, row.index), size.x, select(numbers.z, numbers.y, two));
    let p = layer.probability * row.probability * column.probability;
    let weight = 1.0 / (f32(settings.count) * p);
    lights.lights[light] = virtual_light_from_texel(layer.index, column.index, row.index, weight);
#if LOBES && RSM_SPECULAR
    let lobe = lobe_from_texel(layer.index, column.index, row.index, weight);
    lights.lights[light] = with_lobe(lights.lights[light], lobe);
    lights_lobes[light] = lobe;
#endif
}
