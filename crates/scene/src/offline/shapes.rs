//! Shapes that are no triangles in their files: spheres, disks, cylinders, rectangles and cubes.
//!
//! Round shapes become 64 facets around and 32 from pole to pole, with the normals of the shape: the silhouette lies within
//! 1.2 ‰ of the radius, and the area is 2.4 ‰ too small. Texture coordinates are those of Mitsuba 3, with v downwards in the
//! picture.

use std::f32::consts::{PI, TAU};

use glam::{Quat, Vec2, Vec3};

use super::triangles::Triangles;

/// The facets around a round shape.
const AROUND: u32 = 64;
/// The facets from pole to pole of a sphere.
const UPWARDS: u32 = 32;

/// Returns the surface of a grid: `point` has the position, the normal and the texture coordinates for a column and a row.
fn grid(columns: u32, rows: u32, point: impl Fn(u32, u32) -> (Vec3, Vec3, Vec2)) -> Triangles {
    let mut triangles =
        Triangles { normals: Some(Vec::new()), uvs: Some(Vec::new()), ..Triangles::default() };
    for (row, column) in (0..=rows).flat_map(|row| (0..=columns).map(move |column| (row, column))) {
        let (position, normal, uv) = point(column, row);
        triangles.positions.push(position);
        triangles.normals.iter_mut().for_each(|normals| normals.push(normal));
        triangles.uvs.iter_mut().for_each(|uvs| uvs.push(uv));
    }
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let at = |column: u32, row: u32| row * (columns + 1) + column;
        let [a, b] = [at(column, row), at(column + 1, row)];
        let [c, d] = [at(column + 1, row + 1), at(column, row + 1)];
        for triangle in [[a, b, c], [a, c, d]] {
            let [p, q, r] = triangle.map(|i| triangles.positions[i as usize]);
            if p != q && q != r && r != p {
                triangles.indices.extend(triangle);
            }
        }
    }
    triangles.follow_normals();
    triangles
}

/// Returns the point of the unit circle at a facet's corner; the last is bitwise the first.
fn around(column: u32) -> Vec2 {
    Vec2::from_angle(TAU * (column % AROUND) as f32 / AROUND as f32)
}

/// Returns a sphere around the origin, with its poles on the z axis.
pub(super) fn sphere(radius: f32) -> Triangles {
    grid(AROUND, UPWARDS, |column, row| {
        let (sin, cos) = match row {
            0 => (0.0, 1.0),
            UPWARDS => (0.0, -1.0),
            _ => (PI * row as f32 / UPWARDS as f32).sin_cos(),
        };
        let normal = (around(column) * sin).extend(cos);
        (normal * radius, normal, share(column, row, UPWARDS))
    })
}

fn share(column: u32, row: u32, rows: u32) -> Vec2 {
    Vec2::new(column as f32 / AROUND as f32, row as f32 / rows as f32)
}

/// Returns the unit disk in the plane z = 0, which faces +z; u is the distance from its centre.
pub(super) fn disk() -> Triangles {
    grid(AROUND, 1, |column, row| {
        let uv = share(column, row, 1);
        (around(column).extend(0.0) * row as f32, Vec3::Z, Vec2::new(uv.y, uv.x))
    })
}

/// Returns the open cylinder between two points.
pub(super) fn cylinder(from: Vec3, to: Vec3, radius: f32) -> Triangles {
    let turn = Quat::from_rotation_arc(Vec3::Z, (to - from).normalize_or(Vec3::Z));
    grid(AROUND, 1, |column, row| {
        let normal = turn * around(column).extend(0.0);
        (from + (to - from) * row as f32 + normal * radius, normal, share(column, row, 1))
    })
}

/// Returns the square from −1 to 1 in the plane z = 0, which faces +z.
pub(super) fn rectangle() -> Triangles {
    grid(1, 1, |column, row| {
        let uv = Vec2::new(column as f32, row as f32);
        ((uv * 2.0 - 1.0).extend(0.0), Vec3::Z, uv)
    })
}

/// Returns the cube from −1 to 1 along each axis.
pub(super) fn cube() -> Triangles {
    // The first three corners of each face, whose fourth follows from them.
    const FACES: [[[f32; 3]; 3]; 6] = [
        [[1.0, -1.0, -1.0], [1.0, -1.0, 1.0], [-1.0, -1.0, 1.0]],
        [[1.0, 1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, 1.0, 1.0]],
        [[1.0, -1.0, -1.0], [1.0, 1.0, -1.0], [1.0, 1.0, 1.0]],
        [[1.0, -1.0, 1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]],
        [[-1.0, -1.0, 1.0], [-1.0, 1.0, 1.0], [-1.0, 1.0, -1.0]],
        [[1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, -1.0]],
    ];
    let mut cube = Triangles::default();
    let (mut normals, mut uvs) = (Vec::new(), Vec::new());
    for (face, corners) in (0..).zip(FACES) {
        let [a, b, c] = corners.map(Vec3::from);
        cube.positions.extend([a, b, c, a + c - b]);
        normals.extend([(b - a).cross(c - b).normalize(); 4]);
        uvs.extend([Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO]);
        cube.indices.extend([0, 1, 2, 3, 0, 2].map(|corner| 4 * face + corner));
    }
    Triangles { normals: Some(normals), uvs: Some(uvs), ..cube }
}

/// Returns the indices of the triangles of a polygon, as a fan.
pub(super) fn fan(corners: &[u32]) -> impl Iterator<Item = u32> {
    let first = corners.first().copied().unwrap_or_default();
    let rest = corners.get(1..).unwrap_or_default();
    rest.windows(2).flat_map(move |pair| [first, pair[0], pair[1]])
}
