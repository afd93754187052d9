//! Imperfect maps of lights that stay, against rays of the same lights: they come nearer to them from frame to frame.

use crate::adapter::{rel_mse, renderer};
use metrics::Image;
use renderer::Renderer;
use scene::Camera;

const SIZE: (u32, u32) = (32, 24);

/// All lights at each pixel, so that pixels differ by their maps alone; few points, so that maps have holes.
const SET: &[&str] = &["lights=64", "rsm.size=64", "map=64", "interleave_x=1", "interleave_y=1"];

fn maps(pipeline: &str, scene: &str, fill: &str) -> Option<Renderer> {
    let mut renderer = renderer(pipeline, scene, SIZE, &[SET, &[fill]].concat())?;
    renderer.keep_only(["irradiance"]).unwrap();
    Some(renderer)
}

/// The irradiance of the next frame.
fn next(renderer: &mut Renderer) -> Image {
    renderer.frame().unwrap();
    renderer.output("irradiance").unwrap()
}

/// Also while the camera walks, which moves no light that is chosen by its flux. Errors of maps that are made anew in each frame are those
/// of the first.
#[test]
fn maps_of_lights_that_stay_come_nearer_to_rays() {
    for (scene, at_most) in [("atrium-spot", 0.6), ("cornell-box", 1.0)] {
        let all = [("ism", "fill=64"), ("ism", "fill=0"), ("ism-ray-traced", "fill=0")];
        let [Some(mut filling), Some(mut anew), Some(mut rays)] =
            all.map(|(name, fill)| maps(name, scene, fill))
        else {
            return;
        };
        let begin = rays.scene().camera;
        let (mut of_filling, mut of_anew) = (0.0, 0.0);
        for frame in 0..32 {
            let position = begin.position + glam::Vec3::new(0.002, 0.001, 0.0) * frame as f32;
            for renderer in [&mut filling, &mut anew, &mut rays] {
                renderer.set_camera(Some(Camera { position, ..begin }), false);
            }
            let exact = next(&mut rays);
            let errors = [&mut filling, &mut anew].map(|renderer| rel_mse(&next(renderer), &exact));
            if frame >= 24 {
                of_filling += errors[0];
                of_anew += errors[1];
            }
        }
        eprintln!("{scene}: RATIO {:.3}", of_filling / of_anew);
        assert!(of_filling < at_most * of_anew, "{scene}: {of_filling} against {of_anew}");
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
            next(renderer)
        });
        let error = rel_mse(&ours, &theirs);
        assert!(error < 1e-6, "frame {frame}: {error}");
    }
}
