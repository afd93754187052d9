// Resamples the light of each pixel from that of this frame and that of the frame before, along the motion of surfaces. [Bitterli et
// al. 2020]
//
// Both are weighted by the balance heuristic: by how likely each of the two pixels would have chosen the light. A light of the frame
// before is what it was then, so it counts only while lights and geometry stand still.

#input view: GBuffer // The pixels.
#input reservoirs: Reservoirs // The lights that this frame chose for them.
#input reprojection: Reprojection like view // Where the surface of each pixel was.
#input still: Progress optional // Frames since lights or geometry have moved. Without it, none ever has.
#input seen: SeenSurfaces optional // What the pixels of the frame before showed: `prev` of the pass `reproject`.
#input past: Reservoirs optional // Their lights. Without it, there is nothing to reuse.
#output reused: Reservoirs(
    count: view.width * view.height * reservoirs.per_pixel,
    per_pixel: reservoirs.per_pixel,
    bound: reservoirs.bound,
    least: reservoirs.least,
    doubt: reservoirs.doubt,
) // The lights of both.

#option PAST false // whether there is a frame before
#option SEEN false // whether it is known what that showed
#option STILL false // whether `still` is linked

#import "camera.wgsl"
#import "dispatch.wgsl"
#import "progress.wgsl"
#import "random.wgsl"
#import "reprojection.wgsl"
#import "resampling.wgsl"
#import "view-place.wgsl"

struct Settings {
    view_size: vec2<u32>,
    reservoirs_per_pixel: u32,
    reservoirs_bound: f32,
    reservoirs_least: f32,
#if PAST
    past_age: u32,
#endif
    /// The most that the frame before counts, in numbers of lights that this frame has chosen from. More: less noise in each frame, but
    /// frames that are more alike, so that their mean has more. [default: 20.0, min: 0.0, max: 65536.0]
    most: f32,
    /// The same in a frame in which lights or geometry have moved. Above 0 there is light of the frame before.
    /// [default: 0.0, min: 0.0, max: 65536.0]
    most_moved: f32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read> reservoirs: Reservoirs;
#if PAST && SEEN
var reprojection_place: texture_2d<f32>;
var reprojection_texels: texture_2d<u32>;
var seen_position: texture_2d<f32>;
var seen_normal: texture_2d<f32>;
var<storage, read> past: Reservoirs;
#if STILL
var<storage, read> still: Progress;
#endif
#endif
var<storage, read_write> reused: Reservoirs;

#if PAST && SEEN
/// Returns one of the texels of the frame before that showed the surface of a pixel, by their shares in an interpolation; outside of
/// the frame where there is none.
fn texel_before(pixel: vec2<u32>, number: f32) -> vec2<u32> {
    let texels = textureLoad(reprojection_texels, pixel, 0).x;
    let at = textureLoad(reprojection_place, pixel, 0).xy - 0.5;
    let share = at - floor(at);
    var sum = 0.0;
    var found = settings.view_size;
    for (var t = 0u; t < 4u; t++) {
        let corner = vec2(t & 1u, t >> 1u);
        let shares = select(1.0 - share, share, corner == vec2(1u));
        // Where all others show something else, the one that has no share counts too.
        let part = shares.x * shares.y + 1e-6;
        if (texels & (1u << t)) != 0u {
            sum += part;
            if part > number * sum {
                found = vec2<u32>(vec2<i32>(floor(at)) + vec2<i32>(corner));
            }
        }
    }
    return found;
}

/// The most that the frame before counts, in numbers of lights that this frame has chosen from.
fn most_of_past() -> f32 {
#if STILL
    if still.step == 0u {
        return settings.most_moved;
    }
#endif
    return settings.most;
}
#endif

/// Resamples a reservoir of a pixel. [sampled, threads: view.width * view.height * reservoirs.per_pixel]
@compute @workgroup_size(64)
fn reuse(row: Row) {
    let index = index_in(row, 64u);
    let pixel = pixel_of_reservoir(index, settings.reservoirs_per_pixel, settings.view_size.x);
    if pixel.y >= settings.view_size.y {
        return;
    }
    let own = reservoirs.reservoirs[index];
    var result = own;
#if PAST && SEEN
    let place = place_at(pixel, settings.view_size);
    let key = hash2(settings.seed, index);
    let texel = texel_before(pixel, unit_float(hash2(key, 0u)));
    if settings.past_age > 0u && place.seen && all(texel < settings.view_size) {
        let slot = index % settings.reservoirs_per_pixel;
        var before =
            past.reservoirs[reservoir_of_pixel(texel, slot, settings.reservoirs_per_pixel, settings.view_size.x)];
        before.count = min(before.count, most_of_past() * own.count);
        let by = Target(settings.reservoirs_bound, settings.reservoirs_least);
        let here = Receiver(place.at, place.normal);
        let there = Receiver(textureLoad(seen_position, texel, 0).xyz, textureLoad(seen_normal, texel, 0).xyz);
        // What each of the two pixels has for the light of each.
        let own_here = contribution(by, own.light, here);
        let own_there = contribution(by, own.light, there);
        let before_here = contribution(by, before.light, here);
        let before_there = contribution(by, before.light, there);
        var choice = Resampling(no_light(0.0), 0.0, 0.0);
        let own_value = own_here * own.guess;
        let own_share = share_of(own.count * own_here, before.count * own_there);
        offer(&choice, own, own_value, own_share * own_value * own.weight, unit_float(hash2(key, 1u)));
        let before_value = before_here * before.guess;
        let before_share = share_of(before.count * before_there, own.count * before_here);
        offer(&choice, before, before_value, before_share * before_value * before.weight, unit_float(hash2(key, 2u)));
        result = chosen(choice, own.count + before.count);
    }
#endif
    reused.reservoirs[index] = result;
}
