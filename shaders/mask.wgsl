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
    let first = scene_vertices[scene_indices[3u * index]];
    if scene_materials[first.material].alpha_cutoff > 0.0 {
        let uv1 = scene_vertices[scene_indices[3u * index + 1u]].uv;
        let uv2 = scene_vertices[scene_indices[3u * index + 2u]].uv;
        let uv = first.uv + (uv1 - first.uv) * barycentrics.x + (uv2 - first.uv) * barycentrics.y;
        return surface_exists(first.material, surface(first.material, uv, vec2(0.0), vec2(0.0)).coverage);
    }
#endif
    return true;
}
