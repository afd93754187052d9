// The radiance that diffuse surfaces reflect of an irradiance, albedo/π · E, and light that they reflect besides.

#input view: GBuffer // The surfaces.
#input irradiance: Irradiance like view // What arrives.
#input radiance: Radiance optional like view // What they reflect of other light; it is added.
#output reflected: Radiance // The sum.

#option RADIANCE false // whether `radiance` is linked

#import "color.wgsl"

var view_albedo: texture_2d<f32>;
var view_depth: texture_2d<f32>;
var irradiance: texture_2d<f32>;
#if RADIANCE
var radiance: texture_2d<f32>;
#endif
var reflected: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn reflect_irradiance(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(reflected)) {
        return;
    }
    var sum = textureLoad(view_albedo, id.xy, 0).rgb / PI * textureLoad(irradiance, id.xy, 0).rgb;
#if RADIANCE
    sum += textureLoad(radiance, id.xy, 0).rgb;
#endif
    textureStore(reflected, id.xy, vec4(sum, select(0.0, 1.0, textureLoad(view_depth, id.xy, 0).x > 0.0)));
}
