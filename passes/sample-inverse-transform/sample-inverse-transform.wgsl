// Samples virtual lights in proportion to an importance map by the inverse transform method. [TCAS §4.2, Fig. 2]
//
// cumulate.wgsl sums the importance; each light finds its texel in the sums by three binary searches.

#input rsm: ReflectiveShadowMap // The texels to sample.
#input importance: Importance like rsm // What the probability of a texel is proportional to.
#output lights: VirtualLights(count: settings.count) // N lights; none where the importance is 0 everywhere.

#import "dispatch.wgsl"
#import "random.wgsl"
#import "rsm-light.wgsl"

struct Settings {
    /// Number N of virtual lights. Error falls as N^-½; the time for shadows and gathering rises with N. [default: 1024,
    /// min: 1, max: 2097152]
    count: u32,
    /// Random numbers per light. 3: layer, row and column have one each. 2: the number that picks the layer is
    /// renormalised and picks the row too (Shirley & Wang 1991); flicker between frames is higher (TCAS Fig. 8).
    /// [default: 3, one_of: [3, 2]]
    dimensions: u32,
    seed: u32,
}

var<uniform> settings: Settings;
/// Sums along the rows of all maps.
var row_cdf: texture_2d_array<f32>;
/// [layers][height] Sums along the last column of each map.
var<storage, read> column_cdf: array<f32>;
/// [layers] Sums over the maps.
var<storage, read> layer_cdf: array<f32>;
var<storage, read_write> lights: VirtualLights;

const LAYERS: u32 = 0u;
const ROWS: u32 = 1u;
const COLUMNS: u32 = 2u;

/// Entry i of a cumulative distribution: of the layers, of a layer's rows, or of a row's columns.
fn cumulated(stage: u32, layer: u32, row: u32, i: u32) -> f32 {
    if stage == LAYERS {
        return layer_cdf[i];
    }
    if stage == ROWS {
        return column_cdf[layer * textureDimensions(row_cdf).y + i];
    }
    return textureLoad(row_cdf, vec2(i, row), layer, 0).r;
}

struct Choice {
    index: u32,
    probability: f32,
    /// Position of the number in the chosen interval, in [0, 1): as uniform as the number was (Shirley & Wang 1991).
    rest: f32,
}

/// The first of `count` entries whose sum exceeds number · total; total must not be 0.
///
/// The probability is the width of the interval that the search sees, not weight / total: so the estimator has no bias
/// from the rounding of the sums, whichever way they were computed.
fn choose(stage: u32, layer: u32, row: u32, count: u32, number: f32) -> Choice {
    let total = cumulated(stage, layer, row, count - 1u);
    // number · total can round up to total; below it, the last entry with a weight is found.
    let sought = min(number * total, bitcast<f32>(bitcast<u32>(total) - 1u));
    var low = 0u;
    var high = count - 1u;
    while low < high {
        let middle = (low + high) / 2u;
        if cumulated(stage, layer, row, middle) > sought {
            high = middle;
        } else {
            low = middle + 1u;
        }
    }
    var before = 0.0;
    if low > 0u {
        before = cumulated(stage, layer, row, low - 1u);
    }
    let width = cumulated(stage, layer, row, low) - before;
    // DEVIATION(least-probability): an interval that 24-bit numbers can hit at all is hit as often as one of 2^-24:
    // otherwise a weight of 1e-30 at the start of a row would give a light 1e30 times too bright.
    let probability = max(width / total, 1.0 / 16777216.0);
    return Choice(low, probability, clamp((sought - before) / width, 0.0, 0.99999994));
}

@compute @workgroup_size(64)
fn draw(thread: Row) {
    let light = index_in(thread, 64u);
    if light >= settings.count {
        return;
    }
    let size = textureDimensions(row_cdf);
    let layers = textureNumLayers(row_cdf);
    let none = layer_cdf[layers - 1u] == 0.0;
    if light == 0u {
        lights.count = select(settings.count, 0u, none);
    }
    if none {
        lights.lights[light] = dark_light(0u);
        return;
    }
    let numbers = halton3(light + 1u, settings.seed);
    let two = settings.dimensions == 2u;
    let layer = choose(LAYERS, 0u, 0u, layers, numbers.x);
    let row = choose(ROWS, layer.index, 0u, size.y, select(numbers.y, layer.rest, two));
    let column = choose(COLUMNS, layer.index, row.index, size.x, select(numbers.z, numbers.y, two));
    let p = layer.probability * row.probability * column.probability;
    let weight = 1.0 / (f32(settings.count) * p);
    lights.lights[light] = virtual_light_from_texel(layer.index, column.index, row.index, weight);
}
