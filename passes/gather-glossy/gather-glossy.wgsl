// Gathers virtual lights at surfaces that reflect specularly, from surfaces that do: irradiance, and light that is reflected
// towards the camera. [ISM §5, Fig. 8]
//
// A light gives the irradiance that `gather` has, and by its lobe f' more: the radiant intensity (Φ/π + Ψ f'(ψ, ω)) cosθ'. Glossy
// pixels reflect it by their own lobe.

#input view: GBuffer // The pixels at which light is gathered; those with `specular` are glossy.
#input lights: VirtualLights // The lights; those with `lobes` are glossy.
#input visibility: Visibility optional // The visibility of the lights; without it, all are visible.
#output irradiance: Irradiance(
    interleave_x: min(settings.interleave_x * view.supersampling, view.width),
    interleave_y: min(settings.interleave_y * view.supersampling, view.height),
    clamp: settings.clamp,
) // Irradiance, with noise if interleaved.
#output reflected: Radiance // What is reflected specularly, with noise if interleaved.
#exact interleaving: set(interleave_x: 1, interleave_y: 1) // Each pixel takes all lights.
#exact bound: set(clamp: 0.0, area_bound: 0.0, geometry: 'disc') // Light from discs of the area that each light stands for.

#option LIGHTS_LOBES false // whether the lights have the member `lobes`
#option VIEW_SPECULAR false // whether the G-buffer has the member `specular`

#import "gather-lights.wgsl"
#import "lobe.wgsl"

struct Settings {
    view_size: vec2<u32>,
    view_supersampling: u32,
    /// Number of sub-images along a row, at most one per pixel: each pixel takes one of interleave_x · interleave_y subsets of the
    /// lights. More: less time, but more noise for a filter to remove. [default: 4, min: 1, max: 16]
    interleave_x: u32,
    /// Number of sub-images along a column. [default: 4, min: 1, max: 16]
    interleave_y: u32,
    /// The lights that form a subset. runs: consecutive lights. strides: every (n·m)-th light. [default: "runs", one_of: ["runs",
    /// "strides"]]
    subsets: u32,
    /// Distance b below which a light gives only d² / b² of what it would, as a fraction of the scene's dense extent; 0 is no such bound.
    /// Larger: smaller bright spots near lights, but more energy lost near corners. [default: 0.0, min: 0.0, max: 1.0]
    clamp: f32,
    /// Distance below which a light gives no more, in radii of a disc of the area that it stands for, where `geometry` is bounded; at most
    /// a fifth of the scene's dense extent. 0 is no such bound. [default: 1.0, min: 0.0, max: 100.0]
    area_bound: f32,
    /// How surfaces reflect specularly. ggx: microfacets, as glTF's materials and the path tracer have them. phong: cosᴺ of the angle
    /// to the mirror direction (Lafortune & Willems 1994). blinn: cosᴺ of the angle between normal and half vector. Each is
    /// reciprocal; the last two reflect F₀ at normal incidence, and less at grazing angles. [default: "ggx", one_of: ["ggx",
    /// "phong", "blinn"]]
    model: u32,
    /// Exponent N of all glossy surfaces, for the models phong and blinn. 0: a constant. ISM Fig. 8 has 1 to 50. [default: 20.0,
    /// min: 0.0, max: 100000.0]
    exponent: f32,
    /// How far lobes are widened, in angular radii of the disc that a light stands for. 0: not at all, so that a mirror shows each
    /// light as a dot, or not. Less with more lights. [default: 1.0, min: 0.0, max: 100.0]
    widening: f32,
    /// The pixels of one surface in the window of the interleaving below which a pixel takes all lights, itself counted: at edges and on
    /// thin objects, where filters cannot find the subsets that it lacks. Several samples of one pixel count as one. 0 or 1: none
    /// does. More: less noise there, and more time.
    /// [default: 3, min: 0, max: 256]
    complete_below: u32,
    irradiance_interleave_x: u32,
    irradiance_interleave_y: u32,
    /// The lights of each subset that this dispatch takes: `begin` to `end`.
    begin: u32,
    end: u32,
    /// 1 for the dispatch that takes the last lights.
    last: u32,
}

#if LIGHTS_LOBES
#import "virtual-lobe.wgsl"
var<storage, read> lights_lobes: array<VirtualLobe>;
#endif
#if VIEW_SPECULAR
var view_specular: texture_2d<f32>;
#endif
var irradiance: texture_storage_2d<rgba32float, write>;
var reflected: texture_storage_2d<rgba32float, write>;

/// Irradiance and the luminance of what the bound removed [W/m²]; radiance that is reflected specularly [W/(m² sr)].
alias Sum = mat2x4<f32>;

struct Receiver {
    place: Place,
    sum: Sum,
    to_camera: vec3<f32>,
    /// Reflectance at normal incidence, and roughness.
    specular: vec4<f32>,
}

fn receiver(place: Place) -> Receiver {
    var specular = vec4(0.0);
#if VIEW_SPECULAR
    specular = textureLoad(view_specular, min(place.pixel, settings.view_size - 1u), 0);
#endif
    return Receiver(place, Sum(), normalize(camera.position - place.at), specular);
}

fn contribution(receiver: Receiver, light: VirtualLight, index: u32, terms: vec2<f32>) -> Sum {
    var flux = light.flux;
#if LIGHTS_LOBES || VIEW_SPECULAR
    if terms.x + terms.y > 0.0 {
        let place = receiver.place;
        var way = place.at - light.position;
        var spread = 0.0;
        let model = LobeModel(settings.model, settings.exponent);
        if light.kind == INFINITELY_FAR {
            way = light.normal;
        } else {
            let distance2 = max(dot(way, way), 1e-12 * scene_info.extent * scene_info.extent);
            spread = settings.widening * settings.widening * light.area / (PI * distance2);
            way /= sqrt(distance2);
        }
#if LIGHTS_LOBES
        let lobe = lights_lobes[index];
        if light.kind != INFINITELY_FAR && any(lobe.flux > vec3(0.0)) {
            flux += PI * lobe.flux
                * specular_lobe(model, light.normal, lobe.incoming, way, lobe.f0, lobe.roughness, spread);
        }
#endif
#if VIEW_SPECULAR
        if any(receiver.specular.rgb > vec3(0.0)) {
            let f0 = receiver.specular.rgb;
            let roughness = receiver.specular.a;
            let reflectance = specular_lobe(model, place.normal, -way, receiver.to_camera, f0, roughness, spread);
            return Sum(light_sum(flux, terms), vec4(reflectance * flux * terms.x, 0.0));
        }
#endif
    }
#endif
    return Sum(light_sum(flux, terms), vec4(0.0));
}

fn store(pixel: vec2<u32>, sum: Sum, seen: bool) {
    textureStore(irradiance, pixel, sum[0]);
    textureStore(reflected, pixel, vec4(sum[1].rgb, select(0.0, 1.0, seen)));
}
