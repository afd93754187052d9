// Sums the irradiance of virtual lights at the camera's pixels from few samples, each by a light that is chosen down a tree.
// [Lin & Yuksel 2020]
//
// A pixel cuts the tree into as many nodes as it has samples, by refining the node first whose light may be off by most (Walter et
// al. 2005), and chooses one light below each of them.
//
// irradiance: rgba32float [W/m²]; in alpha the luminance of what the bound removed [W/m²].

#input view: GBuffer // The pixels at which light is gathered.
#input lights: VirtualLights // The lights.
#input tree: LightTree // A tree over these lights.
#input visibility: Visibility optional // The visibility of the lights; without it, all are visible.
#output irradiance: Irradiance(
    interleave_x: min(settings.interleave_x * view.supersampling, view.width),
    interleave_y: min(settings.interleave_y * view.supersampling, view.height),
    clamp: settings.clamp,
    area_bound: settings.area_bound when settings.geometry == 'bounded',
) // Diffuse irradiance, with noise.
#exact bound: set(clamp: 0.0, area_bound: 0.0, geometry: 'disc') // Light from discs of the area that each light stands for.

#option VISIBILITY false // whether something says which lights are seen

#import "light-geometry.wgsl"
// DEVIATION(distance): it takes the distance to the middle of a box and its radius, not the mean over the nearest and farthest point.
#import "light-tree.wgsl"
#import "shuffle.wgsl"
#import "view-place.wgsl"
#import "virtual-lights.wgsl"
#if VISIBILITY
#import interface "visibility"
#endif

struct Settings {
    view_size: vec2<u32>,
    /// Samples of a pixel: the most nodes into which it cuts the tree, of which each gives a light. More: less noise, and more time.
    /// [default: 8, min: 1, max: 64]
    samples: u32,
    /// Pixels along a row whose choices are stratified together, for a filter that averages over them. More: less noise behind such a
    /// filter, which blurs more. 1: each pixel by itself. [default: 4, min: 1, max: 16]
    interleave_x: u32,
    /// Pixels along a column, as `interleave_x` of a row. [default: 4, min: 1, max: 16]
    interleave_y: u32,
    /// Distance b below which a light gives only d² / b² of what it would, as a fraction of the scene's dense extent; 0 is no such bound.
    /// Larger: smaller bright spots near lights, but more energy lost near corners, which alpha has and `bias-compensation`
    /// returns. [default: 0.0, min: 0.0, max: 1.0]
    clamp: f32,
    /// Distance below which a light gives no more, in radii of a disc of the area that it stands for, where `geometry` is bounded; at most
    /// a fifth of the scene's dense extent. 0 is no such bound. With more lights, less is lost.
    /// [default: 1.0, min: 0.0, max: 100.0]
    area_bound: f32,
    irradiance_interleave_x: u32,
    irradiance_interleave_y: u32,
    seed: u32,
    /// The samples that this dispatch takes: `begin` to `end`.
    begin: u32,
    end: u32,
    /// 1 for the dispatch that takes the last samples.
    last: u32,
}

var<uniform> settings: Settings;
var<storage, read> lights: VirtualLights;
var irradiance: texture_storage_2d<rgba32float, write>;
/// Sums of the dispatches before, pixel by pixel. [scratch, count: view.width * view.height * min(parts - 1, 1)]
var<storage, read_write> sums: array<vec4<f32>>;

/// The most samples of a pixel.
const MOST: u32 = 64u;
/// The most levels of a tree.
const LEVELS: u32 = 24u;

/// The nodes of the cut.
var<private> cut: array<u32, MOST>;
/// How much the light of each may be off [W/m²]; 0 of a leaf.
var<private> errors: array<f32, MOST>;

/// How much the light of a node may be off at a place [W/m²]; below 0 where it gives none.
fn error_of(node: u32, place: Place) -> f32 {
    let importance = light_importance(tree.nodes[node], place.at, place.normal);
    if importance <= 0.0 {
        return -1.0;
    }
    // DEVIATION(error): the estimate itself; an upper bound is infinite within the box of a node.
    return select(0.0, importance, node < tree.leaves);
}

// DEVIATION(cut): each pixel has its own cut; the paper shares one among the pixels of a block.
/// Cuts the tree for a place; returns the number of nodes in `cut`.
fn cut_tree(place: Place) -> u32 {
    cut[0] = tree.root;
    errors[0] = error_of(tree.root, place);
    var count = select(0u, 1u, errors[0] >= 0.0);
    while count > 0u && count < settings.samples {
        var worst = 0u;
        for (var k = 1u; k < count; k++) {
            worst = select(worst, k, errors[k] > errors[worst]);
        }
        if errors[worst] <= 0.0 {
            break;
        }
        let child = 2u * cut[worst];
        let left = error_of(child, place);
        let right = error_of(child + 1u, place);
        if left >= 0.0 {
            cut[worst] = child;
            errors[worst] = left;
            if right >= 0.0 {
                cut[count] = child + 1u;
                errors[count] = right;
                count++;
            }
        } else if right >= 0.0 {
            cut[worst] = child + 1u;
            errors[worst] = right;
        } else {
            // The bounds of the node are wider than those of its children: it gives no light.
            count--;
            cut[worst] = cut[count];
            errors[worst] = errors[count];
        }
    }
    return count;
}

/// Random bits for a node of the cut of a pixel. Those of the pixels of a window are stratified for each node.
fn bits_for(pixel: vec2<u32>, node: u32) -> u32 {
    let interleave = vec2(settings.irradiance_interleave_x, settings.irradiance_interleave_y);
    let strata = interleave.x * interleave.y;
    let within = pixel % interleave;
    let key = hash2(settings.seed, node);
    let stratum = shuffled(within.y * interleave.x + within.x, strata, key);
    let width = 0xffffffffu / strata;
    let bits = hash2(key, pixel.y * settings.view_size.x + pixel.x);
    return stratum * width + multiply_high(bits, width);
}

/// What a light gives at a place.
fn light_at(place: Place, index: u32) -> vec4<f32> {
    let light = lights.lights[index];
    var terms = light_geometry(light, place.at, place.normal, settings.clamp, settings.area_bound);
#if VIEW_GEOMETRIC
    terms *= select(0.0, 1.0, is_before(light, place.at, place.plane));
#endif
#if VISIBILITY
    if terms.x > 0.0 {
        terms *= visibility(index, light, place.at, place.plane);
    }
#endif
    return light_sum(light.flux, terms);
}

/// Gathers at the pixels, a thread each. A sample takes an iteration for each level of the tree, and its share of those of the cut.
/// [threads: texels(irradiance), items: settings.samples, iterations: 2 * LEVELS + settings.samples + visibility.iterations]
@compute @workgroup_size(8, 8)
fn gather(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= settings.view_size) {
        return;
    }
    let place = place_at(id.xy, settings.view_size);
    var sum = vec4(0.0);
    if place.seen {
        let end = min(cut_tree(place), settings.end);
        for (var k = settings.begin; k < end; k++) {
            let choice = choose_light_below(cut[k], place.at, place.normal, bits_for(id.xy, cut[k]));
            if choice.probability > 0.0 {
                sum += light_at(place, choice.index) / choice.probability;
            }
        }
    }
    let index = id.y * settings.view_size.x + id.x;
    if settings.begin > 0u {
        sum += sums[index];
    }
    if settings.last == 0u {
        sums[index] = sum;
        return;
    }
    textureStore(irradiance, id.xy, sum);
}
