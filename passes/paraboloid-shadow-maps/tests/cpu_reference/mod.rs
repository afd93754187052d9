//! The CPU reference in `f64`, with the names of paraboloid-shadow-maps.wgsl.

use gpu_algorithms::reference::paraboloid;

use glam::{DVec2, DVec3, UVec2};
use paraboloid::{
    above_horizon, direction_from_paraboloid, frame_from_normal, paraboloid_from_direction, texel_centre,
};

/// A box in the square [-1, 1]²: least and greatest coordinates.
pub(crate) type Box = (DVec2, DVec2);

/// Returns a box that contains another and the image of the segment between two points above or on the
/// light's plane.
pub(crate) fn grown(bounds: Box, p: DVec3, q: DVec3, extent: f64) -> Box {
    if p.length().min(q.length()) <= 1e-6 * extent {
        return (DVec2::NEG_ONE, DVec2::ONE);
    }
    let (p, q) = (p.normalize(), q.normalize());
    let n = p.cross(q);
    let curvature = if n.length() < 1e-6 { 1.0 } else { n.z.abs() / n.length() };
    let (from, to) = (paraboloid_from_direction(p), paraboloid_from_direction(q));
    let half_chord2 = 0.25 * from.distance_squared(to);
    let sagitta =
        half_chord2 * curvature / (1.0 + (1.0 - half_chord2 * curvature * curvature).max(0.0).sqrt());
    (bounds.0.min(from.min(to) - sagitta), bounds.1.max(from.max(to) + sagitta))
}

/// Returns where the segment between points on different sides of the light's plane meets it.
pub(crate) fn at_horizon(p: DVec3, q: DVec3) -> DVec3 {
    (p + (q - p) * (p.z / (p.z - q.z))).with_z(0.0)
}

/// Returns the bounds of the image of the part of a triangle above the light's plane.
pub(crate) fn image_bounds(corners: [DVec3; 3], extent: f64) -> Box {
    let mut bounds = (DVec2::ONE, DVec2::NEG_ONE);
    let mut crossings = Vec::new();
    for i in 0..3 {
        let (mut p, mut q) = (corners[i], corners[(i + 1) % 3]);
        if (p.z < 0.0) != (q.z < 0.0) {
            let crossing = at_horizon(p, q);
            crossings.push(crossing);
            if p.z < 0.0 {
                p = crossing;
            } else {
                q = crossing;
            }
        } else if p.z < 0.0 {
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
pub(crate) fn hit(direction: DVec3, [a, b, c]: [DVec3; 3], extent: f64) -> Option<f64> {
    let sides = [b.cross(c), c.cross(a), a.cross(b)].map(|edge| direction.dot(edge));
    let normal = (b - a).cross(c - a);
    let along = normal.dot(direction);
    if !(sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)) || along == 0.0 {
        return None;
    }
    let distance = normal.dot(a) / along;
    (distance > 0.0 && above_horizon(direction * distance, extent)).then_some(distance)
}

/// Returns the map of a light: row by row the distance \[m\], infinite where nothing is.
pub(crate) fn map(
    triangles: &[[DVec3; 3]],
    light: DVec3,
    light_normal: DVec3,
    tile: u32,
    extent: f64,
) -> Vec<f64> {
    let frame = frame_from_normal(light_normal);
    let local: Vec<[DVec3; 3]> = triangles
        .iter()
        .map(|corners| corners.map(|corner| frame.transpose_mul_vec3(corner - light)))
        .collect();
    (0..tile * tile)
        .map(|i| {
            let direction = direction_from_paraboloid(texel_centre(UVec2::new(i % tile, i / tile), tile));
            local.iter().filter_map(|corners| hit(direction, *corners, extent)).fold(f64::INFINITY, f64::min)
        })
        .collect()
}
