// Makes virtual lights of points on surfaces, with the flux of all photons that land nearest to them.
//
// So the flux of all lights is that of all photons, wherever lights lie and why ever they were chosen: a partition of unity. It is a
// mean over frames. Where lights come and go, what is known of their flux is handed on to those that are nearest now; where the view
// comes to see more, photons from there count whole; and where it no longer sees, the part of those that did not land is lost. Sums
// are whole numbers of 64 bits, so that the order of threads changes nothing.

#input points: SurfacePoints // The positions of the lights.
#input density: Density // The density of the points, for the areas of the lights.
#input photons: VirtualLights // Photons where they meet surfaces.
#input owners: Owners // The point that is nearest to each photon; none where a photon does not count.
#input before: SurfacePoints // The lights of the frame before, where they are now; marked are those that bequeath nothing.
#input owners_before: Owners // Which of these is nearest to each photon; none where the photon would not have counted then.
#input heirs: Owners // The point that is nearest to each of these.
#input past: VirtualLights // These as lights: `prev` of the output.
#input unmoved: VirtualLights // Any history buffer that begins again where lights or surfaces move: its age alone is read.
#output lights: VirtualLights(count: points.count) // A light for each point; dark where there is none.

#option NORMAL_MAPPED false // whether any material of the scene has a normal map

#import "algorithms/scaled.wgsl"
#import "dispatch.wgsl"
#import "horizon.wgsl"
#import "surface-points.wgsl"
#import "virtual-lights.wgsl"

struct Settings {
    points_count: u32,
    photons_count: u32,
    before_count: u32,
    /// Frames since there is a history; 0 where there is none.
    past_age: u32,
    /// Frames since lights or surfaces moved.
    unmoved_age: u32,
    /// The most frames that a flux is the mean of. More: less noise, but light follows later where the camera moves.
    /// [default: 64, min: 1, max: 65536]
    frames: u32,
    /// The same in the frame in which lights or surfaces move. More: less noise, but light follows later.
    /// [default: 8, min: 1, max: 65536]
    moving_frames: u32,
}

