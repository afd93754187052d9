// Takes the virtual lights that pixels chose most.
//
// Numbers are whole, and of lights that were chosen equally often the first are taken: the result does not depend on the order of
// threads.

#input view: GBuffer // The pixels that chose.
#input lights: VirtualLights // The lights.
#input reservoirs: Reservoirs // Which of them the pixels chose in this frame.
#output chosen: VirtualLights(count: min(settings.count, lights.count)) // Those that were chosen most, in their order.
#output places: Owners(count: lights.count) // For each light, its place among `chosen`; none where it is not there.

#import "algorithms/select.wgsl"
#import "dispatch.wgsl"
#import "owners.wgsl"
#import "reservoirs.wgsl"

struct Settings {
    view_size: vec2<u32>,
    reservoirs_per_pixel: u32,
    lights_count: u32,
    /// The most lights to take. A light that no pixel chose is not taken. [default: 16, min: 1, max: 65536]
    count: u32,
}

var<uniform> settings: Settings;
var<storage, read> lights: VirtualLights;
var<storage, read> reservoirs: Reservoirs;
/// How often each light was chosen.
var<storage, read_write> times: array<atomic<u32>>;
/// How often the last light that is taken was chosen. [scratch]
var<storage, read_write> least: u32;
var<storage, read_write> chosen: VirtualLights;
var<storage, read_write> places: array<u32>;

fn light_count() -> u32 {
    return min(lights.count, settings.lights_count);
}

/// One thread a light.
@compute @workgroup_size(GROUP_SIZE)
fn begin(row: Row) {
    let i = index_in(row, GROUP_SIZE);
    if i < settings.lights_count {
        atomicStore(&times[i], 0u);
    }
}

/// One thread a reservoir.
@compute @workgroup_size(GROUP_SIZE)
fn count(row: Row) {
    let i = index_in(row, GROUP_SIZE);
    if i >= settings.view_size.x * settings.view_size.y * settings.reservoirs_per_pixel {
        return;
    }
    let index = reservoirs.reservoirs[i].index;
    if reservoirs.reservoirs[i].weight > 0.0 && index < light_count() {
        atomicAdd(&times[index], 1u);
    }
}

fn select_length() -> u32 {
    return light_count();
}

fn select_rank() -> u32 {
    return settings.count - 1u;
}

/// The more often a light was chosen, the less.
fn select_key(i: u32) -> u32 {
    return ~atomicLoad(&times[i]);
}

fn select_store(key: u32) {
    least = ~key;
}

/// Takes the lights that were chosen more often than the last one, and as many of those that were chosen as often as there is room
/// for: in one workgroup.
@compute @workgroup_size(GROUP_SIZE)
fn take(@builtin(local_invocation_index) thread: u32) {
    let last = least;
    // Its rank among those that were chosen as often.
    let room = selection.rank + 1u;
    var taken = 0u;
    var alike = 0u;
    for (var block = 0u; block < settings.lights_count; block += GROUP_SIZE) {
        let i = block + thread;
        var often = 0u;
        if i < light_count() {
            often = atomicLoad(&times[i]);
        }
        let is_alike = often == last && often > 0u;
        let ranks_alike = prefix_sum_u32(thread, select(0u, 1u, is_alike));
        let is_taken = often > last || (is_alike && alike + ranks_alike.x <= room);
        let ranks = prefix_sum_u32(thread, select(0u, 1u, is_taken));
        if i < settings.lights_count {
            places[i] = NO_OWNER;
            if is_taken {
                let place = taken + ranks.x - 1u;
                places[i] = place;
                chosen.lights[place] = lights.lights[i];
            }
        }
        taken += ranks.y;
        alike += ranks_alike.y;
    }
    for (var i = taken + thread; i < min(settings.count, settings.lights_count); i += GROUP_SIZE) {
        chosen.lights[i] = VirtualLight(vec3(0.0), 0.0, vec3(0.0, 0.0, 1.0), 0u, vec3(0.0), ON_SURFACE);
    }
    if thread == 0u {
        chosen.count = taken;
        chosen.pad0 = 0u;
        chosen.pad1 = 0u;
        chosen.pad2 = 0u;
    }
}
