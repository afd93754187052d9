// The weight of a light from a Metropolis-Hastings chain of eight proposals, by the magnitude of their importance: each is up
// to a thousand times another.

#import "passes/sample-metropolis/ratio.wgsl"

struct Given {
    importance: vec4<f32>,
    more: vec4<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    return Given(magnitude * pow(vec4(1000.0), u), magnitude * pow(vec4(1000.0), fract(u * 64.0)));
}

/// [magnitude: 1e-34 to 1e34, importance]
fn probe(given: Given) -> vec4<f32> {
    var whole = Scaled(given.importance.x, 0);
    for (var i = 1; i < 8; i++) {
        whole = add_scaled(whole, Scaled(select(given.more[i & 3], given.importance[i & 3], i < 4), 0));
    }
    return vec4(ratio(whole, 8.0, given.importance.w), ratio(whole, 1.0, given.more.y), 0.0, 0.0);
}
