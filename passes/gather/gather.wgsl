// Sums the irradiance of virtual lights at the camera's pixels, interleaved. [ISM §4]
//
// irradiance: rgba32float [W/m²]; in alpha the luminance of what the clamp removed [W/m²].

#input view: GBuffer // The pixels at which light is gathered.
#input lights: VirtualLights // The lights.
#input visibility: Visibility optional // The visibility of the lights; without it, all are visible.
#output irradiance: Irradiance(
    interleave_x: min(settings.interleave_x * view.supersampling, view.width),
    interleave_y: min(settings.interleave_y * view.supersampling, view.height),
    clamp: settings.clamp,
    area_bound: settings.area_bound when settings.geometry == 'bounded',
) // Diffuse irradiance, with noise if interleaved.
#exact interleaving: set(interleave_x: 1, interleave_y: 1) // Each pixel takes all lights.
#exact bound: set(clamp: 0.0, area_bound: 0.0, geometry: 'disc') // Light from discs of the area that each light stands for.

#import "gather-lights.wgsl"

struct Settings {
    view_size: vec2<u32>,
    view_supersampling: u32,
    /// Number of sub-images along a row, at most one per pixel. Each pixel takes one of interleave_x · interleave_y subsets of
    /// the lights. More: less time, but more noise for a filter to remove. With 1 × 1 each pixel takes all lights. ISM Tab. 1
    /// uses 4 and 8. [default: 4, min: 1, max: 16]
    interleave_x: u32,
    /// Number of sub-images along a column, as `interleave_x` of a row. [default: 4, min: 1, max: 16]
    interleave_y: u32,
    /// The lights that form a subset. runs: consecutive lights. strides: every (n·m)-th light. Consecutive elements of a Halton
    /// sequence are stratified; every (n·m)-th ones share digits, and so lie in strips. Strides suit lights that are sorted by
    /// position. [default: "runs", one_of: ["runs", "strides"]]
    subsets: u32,
    /// Distance b below which a light gives only d² / b² of what it would, as a fraction of the scene's dense extent; 0 is no such bound.
    /// Larger: smaller bright spots near lights, but more energy lost near corners, which alpha has and `bias-compensation`
    /// returns. [default: 0.0, min: 0.0, max: 1.0]
    clamp: f32,
    /// Distance below which a light gives no more, in radii of a disc of the area that it stands for, where `geometry` is bounded; at most
    /// a fifth of the scene's dense extent. 0 is no such bound. With more lights, less is lost; `bias-compensation` returns it.
    /// [default: 1.0, min: 0.0, max: 100.0]
    area_bound: f32,
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

var irradiance: texture_storage_2d<rgba32float, write>;

/// Irradiance, and the luminance of what the bound removed [W/m²].
alias Sum = vec4<f32>;

struct Receiver {
    place: Place,
    sum: Sum,
}

fn receiver(place: Place) -> Receiver {
    return Receiver(place, Sum());
}

fn contribution(receiver: Receiver, light: VirtualLight, index: u32, terms: vec2<f32>) -> Sum {
    return light_sum(light.flux, terms);
}

fn store(pixel: vec2<u32>, sum: Sum, seen: bool) {
    textureStore(irradiance, pixel, sum);
}
