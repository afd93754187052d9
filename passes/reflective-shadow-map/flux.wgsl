// The flux [W] that the surface in each texel reflects: albedo × the flux that the light sends into the texel; in alpha
// the area of that surface [m²].

#import "beam.wgsl"

var rsm_position: texture_2d_array<f32>;
var rsm_normal: texture_2d_array<f32>;
var rsm_albedo: texture_2d_array<f32>;
var rsm_flux: texture_storage_2d_array<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn flux(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(rsm_position)) {
        return;
    }
    var reflected = vec4(0.0);
    let position = textureLoad(rsm_position, id.xy, id.z, 0);
    if position.w > 0.0 {
        // DEVIATION(flux): by the texel's solid angle.
        let beam = texel_beam(id, textureDimensions(rsm_position));
        let normal = textureLoad(rsm_normal, id.xy, id.z, 0).xyz;
        reflected = vec4(textureLoad(rsm_albedo, id.xy, id.z, 0).rgb * beam.flux, surface_area(beam, position, normal));
    }
    textureStore(rsm_flux, id.xy, id.z, reflected);
}

/// Area [m²] of the plane surface that a beam lights.
fn surface_area(beam: Beam, position: vec4<f32>, normal: vec3<f32>) -> f32 {
    // A surface that is nearly parallel to the beam ends within the texel: it is counted as if it stood at 84°.
    let cosine = max(-dot(normalize(normal), beam.direction), 0.1);
    if beam.directional {
        return beam.section / cosine;
    }
    let distance = length(position.xyz - beam.origin);
    return beam.section * distance * distance / cosine;
}
