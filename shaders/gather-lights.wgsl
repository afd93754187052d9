// Gathers the light of virtual lights at the camera's pixels, interleaved: for passes with the ports `view`, `lights`, `visibility`
// and `irradiance`. [ISM §4]
//
// The pixels are split into n×m interleaved sub-images, and each sub-image takes one of n·m subsets of the lights
// (Segovia et al. 2006).
// A workgroup is 8×8 pixels of one sub-image, so all its threads read the same lights and nearby texels of their maps.
//
// A file that imports this one declares `struct Settings`, as gather.wgsl has it, and what is summed:
//
//     alias Sum                                             a vector or a matrix
//     struct Receiver { place: Place, sum: Sum, … }
//     fn receiver(place: Place) -> Receiver                 with the sum 0
//     fn contribution(receiver: Receiver, light: VirtualLight, index: u32, terms: vec2<f32>) -> Sum
//     fn store(pixel: vec2<u32>, sum: Sum, seen: bool)
//
// where `terms` are those of `light_geometry`, times the visibility; `index` is the light's.

#option VISIBILITY false // whether something says which lights are seen
#option DEFERS false internal // whether `visibility` has `visibility_at_once`: rays are then traced after the lookups that take none

#import "light-geometry.wgsl"
#import "squares.wgsl"
#import "view-place.wgsl"
#import "virtual-lights.wgsl"
#if VISIBILITY
#import interface "visibility"
#endif

var<uniform> settings: Settings;
var<storage, read> lights: VirtualLights;
/// Sums of the dispatches before, pixel by pixel. [scratch, count: view.width * view.height * min(parts - 1, 1)]
var<storage, read_write> sums: array<Sum>;

/// Lights that a workgroup reads at once, at most as many as the bits of two words.
const STAGED: u32 = 64u;
var<workgroup> staged: array<VirtualLight, STAGED>;

/// A subset of the lights: its light k is `first + k * stride`.
struct Subset {
    first: u32,
    count: u32,
    stride: u32,
}

/// Subset s of `subsets`. Every light is in exactly one, also if the count is not a multiple of `subsets`.
fn subset(s: u32, subsets: u32, count: u32) -> Subset {
    if settings.subsets == 0u {
        let first = s * count / subsets;
        return Subset(first, (s + 1u) * count / subsets - first, 1u);
    }
    return Subset(s, (count + subsets - 1u - s) / subsets, subsets);
}

