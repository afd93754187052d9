//! Rooms made of quads, where light has closed forms.

use glam::{DVec3, Vec2, Vec3, Vec4};
use interfaces::surface_points::{SurfacePoint, packed_albedo};
use scene::{Camera, Encoding, Instance, LightKind, Material, Scene, Texture, Vertex, Wrap};
use std::f64::consts::PI;

/// A parallelogram of one material.
pub struct Quad {
    /// In order around it.
    pub corners: [[f32; 3]; 4],
    material: u32,
}

/// Returns the parallelogram at a corner, along two edges.
pub fn quad(corner: [f32; 3], a: [f32; 3], b: [f32; 3], material: u32) -> Quad {
    let [corner, a, b] = [corner, a, b].map(Vec3::from);
    Quad { corners: [corner, corner + a, corner + a + b, corner + b].map(|at| at.to_array()), material }
}

/// Returns a diffuse material with this reflectance, which emits this radiance \[W/(m² sr)\].
pub fn matte(albedo: [f64; 3], emission: [f64; 3]) -> Material {
    let [r, g, b] = albedo.map(|x| x as f32);
    Material {
        base_color: Vec4::new(r, g, b, 1.0),
        emission: Vec3::from(emission.map(|x| x as f32)),
        ..Material::default()
    }
}

/// Returns the scene `plane`, with this in place of its square, and its light off.
pub fn room(quads: &[Quad], materials: Vec<Material>) -> Scene {
    let mut scene = crate::scene("plane");
    scene.materials = materials;
    (scene.vertices, scene.indices) = (Vec::new(), Vec::new());
    for quad in quads {
        let first = scene.vertices.len() as u32;
        let [a, b, _, d] = quad.corners.map(Vec3::from);
        let normal = (b - a).cross(d - a).normalize().to_array();
        scene.vertices.extend(quad.corners.map(|position| Vertex {
            position,
            material: quad.material,
            normal,
            instance: 0,
            uv: [0.0; 2],
            pad: [0.0; 2],
        }));
        scene.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
    }
    scene.instances = vec![Instance {
        name: "room".into(),
        first_vertex: 0,
        vertex_count: scene.vertices.len() as u32,
        first_index: 0,
        index_count: scene.indices.len() as u32,
        moves: false,
    }];
    scene.lights[0].intensity = Vec3::ZERO;
    scene
}

/// Returns the scene `plane`, which faces y, with a normal map that bends its normal by `angle` \[°\] towards x; and the unit
/// normal that the bytes of the map say.
pub fn bent_plane(angle: f64) -> (Scene, DVec3) {
    let (sine, cosine) = angle.to_radians().sin_cos();
    let pixel = [sine, 0.0, cosine].map(|x| (255.0 * (0.5 * x + 0.5)).round() as u8);
    let mut scene = plane_with_texture(1, Encoding::Linear, |_| [pixel[0], pixel[1], pixel[2], 255]);
    scene.materials[0].normal_texture = Some(0);
    // The square's u grows along x, and its v against z.
    let [along_u, against_v, up] = pixel.map(|byte| f64::from(byte) / 127.5 - 1.0);
    (scene, DVec3::new(along_u, up, against_v).normalize())
}

/// Returns the scene `plane`, which is cut out where x is negative.
pub fn half_plane() -> Scene {
    let mut scene =
        plane_with_texture(16, Encoding::Srgb, |column| [255, 255, 255, if column < 8 { 0 } else { 255 }]);
    scene.materials[0].base_color_texture = Some(0);
    scene.materials[0].alpha_cutoff = Some(0.5);
    scene
}

/// Returns the scene `plane` with a texture of `side` by `side` pixels, which its material does not have yet. A column's x grows with
/// its number.
fn plane_with_texture(side: u32, encoding: Encoding, pixel: impl Fn(u32) -> [u8; 4]) -> Scene {
    let mut scene = crate::scene("plane");
    let pixels = (0..side * side).flat_map(|i| pixel(i % side)).collect();
    let wrap = [Wrap::Clamp; 2];
    scene.textures =
        vec![Texture { name: "plane".into(), width: side, height: side, pixels, encoding, wrap }];
    scene
}

