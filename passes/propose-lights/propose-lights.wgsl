// Chooses a virtual light for each pixel, nearly in proportion to what the light gives there. [Talbot et al. 2005; Bitterli et al. 2020]
//
// Candidates are chosen among all lights, in strata; some of them are kept, by their target over the probability of proposing them. A
// module of the visibility is a factor of the target, as a guess: it decides how often a light is chosen, and not what the light gives.
//
// The reservoirs of a pixel choose among the same candidates, each in a part of the sum of their weights, and the samples of a picture
// choose at numbers of one sequence. Where the lights are in the order of a tree, those parts are parts of space.

#input view: GBuffer // The pixels for which lights are chosen.
#input lights: VirtualLights // The lights.
#input tree: LightTree optional // A tree over the lights, which gives candidates that are chosen all alike the order of its leaves: what a
    // pixel chooses is then spread over the scene. With `descend`, candidates are chosen down the tree.
#input visibility: Visibility optional // Guess of the visibility of the lights; without it, the target has none.
#output reservoirs: Reservoirs(
    count: view.width * view.height * settings.per_pixel,
    per_pixel: settings.per_pixel,
    bound: settings.bound,
    least: settings.least,
    doubt: settings.doubt,
) // The lights that were chosen.

#option PROPOSAL power one_of [power, uniform] // How candidates are chosen. power: in proportion to the luminance of their flux.
    // uniform: all alike, which is in proportion to their importance or their flux where the lights were sampled by that.
#option DESCEND false // Whether candidates are chosen down the tree, where there is one: nearly in proportion to what they give to the
    // pixel without occluders. They cost more, and fewer are needed.
#option TREE false // whether there is a tree over the lights
#option VISIBILITY false // whether something guesses which lights are seen

#import "camera.wgsl"
#import "cumulative-choice.wgsl"
#import "dispatch.wgsl"
#import "random.wgsl"
#import "resampling.wgsl"
#import "sobol.wgsl"
#import "view-place.wgsl"
#if TREE && DESCEND
#import "light-tree.wgsl"
#elif TREE && PROPOSAL == uniform
#import "light-nodes.wgsl"
#endif
#if VISIBILITY
#import interface "visibility"
#endif

struct Settings {
    view_size: vec2<u32>,
    /// Candidates of each pixel. More: less noise, and more time. [default: 32, min: 1, max: 65536]
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
    /// What this dispatch takes, from `begin` to `end`: blocks of candidates, or reservoirs.
    begin: u32,
    end: u32,
    seed: u32,
    sample: u32,
}

var<uniform> settings: Settings;
var<storage, read> lights: VirtualLights;
var<storage, read_write> reservoirs: Reservoirs;
/// For each block of candidates, and in it for each pixel, the sum of the weights of these and of those before.
/// [scratch, count: view.width * view.height * ((settings.candidates + BLOCK - 1) / BLOCK)]
var<storage, read_write> sums: array<f32>;

/// Candidates whose sum is kept, so that only those of the blocks that are chosen from are evaluated again.
const BLOCK: u32 = 8u;

fn block_count() -> u32 {
    return (settings.candidates + BLOCK - 1u) / BLOCK;
}

#if PROPOSAL == power && !(TREE && DESCEND)
/// Sums of the luminance of the lights' flux.
var<storage, read> power_sums: array<f32>;
#endif

/// The index of the distribution of lights by their flux.
const OF_FLUX: u32 = 0xffffffffu;

struct Distribution {
    /// That of the blocks of a pixel, whose index this is; or OF_FLUX.
    index: u32,
}

fn cumulated(which: Distribution, i: u32) -> f32 {
#if PROPOSAL == power && !(TREE && DESCEND)
    if which.index == OF_FLUX {
        return power_sums[i];
    }
#endif
    return sums[i * settings.view_size.x * settings.view_size.y + which.index];
}

/// A light, and the probability of proposing it; 0 where there is none.
struct Proposal {
    index: u32,
    probability: f32,
}

fn light_count() -> u32 {
    return min(lights.count, arrayLength(&lights.lights));
}

/// A number in a stratum of [0, 1), below 1 also where it is rounded.
fn number_in(stratum: u32, bits: u32) -> f32 {
    return min((f32(stratum) + unit_float(bits)) / f32(settings.candidates), ALMOST_ONE);
}

#if TREE && DESCEND
fn propose(stratum: u32, bits: u32, receiver: Receiver) -> Proposal {
    // So the tree can choose any light, as the target asks.
    light_floor = vec2(settings.least * term_at_extent(), settings.least);
    let width = 0xffffffffu / settings.candidates;
    let choice = choose_light(receiver.at, receiver.normal, stratum * width + multiply_high(bits, width));
    return Proposal(choice.index, choice.probability);
}
#elif PROPOSAL == power
fn propose(stratum: u32, bits: u32, receiver: Receiver) -> Proposal {
    let count = light_count();
    if count == 0u || power_sums[max(count, 1u) - 1u] <= 0.0 {
        return Proposal();
    }
    let choice = choose(Distribution(OF_FLUX), count, number_in(stratum, bits));
    return Proposal(choice.index, choice.probability);
}
#elif TREE
var<storage, read> tree: LightTree;