/// Gathers at the pixels of a square of GROUP_SIDE * SPAN in one sub-image. A light takes an iteration, and one more and a lookup
/// for each pixel of a thread. [threads: (
///     ((view.width + irradiance.interleave_x - 1) / irradiance.interleave_x + SQUARE - 1) / SQUARE * GROUP_SIDE,
///     ((view.height + irradiance.interleave_y - 1) / irradiance.interleave_y + SQUARE - 1) / SQUARE * GROUP_SIDE
///         * irradiance.interleave_x * irradiance.interleave_y, 1),
/// items: 1 + lights.count / (min(settings.interleave_x * view.supersampling, view.width)
///     * min(settings.interleave_y * view.supersampling, view.height)),
/// iterations: 1 + SPAN * SPAN * (2 + visibility.iterations)]
@compute @workgroup_size(GROUP_SIDE, GROUP_SIDE)
fn gather(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) local_index: u32,
) {
    let interleave = vec2(settings.irradiance_interleave_x, settings.irradiance_interleave_y);
    let subsets = interleave.x * interleave.y;
    // Workgroups along a sub-image; the number of the widest for all of them. Sub-images follow one after the other, so
    // that the maps of one subset of the lights are in the caches.
    let groups = ((settings.view_size + interleave - 1u) / interleave + SQUARE - 1u) / SQUARE;
    let image = group.y / groups.y;
    let first = vec2(image % interleave.x, image / interleave.x);
    let corner = vec2(group.x, group.y % groups.y) * SQUARE + local.xy;
    var receivers: array<Receiver, SPAN * SPAN>;
    for (var r = 0u; r < SPAN * SPAN; r++) {
        let pixel = (corner + place_in_square(r)) * interleave + first;
        receivers[r] = receiver(place_at(pixel, settings.view_size));
    }
    let own = subset(image, subsets, min(lights.count, arrayLength(&lights.lights)));
    let part_end = min(own.count, settings.end);
    for (var begin = settings.begin; begin < part_end; begin += STAGED) {
        if begin + local_index < part_end {
            staged[local_index] = lights.lights[own.first + (begin + local_index) * own.stride];
        }
        workgroupBarrier();
        let end = min(part_end - begin, STAGED);
#if VISIBILITY && DEFERS
        // By pixel, a bit for each staged light that a ray decides. Threads that trace rays one behind the other wait less for
        // those beside them than threads that trace each where they meet it.
        var deferred = array<vec2<u32>, SPAN * SPAN>();
#endif
        for (var i = 0u; i < end; i++) {
            let light = staged[i];
            let index = own.first + (begin + i) * own.stride;
            for (var r = 0u; r < SPAN * SPAN; r++) {
#if VISIBILITY && DEFERS
                let at_once = light_at_once(receivers[r], light, index);
                receivers[r].sum += at_once.sum;
                deferred[r][i / 32u] |= select(0u, 1u << (i % 32u), at_once.is_deferred);
#else
                receivers[r].sum += light_at(receivers[r], light, index);
#endif
            }
        }
#if VISIBILITY && DEFERS
        for (var r = 0u; r < SPAN * SPAN; r++) {
            while any(deferred[r] != vec2(0u)) {
                let word = select(1u, 0u, deferred[r].x != 0u);
                let i = 32u * word + firstTrailingBit(deferred[r][word]);
                deferred[r][word] &= deferred[r][word] - 1u;
                receivers[r].sum += light_at(receivers[r], staged[i], own.first + (begin + i) * own.stride);
            }
        }
#endif
        workgroupBarrier();
    }
    for (var r = 0u; r < SPAN * SPAN; r++) {
        let place = receivers[r].place;
        if all(place.pixel < settings.view_size) {
            // A subset represents all lights: the mean over the sub-images is the sum over all lights.
            add(place, receivers[r].sum * f32(subsets));
        }
    }
}

var<workgroup> listed: atomic<u32>;
/// Of each pixel of a square that takes all lights, its place in the square.
var<workgroup> list: array<u32, TILE>;
/// Sums over subsets of the lights, of which each belongs to a pixel of the list.
var<workgroup> of_subsets: array<Sum, TILE>;

/// Gathers all lights at pixels whose neighbours lie on other surfaces: no filter finds the subsets there that they lack. A workgroup
/// takes a square of pixels, and a thread a subset for a pixel of them.
/// [threads: (
///     (view.width + GROUP_SIDE - 1) / GROUP_SIDE * GROUP_SIDE,
///     (view.height + GROUP_SIDE - 1) / GROUP_SIDE * GROUP_SIDE, 1),
/// repeat: min(settings.complete_below / (view.supersampling * view.supersampling),
///     irradiance.interleave_x * irradiance.interleave_y - 1, 1),
/// items: 1 + lights.count, iterations: 2 + visibility.iterations]
@compute @workgroup_size(GROUP_SIDE, GROUP_SIDE)
fn complete(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) local_index: u32,
) {
    let interleave = vec2(settings.irradiance_interleave_x, settings.irradiance_interleave_y);
    let subsets = interleave.x * interleave.y;
    if is_alone(id.xy, interleave) {
        list[atomicAdd(&listed, 1u)] = local_index;
    }
    workgroupBarrier();
    let pixels = workgroupUniformLoad(&listed);
    let count = min(lights.count, arrayLength(&lights.lights));
    var whole = Sum();
    for (var first = 0u; first < pixels * subsets; first += TILE) {
        let item = first + local_index;
        if item < pixels * subsets {
            let own = subset(item % subsets, subsets, count);
            let end = min(own.count, settings.end / subsets);
            var one = receiver(place_at(pixel_of_list(group, item / subsets), settings.view_size));
            for (var k = settings.begin / subsets; k < end; k++) {
                let index = own.first + k * own.stride;
                one.sum += light_at(one, lights.lights[index], index);
            }
            of_subsets[local_index] = one.sum;
        }
        workgroupBarrier();
        // Thread j adds up for pixel j of the list.
        let taken_end = min((local_index + 1u) * subsets, min(first + TILE, pixels * subsets));
        for (var taken = max(local_index * subsets, first); taken < taken_end; taken++) {
            whole += of_subsets[taken - first];
        }
        workgroupBarrier();
    }
    if local_index < pixels {
        add(place_at(pixel_of_list(group, local_index), settings.view_size), whole);
    }
}

