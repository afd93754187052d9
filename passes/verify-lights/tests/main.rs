//! Mailboxes and marks against rays of the CPU.

use glam::{Vec2, Vec3};
use interfaces::surface_points::{SurfacePoint, SurfacePointsHeader};
use pass_test::Harness;
use pass_test::random::{hash, unit_float};
use pass_test::rooms::point_on;
use ray_tracing::Bvh;
use scene::Scene;
use verify_lights::PASS;

const WIDTH: u32 = 64;
const HEIGHT: u32 = 48;

pass_test::shaders_are_valid!(PASS);

/// A scene, and what sees what in it.
struct Room {
    scene: Scene,
    bvh: Bvh,
}

impl Room {
    fn new(scene: Scene) -> Room {
        let positions: Vec<[f32; 3]> = scene.vertices.iter().map(|vertex| vertex.position).collect();
        let bvh = Bvh::build(&positions, &scene.indices);
        Room { scene, bvh }
    }

    /// Random points on its triangles, which face its middle.
    fn points(&self, count: u32, salt: u32) -> Vec<SurfacePoint> {
        let triangles = self.scene.triangles() as u32;
        let middle = Vec3::new(0.27, 0.3, 0.27);
        let one = |i: u32| {
            let number = |what: u32| hash(hash(salt + what) ^ i);
            let [u, v] = [1, 2].map(|what| 0.5 * (0.02 + 0.96 * unit_float(number(what)) as f32));
            point_on(&self.scene, number(0) % triangles, Vec2::new(u, v), middle, number(3))
        };
        (0..count).map(one).collect()
    }

    fn see_each_other(&self, a: &SurfacePoint, b: &SurfacePoint) -> bool {
        let [from, to, here, there] = [a.position, b.position, a.normal, b.normal].map(Vec3::from);
        let way = to - from;
        here.dot(way) > 0.0 && there.dot(way) < 0.0 && !self.bvh.occluded(from, way, 1e-4, 1.0 - 1e-4)
    }

    fn is_in_view(&self, point: &SurfacePoint) -> bool {
        let camera = &self.scene.camera;
        let (at, normal) = (Vec3::from(point.position), Vec3::from(point.normal));
        let local = camera.view().transform_point3(at);
        let half_height = (camera.vertical_fov * 0.5).tan();
        let bounds = Vec2::new(half_height * WIDTH as f32 / HEIGHT as f32, half_height) * -local.z;
        let way = at - camera.position;
        -local.z > camera.near
            && local.truncate().abs().cmple(bounds).all()
            && normal.dot(way) < 0.0
            && !self.bvh.occluded(camera.position, way, 0.0, 1.0 - 1e-4)
    }

    fn verify(&self, case: &Case<'_>) -> Option<[(SurfacePointsHeader, Vec<SurfacePoint>); 2]> {
        let mut harness = Harness::new(PASS)
            .with_scene(self.scene.clone())
            .frame(WIDTH, HEIGHT)
            .set("rays_per_point", case.rays)
            .set("rounds", case.rounds)
            .set("casters", case.casters);
        for (port, points) in [("lights", case.lights), ("mailboxes", case.mailboxes)] {
            harness = harness.surface_points(port, 17, points);
        }
        // Behind the points lie others, which cast no rays.
        harness = harness.surface_points_before("points", 17, case.points, case.mailboxes);
        let outputs = harness.run()?;
        Some(["verified", "witnesses"].map(|name| outputs.surface_points(name)))
    }
}

struct Case<'a> {
    points: &'a [SurfacePoint],
    lights: &'a [SurfacePoint],
    mailboxes: &'a [SurfacePoint],
    rays: u32,
    rounds: u32,
    casters: u32,
}

fn unmarked(point: &SurfacePoint) -> SurfacePoint {
    SurfacePoint { mark: 0, ..*point }
}

