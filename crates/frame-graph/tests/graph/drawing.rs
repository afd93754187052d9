//! The plan laid out for a window or a page.

use super::whole::{BASE, SHADOWS, plan_of};
use frame_graph::plan::{BoxKind, Drawing, DrawnBox, DrawnEdge, PassId};

fn drawing() -> (frame_graph::Plan, Drawing) {
    let files = [("base.ron", BASE), ("parts/shadows.ron", SHADOWS)];
    let plan = plan_of(&files, "base.ron").unwrap_or_else(|errors| panic!("{errors}"));
    let drawing = plan.drawing();
    (plan, drawing)
}

#[test]
fn each_pass_and_output_has_a_box_of_its_kind() {
    let (plan, drawing) = drawing();
    let of = |kind: BoxKind| -> Vec<&str> {
        drawing.boxes.iter().filter(|drawn| drawn.kind == kind).map(|drawn| drawn.name.as_str()).collect()
    };
    for (i, pass) in plan.passes.iter().enumerate() {
        assert_eq!(of(BoxKind::Pass(PassId(i as u32))), [pass.name.as_str()]);
        let drawn = &drawing.boxes[i];
        assert_eq!((drawn.lines[0].as_str(), drawn.lines[1].as_str()), (&*pass.name, &*pass.kind));
        assert!(drawn.title.starts_with("kept: "), "{}", drawn.title);
    }
    assert_eq!(of(BoxKind::Culled), ["unused"]);
    assert_eq!(of(BoxKind::Off), ["glossy"]);
    assert_eq!(of(BoxKind::Output), ["image", "indirect", "depth"]);
}

#[test]
fn boxes_lie_within_the_drawing_and_apart() {
    let (_, drawing) = drawing();
    let ends = |i: usize| {
        let drawn = &drawing.boxes[i];
        (drawn.at, (drawn.at.0 + drawn.size.0, drawn.at.1 + drawn.size.1))
    };
    for i in 0..drawing.boxes.len() {
        let (from, to) = ends(i);
        assert!(from.0 > 0.0 && from.1 > 0.0 && to.0 < drawing.size.0 && to.1 < drawing.size.1);
        for j in 0..i {
            let (other, end) = ends(j);
            let apart = to.0 < other.0 || end.0 < from.0 || to.1 < other.1 || end.1 < from.1;
            assert!(apart, "{} and {}", drawing.boxes[i].name, drawing.boxes[j].name);
        }
    }
}

/// The outermost boxes are as far from the right edge as from the left one, and as far from the free strip below as from the top.
#[test]
fn the_drawing_is_as_large_as_its_boxes_and_a_margin() {
    let (_, drawing) = drawing();
    let least = |of: fn(&DrawnBox) -> f32| drawing.boxes.iter().map(of).fold(f32::INFINITY, f32::min);
    let most = |of: fn(&DrawnBox) -> f32| drawing.boxes.iter().map(of).fold(0.0, f32::max);
    let right = drawing.size.0 - most(|drawn| drawn.at.0 + drawn.size.0);
    assert!((right - least(|drawn| drawn.at.0)).abs() < 1.0, "{right} on the right");
    let below = drawing.size.1 - most(|drawn| drawn.at.1 + drawn.size.1);
    assert!(below >= 60.0 + least(|drawn| drawn.at.1), "{below} below");
}

#[test]
fn edges_lead_from_the_right_of_a_box_to_the_left_of_one() {
    let (_, drawing) = drawing();
    let mut labels = Vec::new();
    for edge in &drawing.edges {
        let (from, to) = (&drawing.boxes[edge.from], &drawing.boxes[edge.to]);
        let end = edge.curves.last().expect("a curve")[2];
        assert_eq!((edge.start.0, end.0), (from.at.0 + from.size.0, to.at.0), "{}", edge.label);
        assert!(edge.start.1 > from.at.1 && edge.start.1 < from.at.1 + from.size.1);
        assert!(end.1 > to.at.1 && end.1 < to.at.1 + to.size.1);
        // Data flow to the right, but for the past.
        assert!(edge.past || from.at.0 < to.at.0, "{}", edge.label);
        let near = if edge.past { edge.start } else { end };
        assert!((edge.label_at.0 - near.0).abs() < 20.0, "{}", edge.label);
        labels.push((from.name.as_str(), to.name.as_str(), edge.label.as_str(), edge.past));
    }
    for expected in [
        ("view", "lights", "view", false),
        ("shadows/splat", "gather", "atlas → visibility", false),
        ("filter", "image", "irradiance → glossy", false),
        ("steady", "steady", "past: color → history", true),
        ("steady", "image", "Texture", false),
        ("view", "depth", "Texture", false),
    ] {
        assert!(labels.contains(&expected), "{expected:?} in {labels:#?}");
    }
    // An edge past other columns runs through a place of its own in each.
    let is_depth = |edge: &&DrawnEdge| *drawing.boxes[edge.to].name == *"depth";
    let view = drawing.edges.iter().find(is_depth).expect("an output");
    let columns = |i: usize| (drawing.boxes[i].at.0 / 300.0) as usize;
    assert_eq!(view.curves.len(), 2 * (columns(view.to) - columns(view.from) - 1) + 1);
}
