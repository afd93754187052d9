//! The triangle under the cursor, against the plainest test there is.

use std::sync::OnceLock;

use glam::{DMat3, DVec3, Vec3};
use proptest::prelude::*;
use scene::{Hit, Instance, MovedVertices, Scene, Vertex};

use crate::common::{built_in, shipped};

/// Returns a still scene of these triangles, two to an instance.
fn soup(triangles: &[[Vec3; 3]]) -> Scene {
    let corners = triangles.as_flattened();
    let vertex = |(i, position): (usize, &Vec3)| Vertex {
        position: position.to_array(),
        material: 0,
        normal: [0.0, 1.0, 0.0],
        instance: (i / 6) as u32,
        uv: [0.0; 2],
        pad: [0.0; 2],
    };
    let instance = |(i, chunk): (usize, &[Vec3])| Instance {
        name: format!("pair {i}"),
        first_vertex: 6 * i as u32,
        vertex_count: chunk.len() as u32,
        first_index: 6 * i as u32,
        index_count: chunk.len() as u32,
        moves: false,
    };
    let mut scene = shipped("empty");
    scene.vertices = corners.iter().enumerate().map(vertex).collect();
    scene.indices = (0..corners.len() as u32).collect();
    scene.instances = corners.chunks(6).enumerate().map(instance).collect();
    scene
}

/// Solves origin + t direction = a + u (b − a) + v (c − a), and returns t and how far inside the triangle the
/// solution is: the least of its barycentric weights.
fn solve(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<(f64, f64)> {
    let matrix = DMat3::from_cols(-direction, b - a, c - a);
    let solution = matrix.inverse() * (origin - a);
    let inside = solution.y.min(solution.z).min(1.0 - solution.y - solution.z);
    (matrix.determinant().abs() > 1e-6).then_some((solution.x, inside))
}

/// Checks a hit, or that there is none, against all triangles. What is within rounding may go either way.
fn assert_first(
    triangles: &[[Vec3; 3]],
    origin: Vec3,
    direction: Vec3,
    hit: Option<Hit>,
) -> Result<(), TestCaseError> {
    let (from, along) = (origin.as_dvec3(), direction.as_dvec3().normalize());
    let wide = |triangle: &[Vec3; 3]| triangle.map(Vec3::as_dvec3);
    for (i, triangle) in triangles.iter().enumerate() {
        let Some((distance, inside)) = solve(from, along, wide(triangle)) else { continue };
        if inside > 1e-6 && distance > 1e-6 {
            let hit = hit.expect("a triangle is in the way");
            prop_assert!(
                f64::from(hit.distance) <= distance + 1e-5 * (1.0 + distance),
                "{i} is nearer than {hit:?}"
            );
        }
    }
    let Some(hit) = hit else { return Ok(()) };
    let [a, b, c] = wide(&triangles[hit.triangle]);
    let cross = (b - a).cross(c - a);
    prop_assert!(cross.length() > 0.0, "no area: {hit:?}");
    prop_assert!(hit.position.is_finite() && (hit.normal.length() - 1.0).abs() < 1e-5, "{hit:?}");
    prop_assert!(hit.normal.as_dvec3().dot(along) <= 1e-6, "on the side of the ray: {hit:?}");
    prop_assert!(hit.normal.as_dvec3().cross(cross.normalize()).length() < 1e-5, "its own: {hit:?}");
    if let Some((distance, inside)) = solve(from, along, [a, b, c]) {
        let error = (f64::from(hit.distance) - distance).abs() / (1.0 + distance.abs());
        prop_assert!(inside > -1e-6 && error < 1e-5, "{hit:?}: at {distance}, {inside} inside");
        let place = from + along * distance;
        prop_assert!(hit.position.as_dvec3().distance(place) < 1e-5 * (1.0 + place.length()), "{hit:?}");
    }
    Ok(())
}

/// A closed surface whose triangles share the positions of their corners.
fn sphere() -> &'static Scene {
    static SPHERE: OnceLock<Scene> = OnceLock::new();
    SPHERE.get_or_init(|| built_in("sphere"))
}

/// Few enough values that many triangles share corners, lie in one plane, or have no area.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![(-3i32..4).prop_map(|n| n as f32), -4.0f32..4.0]
}

