//! The algorithm in plain f64: same names as paraboloid-shadow-maps.wgsl.

pub use gpu_algorithms::reference::paraboloid;

use paraboloid::{
    Vec2, Vec3, above_horizon, direction_from_paraboloid, dot, frame_from_normal, into_frame,
    paraboloid_from_direction, scale, sub, texel_centre,
};

/// Returns the vector product.
pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn length(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// A box in the square [-1, 1]²: least and greatest coordinates.
pub type Box = (Vec2, Vec2);

/// Returns a box that holds another, and the image of the segment between two points above or on the light's plane.
pub fn grown(bounds: Box, p: Vec3, q: Vec3, extent: f64) -> Box {
    if length(p).min(length(q)) <= 1e-6 * extent {
        return ([-1.0; 2], [1.0; 2]);
    }
    let (p, q) = (scale(p, 1.0 / length(p)), scale(q, 1.0 / length(q)));
    let n = cross(p, q);
    let curvature = if length(n) < 1e-6 { 1.0 } else { n[2].abs() / length(n) };
    let (from, to) = (paraboloid_from_direction(p), paraboloid_from_direction(q));
    let half_chord2 = 0.25 * ((to[0] - from[0]).powi(2) + (to[1] - from[1]).powi(2));
    let sagitta =
        half_chord2 * curvature / (1.0 + (1.0 - half_chord2 * curvature * curvature).max(0.0).sqrt());
    let low = [0, 1].map(|i| bounds.0[i].min(from[i].min(to[i]) - sagitta));
    let high = [0, 1].map(|i| bounds.1[i].max(from[i].max(to[i]) + sagitta));
    (low, high)
}

/// Returns where the segment between points on different sides of the light's plane meets it.
pub fn at_horizon(p: Vec3, q: Vec3) -> Vec3 {
    let t = p[2] / (p[2] - q[2]);
    [p[0] + (q[0] - p[0]) * t, p[1] + (q[1] - p[1]) * t, 0.0]
}

/// Bounds of the image of the part of a triangle above the light's plane.
pub fn image_bounds(corners: [Vec3; 3], extent: f64) -> Box {
    let mut bounds = ([1.0; 2], [-1.0; 2]);
    let mut crossings = Vec::new();
    for i in 0..3 {
        let (mut p, mut q) = (corners[i], corners[(i + 1) % 3]);
        if (p[2] < 0.0) != (q[2] < 0.0) {
            let crossing = at_horizon(p, q);
            crossings.push(crossing);
            if p[2] < 0.0 {
                p = crossing;
            } else {
                q = crossing;
            }
        } else if p[2] < 0.0 {
            continue;
        }
        bounds = grown(bounds, p, q, extent);
    }
    if let [p, q] = crossings[..] {
        bounds = grown(bounds, p, q, extent);
    }
    bounds
}

/// Returns the distance at which a ray from the light meets a triangle, all in the light's frame.
pub fn hit(direction: Vec3, [a, b, c]: [Vec3; 3], extent: f64) -> Option<f64> {
    let sides = [cross(b, c), cross(c, a), cross(a, b)].map(|edge| dot(direction, edge));
    let normal = cross(sub(b, a), sub(c, a));
    let along = dot(normal, direction);
    if !(sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)) || along == 0.0 {
        return None;
    }
    let distance = dot(normal, a) / along;
    (distance > 0.0 && above_horizon(scale(direction, distance), extent)).then_some(distance)
}

/// Returns the map of a light: row by row the distance \[m\], infinite where nothing is.
pub fn map(triangles: &[[Vec3; 3]], light: Vec3, light_normal: Vec3, tile: u32, extent: f64) -> Vec<f64> {
    let frame = frame_from_normal(light_normal);
    let local: Vec<[Vec3; 3]> = triangles
        .iter()
        .map(|corners| corners.map(|corner| into_frame(sub(corner, light), &frame)))
        .collect();
    (0..tile * tile)
        .map(|i| {
            let direction = direction_from_paraboloid(texel_centre([i % tile, i / tile], tile));
            local.iter().filter_map(|corners| hit(direction, *corners, extent)).fold(f64::INFINITY, f64::min)
        })
        .collect()
}
