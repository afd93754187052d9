// The light of the scene's lights that a surface reflects, with a ray to each light.
//
// A file that imports this one imports also how surfaces reflect: reflectance.wgsl, or diffuse-reflectance.wgsl where they are
// all diffuse.

#import "incident-light.wgsl"
#import "light-reach.wgsl"
#import "path-vertex.wgsl"

/// Radiance that a surface reflects of the lights of the scene [W/(m² sr)]. `leaving` points to where it goes, unit.
fn reflected_light(vertex: PathVertex, leaving: vec3<f32>) -> vec3<f32> {
    var radiance = vec3(0.0);
    for (var i = 0u; i < scene_lights.count; i++) {
        let light = scene_lights.lights[i];
        let incident = incident_light(light, vertex.position);
        let to_light = -incident.direction;
        let irradiance = incident.irradiance * dot(vertex.normal, to_light);
        if !any(irradiance > vec3(0.0)) || dot(vertex.geometric, to_light) <= 0.0 {
            continue;
        }
        if light_reaches(light, offset_origin(vertex.position, vertex.geometric), to_light) {
            radiance += reflectance(vertex, to_light, leaving) * irradiance;
        }
    }
    return radiance;
}
