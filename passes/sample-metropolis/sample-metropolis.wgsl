// Samples virtual lights in proportion to an importance map by independent Metropolis-Hastings chains. [TCAS §4.3, Alg. 1]
//
// One light per chain. What is proposed does not depend on where a chain is, so the importance of all proposals is computed first,
// with a thread for each: there are too few chains to keep a GPU busy. Then each chain is followed by a thread.

#input rsm: ReflectiveShadowMap // The texels to sample.
#input importance: Importance like rsm // What the probability of a texel tends to with M.
#output lights: VirtualLights(count: settings.count) // N lights; those of chains that met no importance are dark.
#exact lights: instead trace-photons(count: settings.count, bounces: 1, albedo: 'textured') // Photons, where they meet surfaces.

#option WEIGHTS local-mean one_of [local-mean, single, none, reservoir] // The estimate of the mean importance in a light's
    // weight. local-mean: the mean over the chain's proposals, which removes most of the start-up bias. single: the importance of
    // the first proposal, which is unbiased, but light intensities vary more (Veach & Guibas 1997). none: the mean over the
    // proposals of all chains, which leaves the start-up bias. reservoir: as local-mean, but the light is one of the chain's
    // proposals chosen in proportion to its importance instead of by Metropolis-Hastings (Talbot, Cline & Egbert 2005): unbiased,
    // at the same cost.

#import "dispatch.wgsl"
#import "proposal.wgsl"
#import "ratio.wgsl"
#import "rsm-light.wgsl"
#import "shuffle.wgsl"

struct Settings {
    /// Number N of virtual lights, one per chain. Error falls as N^-½; the time for shadows and gathering rises with N.
    /// [default: 1024, min: 1, max: 2097152]
    count: u32,
    // The N M elements of the sequence are numbered with 32 bits.
    /// Number M of samples of a chain, of which the last is the light. Larger: lights follow the importance more closely; time
    /// rises with N M. 1: uniform sampling. TCAS §4.3.1 has 5; 32 err less where what matters is a small part of the map.
    /// [default: 5, min: 1, max: 1024]
    steps: u32,
    seed: u32,
    /// The chains of this part: from `first`, `chains` of them.
    first: u32,
    chains: u32,
}

var<uniform> settings: Settings;
#if WEIGHTS == none
/// The sum of f over the proposals of all chains.
var<storage, read> sum: Scaled;
#endif
/// [chains][steps] f of the proposals of this part.
var<storage, read_write> proposed: array<f32>;
var<storage, read_write> lights: VirtualLights;

/// Element of the sequence that is proposed to a chain at a step: step k has elements k N + 1 to k N + N.
fn element(chain: u32, step: u32) -> u32 {
    // DEVIATION(dealt-proposals): in the paper's order, j + k N, all proposals of a chain share their first digits
    // wherever N shares a factor with the base. The first step stays in order: it is uniform sampling.
    var place = chain;
    if step > 0u {
        place = shuffled(chain, settings.count, hash2(settings.seed, step));
    }
    return step * settings.count + place + 1u;
}

@compute @workgroup_size(64)
fn propose(row: Row) {
    let index = index_in(row, 64u);
    if index < settings.chains * settings.steps {
        let element = element(settings.first + index / settings.steps, index % settings.steps);
        proposed[index] = proposed_importance(element, settings.seed);
    }
}

@compute @workgroup_size(64)
fn sample(row: Row) {
    let place = index_in(row, 64u);
    if place >= settings.chains {
        return;
    }
    let chain = settings.first + place;
    let proposals = place * settings.steps;
    if chain == 0u {
        lights.count = settings.count;
    }
    var current = element(chain, 0u);
    var current_importance = proposed[proposals];
    var whole = Scaled(current_importance, 0);
    // DEVIATION(chain-length): M counts the first sample too, as in the paper's text and Fig. 3.
    for (var step = 1u; step < settings.steps; step++) {
        let element = element(chain, step);
        let next = proposed[proposals + step];
#if WEIGHTS == local-mean || WEIGHTS == reservoir
        whole = add_scaled(whole, Scaled(next, 0));
#endif
#if WEIGHTS == reservoir
        // DEVIATION(reservoir): f(new) / Σf ≥ threshold: in the end, each proposal is the light with probability f / Σf.
        let unit = magnitude(whole);
        let least = times_power_of_two(threshold(element, settings.seed) * in_units(whole, unit), unit);
#else
        // f(new) / f(current) ≥ threshold without the quotient: from f = 0, any positive f is accepted.
        let least = threshold(element, settings.seed) * current_importance;
#endif
        if next > 0.0 && next >= least {
            current = element;
            current_importance = next;
        }
    }
#if WEIGHTS == local-mean || WEIGHTS == reservoir
    let scale = ratio(whole, f32(settings.steps), current_importance);
#elif WEIGHTS == single
    let scale = ratio(whole, 1.0, current_importance);
#else
    let scale = ratio(sum, f32(settings.count) * f32(settings.steps), current_importance);
#endif
    let size = textureDimensions(rsm_flux);
    let texels = f32(textureNumLayers(rsm_flux)) * f32(size.x) * f32(size.y);
    // Φ = flux · texels / N · w / f: the proposals are uniform over texels.
    let texel = proposed_texel(current, settings.seed);
    lights.lights[chain] = virtual_light_from_texel(texel.x, texel.y, texel.z, texels / f32(settings.count) * scale);
}
