//! Lights against Eq. 6.

use interfaces::radiosity::PointRadiosity;
use interfaces::surface_points::SurfacePoint;
use lights_from_points::PASS;
use pass_test::{Harness, elements};

pass_test::shaders_are_valid!(PASS);

fn lights(
    points: &[SurfacePoint],
    radiosity: f32,
    density: &[f32],
) -> Option<Vec<interfaces::virtual_lights::VirtualLight>> {
    let radiosity =
        vec![PointRadiosity { radiosity: [radiosity, 2.0 * radiosity, 0.0], key: 1 }; points.len()];
    let facts = &[("count", points.len() as u32)];
    let outputs = Harness::new(PASS)
        .surface_points("points", 3, points)
        .input("radiosity", "Radiosity", facts, elements(&radiosity))
        .input("density", "Density", facts, elements(density))
        .run()?;
    Some(outputs.lights("lights"))
}

/// Where density is uniform over the area A, each of N lights stands for A / N of it, and together they give B A.
#[test]
fn lights_share_out_the_area() {
    let mut points: Vec<_> = (0..300u32)
        .map(|i| SurfacePoint {
            position: [i as f32, 0.0, 1.0],
            triangle: i,
            normal: [0.0, 1.0, 0.0],
            ..SurfacePoint::NONE
        })
        .collect();
    // A hundred are not there: the rest stand for all.
    for point in points.iter_mut().step_by(3) {
        *point = SurfacePoint::NONE;
    }
    let area = 7.0;
    let Some(found) = lights(&points, 0.5, &[1.0 / area; 300]) else { return };
    let mut whole = 0.0;
    for (point, light) in points.iter().zip(&found) {
        if point.is_none() {
            assert_eq!((light.flux, light.area), ([0.0; 3], 0.0));
            continue;
        }
        assert!((light.area - area / 200.0).abs() < 1e-6, "{}", light.area);
        assert_eq!(
            (light.position, light.normal, light.texel),
            (point.position, point.normal, point.triangle)
        );
        assert!((light.flux[1] - 2.0 * light.flux[0]).abs() < 1e-7 && light.flux[2] == 0.0);
        whole += light.flux[0];
    }
    assert!((whole - 0.5 * area).abs() < 1e-4, "{whole}");
}

#[test]
fn fluxes_are_finite_at_any_density() {
    let points = [SurfacePoint { triangle: 0, ..SurfacePoint::NONE }; 6];
    let densities = [0.0, 1e-38, f32::MAX, f32::INFINITY, f32::NAN, 1e-44];
    let Some(found) = lights(&points, 3e38, &densities) else { return };
    for (light, density) in found.iter().zip(densities) {
        assert!(light.flux.iter().all(|x| x.is_finite() && *x >= 0.0), "{density}: {:?}", light.flux);
        assert!(light.area.is_finite() && light.area >= 0.0, "{density}: {}", light.area);
    }
    assert_eq!(found[0].flux, [0.0; 3]);
}
