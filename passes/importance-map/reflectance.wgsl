// Computes what a texel of a reflective shadow map reflects, and how samples of the view lie to it. [ACRSM §4.5, Eq. 4.1-4.2, 5.1-5.2]

#option RSM_SPECULAR false // whether the reflective shadow map has the member `specular`

#import "beam.wgsl"
#import "reflectance-values.wgsl"
#import "squares.wgsl"
#import "view-sample.wgsl"

struct Settings {
    view_samples: u32,
    /// Weight w_d of diffuse against specular reflection, for the measure reflectance. 1: diffuse alone. [default: 0.5, min: 0.0,
    /// max: 1.0]
    diffuse_weight: f32,
    /// Side of the blocks of which one texel is compared with the view [texels].
    block_side: u32,
}

var<uniform> settings: Settings;
var<storage, read> samples: array<ViewSample>;
var<workgroup> tile: array<ViewSample, TILE>;
var rsm_position: texture_2d_array<f32>;
var rsm_albedo: texture_2d_array<f32>;
#if RSM_SPECULAR
var rsm_specular: texture_2d_array<f32>;
#endif
/// [layers][rows][columns] ρ_v of each block.
var<storage, read_write> block_seen: array<f32>;
var<storage, read_write> values: array<ReflectanceValues>;

fn greatest_of(rgb: vec3<f32>) -> f32 {
    return max(max(rgb.r, rgb.g), rgb.b);
}

fn is_lit(texel: vec2<u32>, layer: u32) -> bool {
    // Outside the map, the load returns some texel or zero.
    return all(texel < textureDimensions(rsm_position)) && textureLoad(rsm_position, texel, layer, 0).w > 0.0;
}

/// The texel that stands for a block: the one in the middle, or the first that is lit where that is not.
fn texel_of_block(block: vec2<u32>, layer: u32) -> vec2<u32> {
    let side = settings.block_side;
    let first = block * side;
    let middle = first + side / 2u;
    if is_lit(middle, layer) {
        return middle;
    }
    for (var i = 0u; i < side * side; i++) {
        let texel = first + vec2(i % side, i / side);
        if is_lit(texel, layer) {
            return texel;
        }
    }
    return middle;
}

fn index_of_block(block: vec2<u32>, layer: u32) -> u32 {
    let blocks = (textureDimensions(rsm_position) + settings.block_side - 1u) / settings.block_side;
    return (layer * blocks.y + block.y) * blocks.x + block.x;
}

/// A block of which one texel is compared with the view.
struct Compared {
    block: vec2<u32>,
    lit: bool,
    /// The texel's position [extents].
    at: vec3<f32>,
    cosines: f32,
}

fn compared(block: vec2<u32>, layer: u32) -> Compared {
    let texel = texel_of_block(block, layer);
    let inside = min(texel, textureDimensions(rsm_position) - 1u);
    let at = to_extents(textureLoad(rsm_position, inside, layer, 0).xyz);
    return Compared(block, is_lit(texel, layer), at, 0.0);
}

/// Eq. 4.2 of a texel of each block: the mean cosine between the normals of samples of the view and the way to the texel.
@compute @workgroup_size(GROUP_SIDE, GROUP_SIDE)
fn compare_with_view(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let corner = group.xy * SQUARE + local.xy;
    var blocks: array<Compared, SPAN * SPAN>;
    var lit = false;
    for (var i = 0u; i < SPAN * SPAN; i++) {
        blocks[i] = compared(corner + place_in_square(i), group.z);
        lit |= blocks[i].lit;
    }
    for (var first = 0u; first < settings.view_samples; first += TILE) {
        workgroupBarrier();
        if first + thread < settings.view_samples {
            tile[thread] = samples[first + thread];
        }
        workgroupBarrier();
        let end = select(0u, min(TILE, settings.view_samples - first), lit);
        for (var k = 0u; k < end; k++) {
            let sample = tile[k];
            for (var i = 0u; i < SPAN * SPAN; i++) {
                let way = blocks[i].at - sample.position;
                // The normal of a sample that sees nothing is 0. One at the texel itself has no direction.
                blocks[i].cosines += max(dot(sample.normal, way), 0.0) / max(length(way), 1e-10);
            }
        }
    }
    for (var i = 0u; i < SPAN * SPAN; i++) {
        let block = blocks[i].block;
        if all(block * settings.block_side < textureDimensions(rsm_position)) {
            let mean = blocks[i].cosines / f32(settings.view_samples);
            block_seen[index_of_block(block, group.z)] = select(0.0, mean, blocks[i].lit);
        }
    }
}

/// Eq. 4.1 of what the light sends into the texel: f_d and f_s of Eq. 5.1-5.2, weighted.
fn reflected(texel: vec3<u32>) -> f32 {
    let beam = texel_beam(texel, textureDimensions(rsm_position)).flux;
    let albedo = textureLoad(rsm_albedo, texel.xy, texel.z, 0);
    var sum = settings.diffuse_weight * greatest_of(albedo.rgb * albedo.a * beam);
#if RSM_SPECULAR
    let specular = textureLoad(rsm_specular, texel.xy, texel.z, 0);
    // DEVIATION(specular-exponent): smoothness, which is at most 1, in place of the exponent of Blinn's model.
    sum += (1.0 - settings.diffuse_weight) * greatest_of(specular.rgb * beam) * (1.0 - specular.a);
#endif
    return weight_of(sum);
}

/// Stores what a texel reflects, and what its block has of the view.
@compute @workgroup_size(16, 16)
fn reflectance(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(rsm_position);
    if any(id.xy >= size) {
        return;
    }
    var of_texel = ReflectanceValues(0.0, 0.0);
    if is_lit(id.xy, id.z) {
        of_texel = ReflectanceValues(reflected(id), block_seen[index_of_block(id.xy / settings.block_side, id.z)]);
    }
    values[(id.z * size.y + id.y) * size.x + id.x] = of_texel;
}
