// Pull: one level of the pyramid from the finer one. [ISM §3.2]

#option FINEST true internal // whether the finer level is the maps themselves
#option PULL mean one_of [mean, median] // The combination of the four finer texels of a coarse one, without holes. mean: their
    // mean if all are close to each other, otherwise a hole (ISM). median: their median, of two or four the mean of the middle
    // two if these are close (ACRSM): single outliers leave no hole.

#import "combine.wgsl"

struct Settings {
    /// Side of a map at the two levels [px].
    fine_side: u32,
    coarse_side: u32,
    /// Offsets of the levels in the pyramid.
    fine_begin: u32,
    coarse_begin: u32,
    /// 2^l of the finer level.
    scale: f32,
    /// Distances are averaged if they differ by less than this fraction of the scene's extent, doubled with each level;
    /// otherwise the coarser texel is a hole. Larger: holes close at silhouettes, but surfaces mix. By the median, only
    /// the middle two of an even number are averaged.
    /// [default: 0.05, min: 0.0]
    pull_threshold: f32,
}

var<uniform> settings: Settings;
/// The maps of a window, which begin with the first map of the dispatch.
var<storage, read> depth: array<u32>;
/// The pyramids of a window, level 1 first. [scratch, count: pyramid_texels]
var<storage, read_write> pyramid: array<f32>;

fn fine(map: u32, texel: vec2<u32>) -> f32 {
    let side = settings.fine_side;
#if FINEST
    // +∞ is a hole.
    let value = min(bitcast<f32>(depth[(map * side + texel.y) * side + texel.x]), NOTHING);
#else
    let value = pyramid[settings.fine_begin + (map * side + texel.y) * side + texel.x];
#endif
    return select(NOTHING, value, all(texel < vec2(side)));
}

/// One thread per coarse texel; z is the map, from the first of the window.
@compute @workgroup_size(8, 8)
fn pull(@builtin(global_invocation_id) id: vec3<u32>) {
    let side = settings.coarse_side;
    if any(id.xy >= vec2(side)) {
        return;
    }
    let map = id.z;
    let corner = id.xy * 2u;
    let values = vec4(
        fine(map, corner),
        fine(map, corner + vec2(1u, 0u)),
        fine(map, corner + vec2(0u, 1u)),
        fine(map, corner + vec2(1u, 1u)),
    );
    let threshold = settings.pull_threshold * scene_info.extent * settings.scale;
#if PULL == median
    let coarse = pulled_median(values, threshold);
#else
    let coarse = pulled(values, threshold);
#endif
    pyramid[settings.coarse_begin + (map * side + id.y) * side + id.x] = coarse;
}
