// Points whose arrivals are first, where each arrives after an exponentially distributed time with its weight as rate: what
// drawing one after the other, each in proportion to the weights that are left, would give. [Efraimidis, Spirakis 2006]

#import "algorithms/select.wgsl"
#import "exponential.wgsl"
#import "random.wgsl"
#import "surface-points.wgsl"
#import "weights.wgsl"

struct Settings {
    points_count: u32,
    /// The number of points to choose.
    count: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
var<storage, read> weights: array<Scaled>;
/// [points]
var<storage, read_write> keys: array<u32>;
/// The key of the last arrival that is taken.
var<storage, read_write> last_key: u32;
var<storage, read_write> taken: array<u32>;

/// A number in the order of arrivals, with ten bits of exponent and 22 of mantissa; the greatest without a weight.
fn arrival_key(i: u32) -> u32 {
    let weight = weights[i];
    if weight.value == 0.0 {
        return 0xffffffffu;
    }
    let random = hash2(hash2(settings.seed, points.header.iteration), i);
    let x = clamp(f32(random) * 0x1p-32f, 0x1p-33f, 0.99999994);
    let arrival = quotient(Scaled(exponential_time(x), 0), weight);
    return (u32(clamp(arrival.exponent + 512, 0, 1022)) << 22u) | ((bitcast<u32>(arrival.value) & 0x7fffffu) >> 1u);
}

/// Gives each point its key.
@compute @workgroup_size(GROUP_SIZE)
fn arrive(row: Row) {
    let i = index_in(row, GROUP_SIZE);
    if i < settings.points_count {
        keys[i] = arrival_key(i);
    }
}

fn select_length() -> u32 {
    return settings.points_count;
}

fn select_rank() -> u32 {
    return settings.count - 1u;
}

fn select_key(i: u32) -> u32 {
    return keys[i];
}

fn select_store(key: u32) {
    last_key = key;
}

/// Takes a point or not; 2 where it arrives together with the last, of whom the first in their order are taken.
@compute @workgroup_size(GROUP_SIZE)
fn take(row: Row) {
    let i = index_in(row, GROUP_SIZE);
    if i >= settings.points_count {
        return;
    }
    let key = keys[i];
    let together = key == last_key && weights[i].value > 0.0;
    taken[i] = select(select(0u, 2u, together), 1u, key < last_key);
}