fn propose(stratum: u32, bits: u32, receiver: Receiver) -> Proposal {
    if tree.count == 0u {
        return Proposal();
    }
    let leaf = min(u32(number_in(stratum, bits) * f32(tree.count)), tree.count - 1u);
    return Proposal(tree.nodes[tree.leaves + leaf].light, 1.0 / f32(tree.count));
}
#else
fn propose(stratum: u32, bits: u32, receiver: Receiver) -> Proposal {
    let count = light_count();
    if count == 0u {
        return Proposal();
    }
    return Proposal(min(u32(number_in(stratum, bits) * f32(count)), count - 1u), 1.0 / f32(count));
}
#endif

/// A pixel that chooses lights.
struct Chooser {
    place: Place,
    receiver: Receiver,
    /// Where its candidates are in their strata, and its choices in their parts of the sum of weights, in units of 2^-32.
    numbers: vec2<u32>,
}

fn chooser(index: u32) -> Chooser {
    let width = settings.view_size.x;
    let place = place_at(vec2(index % width, index / width), settings.view_size);
    return Chooser(
        place,
        Receiver(place.at, place.normal),
        sobol2_bits_of(settings.sample, hash2(settings.seed, index)),
    );
}

/// A candidate of a pixel.
struct Candidate {
    light: VirtualLight,
    index: u32,
    guess: f32,
    /// Its target.
    value: f32,
    /// Its target over the number of candidates and the probability of proposing it.
    weight: f32,
}

fn candidate(pixel: Chooser, i: u32) -> Candidate {
    var found: Candidate;
    let proposal = propose(i, pixel.numbers.x, pixel.receiver);
    if proposal.probability <= 0.0 {
        return found;
    }
    found.light = lights.lights[proposal.index];
    found.index = proposal.index;
    found.guess = 1.0;
#if VISIBILITY
    found.guess = mix(settings.doubt, 1.0, visibility(proposal.index, found.light, pixel.place.at, pixel.place.plane));
#endif
    found.value = contribution(Target(settings.bound, settings.least), found.light, pixel.receiver) * found.guess;
    found.weight = weight_of(found.value / (proposal.probability * f32(settings.candidates)));
    return found;
}

/// Sums the weights of the candidates of a pixel.
/// [threads: view.width * view.height, items: (settings.candidates + BLOCK - 1) / BLOCK,
/// iterations: BLOCK * (1 + visibility.iterations)]
@compute @workgroup_size(64)
fn weigh(row: Row) {
    let index = index_in(row, 64u);
    let pixels = settings.view_size.x * settings.view_size.y;
    if index >= pixels {
        return;
    }
    let pixel = chooser(index);
    var sum = 0.0;
    if settings.begin > 0u {
        sum = cumulated(Distribution(index), settings.begin - 1u);
    }
    for (var block = settings.begin; block < min(settings.end, block_count()); block++) {
        let end = min((block + 1u) * BLOCK, settings.candidates);
        for (var i = block * BLOCK; i < end && pixel.place.seen; i++) {
            sum = weight_of(sum + candidate(pixel, i).weight);
        }
        sums[block * pixels + index] = sum;
    }
}

/// The light at which the sum of the weights of a pixel's candidates passes this part of the whole.
fn choose_at(pixel: Chooser, index: u32, part: f32, sum: f32) -> Reservoir {
    let block = choose(Distribution(index), block_count(), part).index;
    var before = 0.0;
    if block > 0u {
        before = cumulated(Distribution(index), block - 1u);
    }
    var chosen = no_light(f32(settings.candidates));
    let end = min((block + 1u) * BLOCK, settings.candidates);
    for (var i = block * BLOCK; i < end && before <= part * sum; i++) {
        let found = candidate(pixel, i);
        before = weight_of(before + found.weight);
        if found.weight > 0.0 {
            let weight = weight_of(sum / found.value);
            chosen = Reservoir(found.light, weight, chosen.count, found.guess, found.index);
        }
    }
    return chosen;
}

/// Chooses a light for each reservoir of a pixel.
/// [threads: view.width * view.height, items: settings.per_pixel, iterations: BLOCK * (3 + visibility.iterations)]
@compute @workgroup_size(64)
fn choose_lights(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.view_size.x * settings.view_size.y {
        return;
    }
    let pixel = chooser(index);
    let sum = cumulated(Distribution(index), block_count() - 1u);
    for (var slot = settings.begin; slot < min(settings.end, settings.per_pixel); slot++) {
        let part = (f32(slot) + unit_float(pixel.numbers.y)) / f32(settings.per_pixel);
        var chosen = no_light(f32(settings.candidates));
        if sum > 0.0 {
            chosen = choose_at(pixel, index, part, sum);
        }
        reservoirs.reservoirs[index * settings.per_pixel + slot] = chosen;
    }
}
