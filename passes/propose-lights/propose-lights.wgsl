// Chooses a virtual light for each pixel, nearly in proportion to what the light gives there. [Talbot et al. 2005; Bitterli et al. 2020]
//
// Candidates are chosen among all lights, in strata; one of them is kept by its target over the probability of proposing it. A
// module of the visibility is a factor of the target, as a guess: it decides how often a light is chosen, and not what the light gives.

#input view: GBuffer // The pixels for which lights are chosen.
#input lights: VirtualLights // The lights.
#input tree: LightTree optional // A tree over the lights: with it, candidates are chosen down the tree, nearly in proportion to what they
    // give to the pixel without occluders. They cost more, and fewer are needed.
#input visibility: Visibility optional // Guess of the visibility of the lights; without it, the target has none.
#output reservoirs: Reservoirs(
    count: view.width * view.height * settings.per_pixel,
    per_pixel: settings.per_pixel,
    bound: settings.bound,
    least: settings.least,
    doubt: settings.doubt,
) // The lights that were chosen.

#option PROPOSAL power one_of [power, uniform] // How candidates are chosen where there is no tree. power: in proportion to the
    // luminance of their flux. uniform: all alike, which is in proportion to their importance or their flux where the lights were
    // sampled by that.
#option TREE false // whether there is a tree over the lights
#option VISIBILITY false // whether something guesses which lights are seen

#import "camera.wgsl"
#import "dispatch.wgsl"
#import "random.wgsl"
#import "resampling.wgsl"
#import "view-place.wgsl"
#if TREE
#import "light-tree.wgsl"
#elif PROPOSAL == power
#import "cumulative-choice.wgsl"
#endif
#if VISIBILITY
#import interface "visibility"
#endif

struct Settings {
    view_size: vec2<u32>,
    /// Candidates of each reservoir. More: less noise, and more time. [default: 32, min: 1, max: 65536]
    candidates: u32,
    /// Reservoirs of a pixel, each of which costs a ray. [default: 1, min: 1, max: 16]
    per_pixel: u32,
    /// Bound of the geometry term in the target, in radii of a disc of the area that a light stands for. Less: lights that are near are
    /// chosen more often. It does not bound what they give. [default: 1.0, min: 0.0, max: 100.0]
    bound: f32,
    /// What is added to the geometry term of each light in the target, in units of that of a light at the distance of the scene's dense
    /// extent. More: lights that give nothing are chosen more often. Less: brighter dots where pixels that differ share lights. With 0,
    /// lights that only one of them could choose make sums wrong. [default: 0.01, min: 0.0, max: 1000.0]
    least: f32,
    /// Visibility in the target of a light that seems to be hidden. More: rays are spent on lights that are hidden. Less: brighter dots
    /// where the guess was wrong. With 0, light is lost there. [default: 0.3, min: 0.0, max: 1.0]
    doubt: f32,
    /// The candidates that this dispatch takes: `begin` to `end`.
    begin: u32,
    end: u32,
    /// 1 for the dispatch that takes the last candidates.
    last: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read> lights: VirtualLights;
var<storage, read_write> reservoirs: Reservoirs;

/// A light, and the probability of proposing it.
struct Proposal {
    index: u32,
    probability: f32,
}

/// A number in a stratum of [0, 1), below 1 also where it is rounded.
fn number_in(stratum: u32, bits: u32) -> f32 {
    return min((f32(stratum) + unit_float(bits)) / f32(settings.candidates), 0.99999994);
}

#if TREE
fn propose(count: u32, stratum: u32, bits: u32, receiver: Receiver) -> Proposal {
    let width = 0xffffffffu / settings.candidates;
    let choice = choose_light(receiver.at, receiver.normal, stratum * width + multiply_high(bits, width));
    return Proposal(choice.index, choice.probability);
}

fn is_dark(count: u32) -> bool {
    return tree.count == 0u;
}
#elif PROPOSAL == power
/// Sums of the luminance of the lights' flux.
var<storage, read> power_sums: array<f32>;

struct Distribution {
    pad: u32,
}

fn cumulated(which: Distribution, i: u32) -> f32 {
    return power_sums[i];
}

fn propose(count: u32, stratum: u32, bits: u32, receiver: Receiver) -> Proposal {
    let choice = choose(Distribution(0u), count, number_in(stratum, bits));
    return Proposal(choice.index, choice.probability);
}

fn is_dark(count: u32) -> bool {
    return count == 0u || power_sums[max(count, 1u) - 1u] <= 0.0;
}
#else
fn propose(count: u32, stratum: u32, bits: u32, receiver: Receiver) -> Proposal {
    return Proposal(min(u32(number_in(stratum, bits) * f32(count)), count - 1u), 1.0 / f32(count));
}

fn is_dark(count: u32) -> bool {
    return count == 0u;
}
#endif

/// Chooses a light for a reservoir. The dispatches before leave the choice so far in the reservoir, with the sum in place of the
/// weight. [threads: view.width * view.height * settings.per_pixel, items: settings.candidates, iterations: 1 + visibility.iterations]
@compute @workgroup_size(64)
fn resample(row: Row) {
    let index = index_in(row, 64u);
    let pixel = pixel_of_reservoir(index, settings.per_pixel, settings.view_size.x);
    if pixel.y >= settings.view_size.y {
        return;
    }
    let place = place_at(pixel, settings.view_size);
    let count = min(lights.count, arrayLength(&lights.lights));
    let candidates = f32(settings.candidates);
    if !place.seen || is_dark(count) {
        reservoirs.reservoirs[index] = no_light(candidates);
        return;
    }
    let receiver = Receiver(place.at, place.normal);
    let by = Target(settings.bound, settings.least);
#if TREE
    // So the tree can choose any light, as the target asks.
    light_floor = vec2(settings.least * term_at_extent(), settings.least);
#endif
    var choice = Resampling(no_light(0.0), 0.0, 0.0);
    if settings.begin > 0u {
        let before = reservoirs.reservoirs[index];
        choice = Resampling(before, contribution(by, before.light, receiver) * before.guess, before.weight);
    }
    let key = hash2(settings.seed, index);
    let end = min(settings.end, settings.candidates);
    for (var i = settings.begin; i < end; i++) {
        let proposal = propose(count, i, hash2(key, 2u * i), receiver);
        if proposal.probability <= 0.0 {
            continue;
        }
        let light = lights.lights[proposal.index];
        var guess = 1.0;
#if VISIBILITY
        guess = mix(settings.doubt, 1.0, visibility(proposal.index, light, place.at, place.plane));
#endif
        let value = contribution(by, light, receiver) * guess;
        let weight = value / (proposal.probability * candidates);
        offer(&choice, Reservoir(light, 0.0, 0.0, guess, proposal.index), value, weight, unit_float(hash2(key, 2u * i + 1u)));
    }
    if settings.last == 0u {
        choice.reservoir.weight = choice.sum;
        reservoirs.reservoirs[index] = choice.reservoir;
        return;
    }
    reservoirs.reservoirs[index] = chosen(choice, candidates);
}
