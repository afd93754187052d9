//! Where things are: panels leave room for the picture, and labels stand before their fields.

use super::{Window, pump, window};
use crate::action::{IN_THE_PICTURE, Tab, View, table};
use crate::engine::SideId;
use eframe::egui::accessibility::is_input;
use eframe::egui::{Rect, Role, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use frame_graph::Overrides;

/// The controls and their places.
fn controls(harness: &Window) -> Vec<(String, Rect)> {
    let nodes = harness.root().children_recursive();
    let inputs = nodes.filter(|node| {
        let node = node.accesskit_node();
        is_input(node.role()) && !node.is_hidden()
    });
    inputs
        .map(|node| {
            (
                format!(
                    "{:?} {}",
                    node.accesskit_node().role(),
                    node.accesskit_node().label().unwrap_or_default()
                ),
                node.rect(),
            )
        })
        .collect()
}

#[test]
fn panels_fit_into_a_small_window() {
    let Some(mut harness) = window("ism-invtm", "cornell-box-moving") else { return };
    let app = harness.state_mut();
    app.open_pipeline(SideId::B, "ism-uniform", Overrides::default());
    app.remembered.view = View::Split;
    pump(&mut harness, |app| app.now.sides.len() == 2);
    harness.set_size(vec2(900.0, 600.0));
    for tab in Tab::ALL {
        harness.state_mut().remembered.tab = *tab;
        harness.run_steps(6);
        if *tab == Tab::Graph {
            // It is in the middle in place of the picture.
            assert!(harness.query_by_role_and_label(Role::Image, "Picture").is_none());
            continue;
        }
        let picture = harness.get_by_role_and_label(Role::Image, "Picture").rect();
        assert!(picture.width() >= 350.0 && picture.height() >= 440.0, "{}: {picture}", tab.name());
        let mut cut = controls(&harness);
        cut.retain(|(name, rect)| {
            // What stands in the bars above and below the picture begins where the words before it end.
            let of_bars = name.contains("Split") || name.contains("Resolution");
            let of_settings = !of_bars && rect.left() < picture.left() && rect.top() > picture.top();
            rect.right() > 901.0 || of_settings && rect.right() > picture.left()
        });
        assert!(cut.is_empty(), "{}: not in the window: {cut:?}", tab.name());
    }
}

#[test]
fn labels_stand_before_their_fields() {
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    for tab in Tab::ALL {
        harness.state_mut().remembered.tab = *tab;
        harness.run_steps(4);
        let mut seen = 0;
        for node in harness.root().children_recursive() {
            let field = node.accesskit_node();
            // The text of a check box stands behind it, as everywhere.
            if !is_input(field.role()) || field.role() == Role::CheckBox {
                continue;
            }
            for label in field.labelled_by() {
                let (label, field) = (label.bounding_box(), field.bounding_box());
                let (Some(label), Some(field)) = (label, field) else { continue };
                assert!(label.x0 < field.x0 || label.y1 <= field.y0, "{}: {label:?}, {field:?}", tab.name());
                seen += 1;
            }
        }
        assert!(seen > 5, "{}: {seen} labels", tab.name());
    }
}

/// All keys are seen at once in a window of usual size; a small one holds their list, which scrolls.
#[test]
fn the_keys_are_seen_at_once() {
    let Some(mut harness) = window("ism-invtm", "plane") else { return };
    harness.state_mut().help = true;
    for (size, whole) in
        [(vec2(1500.0, 1000.0), true), (vec2(1100.0, 800.0), true), (vec2(480.0, 320.0), false)]
    {
        harness.set_size(size);
        harness.run_steps(8);
        let list = harness.get_by_role_and_label(Role::Window, "Keys").rect();
        assert!(harness.ctx.content_rect().contains_rect(list), "{size}: {list}");
        let seen =
            |about: &str| harness.query_all_by_label(about).any(|label| list.contains_rect(label.rect()));
        let keys = table();
        let entries = keys.iter().map(|entry| entry.about).chain(IN_THE_PICTURE.map(|(_, about)| about));
        let hidden: Vec<&str> = entries.filter(|about| !seen(about)).collect();
        assert_eq!(hidden.is_empty(), whole, "{size}: {hidden:?}");
    }
}
