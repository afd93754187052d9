// Writes the light that is chosen at a receiver by each of a row of random numbers, and its probability.

#input tree: LightTree // The tree.
#input receivers: Buffer // The points at which lights are chosen.
#output choices: Buffer(count: receivers.count * settings.count) // What each number gives at each of them.

#import "light-tree.wgsl"

struct Settings {
    /// Numbers for each receiver. [default: 1, min: 1]
    count: u32,
}

struct Receiver {
    position: vec3<f32>,
    pad0: u32,
    normal: vec3<f32>,
    pad1: u32,
}

var<uniform> settings: Settings;
var<storage, read> receivers: array<Receiver>;
var<storage, read_write> choices: array<LightChoice>;

@compute @workgroup_size(64)
fn choose(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&choices) {
        let receiver = receivers[id.x / settings.count];
        choices[id.x] = choose_light(receiver.position, receiver.normal, hash2(7u, id.x));
    }
}
