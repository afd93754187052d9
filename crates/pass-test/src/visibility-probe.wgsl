// Writes what the module of a port Visibility returns, one thread per receiver.

#input visibility: Visibility // The module.
#input lights: VirtualLights // The lights that are looked up.
#input receivers: Buffer // The points that look one up each.
#output answers: Buffer(count: receivers.count) // What each finds.

#import interface "visibility"

struct Receiver {
    position: vec3<f32>,
    light: u32,
    normal: vec3<f32>,
    pad: f32,
}

var<storage, read> receivers: array<Receiver>;
var<storage, read> lights: VirtualLights;
var<storage, read_write> answers: array<f32>;

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&answers) {
        let receiver = receivers[id.x];
        let light = lights.lights[receiver.light];
        answers[id.x] = visibility(receiver.light, light, receiver.position, receiver.normal);
    }
}
