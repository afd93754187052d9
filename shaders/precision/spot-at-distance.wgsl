// The light of a spot at a distance from it: direction and irradiance.

#import "incident-light.wgsl"
#import "inputs/directions.wgsl"

struct Given {
    scene_info: SceneInfo,
    position: vec3<f32>,
    axis: vec3<f32>,
    intensity: vec3<f32>,
    at: vec3<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    var scene: SceneInfo;
    scene.extent = 1.0;
    let axis = unit_direction(u.xy);
    let toward = direction_beside(axis, 0.4 * u.z, u.w);
    return Given(scene, vec3(0.0), axis, vec3(1.0, 2.0, 3.0), magnitude * toward);
}

/// [magnitude: 1e-5 to 1e6, distance [extents of the scene]]
fn probe(given: Given) -> vec4<f32> {
    var light: Light;
    light.kind = LIGHT_SPOT;
    light.position = given.position;
    light.direction = given.axis;
    light.cap_outer = 0.2;
    light.cap_inner = 0.02;
    light.intensity = given.intensity;
    let incident = incident_light(light, given.at);
    return vec4(incident.irradiance, length(incident.direction));
}
