//! The content of resources.

use super::{pump, window};
use crate::action::{Action, Tab};
use egui_kittest::kittest::Queryable as _;

#[test]
fn a_texture_is_seen_at_the_scale_that_is_chosen() {
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    harness.state_mut().remembered.tab = Tab::Look;
    pump(&mut harness, |app| app.now.looked.is_some());
    harness.run_steps(4);
    harness.get_by_label("16:1").click();
    harness.run_steps(4);
    harness.get_by_label("1600 %");
    harness.get_by_label("1:1").click();
    harness.run_steps(4);
    harness.get_by_label("100 %");
    // The range of the histogram, and of what is not shown in it.
    harness.get_by_label_contains("RGB: ");
}

#[test]
fn a_snapshot_stays_as_it_was() {
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    let context = harness.ctx.clone();
    harness.state_mut().act(Action::Snapshot, &context);
    let kept = harness.state().now.side(crate::engine::SideId::A).unwrap().picture.clone().unwrap();
    harness.state_mut().act(Action::FlickSnapshot, &context);
    let aside = crate::camera::orbit(&harness.state().now.camera.unwrap(), 0.5, 0.0);
    let app: &mut crate::app::App = harness.state_mut();
    app.pilot.take(&app.engine, aside, false);
    pump(&mut harness, |app| app.now.camera == Some(aside));
    let shown = harness.state().snapshots.shown().expect("it is shown").picture.clone();
    assert_eq!(shown.pixels, kept.pixels);
    harness.state_mut().remembered.tab = Tab::Compare;
    harness.run_steps(4);
    harness.get_by_label("Flicker").click();
    harness.run_steps(2);
    assert!(harness.state().snapshots.shown().is_none());
}
