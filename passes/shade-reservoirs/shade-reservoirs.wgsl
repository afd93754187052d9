// Gathers at each pixel the light that was chosen for it, by a ray: without bias, whatever guessed its visibility. [Bitterli et al.
// 2020]

#input view: GBuffer // The pixels.
#input reservoirs: Reservoirs // The lights that were chosen for them.
#output irradiance: Irradiance(
    clamp: settings.clamp,
    area_bound: settings.area_bound when settings.geometry == 'bounded',
) // Diffuse irradiance, with noise.
#output verified: Reservoirs(
    count: view.width * view.height * reservoirs.per_pixel,
    per_pixel: reservoirs.per_pixel,
    bound: reservoirs.bound,
    least: reservoirs.least,
    doubt: reservoirs.doubt,
) // The same reservoirs; the guess of the visibility is what the rays have found, for the next frame.
#exact bound: set(clamp: 0.0, area_bound: 0.0, geometry: 'disc') // Light from discs of the area that each light stands for.

#import "camera.wgsl"
#import "light-geometry.wgsl"
#import "light-ray.wgsl"
#import "reservoirs.wgsl"
#import "view-place.wgsl"

struct Settings {
    view_size: vec2<u32>,
    reservoirs_per_pixel: u32,
    reservoirs_doubt: f32,
    /// Distance b below which a light gives only d² / b² of what it would, as a fraction of the scene's dense extent; 0 is no such bound.
    /// Larger: smaller bright spots near lights, but more energy lost near corners, which alpha has and `bias-compensation`
    /// returns. [default: 0.0, min: 0.0, max: 1.0]
    clamp: f32,
    /// Distance below which a light gives no more, in radii of a disc of the area that it stands for, where `geometry` is bounded; at most
    /// a fifth of the scene's dense extent. 0 is no such bound. [default: 1.0, min: 0.0, max: 100.0]
    area_bound: f32,
}

var<uniform> settings: Settings;
var<storage, read> reservoirs: Reservoirs;
var irradiance: texture_storage_2d<rgba32float, write>;
var<storage, read_write> verified: Reservoirs;

@compute @workgroup_size(8, 8)
fn shade(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= settings.view_size) {
        return;
    }
    let place = place_at(id.xy, settings.view_size);
    let first = reservoir_of_pixel(id.xy, 0u, settings.reservoirs_per_pixel, settings.view_size.x);
    var sum = vec4(0.0);
    for (var slot = 0u; slot < settings.reservoirs_per_pixel; slot++) {
        let reservoir = reservoirs.reservoirs[first + slot];
        let light = reservoir.light;
        var is_lit = false;
        if place.seen && reservoir.weight > 0.0 {
            let terms = light_geometry(light, place.at, place.normal, settings.clamp, settings.area_bound);
            if terms.x > 0.0 && is_before(light, place.at, place.plane) && is_free(light, place.at, place.plane, FAR) {
                is_lit = true;
                sum += light_sum(light.flux, terms) * reservoir.weight;
            }
        }
        verified.reservoirs[first + slot] = reservoir;
        verified.reservoirs[first + slot].guess = select(settings.reservoirs_doubt, 1.0, is_lit);
    }
    textureStore(irradiance, id.xy, sum / f32(settings.reservoirs_per_pixel));
}
