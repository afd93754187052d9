// Draws the triangles of the interface: the color of a vertex times a texture, in gamma space, alpha premultiplied.

struct Screen {
    // Size of the window in points.
    size: vec2f,
}

@group(0) @binding(0) var<uniform> screen: Screen;
@group(1) @binding(0) var image: texture_2d<f32>;
@group(1) @binding(1) var image_sampler: sampler;

struct Vertex {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
    @location(1) color: vec4f,
}

@vertex
fn vertex(@location(0) point: vec2f, @location(1) uv: vec2f, @location(2) color: vec4f) -> Vertex {
    let ndc = vec2f(2.0, -2.0) * point / screen.size + vec2f(-1.0, 1.0);
    return Vertex(vec4f(ndc, 0.0, 1.0), uv, color);
}

@fragment
fn fragment(in: Vertex) -> @location(0) vec4f {
    return in.color * textureSample(image, image_sampler, in.uv);
}
