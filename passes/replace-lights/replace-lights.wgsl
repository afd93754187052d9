// Puts the strongest candidates in place of lights that reach nothing in view, or are the weakest. [SMC-IR §3.2.5, Alg. 1]
//
// Lines 9 to 16 of the algorithm. Removed are the lights that reach nothing in view, the weakest first, and after them the
// weakest; chosen are the strongest candidates. Ties go by index. Slots and candidates are matched by rank of their index, so
// that no part of the slots gets all the strong lights. Intensities, radiosity over density (Eq. 6), are compared as whole
// numbers of the same order.

#input lights: SurfacePoints // The lights of the frame before; marked are those to go first.
#input mailboxes: SurfacePoints // For each light, a point in view that it reaches.
#input intensities: VirtualLights // The lights of the frame before: `prev` of what is made of `replaced`.
#input candidates: SurfacePoints // The candidates for new lights: as many as there are slots.
#input origins: SurfacePoints // For each candidate, the point in view that it was traced from.
#input radiosity: Radiosity // Radiosity of the candidates.
#input density: Density // Density of the lights around each candidate.
#output replaced: SurfacePoints(count: candidates.count) // The lights now; its header's `marked` counts the new ones.
#output witnesses: SurfacePoints(count: candidates.count) // For each of them, a point that it reaches.
#output progress: Progress // The number of iterations before the first frame.

#import "algorithms/scaled.wgsl"
#import "algorithms/workgroup.wgsl"
#import "color.wgsl"
#import "dispatch.wgsl"
#import "point-radiosity.wgsl"
#import "progress.wgsl"
#import "surface-points.wgsl"
#import "virtual-lights.wgsl"

struct Settings {
    candidates_count: u32,
    /// The most lights replaced in a frame, M_max. More: lights follow camera and light sources sooner, and flicker more. 0:
    /// none, once there are lights. [default: 16, min: 0, max: 65536]
    moved: u32,
    /// Share of the lights that a candidate has to outshine to be a sign that there are too few where it is. Less: more lights
    /// move in frames in which all reach the view. [default: 0.95, min: 0.0, max: 1.0]
    quantile: f32,
    /// Iterations before the first frame. More: lights are better distributed when it comes, after a longer wait. [default:
    /// 100, min: 0, max: 1000]
    warm_up: u32,
    /// How many times `moved` lights are replaced at most in each of these iterations, and how many times as great a share of the lights a
    /// candidate may not outshine. More: fewer iterations distribute lights as well. [default: 1, min: 1, max: 1000]
    haste: u32,
}

/// The size of a replacement.
struct Decision {
    /// Lights that give way.
    removed: u32,
    /// Candidates that become lights.
    chosen: u32,
}

var<uniform> settings: Settings;
var<storage, read> lights: SurfacePoints;
var<storage, read> mailboxes: SurfacePoints;
var<storage, read> intensities: VirtualLights;
var<storage, read> candidates: SurfacePoints;
var<storage, read> origins: SurfacePoints;
var<storage, read> radiosity: PointRadiosities;
var<storage, read> density: array<f32>;
/// By slot: bits of the intensity, and VALID; NO_KEY where there is no light. [scratch, count: candidates.count]
var<storage, read_write> light_keys: array<u32>;
/// Bits of the intensity of each candidate; NO_KEY where there is none. [scratch, count: candidates.count]
var<storage, read_write> candidate_keys: array<u32>;
/// By slot: which of the chosen candidates comes there; NO_KEY where none does. [scratch, count: candidates.count]
var<storage, read_write> newcomers: array<u32>;
/// The candidates that are chosen. [scratch, count: candidates.count]
var<storage, read_write> chosen: array<u32>;
/// The numbers of lights that give way and of candidates that are chosen. [scratch]
var<storage, read_write> decision: Decision;
var<storage, read_write> replaced: SurfacePoints;
var<storage, read_write> witnesses: SurfacePoints;
var<storage, read_write> progress: Progress;

/// The key of what is not there.
const NO_KEY: u32 = 0xffffffffu;

/// Set in the key of a light that reaches what is in view, as far as is known: intensities are positive, and have no sign.
const VALID: u32 = 0x80000000u;

