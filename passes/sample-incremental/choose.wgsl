// Chooses which light goes where, one after the other, in one workgroup. [Laine et al. 2007; ACRSM §3.2.3]
//
// Slots that wait come first, wherever it is emptiest. Then the light that is nearest to another goes to the emptiest place of
// its source, if it is farther from all others there. Whatever it comes near to is then no nearer to it than that, so with
// each there are fewer lights as near to another as it was, and a still scene comes to rest.

#import "algorithms/workgroup.wgsl"
#import "holes.wgsl"
#import "nearest-site.wgsl"

struct Settings {
    count: u32,
    probes: u32,
}

var<uniform> settings: Settings;
var<storage, read> shares: array<Share>;
var<storage, read> probes: array<Probe>;
var<storage, read> hole: Hole;
var<storage, read_write> neighbours: array<Nearest>;
/// By the first slot of a source: its first slot that waits. [scratch, count: settings.count]
var<storage, read_write> waiting: array<atomic<u32>>;
/// [scratch]
var<storage, read_write> choice: Choice;

/// Above the distance of every neighbour.
const NONE_CROWDED: f32 = 1e38;

/// The factor by which a place has to be farther from others, in squares: by a tenth. Less would move lights for rounding's sake.
const FARTHER: f32 = 1.21;

/// The number of slots.
fn slots() -> u32 {
    return min(settings.count, arrayLength(&sites));
}

/// Decides what is placed next, if anything is. All threads call it.
fn next(thread: u32, placed: u32, new_lights: u32, may_place: bool) {
    for (var i = thread; i < slots(); i += GROUP_SIZE) {
        atomicStore(&waiting[i], NO_SLOT);
    }
    storageBarrier();
    // Of the thread's slots: the light that is nearest to another, by the negative of the distance, as a hole has it.
    var crowded = Hole(-NONE_CROWDED, 0u);
    var waits = 0.0;
    for (var i = thread; i < slots(); i += GROUP_SIZE) {
        if sites[i].state == SITE_WAITING {
            atomicMin(&waiting[shares[i].first], i);
            waits = 1.0;
        } else if neighbours[i].slot != NO_SLOT {
            crowded = emptier(crowded, Hole(-neighbours[i].distance * shares[i].density, i));
        }
    }
    let any_waits = workgroup_max(thread, waits) > 0.0;
    crowded = emptiest(thread, crowded);
    if thread == 0u {
        var mode = CHOICE_REST;
        if may_place && any_waits {
            mode = CHOICE_FILL;
        } else if may_place && crowded.key > -NONE_CROWDED {
            mode = CHOICE_CROWD;
        }
        choice = Choice(mode, crowded.probe, -crowded.key, placed, new_lights);
    }
}

/// Begins a frame. At a start all lights are new, and none is placed again.
@compute @workgroup_size(GROUP_SIZE)
fn begin(@builtin(local_invocation_index) thread: u32) {
    var here = 0u;
    for (var i = thread; i < slots(); i += GROUP_SIZE) {
        here += select(0u, 1u, sites[i].state == SITE_NEW);
    }
    let new_lights = prefix_sum_u32(thread, here).y;
    next(thread, NO_SLOT, new_lights, new_lights == 0u);
}

/// Places the light that was decided on, if there is a place for it, and decides on the next.
@compute @workgroup_size(GROUP_SIZE)
fn choose(@builtin(local_invocation_index) thread: u32) {
    let now = choice;
    let share = shares[hole.probe / settings.probes];
    var slot = NO_SLOT;
    if now.mode == CHOICE_FILL && hole.key >= 0.0 {
        slot = atomicLoad(&waiting[share.first]);
    } else if now.mode == CHOICE_CROWD && hole.key > FARTHER * now.crowd {
        // DEVIATION(rest): a light that would be no farther from others elsewhere stays.
        slot = now.slot;
    }
    storageBarrier();
    if thread == 0u && slot != NO_SLOT {
        sites[slot] = Site(probes[hole.probe].place, SITE_NEW);
    }
    storageBarrier();
    if slot != NO_SLOT {
        meet(thread, slot, share);
    }
    storageBarrier();
    let new_lights = now.new_lights + select(0u, 1u, slot != NO_SLOT);
    next(thread, slot, new_lights, slot != NO_SLOT);
}

/// Finds the nearest neighbours of the light that was placed, and of those that it left or came near to.
fn meet(thread: u32, slot: u32, share: Share) {
    let place = sites[slot].place;
    for (var i = share.first + thread; i < min(share.end, slots()); i += GROUP_SIZE) {
        if i == slot || neighbours[i].slot == slot {
            if sites[i].state >= SITE_KEPT {
                neighbours[i] = nearest_site(sites[i].place, share, i);
            }
        } else if sites[i].state >= SITE_KEPT {
            let distance = squared_distance(place, sites[i].place);
            if distance < neighbours[i].distance || (distance == neighbours[i].distance && slot < neighbours[i].slot) {
                neighbours[i] = Nearest(distance, slot);
            }
        }
    }
}
