// Finds where what each pixel shows was in the frame before. [Nehab et al. 2007; Karis 2014]
//
// There are two answers. For what belongs to surfaces, such as irradiance, a texel of the frame before counts where it shows the
// surface of the pixel. For the picture, pixels at an edge show one of its sides in one frame and the other in the next, as
// places within pixels differ: there a texel counts where it shows what any pixel around this one shows, and the motion is
// that of the nearest of these, since the side in front decides where the edge is.

#input view: GBuffer // What is seen now, with `motion`.
#input still: Progress optional // Frames since lights or geometry have moved. While the camera stands still too, every texel counts.
#input past: SeenSurfaces optional // What was seen: `prev` of the output `seen`. Without it nothing has been.
#output surface: Reprojection // Where the surface of each pixel was.
#output picture: Reprojection // Where the part of the picture around each pixel was.
#output seen: SeenSurfaces // What the next frame compares with.

#option PAST false // whether there is a frame before
#option STILL false // whether `still` is linked

#import "camera.wgsl"
#import "progress.wgsl"
#import "reprojection.wgsl"
#import "surface-around.wgsl"

struct Settings {
    view_size: vec2<u32>,
#if PAST
    past_age: u32,
#endif
}

var<uniform> settings: Settings;
#if PAST
var view_motion: texture_2d<f32>;
var past_position: texture_2d<f32>;
var past_normal: texture_2d<f32>;
#if STILL
var<storage, read> still: Progress;
#endif
#endif
var surface_place: texture_storage_2d<rg32float, write>;
var surface_texels: texture_storage_2d<r32uint, write>;
var picture_place: texture_storage_2d<rg32float, write>;
var picture_texels: texture_storage_2d<r32uint, write>;
var seen_position: texture_storage_2d<rgba32float, write>;
var seen_normal: texture_storage_2d<rgba16float, write>;

/// What one texel of a frame shows.
struct Shown {
    /// World space [m].
    position: vec3<f32>,
    /// Along the viewing axis [m]; 0 where nothing is seen.
    depth: f32,
    /// Of its plane; unit.
    normal: vec3<f32>,
}

/// A place in the frame before, and which of the four texels around it count.
struct Place {
    at: vec2<f32>,
    texels: u32,
}

fn shown_now(pixel: vec2<u32>) -> Shown {
    let depth = textureLoad(view_depth, pixel, 0).x;
    let normal = plane_normal(pixel, textureLoad(view_normal, pixel, 0).xyz);
    return Shown(position_from_depth(pixel, settings.view_size, depth), depth, normal);
}

#if PAST
fn shown_before(texel: vec2<u32>) -> Shown {
    let at = textureLoad(past_position, texel, 0);
    return Shown(at.xyz, at.w, textureLoad(past_normal, texel, 0).xyz);
}

/// Whether two texels of one frame and the next show the same surface, or both nothing.
fn is_same(now: Shown, before: Shown) -> bool {
    if now.depth <= 0.0 || before.depth <= 0.0 {
        return max(now.depth, before.depth) <= 0.0;
    }
    let off = abs(dot(now.normal, before.position - now.position));
    return off <= SAME_PLANE * now.depth && dot(now.normal, before.normal) >= SAME_NORMAL;
}

/// Whether neither camera nor lights nor geometry have moved.
fn stands_still() -> bool {
#if STILL
    var same = still.step > 0u;
    for (var column = 0u; column < 4u; column++) {
        same &= all(camera.previous_clip_from_world[column] == camera.clip_from_world[column]);
    }
    return same;
#else
    return false;
#endif
}

/// The eight pixels around one, and itself.
fn around(pixel: vec2<i32>, i: i32) -> vec2<i32> {
    return clamp(pixel + vec2(i % 3 - 1, i / 3 - 1), vec2(0), vec2<i32>(settings.view_size) - 1);
}

