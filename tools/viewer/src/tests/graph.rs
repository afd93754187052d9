//! The graph in the middle of the window.

use super::window;
use crate::action::Tab;
use eframe::egui::{Key, Role};
use egui_kittest::kittest::Queryable as _;

#[test]
fn the_graph_is_a_view_of_its_own() {
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    harness.key_press(Key::F4);
    harness.run_steps(3);
    assert!(
        harness.query_by_role_and_label(Role::Image, "Picture").is_none(),
        "it is in place of the picture"
    );
    // A click shows what a pass reads and writes.
    harness.get_by_role_and_label(Role::Button, "gather").click_accesskit();
    harness.run_steps(3);
    harness.get_by_label("lights: VirtualLights");
    harness.get_by_label("irradiance: Irradiance");
    let link = harness.get_all_by_role(Role::Link).last().expect("the outputs are links");
    link.click();
    harness.run_steps(3);
    assert_eq!(harness.state().remembered.tab, Tab::Look);
    harness.key_press(Key::F4);
    harness.run_steps(3);
    harness.get_by_role_and_label(Role::Button, "Larger").click();
    harness.run_steps(3);
    // The same key goes back to the picture.
    harness.key_press(Key::F4);
    harness.run_steps(3);
    harness.get_by_role_and_label(Role::Image, "Picture");
}
