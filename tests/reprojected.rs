//! Pictures that go on from frame to frame while the camera moves: where pixels were, what it brings, and what ends it.

use crate::adapter::{bits, done, energy, rel_mse, renderer};
use bytemuck::{Pod, pod_collect_to_vec};
use glam::{DVec3, Vec3, dvec2};
use metrics::{Epsilon, Image, Pair};
use renderer::Renderer;
use scene::{Camera, Light, Scene};

const SIZE: (u32, u32) = (64, 48);
const FEW: &[&str] = &["lights=64", "map=16", "rsm.size=64"];

fn reprojected(scene: &str) -> Option<Renderer> {
    renderer("ism-invtm-reprojected", scene, SIZE, FEW)
}

/// The camera of a slow walk to the side.
fn walked(camera: Camera, frame: u32) -> Option<Camera> {
    let by = Vec3::new(0.0015, 0.0005, -0.001) * frame as f32;
    Some(Camera { position: camera.position + by, target: camera.target + by, ..camera })
}

fn indirect(renderer: &Renderer) -> Image {
    renderer.output("indirect").unwrap()
}

/// The texels of a resource, row by row.
fn texels<T: Pod>(renderer: &Renderer, name: &str) -> Vec<T> {
    let resource = renderer.plan().unwrap().resource(name).unwrap();
    pod_collect_to_vec(&renderer.resource_bytes(resource).unwrap())
}

/// Whether anything stands between two points, but for a thousandth of the way at the ends.
fn is_hidden(scene: &Scene, from: DVec3, to: DVec3) -> bool {
    scene.indices.chunks_exact(3).any(|corners| {
        let [a, b, c] =
            [0, 1, 2].map(|i| DVec3::from(scene.vertices[corners[i] as usize].position.map(f64::from)));
        let (u, v, ray) = (b - a, c - a, to - from);
        let (p, q) = (ray.cross(v), (from - a).cross(u));
        let determinant = u.dot(p);
        let [x, y, t] = [(from - a).dot(p), ray.dot(q), v.dot(q)].map(|part| part / determinant);
        determinant != 0.0 && x >= 0.0 && y >= 0.0 && x + y <= 1.0 && t > 1e-3 && t < 1.0 - 1e-3
    })
}

/// Of what rays say was seen in the frame before nearly all is found, and what was there at the place is the surface of the pixel.
#[test]
fn places_are_where_surfaces_were_seen() {
    let Some(mut renderer) = reprojected("cornell-box") else { return };
    let names = ["reproject.surface.place", "reproject.surface.texels", "reproject.seen.position"];
    renderer.keep_only(names).unwrap();
    let scene = renderer.scene().clone();
    let before = scene.camera;
    renderer.frame().unwrap();
    let seen_before: Vec<[f32; 4]> = texels(&renderer, names[2]);
    let by = Vec3::new(0.12, 0.05, -0.02);
    renderer.set_camera(Some(Camera { position: before.position + by, ..before }), false);
    renderer.frame().unwrap();
    let (place, found, seen): (Vec<[f32; 2]>, Vec<u32>, Vec<[f32; 4]>) =
        (texels(&renderer, names[0]), texels(&renderer, names[1]), texels(&renderer, names[2]));
    let size = dvec2(f64::from(SIZE.0), f64::from(SIZE.1));
    let tangent = f64::from(before.vertical_fov * 0.5).tan();
    let position = |[x, y, z, _]: [f32; 4]| Vec3::new(x, y, z).as_dvec3();
    let (mut visible, mut hidden, mut found_again, mut lost) = (0, 0, 0, 0);
    for (i, now) in seen.into_iter().enumerate().filter(|(_, at)| at[3] > 0.0) {
        let at = position(now);
        let from = before.view().as_dmat4().transform_point3(at);
        let ndc = dvec2(from.x / tangent * size.y / size.x, from.y / tangent) / -from.z;
        let expected = (ndc * dvec2(0.5, -0.5) + 0.5) * size;
        if expected.cmplt(dvec2(1.0, 1.0)).any() || expected.cmpgt(size - 1.0).any() {
            continue;
        }
        let is_hidden = is_hidden(&scene, before.position.as_dvec3(), at);
        (visible, hidden) = (visible + usize::from(!is_hidden), hidden + usize::from(is_hidden));
        if found[i] == 0 {
            lost += usize::from(is_hidden);
            continue;
        }
        found_again += usize::from(!is_hidden);
        // One texel that counts is at the place, or has all of the weight.
        let texel = |t: u32| {
            let corner =
                [0, 1].map(|axis| (place[i][axis] - 0.5).floor() as usize + (t as usize >> axis & 1));
            position(seen_before[corner[1] * SIZE.0 as usize + corner[0]])
        };
        let pixel = 2.0 * tangent * from.z.abs() / size.y;
        for t in (0..4).filter(|t| found[i] & (1 << t) != 0) {
            // At a grazing angle pixels lie further apart.
            assert!(texel(t).distance(at) < 12.0 * pixel, "pixel {i}: {:?} and {at:?}", texel(t));
        }
    }
    assert!(
        visible > 1500 && hidden > 20 && lost > 5,
        "{visible} seen, {hidden} hidden, of which {lost} have no place"
    );
    assert!(
        found_again as f64 > 0.98 * visible as f64,
        "of {visible} that were seen, {found_again} are found"
    );
}