/// The key of the light in a slot.
fn light_key(slot: u32) -> u32 {
    // There may have been another number of lights, or none.
    if slot >= min(lights.header.count, intensities.count) {
        return NO_KEY;
    }
    let point = lights.points[slot];
    if point.triangle == NO_TRIANGLE {
        return NO_KEY;
    }
    // A flux is radiosity over density, shared out over all lights.
    let intensity = weight_of(luminance(intensities.lights[slot].flux) * f32(settings.candidates_count));
    return bitcast<u32>(intensity) | select(0u, VALID, point.mark == 0u);
}

/// Gives each slot and each candidate its key.
@compute @workgroup_size(64)
fn rank(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.candidates_count {
        return;
    }
    light_keys[index] = light_key(index);
    var key = NO_KEY;
    if candidates.points[index].triangle != NO_TRIANGLE && density[index] > 0.0 {
        key = bitcast<u32>(weight_of(luminance(radiosity.radiosities[index].radiosity) / density[index]));
    }
    candidate_keys[index] = key;
}

/// Orders of keys, least first.
const BY_INTENSITY: u32 = 0u;
const BY_USE: u32 = 1u;
const STRONGEST_CANDIDATE: u32 = 2u;

var<workgroup> digits: array<atomic<u32>, 256>;
var<workgroup> narrowed: vec2<u32>;

/// The key in an order; NO_KEY is no part of it.
fn ordered_key(order: u32, i: u32) -> u32 {
    if order == STRONGEST_CANDIDATE {
        let key = candidate_keys[i];
        return select(~VALID - key, NO_KEY, key == NO_KEY);
    }
    let key = light_keys[i];
    return select(key, key & ~VALID, order == BY_INTENSITY && key != NO_KEY);
}

/// A key, and how many of its equals with lower indices come before it.
struct Ranked {
    key: u32,
    equals: u32,
}

/// The key of a rank, below the number of those that are there. All threads call it.
fn ranked(thread: u32, order: u32, rank: u32) -> Ranked {
    var key = 0u;
    var left = rank;
    for (var shift = 24i; shift >= 0i; shift -= 8i) {
        atomicStore(&digits[thread], 0u);
        workgroupBarrier();
        for (var i = thread; i < settings.candidates_count; i += GROUP_SIZE) {
            let other = ordered_key(order, i);
            // The digits above agree; above the highest there are none.
            if other != NO_KEY && (shift == 24i || other >> u32(shift + 8i) == key >> u32(shift + 8i)) {
                atomicAdd(&digits[(other >> u32(shift)) & 255u], 1u);
            }
        }
        workgroupBarrier();
        let count = atomicLoad(&digits[thread]);
        let sum = prefix_sum_u32(thread, count).x;
        if left < sum && left >= sum - count {
            narrowed = vec2(thread, left - (sum - count));
        }
        let found = workgroupUniformLoad(&narrowed);
        key |= found.x << u32(shift);
        left = found.y;
        workgroupBarrier();
    }
    return Ranked(key, left);
}

/// Counts the keys of an order, and those below a bound. All threads call it.
fn counted(thread: u32, order: u32, bound: u32) -> vec2<u32> {
    var here = vec2(0u);
    for (var i = thread; i < settings.candidates_count; i += GROUP_SIZE) {
        let key = ordered_key(order, i);
        if key != NO_KEY {
            here += vec2(1u, select(0u, 1u, key < bound));
        }
    }
    return vec2(prefix_sum_u32(thread, here.x).y, prefix_sum_u32(thread, here.y).y);
}

