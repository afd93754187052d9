//! The shaders are valid; the CPU reference against closed forms.

mod cpu_reference;
mod gpu;

use cpu_reference::{Camera, Change, bent_normal, shading_normal};
use glam::{DMat2, DMat3, DVec2, DVec3, dvec2, dvec3, uvec2};

pass_test::shaders_are_valid!(gbuffer::PASS);

/// Numbers in -1..1, the same in every run.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::from([0; 3].map(|_| self.next()))
    }

    fn camera(&mut self) -> Camera {
        let back = self.vector().normalize();
        let right = self.vector().cross(back).normalize();
        let axes = DMat3::from_cols(right, back.cross(right), back);
        Camera { axes, position: self.vector(), half_extent: dvec2(0.8, 0.5), size: dvec2(320.0, 200.0) }
    }
}

fn near(a: DVec3, b: DVec3) -> bool {
    a.abs_diff_eq(b, 1e-9)
}

#[test]
fn depth_gives_the_position_back() {
    let mut numbers = Numbers(1);
    for i in 0..1000 {
        let camera = numbers.camera();
        let pixel = uvec2(i * 7 % 320, i * 11 % 200);
        let depth = 10f64.powf(6.0 * numbers.next());
        let (at, again) = camera.project(camera.position_from_depth(pixel, depth));
        assert!((again / depth - 1.0).abs() < 1e-9, "{depth} {again}");
        assert!(at.abs_diff_eq(pixel.as_dvec2() + 0.5, 1e-6), "{pixel:?} {at:?}");
    }
}

/// The sign that gbuffer.wgsl relies on: down × right over the pixels of any plane is on the camera's side.
#[test]
fn the_geometric_normal_of_a_seen_plane_faces_the_camera() {
    let mut numbers = Numbers(2);
    let mut seen = 0;
    for _ in 0..1000 {
        let camera = numbers.camera();
        let normal = numbers.vector().normalize();
        let level = numbers.next();
        let at = |x: f64, y: f64| {
            let ray = camera.view_ray(dvec2(x, y));
            let t = level / ray.dot(normal);
            (t > 0.0).then_some(ray * t)
        };
        let (x, y) = (160.0 + 150.0 * numbers.next(), 100.0 + 90.0 * numbers.next());
        let (Some(here), Some(right), Some(down)) = (at(x, y), at(x + 1.0, y), at(x, y + 1.0)) else {
            continue;
        };
        let towards = (down - here).cross(right - here);
        assert!(towards.dot(here) < 0.0, "{towards:?} seen along {here:?}");
        seen += 1;
    }
    assert!(seen > 300, "only {seen} planes were seen");
}

#[test]
fn the_side_is_that_of_the_geometry_whatever_the_winding() {
    let mut numbers = Numbers(3);
    for _ in 0..1000 {
        let (shading, towards) = (numbers.vector().normalize(), numbers.vector());
        let normal = shading_normal(shading, towards);
        assert!(normal.dot(towards) >= 0.0);
        assert!(near(normal, shading_normal(-shading, towards)));
        assert!((normal.length_squared() - 1.0).abs() < 1e-12);
    }
    // Vertex normals that cancel leave the geometric one.
    assert!(near(shading_normal(dvec3(1e-5, 0.0, 0.0), dvec3(0.0, 0.0, 3.0)), DVec3::Z));
}

#[test]
fn a_normal_map_bends_along_u_and_against_v() {
    // Seen from +z: u to the right, v down, as a picture lies.
    let upright = Change {
        position_x: dvec3(0.1, 0.0, 0.0),
        position_y: dvec3(0.0, -0.1, 0.0),
        uv_x: dvec2(0.02, 0.0),
        uv_y: dvec2(0.0, 0.02),
    };
    let z = DVec3::Z;
    assert!(near(bent_normal(z, dvec3(0.6, 0.0, 0.8), &upright), dvec3(0.6, 0.0, 0.8)));
    assert!(near(bent_normal(z, dvec3(0.0, 0.6, 0.8), &upright), dvec3(0.0, 0.6, 0.8)));
    let mirrored = Change { uv_x: dvec2(-0.02, 0.0), ..upright };
    assert!(near(bent_normal(z, dvec3(0.6, 0.0, 0.8), &mirrored), dvec3(-0.6, 0.0, 0.8)));
    let without = Change { uv_x: DVec2::ZERO, uv_y: DVec2::ZERO, ..upright };
    assert!(near(bent_normal(z, dvec3(0.6, 0.0, 0.8), &without), z));
}

#[test]
fn a_normal_map_looks_the_same_from_everywhere() {
    let mut numbers = Numbers(4);
    let mut tried = 0;
    while tried < 500 {
        let normal = numbers.vector().normalize();
        let (right, down) = (numbers.vector(), numbers.vector());
        let uv = DMat2::from_cols_array(&[0; 4].map(|_| numbers.next()));
        let change = Change {
            position_x: right.reject_from_normalized(normal),
            position_y: down.reject_from_normalized(normal),
            uv_x: uv.x_axis,
            uv_y: uv.y_axis,
        };
        // Another view: pixels that go other ways over the same plane, the other way round even.
        let turned = DMat2::from_cols_array(&[0; 4].map(|_| numbers.next()));
        if turned.determinant().abs() < 0.1 || uv.determinant().abs() < 0.1 {
            continue;
        }
        let position = |by: DVec2| change.position_x * by.x + change.position_y * by.y;
        let other = Change {
            position_x: position(turned.x_axis),
            position_y: position(turned.y_axis),
            uv_x: uv * turned.x_axis,
            uv_y: uv * turned.y_axis,
        };
        let bent = dvec3(0.3 * numbers.next(), 0.3 * numbers.next(), 0.9);
        let (a, b) = (bent_normal(normal, bent, &change), bent_normal(normal, bent, &other));
        assert!(near(a, b), "{a:?} {b:?}");
        tried += 1;
    }
}

#[test]
fn motion_is_where_it_was_minus_where_it_is() {
    let now = Camera {
        axes: DMat3::IDENTITY,
        position: DVec3::ZERO,
        half_extent: DVec2::ONE,
        size: DVec2::splat(100.0),
    };
    // The camera went 0.1 m to the right: at 2 m, 4 m are 100 px, so everything was 2.5 px further right.
    let before = Camera { position: dvec3(-0.1, 0.0, 0.0), ..now };
    let motion = now.motion(&before, uvec2(50, 50), 2.0);
    assert!(motion.abs_diff_eq(dvec2(2.5, 0.0), 1e-9), "{motion:?}");
    assert_eq!(now.motion(&before, uvec2(50, 50), 0.0), DVec2::ZERO);
    let ahead = Camera { position: dvec3(0.0, 0.0, -3.0), ..now };
    assert_eq!(now.motion(&ahead, uvec2(50, 50), 2.0), DVec2::splat(200.0));
}
