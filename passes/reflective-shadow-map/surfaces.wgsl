// One layer of a reflective shadow map: the surfaces that a light sees (Dachsbacher & Stamminger 2005, §3.1).

#import "lights.wgsl"
#import "surface.wgsl"

struct Settings {
    /// The layer that is rendered.
    layer: u32,
}

var<uniform> settings: Settings;

struct Seen {
    @builtin(position) clip: vec4<f32>,
    /// [m]; not from the light, which may be so far away that places in the scene would all be rounded to one.
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) @interpolate(flat) material: u32,
}

struct Texel {
    @location(0) position: vec4<f32>,
    @location(1) normal: vec4<f32>,
    @location(2) albedo: vec4<f32>,
}

@vertex
fn project(vertex: Attributes) -> Seen {
    let clip = scene_light_layers[settings.layer].clip_from_world * vec4(vertex.position, 1.0);
    return Seen(clip, vertex.position, vertex.normal, vertex.uv, vertex.material);
}

@fragment
fn surfaces(seen: Seen) -> Texel {
    let change = change_of(seen);
    let at = surface(seen.material, seen.uv, change.uv_x, change.uv_y);
    if !surface_exists(seen.material, at.coverage) {
        discard;
    }
    let world_from_layer = scene_light_layers[settings.layer].world_from_layer;
    let offset = seen.position - world_from_layer[3].xyz;
    let along = -dot(offset, world_from_layer[2].xyz);
    // DEVIATION(sides): from a texel down and from there to the right turns to the light, whatever the surface; but not where
    // the next texel is beyond the plane's horizon, as in maps of few texels.
    let parallel = scene_light_layers[settings.layer].kind == LIGHT_DIRECTIONAL;
    let travels = select(offset, -world_from_layer[2].xyz, parallel);
    let towards = facing(cross(change.position_y, change.position_x), -travels);
    let normal = shading_normal(seen.material, seen.normal, towards, seen.uv, change);
    return Texel(vec4(seen.position, along), vec4(normal, 0.0), vec4(at.albedo, 1.0));
}

@fragment
fn specular(seen: Seen) -> @location(0) vec4<f32> {
    let change = change_of(seen);
    let at = surface(seen.material, seen.uv, change.uv_x, change.uv_y);
    if !surface_exists(seen.material, at.coverage) {
        discard;
    }
    return vec4(at.specular, at.roughness);
}

fn change_of(seen: Seen) -> Change {
    return Change(dpdx(seen.position), dpdy(seen.position), dpdx(seen.uv), dpdy(seen.uv));
}
