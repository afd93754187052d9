// Shows where virtual lights lie on the surfaces in view, over what they light.
//
// Each light has a dot, over the indirect light in false colors, as in TCAS Fig. 5.

#input lights: VirtualLights // The lights, whose places get a dot each.
#input view: GBuffer // The surfaces to show them on.
#input irradiance: Irradiance optional // The irradiance shown under the dots in false colors; else gray.
#output display: Display(size: like(view) / view.supersampling) // Dots over false colors.

#option IRRADIANCE false // whether there is light to show under the dots

#import "camera.wgsl"
#import "color.wgsl"
#import "dispatch.wgsl"
#import "virtual-lights.wgsl"

struct Settings {
    view_size: vec2<u32>,
    view_supersampling: u32,
    display_size: vec2<u32>,
    /// Radius of a dot. More: lights are easier to see, and hide more of each other. [default: 1.5, min: 0.5, max: 16.0, unit: "px"]
    dot: f32,
    /// Luminance of the irradiance in the middle of the scale of colors. [default: 0.2, min: 1e-12, max: 1e12, unit: "W/m²"]
    middle: f32,
}

var<uniform> settings: Settings;
var view_depth: texture_2d<f32>;
#if IRRADIANCE
var irradiance: texture_2d<f32>;
#endif
var<storage, read> lights: VirtualLights;
/// The least index of the lights whose places fall into a pixel. [scratch,
/// count: (view.width / view.supersampling) * (view.height / view.supersampling)]
var<storage, read_write> nearest: array<atomic<u32>>;
var display: texture_storage_2d<rgba8unorm, write>;

const NO_LIGHT: u32 = 0xffffffffu;

/// Dots of lights that shine, and of those that are dark.
const BRIGHT: vec3<f32> = vec3(1.0);
const DARK: vec3<f32> = vec3(0.0);

/// [threads: display.width * display.height]
@compute @workgroup_size(64)
fn clear(row: Row) {
    let pixel = index_in(row, 64u);
    if pixel < arrayLength(&nearest) {
        atomicStore(&nearest[pixel], NO_LIGHT);
    }
}

/// [threads: lights.count]
@compute @workgroup_size(64)
fn place(row: Row) {
    let index = index_in(row, 64u);
    if index >= min(lights.count, arrayLength(&lights.lights)) {
        return;
    }
    let clip = camera.clip_from_world * vec4(lights.lights[index].position, 1.0);
    // Behind the camera w is negative; beside the image the comparison fails, as it does with what is no number.
    if !(clip.w > 0.0 && all(abs(clip.xy) < vec2(clip.w))) {
        return;
    }
    let at = (clip.xy / clip.w * vec2(0.5, -0.5) + 0.5) * vec2<f32>(settings.display_size);
    let pixel = min(vec2<u32>(at), settings.display_size - 1u);
    atomicMin(&nearest[pixel.y * settings.display_size.x + pixel.x], index);
}

/// The color of the dot that covers `at` [m], which a pixel sees at this depth; negative where none does. Of several, the one whose light
/// is nearest.
fn dot_over(pixel: vec2<u32>, at: vec3<f32>, depth: f32) -> vec3<f32> {
    // The dot is a disc on the surface, so lights that something hides have none.
    var farthest = settings.dot * 2.0 * camera.half_extent.y * depth / f32(settings.display_size.y);
    var color = vec3(-1.0);
    let reach = i32(ceil(settings.dot)) + 1;
    for (var y = -reach; y <= reach; y++) {
        for (var x = -reach; x <= reach; x++) {
            let other = vec2<i32>(pixel) + vec2(x, y);
            if any(other < vec2(0)) || any(vec2<u32>(other) >= settings.display_size) {
                continue;
            }
            let index = atomicLoad(&nearest[u32(other.y) * settings.display_size.x + u32(other.x)]);
            if index == NO_LIGHT {
                continue;
            }
            let away = distance(at, lights.lights[index].position);
            if away < farthest {
                farthest = away;
                color = select(DARK, BRIGHT, any(lights.lights[index].flux > vec3(0.0)));
            }
        }
    }
    return color;
}

/// From blue over green to red, as `scale` goes from 0 to 1.
fn false_color(scale: f32) -> vec3<f32> {
    return clamp(1.5 - abs(4.0 * scale - vec3(3.0, 2.0, 1.0)), vec3(0.0), vec3(1.0)) * 0.8;
}

@compute @workgroup_size(8, 8)
fn show(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= settings.display_size) {
        return;
    }
    // Of a view with more samples, one for each pixel.
    let sample = id.xy * settings.view_supersampling;
    let depth = textureLoad(view_depth, sample, 0).x;
    var color = vec3(0.0);
    if depth > 0.0 {
        color = vec3(0.2);
#if IRRADIANCE
        let light = luminance(textureLoad(irradiance, sample, 0).rgb);
        color = false_color(light / (light + settings.middle));
#endif
        let at = camera.position + pixel_ray(vec2<f32>(sample), settings.view_size) * depth;
        let over = dot_over(id.xy, at, depth);
        color = select(over, color, over.x < 0.0);
    }
    textureStore(display, id.xy, vec4(color, 1.0));
}
