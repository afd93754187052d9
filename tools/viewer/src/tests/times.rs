//! Times of passes, and what is chosen by them.

use super::{pump, remembering, window};
use crate::app::App;
use crate::engine::{Command, SideId, SideView};
use crate::remembered::Remembered;

fn a(app: &App) -> &SideView {
    app.now.side(SideId::A).unwrap()
}

#[test]
fn every_pass_runs_in_every_frame_where_that_is_asked_for() {
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    pump(&mut harness, |app| a(app).idle);
    let frames = a(harness.state()).frames;
    // A pass without a step of its own, such as the lookups of settled maps, never runs.
    let idle: Vec<bool> = a(harness.state()).steps.iter().map(|steps| steps.is_empty()).collect();
    assert!(idle.iter().filter(|idle| **idle).count() <= 1);
    harness.state().engine.send(Command::RunEverything(true));
    pump(&mut harness, |app| {
        a(app).frames > frames + 5 && std::iter::zip(&a(app).ran, &idle).all(|(ran, idle)| ran != idle)
    });
    pump(&mut harness, |app| {
        std::iter::zip(&*a(app).times, &idle).all(|(times, idle)| *idle || times.all().len() > 3)
    });
    harness.state().engine.send(Command::RunEverything(false));
    pump(&mut harness, |app| a(app).idle);
}

#[test]
fn times_begin_again_with_another_resolution() {
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    harness.state().engine.send(Command::RunEverything(true));
    pump(&mut harness, |app| a(app).whole.all().len() > 8 && a(app).times[0].all().len() > 4);
    harness.state().engine.send(Command::RunEverything(false));
    pump(&mut harness, |app| a(app).idle);
    let before = a(harness.state()).plan.frame;
    harness.state_mut().remembered.resolution = 0.25;
    pump(&mut harness, |app| a(app).plan.frame != before && a(app).idle);
    let side = a(harness.state());
    assert!(side.whole.all().len() < 5, "{} frames", side.whole.all().len());
    assert!(side.times.iter().all(|times| times.all().len() < 5));
}

/// On a processor the first picture is small, and comes to full size at rest; what moves is small again from its first frame.
#[test]
fn the_automatic_resolution_begins_small_on_a_processor() {
    let Some(mut harness) = remembering("ism", "plane", Remembered::default()) else { return };
    pump(&mut harness, |app| !app.now.adapter.is_empty());
    if !harness.state().now.on_cpu {
        return;
    }
    assert_eq!(harness.state().resolution(), 0.125);
    let small = harness.state().frame_size.sent;
    // Eight times as wide, but for rounding; the size before is four times as wide.
    pump(&mut harness, |app| app.resolution() == 1.0 && a(app).plan.frame.0 > 6 * small.0 && a(app).idle);
    let full = a(harness.state()).plan.frame;
    for time in [1.0, 2.0, 3.0] {
        let engine = &harness.state().engine;
        let (sent, frames) = (engine.sent(), a(harness.state()).frames);
        assert!(engine.small().is_some_and(|(width, _)| width < full.0));
        engine.send(Command::Time(time));
        assert_eq!((engine.sent(), *engine.small()), (sent + 2, None), "the size goes before the command");
        pump(&mut harness, |app| {
            a(app).frames > frames && app.engine.small().is_some() && a(app).plan.frame == full
        });
    }
}