/// With a ray from each point to each unseen light, marks and mailboxes are those of all pairs.
#[test]
fn with_all_rays_marks_and_mailboxes_are_those_of_all_pairs() {
    let room = Room::new(pass_test::scene("cornell-box"));
    let in_view: Vec<_> =
        room.points(4000, 1).into_iter().filter(|point| room.is_in_view(point)).take(150).collect();
    assert_eq!(in_view.len(), 150);
    let (mut lights, mut mailboxes) = (room.points(600, 2), room.points(600, 3));
    (lights[9], mailboxes[9], mailboxes[10]) = (SurfacePoint::NONE, SurfacePoint::NONE, SurfacePoint::NONE);
    let case = Case {
        points: &in_view,
        lights: &lights,
        mailboxes: &mailboxes,
        rays: 1024,
        rounds: 1,
        casters: 2048,
    };
    let Some([(header, verified), (_, witnesses)]) = room.verify(&case) else { return };
    let (mut kept, mut found, mut marked, mut wrong) = (0, 0, 0, 0);
    for (i, light) in lights.iter().enumerate() {
        assert_eq!(unmarked(&verified[i]), *light, "light {i}");
        if light.is_none() {
            assert_eq!((verified[i].mark, witnesses[i]), (0, SurfacePoint::NONE));
            continue;
        }
        let first = in_view.iter().find(|point| room.see_each_other(point, light));
        let expected = if !mailboxes[i].is_none() && room.is_in_view(&mailboxes[i]) {
            kept += 1;
            (0, mailboxes[i])
        } else if let Some(first) = first {
            found += 1;
            (0, *first)
        } else {
            marked += 1;
            (1, mailboxes[i])
        };
        wrong += usize::from((verified[i].mark, witnesses[i]) != expected);
    }
    assert!(kept > 50 && found > 100 && marked > 10, "{kept} kept, {found} found, {marked} marked");
    // Rays along edges may go to either side.
    assert!(wrong <= 6, "{wrong} of 600 differ");
    assert_eq!(header.marked as usize, verified.iter().filter(|light| light.mark != 0).count());
    assert_eq!(header.iteration, 17);
}

/// Few rays find fewer lights, two rounds more of them than one, and whatever is found is true.
#[test]
fn fewer_rays_find_fewer_and_nothing_false() {
    let room = Room::new(pass_test::scene("cornell-box"));
    let in_view: Vec<_> =
        room.points(1000, 1).into_iter().filter(|point| room.is_in_view(point)).take(64).collect();
    let lights = room.points(500, 2);
    let mailboxes = vec![SurfacePoint::NONE; 500];
    let mut counts = Vec::new();
    for (rounds, rays, casters) in [(0, 16, 64), (1, 1, 64), (2, 1, 64), (2, 16, 16), (2, 16, 64)] {
        let case = Case { points: &in_view, lights: &lights, mailboxes: &mailboxes, rays, rounds, casters };
        let Some([(header, verified), (_, witnesses)]) = room.verify(&case) else { return };
        let mut wrong = 0;
        for (light, witness) in verified.iter().zip(&witnesses) {
            assert_eq!(light.mark == 0, !witness.is_none());
            wrong += usize::from(light.mark == 0 && !room.see_each_other(witness, light));
        }
        assert!(wrong <= 3, "{wrong} lights are not seen from their mailboxes");
        let casting: Vec<_> = in_view.iter().take(casters as usize).map(|point| point.seed).collect();
        assert!(witnesses.iter().all(|point| point.is_none() || casting.contains(&point.seed)));
        counts.push(500 - header.marked);
    }
    assert_eq!(counts[0], 0);
    assert!(counts[1] > 10 && counts[1] <= 64, "{counts:?}");
    assert!(counts[2] > counts[1] && counts[4] > counts[2] && counts[4] > counts[3], "{counts:?}");
}

#[test]
fn a_camera_that_sees_nothing_leaves_all_lights_unseen() {
    let mut scene = pass_test::scene("cornell-box");
    let back = 2.0 * scene.camera.position - scene.camera.target;
    scene.camera.target = back;
    let room = Room::new(scene);
    let (lights, mailboxes) = (room.points(300, 2), room.points(300, 3));
    let nothing = [SurfacePoint::NONE; 64];
    let case =
        Case { points: &nothing, lights: &lights, mailboxes: &mailboxes, rays: 16, rounds: 2, casters: 64 };
    let Some([(header, verified), (_, witnesses)]) = room.verify(&case) else { return };
    assert_eq!(header.marked, 300);
    assert!(verified.iter().all(|light| light.mark == 1));
    assert_eq!(witnesses, mailboxes);
    // Without lights nothing is marked.
    let none = [SurfacePoint::NONE; 300];
    let case = Case { lights: &none, mailboxes: &none, ..case };
    assert_eq!(room.verify(&case).expect("the adapter is still there")[0].0.marked, 0);
}
