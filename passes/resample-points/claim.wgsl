// Independent draws in parallel, which claim the points that they find. A draw whose point another has claimed tries again in
// the next round. [SMC-IR §3.2.1]
//
// Of the draws that find a point, the one with the least number has it, and numbers rise from round to round: so it does not
// matter which comes first.

#import "dispatch.wgsl"
#import "random.wgsl"
#import "surface-points.wgsl"

struct Settings {
    points_count: u32,
    /// The number of draws.
    count: u32,
    round: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
var<storage, read> cumulated: array<f32>;
/// [points] Number of the draw that has a point: its round times `count`, and its index.
var<storage, read_write> claims: array<atomic<u32>>;
/// [count] The point that a draw has found last.
var<storage, read_write> found: array<u32>;
var<storage, read_write> taken: array<u32>;

const UNCLAIMED: u32 = 0xffffffffu;

@compute @workgroup_size(64)
fn clear_claims(row: Row) {
    let i = index_in(row, 64u);
    if i < settings.points_count {
        atomicStore(&claims[i], UNCLAIMED);
    }
}

/// The first point whose sum exceeds a number in [0, 1) times the sum of all, which is not 0.
fn point_at(number: f32) -> u32 {
    let total = cumulated[settings.points_count - 1u];
    // The product can round up to the total; below it, the last point with a weight is found.
    let sought = min(number * total, bitcast<f32>(bitcast<u32>(total) - 1u));
    var low = 0u;
    var high = settings.points_count - 1u;
    while low < high {
        let middle = (low + high) / 2u;
        if cumulated[middle] > sought {
            high = middle;
        } else {
            low = middle + 1u;
        }
    }
    return low;
}

@compute @workgroup_size(64)
fn claim(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.count || cumulated[settings.points_count - 1u] == 0.0 {
        return;
    }
    // Draws of this round have greater numbers, and change no claim of a round before.
    if settings.round > 0u && atomicLoad(&claims[found[index]]) % settings.count == index {
        return;
    }
    let draw = settings.round * settings.count + index;
    let point = point_at(unit_float(hash2(hash2(settings.seed, points.header.iteration), draw)));
    found[index] = point;
    atomicMin(&claims[point], draw);
}

/// Takes the points that are claimed.
@compute @workgroup_size(64)
fn take(row: Row) {
    let i = index_in(row, 64u);
    if i < settings.points_count {
        taken[i] = select(0u, 1u, atomicLoad(&claims[i]) != UNCLAIMED);
    }
}
