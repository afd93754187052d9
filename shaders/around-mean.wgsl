// Keeps the mean of earlier frames near to what the new frame has around a pixel. [Salvi 2016]

/// A mean of earlier frames, moved to within so many standard deviations of the mean of the nine pixels around one.
fn near_frame(before: vec4<f32>, frame: texture_2d<f32>, pixel: vec2<u32>, deviations: f32) -> vec4<f32> {
    let last = vec2<i32>(textureDimensions(frame)) - 1;
    let centre = textureLoad(frame, pixel, 0);
    var sum = vec4(0.0);
    var squares = vec4(0.0);
    for (var i = 0; i < 9; i++) {
        let other = clamp(vec2<i32>(pixel) + vec2(i % 3 - 1, i / 3 - 1), vec2(0), last);
        let away = textureLoad(frame, other, 0) - centre;
        sum += away;
        squares += away * away;
    }
    let mean = sum / 9.0;
    let spread = deviations * sqrt(max(squares / 9.0 - mean * mean, vec4(0.0)));
    return clamp(before, centre + mean - spread, centre + mean + spread);
}