/// What is measured of all photons and lights.
struct Measured {
    /// Points that become lights.
    points: atomic<u32>,
    /// Bits of the largest flux of a photon, and of a light of the frame before.
    fresh: atomic<u32>,
    past: atomic<u32>,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
var<storage, read> density: array<f32>;
var<storage, read> photons: VirtualLights;
var<storage, read> owners: array<u32>;
var<storage, read> before: SurfacePoints;
var<storage, read> owners_before: array<u32>;
var<storage, read> heirs: array<u32>;
var<storage, read> past: VirtualLights;
/// [scratch, cleared]
var<storage, read_write> measured: Measured;
/// For each point, sums of two words, low and high: red, green and blue of its photons that would have counted in the frame before,
/// of its others, and of what is handed on to it; and the same of what normal maps add to normals. [scratch, count: points.count, cleared]
var<storage, read_write> sums: array<array<atomic<u32>, WORDS>>;
/// For each light of the frame before, the weight of its photons in two words. [scratch, count: before.count, cleared]
var<storage, read_write> weights_before: array<array<atomic<u32>, 2>>;
var<storage, read_write> lights: VirtualLights;

/// Places of the sums of a channel c: AGAIN + c, FIRST + c and HANDED + c; of what normal maps add, BENDS more.
const AGAIN: u32 = 0u;
const FIRST: u32 = 3u;
const HANDED: u32 = 6u;
const BENDS: u32 = 9u;

#if NORMAL_MAPPED
const WORDS: u32 = 36u;
#else
const WORDS: u32 = 18u;
#endif

/// Binary places of a sum below the leading one of the largest number in it: 2^25 of these fit.
const PLACES: i32 = 36;

fn is_light(index: u32) -> bool {
    return index < min(points.header.count, settings.points_count) && points.points[index].triangle != NO_TRIANGLE;
}

/// Whether there was a light in a slot in the frame before.
fn is_before(index: u32) -> bool {
    return settings.past_age > 0u && index < min(settings.before_count, min(before.header.count, past.count))
        && before.points[index].triangle != NO_TRIANGLE;
}

/// The flux of a photon that counts now or would have counted before; else 0.
fn flux_of(photon: u32) -> vec3<f32> {
    if photon >= min(photons.count, settings.photons_count) {
        return vec3(0.0);
    }
    if owners[photon] >= settings.points_count && owners_before[photon] >= settings.before_count {
        return vec3(0.0);
    }
    return weights_of(photons.lights[photon].flux);
}

fn largest(flux: vec3<f32>) -> u32 {
    return bitcast<u32>(max(flux.r, max(flux.g, flux.b)));
}

/// Finds the largest photon. [threads: photons.count]
@compute @workgroup_size(64)
fn measure_photons(row: Row) {
    let index = index_in(row, 64u);
    if index < settings.photons_count {
        atomicMax(&measured.fresh, largest(flux_of(index)));
    }
}

/// Counts points, and finds the largest light of the frame before. [threads: max(points.count, before.count)]
@compute @workgroup_size(64)
fn measure_lights(row: Row) {
    let index = index_in(row, 64u);
    if is_light(index) {
        atomicAdd(&measured.points, 1u);
    }
    if is_before(index) {
        atomicMax(&measured.past, largest(past.lights[index].flux));
    }
}

/// The exponent of the unit in which numbers are summed of which the largest has these bits.
fn unit_of(bits: u32) -> i32 {
    return i32(bits >> 23u) - 127 - PLACES;
}

/// Low and high word of a number of units.
fn words(value: f32, unit: i32) -> vec2<u32> {
    let units = times_power_of_two(value, -unit);
    let high = floor(units * 0x1p-32f);
    return vec2(u32(units - high * 0x1p32f), u32(high));
}

/// The carry of a low word into the high one: `before` is what the word was when `part` was added to it.
fn carry(before: u32, part: u32) -> u32 {
    return select(0u, 1u, before > 0xffffffffu - part);
}

/// The sum that two words hold.
fn number(low: u32, high: u32, unit: i32) -> f32 {
    return times_power_of_two(f32(high) * 0x1p32f + f32(low), unit);
}

fn add(point: u32, place: u32, flux: vec3<f32>, unit: i32) {
    for (var c = 0u; c < 3u; c++) {
        let parts = words(flux[c], unit);
        let low = 2u * (place + c);
        let before = atomicAdd(&sums[point][low], parts.x);
        atomicAdd(&sums[point][low + 1u], parts.y + carry(before, parts.x));
    }
}

/// Adds the flux of a light to a point, and what a normal map adds to its normal: from -2 to 2 as from 0 to the weight of its flux.
fn add_light(point: u32, place: u32, flux: vec3<f32>, light: VirtualLight, unit: i32) {
    add(point, place, flux, unit);
#if NORMAL_MAPPED
    add(point, BENDS + place, weight(flux) * (0.5 + 0.25 * bend_of(light)), unit);
#endif
}

/// How much of what a light had goes with a photon: a quarter of its power, so that three channels add up in range.
fn weight(flux: vec3<f32>) -> f32 {
    return flux.r * 0.25 + flux.g * 0.25 + flux.b * 0.25;
}

/// Gives each photon to the point that is nearest, and its weight to the light that was. [threads: photons.count]
@compute @workgroup_size(64)
fn share(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.photons_count {
        return;
    }
    let flux = flux_of(index);
    if !any(flux > vec3(0.0)) {
        return;
    }
    let unit = unit_of(atomicLoad(&measured.fresh));
    let owner = owners[index];
    let old = owners_before[index];
    if owner < settings.points_count {
        add_light(owner, select(FIRST, AGAIN, old < settings.before_count), flux, photons.lights[index], unit);
    }
    if old < settings.before_count {
        let parts = words(weight(flux), unit);
        let low = atomicAdd(&weights_before[old][0], parts.x);
        atomicAdd(&weights_before[old][1], parts.y + carry(low, parts.x));
    }
}

/// The weight of the photons of a light of the frame before.
fn weight_before(light: u32) -> f32 {
    let unit = unit_of(atomicLoad(&measured.fresh));
    return number(atomicLoad(&weights_before[light][0]), atomicLoad(&weights_before[light][1]), unit);
}

/// Hands on what lights had to those that are nearest to their photons now: what they all find is
/// neither lost nor counted twice.
/// [threads: photons.count]
@compute @workgroup_size(64)
fn hand_on(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.photons_count {
        return;
    }
    let flux = flux_of(index);
    let owner = owners[index];
    let old = owners_before[index];
    if any(flux > vec3(0.0)) && owner < settings.points_count && is_before(old) {
        let all = weight_before(old);
        if all > 0.0 {
            let light = past.lights[old];
            add_light(owner, HANDED, light.flux * min(weight(flux) / all, 1.0), light, unit_of(atomicLoad(&measured.past)));
        }
    }
}

/// Hands on what lights without photons had to the nearest light; what reaches nothing in view any more is lost.
/// [threads: before.count]
@compute @workgroup_size(64)
fn bequeath(row: Row) {
    let index = index_in(row, 64u);
    if !is_before(index) || heirs[index] >= settings.points_count {
        return;
    }
    if before.points[index].mark == 0u && weight_before(index) == 0.0 {
        let light = past.lights[index];
        add_light(heirs[index], HANDED, light.flux, light, unit_of(atomicLoad(&measured.past)));
    }
}

fn sum(point: u32, place: u32, unit: i32) -> vec3<f32> {
    var flux: vec3<f32>;
    for (var c = 0u; c < 3u; c++) {
        let low = 2u * (place + c);
        flux[c] = weight_of(number(atomicLoad(&sums[point][low]), atomicLoad(&sums[point][low + 1u]), unit));
    }
    return flux;
}

/// The mean over frames of what a point has. Every light counts its frame alike: if new lights followed faster than those whose flux
/// they took a part of, the sum would not stay. `first` is 0 for flux, and BENDS.
fn mean_over_frames(index: u32, first: u32) -> vec3<f32> {
    let unit = unit_of(atomicLoad(&measured.fresh));
    let handed = sum(index, first + HANDED, unit_of(atomicLoad(&measured.past)));
    let frames = min(min(settings.past_age + 1u, settings.unmoved_age + settings.moving_frames), settings.frames);
    let share = 1.0 / f32(max(frames, 1u));
    return handed * (1.0 - share) + sum(index, first + AGAIN, unit) * share + sum(index, first + FIRST, unit);
}

/// Makes a light in each thread. [threads: points.count]
@compute @workgroup_size(64)
fn make_lights(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.points_count {
        return;
    }
    var light: VirtualLight;
    light.texel = points.points[index].triangle;
    // A light that is dark has a place all the same, where its map may be rendered.
    light.normal = vec3(0.0, 0.0, 1.0);
    if is_light(index) {
        light.position = points.points[index].position;
        light.normal = points.points[index].normal;
        light.area = weight_of(1.0 / (f32(atomicLoad(&measured.points)) * density[index]));
        light.flux = mean_over_frames(index, 0u);
#if NORMAL_MAPPED
        let all = weight(light.flux);
        if all > 0.0 {
            light.kind = kind_of_bend(light.normal, 4.0 * (mean_over_frames(index, BENDS) / all - 0.5));
        }
#endif
    }
    lights.lights[index] = light;
    if index == 0u {
        lights.count = settings.points_count;
    }
}