/// Decides which lights give way to which candidates, in one workgroup. [threads: 1]
@compute @workgroup_size(GROUP_SIZE)
fn decide(@builtin(local_invocation_index) thread: u32) {
    let lights = counted(thread, BY_USE, VALID);
    let there = counted(thread, STRONGEST_CANDIDATE, 0u).x;
    let empty = settings.candidates_count - lights.x;

    let haste = select(1u, settings.haste, candidates.header.iteration < settings.warm_up);
    let moved = settings.moved * haste;
    // Eq. 9: candidates stronger than most lights.
    let quantile = max(settings.quantile - f32(haste - 1u) * (1.0 - settings.quantile), 0.0);
    let most = u32(ceil(quantile * f32(lights.x)));
    let threshold = ranked(thread, BY_INTENSITY, max(most, 1u) - 1u).key;
    let strong = counted(thread, STRONGEST_CANDIDATE, ~VALID - threshold).y;
    // DEVIATION(stay): a light gives way to a candidate, and stays where there is none for its place.
    let wanted = min(max(lights.y, min(strong, moved)), moved);
    let removed = select(0u, min(wanted, there - min(there, empty)), lights.x > 0u);
    let taken = min(there, empty + removed);

    let last_removed = ranked(thread, BY_USE, max(removed, 1u) - 1u);
    let last_chosen = ranked(thread, STRONGEST_CANDIDATE, max(taken, 1u) - 1u);
    free_slots(thread, removed, taken, last_removed);
    choose(thread, taken, last_chosen);
    if thread == 0u {
        decision = Decision(removed, taken);
    }
}

/// Gives the slots that are empty, and those whose lights are removed, one of the chosen candidates each.
fn free_slots(thread: u32, removed: u32, taken: u32, last: Ranked) {
    var equals_before = 0u;
    var free_before = 0u;
    for (var block = 0u; block < settings.candidates_count; block += GROUP_SIZE) {
        let slot = block + thread;
        let exists = slot < settings.candidates_count;
        var key = 0u;
        if exists {
            key = light_keys[slot];
        }
        let is_equal = exists && removed > 0u && key == last.key;
        let equals = prefix_sum_u32(thread, select(0u, 1u, is_equal));
        let gives_way = removed > 0u && (key < last.key || (is_equal && equals_before + equals.x <= last.equals + 1u));
        let is_free = exists && (key == NO_KEY || gives_way);
        let free = prefix_sum_u32(thread, select(0u, 1u, is_free));
        if exists {
            let rank = free_before + free.x - 1u;
            newcomers[slot] = select(NO_KEY, rank, is_free && rank < taken);
        }
        equals_before += equals.y;
        free_before += free.y;
    }
}

/// Lists the chosen candidates by index.
fn choose(thread: u32, taken: u32, last: Ranked) {
    var equals_before = 0u;
    var chosen_before = 0u;
    for (var block = 0u; block < settings.candidates_count; block += GROUP_SIZE) {
        let index = block + thread;
        var key = NO_KEY;
        if index < settings.candidates_count {
            key = ordered_key(STRONGEST_CANDIDATE, index);
        }
        let is_equal = taken > 0u && key != NO_KEY && key == last.key;
        let equals = prefix_sum_u32(thread, select(0u, 1u, is_equal));
        let is_chosen = taken > 0u
            && (key < last.key || (is_equal && equals_before + equals.x <= last.equals + 1u));
        let ranks = prefix_sum_u32(thread, select(0u, 1u, is_chosen));
        if is_chosen {
            chosen[chosen_before + ranks.x - 1u] = index;
        }
        equals_before += equals.y;
        chosen_before += ranks.y;
    }
}

/// Puts the chosen candidates in place of the lights that give way.
@compute @workgroup_size(64)
fn replace(row: Row) {
    let slot = index_in(row, 64u);
    if slot >= settings.candidates_count {
        return;
    }
    var light = no_point();
    var mailbox = no_point();
    let newcomer = newcomers[slot];
    if newcomer != NO_KEY {
        let candidate = chosen[newcomer];
        light = candidates.points[candidate];
        mailbox = origins.points[candidate];
    } else if slot < min(lights.header.count, mailboxes.header.count) {
        light = lights.points[slot];
        mailbox = mailboxes.points[slot];
    }
    light.mark = 0u;
    replaced.points[slot] = light;
    witnesses.points[slot] = mailbox;
    if slot == 0u {
        let iteration = candidates.header.iteration;
        replaced.header = SurfacePointsHeader(settings.candidates_count, iteration, decision.chosen, 0u);
        witnesses.header = SurfacePointsHeader(settings.candidates_count, iteration, 0u, 0u);
        let step = min(iteration + 1u, settings.warm_up);
        progress = Progress(step, settings.warm_up, 0.0, select(0u, 1u, step >= settings.warm_up));
    }
}
