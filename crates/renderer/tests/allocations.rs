//! A frame in which nothing changes allocates nothing but what wgpu does: held against the same calls made by hand.

use frame_graph::{Overrides, Value};
use renderer::{Assets, Catalog, Gpu, Renderer, wgpu};
use std::sync::Arc;

/// Frames that are counted. The least counts: lists inside wgpu grow now and then.
const FRAMES: usize = 24;

fn allocations(work: impl FnMut()) -> u64 {
    allocation_counter::measure(work).count_total
}

#[test]
fn a_frame_in_which_nothing_changes_allocates_what_wgpu_does() {
    let gpu = match Gpu::open() {
        Ok(gpu) => gpu,
        Err(error) => return eprintln!("skipped: {error}"),
    };
    let catalog = Arc::new(Catalog::new(Assets::new(None)));
    let scene = renderer::load_scene(&catalog, "cornell-box").unwrap();
    let mut renderer = Renderer::new(gpu.clone(), catalog, scene, (16, 16)).unwrap();
    let lights = Overrides(vec![("lights".to_owned(), Value::U32(8))]);
    renderer.set_pipeline("ism-invtm", &lights).unwrap();
    for _ in 0..4 {
        renderer.frame().unwrap();
    }
    // The number and the time of the frame, which are written in every frame.
    let numbers = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 16,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    // One after the other: what wgpu allocates for a buffer depends on which one was written last.
    let least = |work: &mut dyn FnMut()| {
        let frame = || {
            let count = allocations(&mut *work);
            gpu.wait().unwrap();
            count
        };
        std::iter::repeat_with(frame).take(FRAMES).min()
    };
    let by_hand = least(&mut || {
        gpu.queue.write_buffer(&numbers, 0, &[1; 16]);
        gpu.queue.submit([]);
    });
    let frame = least(&mut || {
        let report = renderer.frame().unwrap();
        assert!(report.ran.iter().all(|ran| !ran));
    });
    assert!(frame <= by_hand, "{frame:?} allocations, {by_hand:?} by hand");
}
