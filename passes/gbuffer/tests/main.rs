//! The shaders are valid; the CPU reference against closed forms.

mod gpu;

use gbuffer::cpu_reference::{Camera, Change, Vec3, bent_normal, combine, cross, dot, shading_normal, unit};

#[test]
fn every_variant_is_valid() {
    pass_test::assert_shaders_are_valid(gbuffer::PASS);
}

/// Numbers in -1..1, the same in every run.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self) -> Vec3 {
        [self.next(), self.next(), self.next()]
    }

    fn camera(&mut self) -> Camera {
        let back = unit(self.vector());
        let right = unit(cross(self.vector(), back));
        let axes = [right, cross(back, right), back];
        Camera { axes, position: self.vector(), half_extent: [0.8, 0.5], size: [320.0, 200.0] }
    }
}

fn near(a: Vec3, b: Vec3) -> bool {
    (0..3).all(|i| (a[i] - b[i]).abs() < 1e-9)
}

#[test]
fn depth_gives_the_position_back() {
    let mut numbers = Numbers(1);
    for i in 0..1000 {
        let camera = numbers.camera();
        let pixel = [i * 7 % 320, i * 11 % 200];
        let depth = 10f64.powf(6.0 * numbers.next());
        let (at, again) = camera.project(camera.position_from_depth(pixel, depth));
        assert!((again / depth - 1.0).abs() < 1e-9, "{depth} {again}");
        assert!((0..2).all(|k| (at[k] - f64::from(pixel[k]) - 0.5).abs() < 1e-6), "{pixel:?} {at:?}");
    }
}

/// The sign that gbuffer.wgsl relies on: down × right over the pixels of any plane is on the camera's side.
#[test]
fn the_geometric_normal_of_a_seen_plane_faces_the_camera() {
    let mut numbers = Numbers(2);
    let mut seen = 0;
    for _ in 0..1000 {
        let camera = numbers.camera();
        let normal = unit(numbers.vector());
        let level = numbers.next();
        let at = |x: f64, y: f64| {
            let ray = camera.view_ray([x, y]);
            let t = level / dot(ray, normal);
            (t > 0.0).then(|| ray.map(|c| c * t))
        };
        let (x, y) = (160.0 + 150.0 * numbers.next(), 100.0 + 90.0 * numbers.next());
        let (Some(here), Some(right), Some(down)) = (at(x, y), at(x + 1.0, y), at(x, y + 1.0)) else {
            continue;
        };
        let change = |to: Vec3| std::array::from_fn(|i| to[i] - here[i]);
        let towards = cross(change(down), change(right));
        assert!(dot(towards, here) < 0.0, "{towards:?} seen along {here:?}");
        seen += 1;
    }
    assert!(seen > 300, "only {seen} planes were seen");
}

#[test]
fn the_side_is_that_of_the_geometry_whatever_the_winding() {
    let mut numbers = Numbers(3);
    for _ in 0..1000 {
        let (shading, towards) = (unit(numbers.vector()), numbers.vector());
        let normal = shading_normal(shading, towards);
        assert!(dot(normal, towards) >= 0.0);
        assert!(near(normal, shading_normal(shading.map(|x| -x), towards)));
        assert!((dot(normal, normal) - 1.0).abs() < 1e-12);
    }
    // Vertex normals that cancel leave the geometric one.
    assert!(near(shading_normal([1e-5, 0.0, 0.0], [0.0, 0.0, 3.0]), [0.0, 0.0, 1.0]));
}

#[test]
fn a_normal_map_bends_along_u_and_against_v() {
    // Seen from +z: u to the right, v down, as a picture lies.
    let upright = Change {
        position_x: [0.1, 0.0, 0.0],
        position_y: [0.0, -0.1, 0.0],
        uv_x: [0.02, 0.0],
        uv_y: [0.0, 0.02],
    };
    let z = [0.0, 0.0, 1.0];
    assert!(near(bent_normal(z, [0.6, 0.0, 0.8], &upright), [0.6, 0.0, 0.8]));
    assert!(near(bent_normal(z, [0.0, 0.6, 0.8], &upright), [0.0, 0.6, 0.8]));
    let mirrored = Change { uv_x: [-0.02, 0.0], ..upright };
    assert!(near(bent_normal(z, [0.6, 0.0, 0.8], &mirrored), [-0.6, 0.0, 0.8]));
    let without = Change { uv_x: [0.0; 2], uv_y: [0.0; 2], ..upright };
    assert!(near(bent_normal(z, [0.6, 0.0, 0.8], &without), z));
}

#[test]
fn a_normal_map_looks_the_same_from_everywhere() {
    let mut numbers = Numbers(4);
    let mut tried = 0;
    while tried < 500 {
        let normal = unit(numbers.vector());
        let (right, down) = (numbers.vector(), numbers.vector());
        let flat = |v: Vec3| combine(v, normal, [0.0; 3], [1.0, -dot(v, normal), 0.0]);
        let uv = [numbers.next(), numbers.next(), numbers.next(), numbers.next()];
        let change = Change {
            position_x: flat(right),
            position_y: flat(down),
            uv_x: [uv[0], uv[1]],
            uv_y: [uv[2], uv[3]],
        };
        // Another view: pixels that go other ways over the same plane, the other way round even.
        let m = [numbers.next(), numbers.next(), numbers.next(), numbers.next()];
        if (m[0] * m[3] - m[1] * m[2]).abs() < 0.1 || (uv[0] * uv[3] - uv[1] * uv[2]).abs() < 0.1 {
            continue;
        }
        let mix = |a: Vec3, b: Vec3, x: f64, y: f64| combine(a, b, [0.0; 3], [x, y, 0.0]);
        let mix2 = |x: f64, y: f64| [0, 1].map(|i| change.uv_x[i] * x + change.uv_y[i] * y);
        let other = Change {
            position_x: mix(change.position_x, change.position_y, m[0], m[1]),
            position_y: mix(change.position_x, change.position_y, m[2], m[3]),
            uv_x: mix2(m[0], m[1]),
            uv_y: mix2(m[2], m[3]),
        };
        let bent = [0.3 * numbers.next(), 0.3 * numbers.next(), 0.9];
        let (a, b) = (bent_normal(normal, bent, &change), bent_normal(normal, bent, &other));
        assert!(near(a, b), "{a:?} {b:?}");
        tried += 1;
    }
}

#[test]
fn motion_is_where_it_was_minus_where_it_is() {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let now = Camera { axes, position: [0.0; 3], half_extent: [1.0; 2], size: [100.0; 2] };
    // The camera went 0.1 m to the right: at 2 m, 4 m are 100 px, so everything was 2.5 px further right.
    let before = Camera { position: [-0.1, 0.0, 0.0], ..now };
    let motion = now.motion(&before, [50, 50], 2.0);
    assert!((motion[0] - 2.5).abs() < 1e-9 && motion[1].abs() < 1e-9, "{motion:?}");
    assert_eq!(now.motion(&before, [50, 50], 0.0), [0.0; 2]);
    let ahead = Camera { position: [0.0, 0.0, -3.0], ..now };
    assert_eq!(now.motion(&ahead, [50, 50], 2.0), [200.0; 2]);
}
