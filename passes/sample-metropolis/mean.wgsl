// The sum of f over the proposals of all chains, for the weights `none`: they are the first N M elements of the
// sequence, whichever chain has which. The sum is over proposals, not over the map.

#import "algorithms/sum-scaled.wgsl"
#import "proposal.wgsl"

struct Settings {
    count: u32,
    steps: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read_write> sum: Scaled;

fn reduce_length() -> u32 {
    return settings.count * settings.steps;
}

fn reduce_element(i: u32) -> Scaled {
    return Scaled(proposed_importance(i + 1u, settings.seed), 0);
}

fn reduce_store(result: Scaled) {
    sum = result;
}
