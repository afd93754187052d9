//! Incremental instant radiosity: what its lights carry, in the first frame and while the source moves.

use crate::adapter::renderer;
use crate::surface_lights::{fluxes, lights};
use frame_graph::Value;
use std::ops::ControlFlow;

/// Lights that are kept carry what photons carry, on each surface: while the source glides, too.
#[test]
fn kept_lights_carry_the_flux_of_photons() {
    for (scene, frames) in [("cornell-box", 0), ("cornell-box-lights", 0), ("cornell-box-glide", 12)] {
        let values = ["lights=1024", "map=4", "interleave_x=1", "interleave_y=1"];
        let kept = [&values[..], &["moved=16"]].concat();
        let Some(mut kept) = renderer("incremental-instant-radiosity", scene, (16, 16), &kept) else {
            return;
        };
        let photons = [&values[..], &["bounces=1"]].concat();
        let mut photons = renderer("instant-radiosity", scene, (16, 16), &photons).expect("as before");
        for frame in 0..=frames {
            kept.set_frame_index(frame);
            let found = fluxes(&lights(&mut kept));
            if frame != 0 && frame != frames {
                continue;
            }
            photons.set_frame_index(frame);
            let expected = fluxes(&lights(&mut photons));
            let all: f64 = expected.values().sum();
            for (direction, flux) in &expected {
                let error = (found.get(direction).copied().unwrap_or(0.0) - flux).abs() / all;
                assert!(error < 0.02, "{scene}, {direction}: {found:?} W of {expected:?}");
            }
            let ratio = found.values().sum::<f64>() / all;
            assert!((ratio - 1.0).abs() < 0.01, "{scene}: {ratio} times the flux of photons");
        }
    }
}

/// The picture has the energy of path tracing of one bounce.
#[test]
fn one_bounce_has_the_energy_of_path_tracing() {
    let energy = |pipeline: &str, values: &[&str]| {
        let mut renderer = renderer(pipeline, "cornell-box", (48, 48), values)?;
        renderer.frame_until_done(|_, _| ControlFlow::Continue(())).unwrap();
        let image = renderer.output("indirect").unwrap();
        Some(image.pixels().iter().map(|p| f64::from(metrics::luminance([p[0], p[1], p[2]]))).sum::<f64>())
    };
    let Some(truth) = energy("reference", &["bounces=1", "samples=256"]) else { return };
    let values = ["lights=1024", "map=64", "interleave_x=1", "interleave_y=1", "clamp=0.01"];
    let found = energy("incremental-instant-radiosity", &values).expect("the adapter is still there");
    assert!((found / truth - 1.0).abs() < 0.04, "{} times the energy", found / truth);
}

/// While the source glides, a frame moves as many lights as it may and no more; where all is still, none in the end.
#[test]
fn a_frame_moves_no_more_lights_than_it_may() {
    for (most, scene) in [(1, "cornell-box-glide"), (8, "cornell-box-glide"), (8, "cornell-box")] {
        let count = format!("moved={most}");
        let values = ["lights=128", "map=4", count.as_str()];
        let Some(mut renderer) = renderer("incremental-instant-radiosity", scene, (16, 16), &values) else {
            return;
        };
        let mut before = lights(&mut renderer);
        let mut last = 0;
        for frame in 1..20 {
            renderer.set_frame_index(frame);
            let after = lights(&mut renderer);
            // A light that is lost leaves a dark place until another comes.
            last =
                before.iter().zip(&after).filter(|(a, b)| b.area > 0.0 && a.position != b.position).count();
            assert!(last <= most, "{last} lights moved, of {most}");
            before = after;
        }
        assert_eq!(last > 0, scene == "cornell-box-glide", "{scene}: {last} lights move in the last frame");
    }
}

/// Pipelines whose lights are of one bounce take no other number: it is what references and `lightloom stress` go by.
#[test]
fn lights_of_one_bounce_are_declared_as_such() {
    for pipeline in ["incremental-instant-radiosity", "tcas-instant-radiosity"] {
        let Some(mut renderer) = renderer(pipeline, "cornell-box", (8, 8), &["lights=16", "map=4"]) else {
            return;
        };
        renderer.set_value("bounces", Value::U32(1)).unwrap();
        let refused = renderer.set_value("bounces", Value::U32(2)).err().map(|error| error.to_string());
        assert!(refused.is_some_and(|error| error.contains("bounces")), "{pipeline} takes two bounces");
    }
}
