// Where triangles are cut out: alpha is below their material's cutoff.

#option MASKED false // whether triangles do not count where alpha is below their material's cutoff
#option TEXTURED false // whether any material of the scene has a texture, where MASKED

#import "scene.wgsl"
#if MASKED
#import "surface.wgsl"
#endif

/// Whether the surface of a triangle is there at a point, by the weights of its second and third vertex.
fn triangle_exists(index: u32, barycentrics: vec2<f32>) -> bool {
#if MASKED
    let material = scene_vertices[scene_indices[3u * index]].material;
    if scene_materials[material].alpha_cutoff > 0.0 {
        return surface_exists(material, uv_on_triangle(index, barycentrics));
    }
#endif
    return true;
}
