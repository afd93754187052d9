// Push: corrects a level of the pyramid, not the finest, by the coarser one, in place. [ISM §3.2]

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
    /// Distances that differ from the coarser level by more than this fraction of the scene's extent, doubled with each
    /// level, are replaced. Smaller: more leaks close, but thin occluders thicken. [default: 0.05, min: 0.0]
    push_threshold: f32,
}

var<uniform> settings: Settings;
/// The pyramids of a window, level 1 first. [scratch, count: pyramid_texels]
var<storage, read_write> pyramid: array<f32>;

fn coarse(map: u32, x: u32, y: u32) -> f32 {
    let side = settings.coarse_side;
    let value = pyramid[settings.coarse_begin + (map * side + y) * side + x];
    return select(NOTHING, value, max(x, y) < side);
}

/// One thread per fine texel; z is the map, from the first of the window.
@compute @workgroup_size(8, 8)
fn push(@builtin(global_invocation_id) id: vec3<u32>) {
    let side = settings.fine_side;
    if any(id.xy >= vec2(side)) {
        return;
    }
    let index = settings.fine_begin + (id.z * side + id.y) * side + id.x;
    let own = pyramid[index];
    let threshold = settings.push_threshold * scene_info.extent * settings.scale;
    if is_final(own, threshold) {
        return;
    }
    let p = parents(id.xy);
    let values = vec4(
        coarse(id.z, p.x, p.y),
        coarse(id.z, p.z, p.y),
        coarse(id.z, p.x, p.w),
        coarse(id.z, p.z, p.w),
    );
    pyramid[index] = pushed(own, values, threshold);
}
