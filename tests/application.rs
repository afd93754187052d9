//! An application hands in its own device, and draws with the texture of an output.

use crate::adapter::{SMALL, bits, gpu, root, set, shown};
use executor::wgpu;
use frame_graph::Value;
use renderer::{Assets, Catalog, Gpu, Renderer, SharedScene};
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

fn values(pipeline: &str) -> &'static [&'static str] {
    if pipeline == "ism" { SMALL } else { &["lights=64", "rsm.size=64"] }
}

/// A picture by an upload of its own, at the frame with this number.
fn alone(pipeline: &str, size: (u32, u32), frame: u32) -> Option<Vec<[u32; 4]>> {
    let catalog = Arc::new(Catalog::new(Assets::new(Some(root()))));
    let scene = renderer::load_scene(&catalog, "cornell-box-moving").unwrap();
    let mut renderer = Renderer::new(gpu()?, catalog, scene, size).unwrap();
    renderer.set_pipeline(pipeline, &set(values(pipeline))).unwrap();
    renderer.set_frame_index(frame);
    renderer.frame().unwrap();
    Some(bits(&renderer.output("image").unwrap()))
}

#[test]
fn several_renderers_share_a_scene() {
    let Some(gpu) = gpu() else { return };
    let catalog = Arc::new(Catalog::new(Assets::new(Some(root()))));
    let scene = renderer::load_scene(&catalog, "cornell-box-moving").unwrap();
    let shared = SharedScene::new(&gpu, scene).unwrap();
    // Other pipelines, sizes and times, in turn; one traces rays through the geometry that moves.
    let views = [("ism", (16, 16), 3), ("ism-ray-traced", (20, 12), 40), ("ism", (12, 12), 20)];
    let mut renderers: Vec<Renderer> =
        views.iter().map(|(_, size, _)| Renderer::with_scene(Arc::clone(&catalog), &shared, *size)).collect();
    for (renderer, (pipeline, ..)) in renderers.iter_mut().zip(&views) {
        renderer.set_pipeline(pipeline, &set(values(pipeline))).unwrap();
    }
    for _ in 0..2 {
        for (renderer, (pipeline, size, frame)) in renderers.iter_mut().zip(&views) {
            renderer.set_frame_index(*frame);
            let picture = bits(&shown(renderer, "image"));
            assert!(Some(picture) == alone(pipeline, *size, *frame), "{pipeline} at frame {frame}");
        }
    }
}

#[test]
fn values_and_lights_are_set_between_frames() {
    let Some(gpu) = gpu() else { return };
    let catalog = Arc::new(Catalog::new(Assets::new(Some(root()))));
    let scene = renderer::load_scene(&catalog, "cornell-box").unwrap();
    let own = scene.lights.clone();
    let mut renderer = Renderer::new(gpu, catalog, scene, (16, 16)).unwrap();
    assert!(renderer.set_value("lights", Value::U32(16)).is_err(), "no pipeline is set");
    renderer.set_pipeline("ism", &set(SMALL)).unwrap();
    let picture = |renderer: &mut Renderer| shown(renderer, "image");
    let first = picture(&mut renderer);

    renderer.set_value("lights", Value::U32(8)).unwrap();
    assert!(bits(&picture(&mut renderer)) != bits(&first), "other virtual lights");
    let error = renderer.set_value("lihgts", Value::U32(8)).unwrap_err();
    assert!(error.to_string().contains("did you mean `lights`?"), "{error}");
    renderer.set_value("lights", Value::U32(32)).unwrap();

    // As many lights as before: the plan stays. More of them: it is linked again, in larger buffers.
    let plan = renderer.plan().unwrap().id;
    let mut dark = own.clone();
    dark.iter_mut().for_each(|light| light.intensity = glam::Vec3::ZERO);
    renderer.set_lights(Some(dark)).unwrap();
    assert_eq!(renderer.plan().unwrap().id, plan);
    assert!(picture(&mut renderer).pixels().iter().all(|pixel| pixel[..3] == [0.0; 3]), "all is dark");
    renderer.set_lights(Some(vec![own; 9].concat())).unwrap();
    let many = picture(&mut renderer);
    let sum = |image: &metrics::Image| image.pixels().iter().map(|pixel| f64::from(pixel[1])).sum::<f64>();
    renderer.set_lights(None).unwrap();
    let one = picture(&mut renderer);
    assert!(sum(&many) > 5.0 * sum(&one), "{} of nine, {} of one", sum(&many), sum(&one));
}

fn block_on<F: Future>(future: F) -> F::Output {
    executor::block_on(future)
}
