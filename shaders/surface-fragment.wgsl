// The surface of a fragment.

#import "surface.wgsl"

/// The material at a fragment, filtered over a pixel. Where it is cut out at the pixel's centre, the fragment is discarded: a mask is
/// filtered no more than the outlines of triangles are, for where its mean is below the cutoff nothing would be left.
fn fragment_surface(index: u32, uv: vec2<f32>, change: Change) -> Surface {
    let material = scene_materials[index];
    var alpha = material.base_color.a;
#if TEXTURED
    if material.alpha_cutoff > 0.0 && material.base_color_texture != NO_TEXTURE {
        alpha *= textureSampleLevel(scene_textures, scene_sampler, uv, material.base_color_texture, 0.0).a;
    }
#endif
    if !surface_exists(index, alpha) {
        discard;
    }
    return surface(index, uv, change.uv_x, change.uv_y);
}
