// Finds the emptiest place, after what was placed last is taken into account.

#import "algorithms/reduce.wgsl"
#import "hear.wgsl"
#import "holes.wgsl"

struct Settings {
    count: u32,
    probes: u32,
}

var<uniform> settings: Settings;
/// By the first slot of a source: its first slot that waits.
var<storage, read> waiting: array<u32>;
/// [scratch]
var<storage, read_write> hole: Hole;

alias Reduced = Hole;

/// The emptiness around a probe; negative where nothing is to be placed. A crowded light does not count: it goes.
fn emptiness(index: u32, share: Share) -> f32 {
    if choice.mode == CHOICE_FILL && waiting[share.first] != NO_SLOT {
        return probes[index].distance * share.density;
    }
    if choice.mode == CHOICE_CROWD && choice.slot >= share.first && choice.slot < share.end {
        var distance = probes[index].distance;
        if owners[index] == choice.slot {
            distance = nearest_site(probes[index].place, share, choice.slot).distance;
        }
        return distance * share.density;
    }
    return -1.0;
}

fn reduce_length() -> u32 {
    return settings.count * settings.probes;
}

fn reduce_element(i: u32) -> Reduced {
    if choice.mode == CHOICE_REST && choice.placed == NO_SLOT {
        return reduce_identity();
    }
    let share = shares[i / settings.probes];
    if share.source == NO_SOURCE {
        return reduce_identity();
    }
    hear(i, share);
    return Hole(emptiness(i, share), i);
}

fn reduce_identity() -> Reduced {
    return Hole(-1.0, 0u);
}

fn reduce_both(a: Reduced, b: Reduced) -> Reduced {
    return emptier(a, b);
}

fn reduce_workgroup(thread: u32, own: Reduced) -> Reduced {
    return emptiest(thread, own);
}

fn reduce_store(result: Reduced) {
    hole = result;
}
