// What the program draws itself: the rendered picture with dark corners, and a triangle that turns on top of it.

@group(0) @binding(0) var rendered: texture_2d<f32>;

// One triangle that covers the target.
@vertex
fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(vec2u(index << 1u, index) & vec2u(2u)) * 2.0 - 1.0, 0.0, 1.0);
}

// The texture is as large as the target, pixel for pixel.
@fragment
fn picture(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let from_centre = position.xy / vec2f(textureDimensions(rendered)) * 2.0 - 1.0;
    let vignette = 1.0 - 0.25 * dot(from_centre, from_centre);
    return vec4f(textureLoad(rendered, vec2u(position.xy), 0).rgb * vignette, 1.0);
}

// A small triangle in a corner, turned by so many mrad.
@vertex
fn turn(@builtin(vertex_index) index: u32, @builtin(instance_index) mrad: u32) -> @builtin(position) vec4f {
    let angle = f32(mrad) * 0.001 + f32(index) * radians(120.0);
    return vec4f(vec2f(0.75, -0.75) + 0.15 * vec2f(cos(angle), sin(angle)), 0.0, 1.0);
}

@fragment
fn paint() -> @location(0) vec4f {
    return vec4f(1.0, 0.8, 0.1, 1.0);
}
