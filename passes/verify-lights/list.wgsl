// Lists the lights that no point in view has reached so far.

#import "algorithms/compact.wgsl"
#import "verify.wgsl"

struct Settings {
    lights_count: u32,
    /// Workgroups that cast rays in a round.
    workgroups: u32,
}

var<uniform> settings: Settings;
var<storage, read> claims: array<u32>;
var<storage, read_write> unseen: array<u32>;
var<storage, read_write> round: Round;

fn scan_length() -> u32 {
    return settings.lights_count;
}

fn compact_keeps(i: u32) -> bool {
    return claims[i] == UNSEEN;
}

fn compact_move(i: u32, place: u32) {
    unseen[place] = i;
}

fn compact_count(count: u32) {
    // Nothing runs where all lights are accounted for.
    round = Round(select(0u, settings.workgroups, count > 0u), 1u, 1u, count);
}