/// Where what a pixel shows was in the frame before, minus where it is [px].
fn motion_of(pixel: vec2<i32>) -> vec2<f32> {
    var motion = vec2(0.0);
    if textureLoad(view_depth, pixel, 0).x > 0.0 {
        motion = textureLoad(view_motion, pixel, 0).xy;
    } else {
        // What is seen is as far away as can be.
        let at = vec2<f32>(pixel) + 0.5;
        let size = vec2<f32>(settings.view_size);
        let clip = camera.previous_clip_from_world * vec4(pixel_ray(vec2<f32>(pixel), settings.view_size), 0.0);
        let before = (clip.xy / clip.w * vec2(0.5, -0.5) + 0.5) * size;
        motion = select(before - at, 2.0 * size, clip.w <= 0.0);
    }
    return select(motion, vec2(0.0), all(abs(motion) < vec2(ROUNDING)));
}

/// The nearest of the pixels around one.
fn nearest_around(pixel: vec2<i32>) -> vec2<i32> {
    var nearest = pixel;
    var depth = 0.0;
    for (var i = 0; i < 9; i++) {
        let other = around(pixel, i);
        let found = textureLoad(view_depth, other, 0).x;
        if found > 0.0 && (depth == 0.0 || found < depth) {
            nearest = other;
            depth = found;
        }
    }
    return nearest;
}

fn is_in_frame(texel: vec2<i32>) -> bool {
    return all(texel >= vec2(0)) && all(texel < vec2<i32>(settings.view_size));
}

/// The place of a pixel's surface. Where none of the four texels shows it, that of a texel beside them that does.
fn place_of_surface(pixel: vec2<i32>, own: Shown) -> Place {
    var place = Place(vec2<f32>(pixel) + 0.5 + motion_of(pixel), 0u);
    let first = vec2<i32>(floor(place.at - 0.5));
    let share = place.at - 0.5 - vec2<f32>(first);
    var found = false;
    for (var t = 0u; t < 4u; t++) {
        let at = vec2(t & 1u, t >> 1u);
        let texel = first + vec2<i32>(at);
        if is_in_frame(texel) && is_same(own, shown_before(vec2<u32>(texel))) {
            place.texels |= 1u << t;
            found |= all(select(1.0 - share, share, at == vec2(1u)) > vec2(0.0));
        }
    }
    let nearest = vec2<i32>(floor(place.at));
    for (var i = 0; i < 9 && !found; i++) {
        let texel = nearest + vec2(i % 3 - 1, i / 3 - 1);
        if is_in_frame(texel) && is_same(own, shown_before(vec2<u32>(texel))) {
            place = Place(vec2<f32>(texel) + 0.5, 1u);
            found = true;
        }
    }
    return place;
}

/// The place of the part of the picture around a pixel.
fn place_of_picture(pixel: vec2<i32>) -> Place {
    var place = Place(vec2<f32>(pixel) + 0.5 + motion_of(nearest_around(pixel)), 0u);
    let first = vec2<i32>(floor(place.at - 0.5));
    for (var t = 0u; t < 4u; t++) {
        let texel = first + vec2(i32(t & 1u), i32(t >> 1u));
        if !is_in_frame(texel) {
            continue;
        }
        let before = shown_before(vec2<u32>(texel));
        for (var i = 0; i < 9; i++) {
            // The pixel itself first.
            if is_same(shown_now(vec2<u32>(around(pixel, (i + 4) % 9))), before) {
                place.texels |= 1u << t;
                break;
            }
        }
    }
    return place;
}

/// The greatest motion that is rounding [px].
const ROUNDING: f32 = 1e-3;
#endif

/// Finds both. [sampled]
@compute @workgroup_size(8, 8)
fn reproject(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= settings.view_size) {
        return;
    }
    let pixel = vec2<i32>(id.xy);
    let own = shown_now(id.xy);
    let centre = vec2<f32>(id.xy) + 0.5;
    var surface = Place(centre, 0u);
    var picture = surface;
#if PAST
    if settings.past_age > 0u {
        surface = place_of_surface(pixel, own);
        if stands_still() {
            picture = Place(centre, 1u | STANDS_STILL);
        } else {
            picture = place_of_picture(pixel);
        }
    }
#endif
    textureStore(surface_place, id.xy, vec4(surface.at, 0.0, 0.0));
    textureStore(surface_texels, id.xy, vec4(surface.texels));
    textureStore(picture_place, id.xy, vec4(picture.at, 0.0, 0.0));
    textureStore(picture_texels, id.xy, vec4(picture.texels));
    textureStore(seen_position, id.xy, vec4(own.position, own.depth));
    textureStore(seen_normal, id.xy, vec4(own.normal, 0.0));
}