/// Returns a closed cube of 2 m about the origin, seen from near its middle.
pub fn furnace(emitted: [f64; 3], albedo: [f64; 3]) -> Scene {
    let (x, y, z) = ([2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]);
    let low = [-1.0; 3];
    let faces = [(low, x, y), (low, y, z), (low, z, x)];
    let opposite = [[-1.0, -1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0]];
    let mut quads = Vec::new();
    for ((corner, a, b), far) in faces.into_iter().zip(opposite) {
        quads.push(quad(corner, a, b, 0));
        quads.push(quad(far, a, b, 0));
    }
    let mut scene = room(&quads, vec![matte(albedo, emitted)]);
    scene.camera = Camera {
        position: Vec3::new(0.1, -0.2, 0.3),
        target: Vec3::new(1.0, 0.7, -0.8),
        up: Vec3::Y,
        vertical_fov: 1.2,
        near: 1e-3,
    };
    scene
}

/// Returns a floor of 1 m², and on its side x = 0 a wall as large, on which a sun shines along the floor.
pub fn floor_and_wall() -> Scene {
    let quads = [
        quad([0.0, 0.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0),
        quad([0.0, 0.0, -0.5], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], 1),
    ];
    let mut scene = room(&quads, vec![matte([0.5; 3], [0.0; 3]), matte([0.6; 3], [0.0; 3])]);
    scene.lights[0].kind = LightKind::Directional;
    scene.lights[0].direction = Vec3::NEG_X;
    scene.lights[0].intensity = Vec3::splat(2.0);
    scene
}

/// Returns a floor of 2 m × 2 m about the origin that reflects ½, and above it, at this height, a square lamp with this side
/// that emits 1 W/(m² sr) and reflects nothing. The floor has the material 0 and the lamp 1.
pub fn floor_and_lamp(height: f32, side: f32) -> Scene {
    let half = side / 2.0;
    let quads = [
        quad([-1.0, 0.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0], 0),
        quad([-half, height, -half], [side, 0.0, 0.0], [0.0, 0.0, side], 1),
    ];
    room(&quads, vec![matte([0.5; 3], [0.0; 3]), matte([0.0; 3], [1.0; 3])])
}

/// Returns the view factor from a patch to a rectangle on a plane parallel to it, at this distance, whose sides are parallel
/// to x and z and begin and end there (Howell's catalogue, B-3, for each of the four corners).
pub fn view_factor(distance: f64, x: [f64; 2], z: [f64; 2]) -> f64 {
    let corner = |x: f64, z: f64| {
        let (x, z) = (x / distance, z / distance);
        let (far_x, far_z) = (x.hypot(1.0), z.hypot(1.0));
        (x / far_x * (z / far_x).atan() + z / far_z * (x / far_z).atan()) / (2.0 * PI)
    };
    corner(x[1], z[1]) - corner(x[0], z[1]) - corner(x[1], z[0]) + corner(x[0], z[0])
}

/// Returns a camera with z upwards.
pub fn camera_at(position: [f32; 3], target: [f32; 3], vertical_fov: f32) -> Camera {
    let [position, target] = [position, target].map(Vec3::from);
    Camera { position, target, up: Vec3::Z, vertical_fov, near: 1e-3 }
}

/// Returns the point on a triangle whose normal faces `towards`, with the reflectance of its material.
///
/// # Panics
/// Where there is no such triangle.
pub fn point_on(scene: &Scene, triangle: u32, barycentrics: Vec2, towards: Vec3, seed: u32) -> SurfacePoint {
    let corners = [0, 1, 2].map(|i| scene.vertices[scene.indices[(3 * triangle + i) as usize] as usize]);
    let [a, b, c] = corners.map(|vertex| Vec3::from(vertex.position));
    let position = a + (b - a) * barycentrics.x + (c - a) * barycentrics.y;
    let normal = (b - a).cross(c - a).normalize();
    let normal = if normal.dot(towards - position) < 0.0 { -normal } else { normal };
    let albedo = scene.materials[corners[0].material as usize].base_color.truncate().to_array();
    SurfacePoint {
        position: position.to_array(),
        triangle,
        normal: normal.to_array(),
        seed,
        barycentrics: barycentrics.to_array(),
        albedo: packed_albedo(albedo.map(f64::from)),
        mark: 0,
    }
}