fn point() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(coordinate()).prop_map(Vec3::from)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn the_first_of_any_triangles_is_hit(
        triangles in prop::collection::vec(prop::array::uniform3(point()), 1..12),
        origin in point(),
        direction in point(),
        scale in prop_oneof![Just(1.0f32), Just(2f32.powi(-99)), Just(2f32.powi(99))],
    ) {
        prop_assume!(direction != Vec3::ZERO);
        let scene = soup(&triangles);
        let hit = scene.pick(&scene.at(0.0), origin, direction * scale);
        assert_first(&triangles, origin, direction, hit)?;
        if let Some(hit) = hit {
            prop_assert_eq!(hit.instance, hit.triangle / 2);
        }
    }

    #[test]
    fn what_moved_is_hit_where_it_is(
        triangles in prop::collection::vec(prop::array::uniform3(point()), 4..9),
        moved in prop::array::uniform6(point()),
        origin in point(),
        direction in point(),
    ) {
        prop_assume!(direction != Vec3::ZERO);
        let scene = soup(&triangles);
        let mut pose = scene.at(0.0);
        let place = |(vertex, position): (&Vertex, &Vec3)| Vertex { position: position.to_array(), ..*vertex };
        let vertices = scene.vertices[6..12].iter().zip(&moved).map(place).collect();
        pose.moved = vec![MovedVertices { first_vertex: 6, vertices }];
        let mut now = triangles;
        now[2..4].as_flattened_mut().copy_from_slice(&moved);
        assert_first(&now, origin, direction, scene.pick(&pose, origin, direction))?;
    }

    #[test]
    fn no_ray_leaves_a_closed_surface_between_its_triangles(
        origin in prop::array::uniform3(-0.5f32..0.5).prop_map(Vec3::from),
        triangle in any::<prop::sample::Index>(),
        along in prop_oneof![Just(0.0f32), Just(0.5), 0.0f32..1.0],
    ) {
        let sphere = sphere();
        let edge = &sphere.indices[3 * triangle.index(sphere.triangles())..][..2];
        let [from, to] = [edge[0], edge[1]].map(|i| Vec3::from(sphere.vertices[i as usize].position));
        let at = from.lerp(to, along);
        prop_assert!(sphere.pick(&sphere.at(0.0), origin, at - origin).is_some(), "from {origin} to {at}");
    }

    #[test]
    fn any_numbers_give_a_finite_hit_or_none(
        numbers in prop::array::uniform32(any::<f32>()),
    ) {
        let vector = |i: usize| Vec3::new(numbers[i], numbers[i + 1], numbers[i + 2]);
        let triangles = [[vector(0), vector(3), vector(6)], [vector(9), vector(12), vector(15)]];
        let scene = soup(&triangles);
        let pose = scene.at(0.0);
        let rays = [(vector(18), vector(21)), (Vec3::ZERO, vector(24)), (vector(27), Vec3::ZERO)];
        for (origin, direction) in rays {
            if let Some(hit) = scene.pick(&pose, origin, direction) {
                prop_assert!(hit.distance.is_finite() && hit.distance > 0.0 && hit.position.is_finite() && hit.normal.is_finite(), "{hit:?}");
            }
        }
    }
}

#[test]
fn a_rolling_ball_is_picked_where_it_is_seen() {
    let scene = shipped("cornell-box-moving");
    for (time, place) in [(0.0, Vec3::new(0.45, 0.06, 0.12)), (1.0, Vec3::new(0.3, 0.06, 0.02))] {
        let pose = scene.at(time);
        let aspect = 1.5;
        let ndc = pose.camera.project_to_ndc(place, aspect).expect("in front");
        let (origin, direction) = pose.camera.ray(ndc, aspect);
        let hit = scene.pick(&pose, origin, direction).expect("the ball");
        assert_eq!(scene.instances[hit.instance].name, "sphere", "at {time} s: {hit:?}");
        assert!((hit.position.distance(place) - 0.06).abs() < 0.005, "on its surface: {hit:?}");
        assert!((hit.distance - origin.distance(hit.position)).abs() < 1e-5, "{hit:?}");
    }
    let gone = scene.at(2.0);
    let (origin, direction) = (Vec3::new(0.45, 0.3, 0.12), Vec3::NEG_Y);
    let floor = scene.pick(&gone, origin, direction).expect("the floor");
    assert_ne!(scene.instances[floor.instance].name, "sphere", "it has rolled away");
    assert!(floor.position.y.abs() < 1e-5 && floor.normal.abs_diff_eq(Vec3::Y, 1e-5), "{floor:?}");
}

/// The frame shows a square of 2 m at a distance of 1 m: a triangle beyond one of its sides is not in view, however near.
#[test]
fn what_lies_beyond_one_side_is_not_in_view() {
    let triangle = |center: Vec3| {
        [Vec3::new(-0.2, -0.2, 0.0), Vec3::new(0.2, -0.2, 0.0), Vec3::new(0.0, 0.2, 0.0)].map(|p| p + center)
    };
    let is_in_view = |center: Vec3| {
        let scene = soup(&[triangle(center)]);
        let mut pose = scene.at(0.0);
        pose.camera = scene::Camera {
            position: Vec3::ZERO,
            target: Vec3::NEG_Z,
            up: Vec3::Y,
            vertical_fov: std::f32::consts::FRAC_PI_2,
            near: 0.1,
        };
        scene.is_in_view(&pose, 1.0)
    };
    for side in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y] {
        assert!(is_in_view(Vec3::NEG_Z + side * 1.1), "{side}: a corner is seen");
        assert!(!is_in_view(Vec3::NEG_Z + side * 1.3), "{side}");
        assert!(!is_in_view(Vec3::NEG_Z + side * 1.9), "{side}");
    }
    assert!(!is_in_view(Vec3::Z), "behind");
    assert!(!is_in_view(Vec3::NEG_Z * 0.05), "before the near plane");
}
