// Directions about an axis, from the unit square. Areas are preserved, so what is stratified in the square is so among directions.

#import "color.wgsl"

/// The direction about z at that 1 - cos to it, which keeps its digits near z, turned about it by a number of turns.
fn direction_about_z(cap: f32, turns: f32) -> vec3<f32> {
    let radius = sqrt(max(cap * (2.0 - cap), 0.0));
    let angle = 2.0 * PI * turns;
    return vec3(radius * cos(angle), radius * sin(angle), 1.0 - cap);
}

/// Distributed by the cosine to z: by area in the unit disc below.
fn by_cosine(square: vec2<f32>) -> vec3<f32> {
    let radius = sqrt(square.x);
    let angle = 2.0 * PI * square.y;
    return vec3(radius * cos(angle), radius * sin(angle), sqrt(max(1.0 - square.x, 0.0)));
}
