// What a texel of a reflective shadow map reflects, and how samples of the view lie to it. [ACRSM §4.5, Eq. 4.1-4.2, 5.1-5.2]

#option SPECULAR false // whether the reflective shadow map has the member `specular`

#import "beam.wgsl"
#import "reflectance-values.wgsl"
#import "view-sample.wgsl"

struct Settings {
    view_samples: u32,
    diffuse_weight: f32,
}

const TILE: u32 = 64u;

var<uniform> settings: Settings;
var<storage, read> samples: array<ViewSample>;
var<workgroup> tile: array<ViewSample, TILE>;
var rsm_position: texture_2d_array<f32>;
var rsm_albedo: texture_2d_array<f32>;
#if SPECULAR
var rsm_specular: texture_2d_array<f32>;
#endif
var<storage, read_write> values: array<ReflectanceValues>;

fn greatest_of(rgb: vec3<f32>) -> f32 {
    return max(max(rgb.r, rgb.g), rgb.b);
}

/// Eq. 4.1 of what the light sends into the texel: f_d and f_s of Eq. 5.1-5.2, weighted.
fn reflected(texel: vec3<u32>) -> f32 {
    let beam = texel_beam(texel, textureDimensions(rsm_position)).flux;
    var sum = settings.diffuse_weight * greatest_of(textureLoad(rsm_albedo, texel.xy, texel.z, 0).rgb * beam);
#if SPECULAR
    let specular = textureLoad(rsm_specular, texel.xy, texel.z, 0);
    // DEVIATION(specular-exponent): smoothness, which is at most 1, in place of the exponent of Blinn's model.
    sum += (1.0 - settings.diffuse_weight) * greatest_of(specular.rgb * beam) * (1.0 - specular.a);
#endif
    return weight_of(sum);
}

@compute @workgroup_size(16, 16)
fn reflectance(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let size = textureDimensions(rsm_position);
    let position = textureLoad(rsm_position, min(id.xy, size - 1u), id.z, 0);
    let lit = all(id.xy < size) && position.w > 0.0;
    let at = to_extents(position.xyz);
    var cosines = 0.0;
    for (var first = 0u; first < settings.view_samples; first += TILE) {
        workgroupBarrier();
        if thread < TILE && first + thread < settings.view_samples {
            tile[thread] = samples[first + thread];
        }
        workgroupBarrier();
        let end = min(TILE, settings.view_samples - first);
        if lit {
            for (var k = 0u; k < end; k++) {
                let way = at - tile[k].position;
                // The normal of a sample that sees nothing is 0. One at the texel itself has no direction.
                cosines += max(dot(tile[k].normal, way), 0.0) / max(length(way), 1e-10);
            }
        }
    }
    if any(id.xy >= size) {
        return;
    }
    var of_texel = ReflectanceValues(0.0, 0.0);
    if lit {
        of_texel = ReflectanceValues(reflected(id), cosines / f32(settings.view_samples));
    }
    values[(id.z * size.y + id.y) * size.x + id.x] = of_texel;
}
