//! Lightloom inside another program. The program owns the window, the device and the render pass (`window.rs`);
//! Lightloom renders into a texture on that device, with which the program draws.

mod window;

use anyhow::Result;
use glam::{Quat, Vec3};
use renderer::{Assets, Catalog, Gpu, Renderer};
use std::sync::Arc;
use window::{Graphics, Program};

struct Embedded {
    renderer: Renderer,
    picture: wgpu::RenderPipeline,
    triangle: wgpu::RenderPipeline,
}

impl Program for Embedded {
    fn new(graphics: &Graphics, size: (u32, u32)) -> Result<Self> {
        let Graphics { device, queue, adapter, format } = graphics;
        // The device stays the program's own; Lightloom uses it too. (Both are handles, and cheap to clone.)
        let gpu = Gpu::from_device(device.clone(), queue.clone(), adapter.get_info());
        // Pipelines, shaders and scenes are built in. A folder in place of `None` takes precedence.
        let catalog = Arc::new(Catalog::new(Assets::new(None)));
        let scene = renderer::load_scene(&catalog, "cornell-box")?;
        let mut renderer = Renderer::new(gpu, catalog, scene, size)?;
        renderer.set_pipeline("ism-invtm", &Default::default())?;

        // What the program draws itself. The output `display` is encoded in sRGB already: the target must not do it again.
        let shader = device.create_shader_module(wgpu::include_wgsl!("embed.wgsl"));
        let pipeline = |vertex, fragment| window::pipeline(device, &shader, vertex, fragment, *format);
        Ok(Self { renderer, picture: pipeline("cover", "picture"), triangle: pipeline("turn", "paint") })
    }

    fn resize(&mut self, size: (u32, u32)) -> Result<()> {
        Ok(self.renderer.set_size(size)?)
    }

    fn draw(&mut self, graphics: &Graphics, target: &wgpu::TextureView, seconds: f32) -> Result<()> {
        // The scene's own camera, swung about the middle of the box.
        let mut camera = self.renderer.scene().camera;
        camera.target = Vec3::new(0.278, 0.273, 0.28);
        let swing = Quat::from_rotation_y(0.3 * seconds.sin());
        camera.position = camera.target + swing * (camera.position - camera.target);
        self.renderer.set_camera(Some(camera), false);
        // This submits the frame to the queue, so that it runs before all that is submitted after it.
        self.renderer.frame()?;

        // The texture may be another one in each frame, so it is bound again.
        let rendered = self.renderer.output_texture("display")?;
        let bindings = graphics.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.picture.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(rendered),
            }],
        });
        let mut encoder = graphics.device.create_command_encoder(&Default::default());
        let mut pass = window::begin_pass(&mut encoder, target);
        pass.set_pipeline(&self.picture);
        pass.set_bind_group(0, &bindings, &[]);
        pass.draw(0..3, 0..1);
        pass.set_pipeline(&self.triangle);
        // The angle [mrad] comes as the index of the instance: one number needs no buffer.
        let angle = (seconds * 1000.0) as u32;
        pass.draw(0..3, angle..angle + 1);
        drop(pass);
        graphics.queue.submit([encoder.finish()]);
        Ok(())
    }
}

fn main() -> Result<()> {
    // The device must allow what Lightloom needs: this is what it would request itself. Add your own features.
    window::run::<Embedded>("Lightloom, embedded", Gpu::device_descriptor)
}
