// Resamples the light of each pixel from its own and those of pixels around it that show the same surface. [Bitterli et al. 2020;
// Lin et al. 2022]
//
// Lights of other pixels are weighted by how likely each of the pixels would have chosen them: pairwise, of the pixel itself and one
// other (Bitterli 2022), or by the balance heuristic over all.

#input view: GBuffer // The pixels.
#input reservoirs: Reservoirs // The lights that were chosen for them.
#output reused: Reservoirs(
    count: view.width * view.height * reservoirs.per_pixel,
    per_pixel: reservoirs.per_pixel,
    bound: reservoirs.bound,
    least: reservoirs.least,
    doubt: reservoirs.doubt,
) // The lights of the pixel and those around it.

#import "camera.wgsl"
#import "dispatch.wgsl"
#import "random.wgsl"
#import "resampling.wgsl"
#import "view-place.wgsl"

struct Settings {
    view_size: vec2<u32>,
    reservoirs_per_pixel: u32,
    reservoirs_bound: f32,
    reservoirs_least: f32,
    /// Pixels around each whose lights it takes. More: less noise, and more time. [default: 5, min: 0, max: 32]
    neighbours: u32,
    /// How far away they are at most, in heights of the view; at least 4 px. More: lights that differ more, but pixels that are less
    /// alike, and so more noise. [default: 0.03, min: 0.0, max: 1.0]
    radius: f32,
    /// Weights of the lights of other pixels. pairwise: by the pixel itself and one other. balance: by all of them, with time that
    /// grows with the square of their number. constant: by the numbers of lights that they were chosen from (Bitterli et al. 2020,
    /// Alg. 4), with bright dots where pixels differ; and where the target of a light can be 0, light is lost. [default: "pairwise",
    /// one_of: ["pairwise", "balance", "constant"]]
    weights: u32,
    seed: u32,
}

const PAIRWISE: u32 = 0u;
const BALANCE: u32 = 1u;
/// The least radius [px]: within it are enough other pixels.
const LEAST_RADIUS: f32 = 4.0;

var<uniform> settings: Settings;
var<storage, read> reservoirs: Reservoirs;
var<storage, read_write> reused: Reservoirs;

fn receiver_at(pixel: vec2<u32>) -> Receiver {
    let place = place_at(pixel, settings.view_size);
    return Receiver(place.at, place.normal);
}

/// A pixel around another.
struct Neighbour {
    /// Whether it is in the frame and shows the same surface.
    counts: bool,
    pixel: vec2<u32>,
    /// The index of its reservoir.
    index: u32,
}

/// Returns the k-th pixel around one: uniform in a disc.
fn neighbour(around: SurfaceAround, slot: u32, key: u32, k: u32) -> Neighbour {
    let radius = max(settings.radius * f32(settings.view_size.y), LEAST_RADIUS);
    let distance = radius * sqrt(unit_float(hash2(key, 3u * k)));
    let angle = 2.0 * PI * unit_float(hash2(key, 3u * k + 1u));
    let other = around.pixel + vec2<i32>(round(distance * vec2(cos(angle), sin(angle))));
    let pixel = vec2<u32>(other);
    // As unsigned numbers, negative ones are large.
    let counts = any(other != around.pixel) && all(pixel < settings.view_size)
        && is_same_surface(around, other, SAME_PLANE, SAME_NORMAL);
    let index = reservoir_of_pixel(pixel, slot, settings.reservoirs_per_pixel, settings.view_size.x);
    return Neighbour(counts, pixel, index);
}

/// Resamples a reservoir of a pixel. [threads: view.width * view.height * reservoirs.per_pixel]
@compute @workgroup_size(64)
fn reuse(row: Row) {
    let index = index_in(row, 64u);
    let pixel = pixel_of_reservoir(index, settings.reservoirs_per_pixel, settings.view_size.x);
    if pixel.y >= settings.view_size.y {
        return;
    }
    let own = reservoirs.reservoirs[index];
    let depth = textureLoad(view_depth, pixel, 0).x;
    if depth <= 0.0 || settings.neighbours == 0u {
        reused.reservoirs[index] = own;
        return;
    }
    let slot = index % settings.reservoirs_per_pixel;
    let here = receiver_at(pixel);
    let around = surface_around(pixel, settings.view_size, depth, here.normal);
    let by = Target(settings.reservoirs_bound, settings.reservoirs_least);
    let key = hash2(settings.seed, index);
    var all = 0.0;
    for (var k = 0u; k < settings.neighbours; k++) {
        let other = neighbour(around, slot, key, k);
        if other.counts {
            all += reservoirs.reservoirs[other.index].count;
        }
    }
    if all <= 0.0 {
        reused.reservoirs[index] = own;
        return;
    }
    let own_contribution = contribution(by, own.light, here);
    var own_share = 0.0;
    var own_sum = own.count * own_contribution;
    var choice = Resampling(no_light(0.0), 0.0, 0.0);
    for (var k = 0u; k < settings.neighbours; k++) {
        let other = neighbour(around, slot, key, k);
        if !other.counts {
            continue;
        }
        let theirs = reservoirs.reservoirs[other.index];
        let there = receiver_at(other.pixel);
        let contribution_here = contribution(by, theirs.light, here);
        var share = theirs.count / (all + own.count);
        if settings.weights == PAIRWISE {
            // The pixel itself counts in each pair as much as it does in all of them.
            let of_theirs = all * contribution(by, theirs.light, there);
            share = theirs.count / all * share_of(of_theirs, own.count * contribution_here);
            let of_own_there = all * contribution(by, own.light, there);
            own_share += theirs.count / all * share_of(own.count * own_contribution, of_own_there);
        } else if settings.weights == BALANCE {
            var others = own.count * contribution_here;
            for (var j = 0u; j < settings.neighbours; j++) {
                let third = neighbour(around, slot, key, j);
                if third.counts && j != k {
                    others += reservoirs.reservoirs[third.index].count
                        * contribution(by, theirs.light, receiver_at(third.pixel));
                }
            }
            share = share_of(theirs.count * contribution(by, theirs.light, there), others);
            own_sum += theirs.count * contribution(by, own.light, there);
        }
        let value = contribution_here * theirs.guess;
        offer(&choice, theirs, value, share * value * theirs.weight, unit_float(hash2(key, 3u * k + 2u)));
    }
    if settings.weights == BALANCE {
        own_share = own.count * own_contribution / max(own_sum, 1e-37);
    } else if settings.weights != PAIRWISE {
        own_share = own.count / (all + own.count);
    }
    let value = own_contribution * own.guess;
    let number = unit_float(hash2(key, 3u * settings.neighbours));
    offer(&choice, own, value, own_share * value * own.weight, number);
    reused.reservoirs[index] = chosen(choice, all + own.count);
}
