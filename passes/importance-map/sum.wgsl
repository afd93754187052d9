// The total of the sums of all workgroups of importance-map.wgsl.

#import "algorithms/reduce.wgsl"
#import "sums.wgsl"

struct Settings {
    groups: u32,
}

alias Reduced = Sums;

var<uniform> settings: Settings;
/// [groups]
var<storage, read> partial_sums: array<Sums>;
var<storage, read_write> sums: Sums;

fn reduce_length() -> u32 {
    return settings.groups;
}

fn reduce_element(i: u32) -> Sums {
    return partial_sums[i];
}

fn reduce_identity() -> Sums {
    return Sums();
}

fn reduce_both(a: Sums, b: Sums) -> Sums {
    return Sums(add_scaled(a.contribution, b.contribution), add_scaled(a.flux, b.flux));
}

fn reduce_workgroup(thread: u32, own: Sums) -> Sums {
    let contribution = workgroup_sum(thread, own.contribution);
    let flux = workgroup_sum(thread, own.flux);
    return Sums(contribution, flux);
}

fn reduce_store(result: Sums) {
    sums = result;
}