/// The pixel at a place of the list.
fn pixel_of_list(group: vec3<u32>, place: u32) -> vec2<u32> {
    let index = list[place];
    return group.xy * GROUP_SIDE + vec2(index % GROUP_SIDE, index / GROUP_SIDE);
}

/// Whether a pixel sees a surface that too few pixels of the window of the interleaving see.
fn is_alone(pixel: vec2<u32>, interleave: vec2<u32>) -> bool {
    let place = place_at(pixel, settings.view_size);
    if !place.seen {
        return false;
    }
    let depth = textureLoad(view_depth, pixel, 0).x;
    let around = surface_around(pixel, settings.view_size, depth, place.normal);
    let alike = alike_in_window(around, settings.view_size, interleave);
    // The noise of a sample is divided by their number in the pixel.
    return alike * settings.view_supersampling * settings.view_supersampling < settings.complete_below;
}

/// The terms of a light at a pixel, without its visibility.
fn terms_at(place: Place, light: VirtualLight) -> vec2<f32> {
    let terms = light_geometry(light, place.at, place.normal, settings.clamp, settings.area_bound);
#if VIEW_GEOMETRIC
    return terms * select(0.0, 1.0, is_before(light, place.at, place.plane));
#else
    return terms;
#endif
}

/// What a light gives at a pixel.
fn light_at(receiver: Receiver, light: VirtualLight, index: u32) -> Sum {
    let place = receiver.place;
    var terms = terms_at(place, light);
#if VISIBILITY
    if terms.x > 0.0 && place.seen {
        terms *= visibility(index, light, place.at, place.plane);
    }
#endif
    return contribution(receiver, light, index, terms);
}

#if VISIBILITY && DEFERS
/// What a light gives at a pixel, unless a ray decides that.
struct AtOnce {
    sum: Sum,
    is_deferred: bool,
}

/// What a light gives at a pixel by what its map is sure of.
fn light_at_once(receiver: Receiver, light: VirtualLight, index: u32) -> AtOnce {
    let place = receiver.place;
    var terms = terms_at(place, light);
    if terms.x > 0.0 && place.seen {
        let seen = visibility_at_once(index, light, place.at, place.plane);
        if seen < 0.0 {
            return AtOnce(Sum(), true);
        }
        terms *= seen;
    }
    return AtOnce(contribution(receiver, light, index, terms), false);
}
#endif

/// Adds the sum of a dispatch to those of the dispatches before, and stores what the last makes of them.
fn add(place: Place, part: Sum) {
    var sum = part;
    if !place.seen {
        sum = Sum();
    }
    let index = place.pixel.y * settings.view_size.x + place.pixel.x;
    if settings.begin > 0u {
        sum += sums[index];
    }
    if settings.last == 0u {
        sums[index] = sum;
        return;
    }
    store(place.pixel, sum, place.seen);
}
