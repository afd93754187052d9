//! A host program hands in its own device, and draws with the texture of an output.

use crate::adapter::{SMALL, root, set};
use executor::wgpu;
use renderer::{Assets, Catalog, Gpu, Renderer};
use std::sync::Arc;

#[test]
fn a_host_program_hands_in_its_device() {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapters = block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
    let Some(adapter) = adapters.first() else {
        eprintln!("skipped: no graphics adapter");
        return;
    };
    let (device, queue) = block_on(adapter.request_device(&Gpu::device_descriptor(adapter))).unwrap();
    let gpu = Gpu::from_device(device.clone(), queue, adapter.get_info());
    let catalog = Arc::new(Catalog::new(Assets::new(Some(root()))));
    let scene = renderer::load_scene(&catalog, "cornell-box").unwrap();
    let mut renderer = Renderer::new(gpu, catalog, scene, (16, 16)).unwrap();
    renderer.set_pipeline("ism", &set(SMALL)).unwrap();
    renderer.frame().unwrap();
    let view = renderer.output_texture("display").unwrap();
    assert_eq!(view.texture().size().width, 16);
    assert_eq!(view.texture().format(), wgpu::TextureFormat::Rgba8Unorm);
    assert!(renderer.output_texture("nothing").is_err());
}

fn block_on<F: Future>(future: F) -> F::Output {
    executor::block_on(future)
}
