// Radii of a disc light and of the penumbra that it casts, by how near the receiver is to the blocker.

#import "disc-shadow.wgsl"

struct Given {
    area: f32,
    receiver: f32,
    blocker: f32,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let receiver = 0.1 + u.x;
    return Given(u.y, receiver, receiver * (1.0 - magnitude * (0.5 + 0.49 * u.z)));
}

/// [magnitude: 1e-6 to 1, distance of blocker and receiver over the height of the receiver]
fn probe(given: Given) -> vec4<f32> {
    let radius = disc_radius(given.area);
    return vec4(radius, penumbra_radius(radius, given.receiver, given.blocker), search_radius(radius, 0.1), 0.0);
}
