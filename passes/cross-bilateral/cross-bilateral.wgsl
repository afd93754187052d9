// Averages irradiance over a Gaussian window, weighted by how alike surfaces are. [Eisemann & Durand 2004; Petschnigg et
// al. 2004]
//
// filtered: rgba32float [W/m²]; all four channels are averaged alike.

#input view: GBuffer // Determines which pixels see the same surface.
#input irradiance: Irradiance like view // The irradiance to average.
#output filtered: Irradiance // The averages.
#exact filter: input irradiance // Irradiance as it is gathered.

#import "surface-around.wgsl"

struct Settings {
    view_size: vec2<u32>,
    /// Pixels to each side of the centre. Larger: less noise, but less detail and more time; 0 averages nothing. [default:
    /// 4, min: 0, max: 32, unit: "px"]
    radius: u32,
    /// Distance of a pixel from the plane of the centre at which its weight falls to 1/e, as a fraction of the depth.
    /// Larger: blur across steps. Smaller: noise on curved surfaces. [default: 0.01, min: 0.0]
    plane: f32,
    /// Power of the cosine between normals. Smaller: blur across creases. Larger: noise on curved surfaces. [default: 32,
    /// min: 0.0, max: 1024.0]
    normal_power: f32,
}

var<uniform> settings: Settings;
var irradiance: texture_2d<f32>;
var filtered: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn smooth_window(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = id.xy;
    if any(pixel >= settings.view_size) {
        return;
    }
    let depth = textureLoad(view_depth, pixel, 0).x;
    if depth <= 0.0 {
        textureStore(filtered, pixel, vec4(0.0));
        return;
    }
    let normal = normalize(textureLoad(view_normal, pixel, 0).xyz);
    let around = surface_around(pixel, settings.view_size, depth, normal);
    let reach = i32(settings.radius);
    // The standard deviation is half the radius: the window ends where the Gaussian has fallen to e^-2.
    let falloff = -2.0 / f32(reach * reach);
    // The centre is like itself, whatever rounding says, so the weights never sum to zero.
    var sum = textureLoad(irradiance, pixel, 0);
    var weights = 1.0;
    for (var y = -reach; y <= reach; y++) {
        for (var x = -reach; x <= reach; x++) {
            let other = vec2<i32>(pixel) + vec2(x, y);
            if (x == 0 && y == 0) || any(other < vec2(0)) || any(other >= vec2<i32>(settings.view_size)) {
                continue;
            }
            let alike = likeness(around, other, settings.plane, settings.normal_power);
            let weight = exp(falloff * f32(x * x + y * y)) * alike;
            sum += weight * textureLoad(irradiance, other, 0);
            weights += weight;
        }
    }
    textureStore(filtered, pixel, sum / weights);
}
