// Reflection at surfaces: diffuse, and by microfacets where GLOSSY is set.

#option GLOSSY false // whether anything reflects other than diffusely

#import "color.wgsl"
#import "path-vertex.wgsl"
#if GLOSSY
#import "ggx.wgsl"
#endif

/// The bidirectional reflectance [1/sr].
fn reflectance(vertex: PathVertex, to_light: vec3<f32>, leaving: vec3<f32>) -> vec3<f32> {
    var value = vertex.surface.albedo / PI;
#if GLOSSY
    if any(vertex.surface.specular > vec3(0.0)) {
        value += ggx(vertex.normal, to_light, leaving, vertex.surface.specular, vertex.surface.roughness);
    }
#endif
    return value;
}
