// Makes surface points where rays meet the scene, and lets them follow it. A pass that imports this file declares the
// scene bindings SCENE.

#option TEXTURED false // whether any material of the scene has a texture

#import "surface-points.wgsl"
#import "surface.wgsl"

/// A place on a triangle.
struct OnTriangle {
    /// World space [m].
    position: vec3<f32>,
    /// Unit normal of the triangle; zero where it has no area. Its sign means nothing.
    normal: vec3<f32>,
}

/// The place with these weights of the second and third vertex.
fn on_triangle(triangle: u32, barycentrics: vec2<f32>) -> OnTriangle {
    let corner = scene_vertices[scene_indices[3u * triangle]].position;
    let a = scene_vertices[scene_indices[3u * triangle + 1u]].position - corner;
    let b = scene_vertices[scene_indices[3u * triangle + 2u]].position - corner;
    return OnTriangle(corner + a * barycentrics.x + b * barycentrics.y, unit(cross(unit(a), unit(b))));
}

/// The diffuse reflectance of a material, with each texture replaced by its mean. [SMC-IR §5]
fn mean_albedo(index: u32) -> vec3<f32> {
    let material = scene_materials[index];
    var base = material.base_color.rgb;
    var metallic = material.metallic;
#if TEXTURED
    // The coarsest level is one texel: the mean of all.
    let level = textureNumLevels(scene_textures) - 1u;
    if material.base_color_texture != NO_TEXTURE {
        base *= textureLoad(scene_textures, vec2(0u), material.base_color_texture, level).rgb;
    }
    if material.metallic_roughness_texture != NO_TEXTURE {
        metallic *= textureLoad(scene_textures_linear, vec2(0u), material.metallic_roughness_texture, level).b;
    }
#endif
    return base * (1.0 - metallic);
}

/// The point where a ray along `direction` met a triangle.
fn surface_point(triangle: u32, barycentrics: vec2<f32>, direction: vec3<f32>, seed: u32) -> SurfacePoint {
    let place = on_triangle(triangle, barycentrics);
    let normal = select(place.normal, -place.normal, dot(place.normal, direction) > 0.0);
    let material = scene_vertices[scene_indices[3u * triangle]].material;
    return SurfacePoint(place.position, triangle, normal, seed, barycentrics, packed_albedo(mean_albedo(material)), 0u);
}

/// A point where its triangle is now, on the same side. Where that is where it was, up to rounding, the point keeps its
/// bits, however differently a compiler orders the sums here and where the point was made.
fn followed(point: SurfacePoint) -> SurfacePoint {
    if point.triangle == NO_TRIANGLE {
        return point;
    }
    let place = on_triangle(point.triangle, point.barycentrics);
    var followed = point;
    let rounding = (abs(point.position) + scene_info.extent) * 0x1p-21f;
    if any(abs(place.position - point.position) > rounding) {
        followed.position = place.position;
    }
    let normal = select(place.normal, -place.normal, dot(place.normal, point.normal) < 0.0);
    if any(abs(normal - point.normal) > vec3(0x1p-18f)) && any(normal != vec3(0.0)) {
        followed.normal = normal;
    }
    return followed;
}