/// At rest the mean is that of as many samples as there are frames, and then it stands.
#[test]
fn at_rest_the_picture_converges_and_stands() {
    let Some(mut renderer) = reprojected("cornell-box") else { return };
    let Some(mut mean) = crate::adapter::renderer(
        "ism-invtm-accumulated",
        "cornell-box",
        SIZE,
        &[FEW, &["frames=256"]].concat(),
    ) else {
        return;
    };
    done(&mut mean);
    let truth = indirect(&mean);
    let error = |renderer: &Renderer| rel_mse(&indirect(renderer), &truth);
    renderer.frame().unwrap();
    let first = error(&renderer);
    for _ in 1..40 {
        renderer.frame().unwrap();
    }
    assert!(error(&renderer) < 0.1 * first, "{} after {first}", error(&renderer));
    for _ in 40..150 {
        renderer.frame().unwrap();
    }
    let ran = std::iter::zip(&renderer.plan().unwrap().passes, &renderer.report().ran);
    let ran: Vec<&str> = ran.filter(|(_, ran)| **ran).map(|(pass, _)| &*pass.name).collect();
    assert!(ran.is_empty(), "{ran:?} still run");
}

/// In a slow walk the picture is nearer to the mean of many samples than a frame alone is, and as bright.
#[test]
fn a_walk_keeps_what_it_has_seen() {
    const FRAMES: u32 = 24;
    const SEEDS: u32 = 4;
    // Thin faces that are lit are too bright, since a mean along a surface shows none of what lies beside it in the pixel: by 2.0 % of the
    // energy of 64×48 pixels, and by 1.8 % of that of these.
    const LARGER: (u32, u32) = (96, 72);
    let in_box = |pipeline: &str, values: &[&str]| renderer(pipeline, "cornell-box", LARGER, values);
    let Some(mut walking) = in_box("ism-invtm-reprojected", FEW) else { return };
    let camera = walking.scene().camera;
    let mut walk_of_seed = |seed: u32| {
        walking.set_seed(seed);
        for frame in 0..=FRAMES {
            walking.set_camera(walked(camera, frame), frame == 0);
            walking.frame().unwrap();
        }
        indirect(&walking)
    };
    let still = |pipeline: &str, values: &[&str]| {
        let mut renderer = in_box(pipeline, &[FEW, values].concat()).expect("the adapter is still there");
        renderer.set_camera(walked(camera, FRAMES), false);
        done(&mut renderer);
        indirect(&renderer)
    };
    let truth = still("ism-invtm-accumulated", &["frames=128"]);
    let alone = still("ism-invtm", &[]);
    let measured = |image: &Image| {
        let pair = Pair::new(image, &truth).unwrap();
        (pair.rel_mse(Epsilon::default()).unwrap(), pair.energy_ratio().unwrap())
    };
    let walks: Vec<(f64, f64)> = (0..SEEDS).map(|seed| measured(&walk_of_seed(seed))).collect();
    let mean = |of: fn(&(f64, f64)) -> f64| walks.iter().map(of).sum::<f64>() / f64::from(SEEDS);
    let (walk, bright, (single, _)) = (mean(|walk| walk.0), mean(|walk| walk.1), measured(&alone));
    assert!(walk < 0.5 * single, "{walk} in the walk, {single} alone");
    assert!((bright - 1.0).abs() < 0.02, "{bright} of the energy");
}

/// After a cut there is nothing of what was before.
#[test]
fn a_cut_leaves_no_ghost() {
    let picture = |before: bool| {
        let mut renderer = reprojected("cornell-box")?;
        let camera = renderer.scene().camera;
        if before {
            (0..5).for_each(|_| {
                renderer.frame().unwrap();
            });
        } else {
            // The same samples, which are counted from the beginning.
            (0..5).for_each(|frame| {
                renderer.set_camera(walked(camera, 200 * frame), true);
                renderer.frame().unwrap();
            });
        }
        renderer.set_camera(walked(camera, 100), true);
        renderer.frame().unwrap();
        Some([bits(&indirect(&renderer)), bits(&renderer.output("image").unwrap())])
    };
    let (Some(after), Some(other)) = (picture(true), picture(false)) else { return };
    assert!(after == other, "what was before the cut is seen");
}

/// A light that is twice as strong is so after five frames, but for a twentieth, and one that is switched off is dark at once.
#[test]
fn light_that_changes_is_soon_seen() {
    let Some(mut renderer) = reprojected("cornell-box") else { return };
    for _ in 0..20 {
        renderer.frame().unwrap();
    }
    let before = energy(&indirect(&renderer));
    let lights = renderer.scene().lights.clone();
    let times = |factor: f32| {
        let scaled = |light: &Light| Light { intensity: light.intensity * factor, ..light.clone() };
        Some(lights.iter().map(scaled).collect())
    };
    renderer.set_lights(times(2.0)).unwrap();
    let after: Vec<f64> = (0..5)
        .map(|_| {
            renderer.frame().unwrap();
            energy(&indirect(&renderer)) / before
        })
        .collect();
    assert!(after[0] > 1.5 && (after[4] - 2.0).abs() < 0.1, "{after:?}");
    renderer.set_lights(times(0.0)).unwrap();
    renderer.frame().unwrap();
    assert!(energy(&indirect(&renderer)) < 1e-3 * before);
}
