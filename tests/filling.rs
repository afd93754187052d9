//! Imperfect maps of lights that stay, against rays of the same lights: they come nearer to them from frame to frame.

use crate::adapter::{rel_mse, renderer};
use renderer::Renderer;
use scene::Camera;

const SIZE: (u32, u32) = (32, 24);

/// All lights at each pixel, so that pixels differ by their maps alone; few points, so that maps have holes.
const SET: &[&str] =
    &["lights=64", "rsm.size=64", "map=32", "settle=false", "interleave_x=1", "interleave_y=1"];

fn maps(pipeline: &str, scene: &str, fill: &str) -> Option<Renderer> {
    let mut renderer = renderer(pipeline, scene, SIZE, &[SET, &[fill]].concat())?;
    renderer.keep_only(["irradiance"]).unwrap();
    Some(renderer)
}

/// The error of the next frame against rays.
fn error(maps: &mut Renderer, rays: &mut Renderer) -> f64 {
    let [ours, exact] = [maps, rays].map(|renderer| {
        renderer.frame().unwrap();
        renderer.output("irradiance").unwrap()
    });
    rel_mse(&ours, &exact)
}

/// Also while the camera moves, which moves none of the lights of their flux.
#[test]
fn maps_of_lights_that_stay_come_nearer_to_rays() {
    for (scene, at_most) in [("atrium-spot", 0.35), ("cornell-box", 0.9)] {
        let (Some(mut filling), Some(mut rays)) =
            (maps("ism", scene, "fill=64"), maps("ism-ray-traced", scene, "fill=0"))
        else {
            return;
        };
        let mut errors = Vec::new();
        for frame in 0..32 {
            let camera = rays.scene().camera;
            let by = glam::Vec3::new(0.002, 0.001, 0.0) * frame as f32;
            for renderer in [&mut filling, &mut rays] {
                renderer.set_camera(Some(Camera { position: camera.position + by, ..camera }), false);
            }
            errors.push(error(&mut filling, &mut rays));
        }
        let (first, last) = (errors[0], errors[31]);
        eprintln!("{scene}: {first:.4}, {:.4}, {last:.4}", errors[8]);
        assert!(last < at_most * first, "{scene}: {errors:?}");
    }
}

/// Where geometry moves, each frame has the maps of a frame by itself.
#[test]
fn maps_begin_anew_where_geometry_moves() {
    let both = ["fill=64", "fill=0"].map(|fill| maps("ism", "cornell-box-moving", fill));
    let [Some(mut filling), Some(mut anew)] = both else { return };
    for frame in 0..3 {
        let [ours, theirs] = [&mut filling, &mut anew].map(|renderer| {
            renderer.set_time(Some(frame as f32 / 15.0));
            renderer.frame().unwrap();
            renderer.output("irradiance").unwrap()
        });
        let error = rel_mse(&ours, &theirs);
        assert!(error < 1e-6, "frame {frame}: {error}");
    }
}
