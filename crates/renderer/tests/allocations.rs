//! A renderer allocates nothing before its executor's frame where nothing changes. The executor's own frame is
//! tested in its crate.

use renderer::{Assets, Catalog};

#[test]
fn posing_a_scene_in_which_nothing_moves_allocates_nothing() {
    let catalog = Catalog::new(Assets::new(None));
    for name in ["cornell-box", "cornell-box-lights", "atrium"] {
        let scene = renderer::load_scene(&catalog, name).unwrap();
        let mut pose = scene.at(0.0);
        for frame in 0..4 {
            let time = scene.frame_time(frame);
            let count = allocation_counter::measure(|| scene.pose(time, &mut pose)).count_total;
            assert_eq!(count, 0, "{name}, frame {frame}");
        }
    }
}
