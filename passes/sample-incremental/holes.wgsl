// The emptiest of several places.

#import "algorithms/workgroup.wgsl"
#import "slots.wgsl"

/// Beyond every index.
const FURTHEST: f32 = 0x1p24f;

/// The emptier of two places; of equals, that of the first probe.
fn emptier(a: Hole, b: Hole) -> Hole {
    if b.key > a.key || (b.key == a.key && b.probe < a.probe) {
        return b;
    }
    return a;
}

/// The emptiest place of a workgroup. All threads call it. Indices of probes are below 2^24, so floats hold them.
fn emptiest(thread: u32, own: Hole) -> Hole {
    let key = workgroup_max(thread, own.key);
    let first = workgroup_max(thread, select(-FURTHEST, -f32(own.probe), own.key == key));
    return Hole(key, u32(-first));
}
