//! Draws the interface by a shader that is cheap on a processor.
//!
//! The shader of egui-wgpu 0.37 has a branch on a uniform: one side samples a texture, the other filters by hand for
//! tests. A driver that renders on the processor computes both for each pixel: a frame of 1280×800 takes 74 ms, and 16 ms
//! without the branch. No option of egui-wgpu removes it: `RendererOptions` set the uniform, and the shader is fixed. Here
//! the shapes of a frame become one callback of egui-wgpu, which draws them by `painter.wgsl`, with the textures that
//! egui-wgpu keeps.

use eframe::egui::emath::TSTransform;
use eframe::egui::epaint::mutex::RwLock;
use eframe::egui::epaint::{ClippedShape, Mesh, PaintCallbackInfo, Primitive, Shape, Vertex};
use eframe::egui::{ClippedPrimitive, Context, FullOutput, Plugin, Rect};
use eframe::egui_wgpu::{
    Callback, CallbackResources, CallbackTrait, RenderState, Renderer, ScreenDescriptor,
};
use renderer::wgpu;
use renderer::wgpu::util::{BufferInitDescriptor, DeviceExt as _};
use std::sync::{Arc, OnceLock};

/// Lets the shader of this module draw the interface where that is faster than egui-wgpu's own.
pub(crate) fn install(context: &Context, state: &RenderState) {
    let on_cpu = state.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
    // The shader writes gamma, as egui does where it can choose.
    if on_cpu && !state.target_format.is_srgb() {
        let painter = Painter::new(&state.device, state.target_format, Arc::clone(&state.renderer));
        context.add_plugin(Hook(Arc::new(painter)));
    }
}

/// Takes the shapes of each frame from egui-wgpu.
struct Hook(Arc<Painter>);

impl Plugin for Hook {
    fn debug_name(&self) -> &'static str {
        "painter"
    }

    fn output_hook(&mut self, context: &Context, output: &mut FullOutput) {
        let shapes = std::mem::take(&mut output.shapes);
        let primitives = context.tessellate(shapes, output.pixels_per_point);
        let all = context.viewport_rect();
        let frame = Frame { painter: Arc::clone(&self.0), primitives, uploaded: OnceLock::new() };
        let shape = Shape::Callback(Callback::new_paint_callback(all, frame));
        let transform_after_tessellation = TSTransform::IDENTITY;
        output.shapes = vec![ClippedShape { clip_rect: all, shape, transform_after_tessellation }];
    }
}

/// The objects on the device that draws the window.
struct Painter {
    pipeline: wgpu::RenderPipeline,
    /// Holds the textures.
    renderer: Arc<RwLock<Renderer>>,
}

impl Painter {
    fn new(device: &wgpu::Device, target: wgpu::TextureFormat, renderer: Arc<RwLock<Renderer>>) -> Painter {
        let shader = device.create_shader_module(wgpu::include_wgsl!("painter.wgsl"));
        let entry = |binding: u32, visibility: wgpu::ShaderStages, ty: wgpu::BindingType| {
            wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
        };
        let uniform = |size: u64| wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: std::num::NonZeroU64::new(size),
        };
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let (vertex, fragment) = (wgpu::ShaderStages::VERTEX, wgpu::ShaderStages::FRAGMENT);
        let layout = |entries: &[wgpu::BindGroupLayoutEntry]| {
            let label = Some("interface");
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries })
        };
        let screen = layout(&[entry(0, vertex, uniform(size_of::<[f32; 2]>() as u64))]);
        // That of the groups that egui-wgpu makes of textures.
        let textures = layout(&[
            entry(0, fragment, texture),
            entry(1, fragment, sampler),
            entry(2, fragment, uniform(16)),
        ]);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("interface"),
            bind_group_layouts: &[Some(&screen), Some(&textures)],
            immediate_size: 0,
        });
        let blend = wgpu::BlendState {
            color: wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING.color,
            // The window stays opaque where it is.
            alpha: wgpu::BlendComponent {
                src_factor: wgpu::BlendFactor::OneMinusDstAlpha,
                dst_factor: wgpu::BlendFactor::One,
                operation: wgpu::BlendOperation::Add,
            },
        };
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("interface"),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &shader,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<Vertex>() as u64,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &wgpu::vertex_attr_array![0 => Float32x2, 1 => Float32x2, 2 => Unorm8x4],
                })],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &shader,
                entry_point: Some("fragment"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: target,
                    blend: Some(blend),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        });
        Painter { pipeline, renderer }
    }
}

/// One frame of the interface.
struct Frame {
    painter: Arc<Painter>,
    primitives: Vec<ClippedPrimitive>,
    uploaded: OnceLock<Uploaded>,
}

/// The objects of a frame on the device.
struct Uploaded {
    screen: ScreenDescriptor,
    screen_group: wgpu::BindGroup,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
}

impl CallbackTrait for Frame {
    fn prepare(
        &self,
        device: &wgpu::Device,
        _: &wgpu::Queue,
        screen: &ScreenDescriptor,
        _: &mut wgpu::CommandEncoder,
        _: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let mut vertices: Vec<Vertex> = Vec::new();
        let mut indices: Vec<u32> = Vec::new();
        for mesh in self.primitives.iter().filter_map(mesh) {
            vertices.extend(&mesh.vertices);
            indices.extend(&mesh.indices);
        }
        let buffer = |contents: &[u8], usage: wgpu::BufferUsages| {
            device.create_buffer_init(&BufferInitDescriptor { label: Some("interface"), contents, usage })
        };
        let points = screen.size_in_pixels.map(|size| size as f32 / screen.pixels_per_point);
        let points = buffer(bytemuck::bytes_of(&points), wgpu::BufferUsages::UNIFORM);
        let screen_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("interface"),
            layout: &self.painter.pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: points.as_entire_binding() }],
        });
        let ScreenDescriptor { size_in_pixels, pixels_per_point } = *screen;
        self.uploaded.get_or_init(|| Uploaded {
            screen: ScreenDescriptor { size_in_pixels, pixels_per_point },
            screen_group,
            vertices: buffer(bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX),
            indices: buffer(bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX),
        });
        Vec::new()
    }

    fn paint(&self, _: PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, _: &CallbackResources) {
        let Some(Uploaded { screen, screen_group, vertices, indices }) = self.uploaded.get() else { return };
        if indices.size() == 0 {
            return;
        }
        pass.set_pipeline(&self.painter.pipeline);
        pass.set_bind_group(0, screen_group, &[]);
        pass.set_vertex_buffer(0, vertices.slice(..));
        pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
        // It is locked for reading by whoever paints; nobody waits to write, since this is the thread that does.
        let renderer = self.painter.renderer.read();
        let (mut first_index, mut first_vertex) = (0, 0);
        for primitive in &self.primitives {
            let Some(mesh) = mesh(primitive) else { continue };
            let range = first_index..first_index + mesh.indices.len() as u32;
            let base = first_vertex;
            (first_index, first_vertex) = (range.end, base + mesh.vertices.len() as i32);
            let [x, y, width, height] = scissor(&primitive.clip_rect, screen);
            let Some(texture) = renderer.texture(&mesh.texture_id) else { continue };
            if width > 0 && height > 0 {
                pass.set_bind_group(1, &texture.bind_group, &[]);
                pass.set_scissor_rect(x, y, width, height);
                pass.draw_indexed(range, base, 0..1);
            }
        }
    }
}

/// Returns the triangles; callbacks of others have none.
fn mesh(primitive: &ClippedPrimitive) -> Option<&Mesh> {
    match &primitive.primitive {
        Primitive::Mesh(mesh) => Some(mesh),
        Primitive::Callback(_) => None,
    }
}

/// Returns a rectangle in points as one in whole pixels of the window: x, y, width and height.
fn scissor(clip: &Rect, screen: &ScreenDescriptor) -> [u32; 4] {
    let pixel = |point: f32, size: u32| ((point * screen.pixels_per_point).round() as u32).min(size);
    let [width, height] = screen.size_in_pixels;
    let (x, y) = (pixel(clip.min.x, width), pixel(clip.min.y, height));
    [x, y, pixel(clip.max.x, width).saturating_sub(x), pixel(clip.max.y, height).saturating_sub(y)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{CentralPanel, Color32, ColorImage, Panel, RawInput, TextureOptions, pos2, vec2};
    use eframe::egui_wgpu::RendererOptions;
    use renderer::Gpu;
    use std::time::{Duration, Instant};

    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

    /// A context of egui and what draws it, into a texture.
    struct Drawn {
        gpu: Gpu,
        context: Context,
        renderer: Arc<RwLock<Renderer>>,
        target: wgpu::Texture,
        picture: Option<eframe::egui::TextureHandle>,
    }

    impl Drawn {
        /// Draws as eframe does into a window of a size in pixels, with this painter or without; `None` without an adapter.
        fn new(size: [u32; 2], painted: bool) -> Option<Drawn> {
            if Gpu::adapters().is_empty() {
                eprintln!("skipped: no graphics adapter");
                return None;
            }
            let gpu = Gpu::open().expect("there is an adapter");
            let context = Context::default();
            let options = RendererOptions { dithering: false, ..RendererOptions::default() };
            let renderer = Arc::new(RwLock::new(Renderer::new(&gpu.device, FORMAT, options)));
            if painted {
                let painter = Painter::new(&gpu.device, FORMAT, Arc::clone(&renderer));
                context.add_plugin(Hook(Arc::new(painter)));
            }
            let target = gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: FORMAT,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            });
            Some(Drawn { gpu, context, renderer, target, picture: None })
        }

        /// Draws panels, text and a picture that changes from frame to frame; returns how long that took on the device.
        fn frame(&mut self, number: u8) -> Duration {
            let (width, height) = (self.target.width(), self.target.height());
            let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(width as f32, height as f32));
            let picture = &mut self.picture;
            let input = RawInput { screen_rect: Some(rect), ..RawInput::default() };
            let mut output = self.context.run_ui(input, |ui| {
                let pixels = (0..64).map(|i| Color32::from_rgb(number, 4 * i, 255 - 4 * i)).collect();
                let image = ColorImage::new([8, 8], pixels);
                let texture = ui.ctx().load_texture("picture", image, TextureOptions::NEAREST);
                Panel::left("panel").show(ui, |ui| ui.label(format!("Frame {number}, ½ of ∫ f")));
                CentralPanel::default().show(ui, |ui| {
                    let place = ui.available_rect_before_wrap();
                    let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                    ui.painter_at(place.shrink(10.5)).image(texture.id(), place, whole, Color32::WHITE);
                    ui.painter_at(place).circle_filled(place.center(), 30.0, Color32::from_white_alpha(90));
                });
                // That of the frame before is freed.
                *picture = Some(texture);
            });
            let primitives = self.context.tessellate(std::mem::take(&mut output.shapes), 1.0);
            let (device, queue) = (&self.gpu.device, &self.gpu.queue);
            let screen = ScreenDescriptor { size_in_pixels: [width, height], pixels_per_point: 1.0 };
            for (id, deltas) in output.textures_delta.set.drain() {
                for delta in deltas {
                    self.renderer.write().update_texture(device, queue, id, &delta);
                }
            }
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            self.renderer.write().update_buffers(device, queue, &mut encoder, &primitives, &screen);
            let view = self.target.create_view(&wgpu::TextureViewDescriptor::default());
            let attachment = wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations::default(),
            };
            let mut pass = encoder
                .begin_render_pass(&wgpu::RenderPassDescriptor {
                    color_attachments: &[Some(attachment)],
                    ..wgpu::RenderPassDescriptor::default()
                })
                .forget_lifetime();
            self.renderer.read().render(&mut pass, &primitives, &screen);
            drop(pass);
            let begun = Instant::now();
            queue.submit([encoder.finish()]);
            device.poll(wgpu::PollType::wait_indefinitely()).expect("the device is there");
            let took = begun.elapsed();
            for id in output.textures_delta.free.drain() {
                self.renderer.write().free_texture(&id);
            }
            took
        }

        /// The pixels of the last frame.
        fn pixels(&self) -> Vec<u8> {
            let (width, height) = (self.target.width(), self.target.height());
            let buffer = self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: u64::from(width * height * 4),
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            });
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            encoder.copy_texture_to_buffer(
                self.target.as_image_copy(),
                wgpu::TexelCopyBufferInfo {
                    buffer: &buffer,
                    layout: wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(width * 4),
                        rows_per_image: None,
                    },
                },
                self.target.size(),
            );
            self.gpu.queue.submit([encoder.finish()]);
            buffer.slice(..).map_async(wgpu::MapMode::Read, |mapped| mapped.expect("it can be mapped"));
            self.gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device is there");
            buffer.slice(..).get_mapped_range().expect("it is mapped").to_vec()
        }
    }

    #[test]
    fn the_painter_draws_what_egui_wgpu_draws() {
        let Some(mut own) = Drawn::new([640, 320], true) else { return };
        let Some(mut other) = Drawn::new([640, 320], false) else { return };
        for number in 0..5 {
            own.frame(number * 50);
            other.frame(number * 50);
            let (a, b) = (own.pixels(), other.pixels());
            let colors = b.chunks_exact(4).collect::<std::collections::BTreeSet<_>>();
            assert!(colors.len() > 60, "frame {number} has {} colors only", colors.len());
            let differs = a.iter().zip(&b).map(|(a, b)| a.abs_diff(*b)).max();
            assert!(differs <= Some(1), "frame {number} differs by {differs:?}");
        }
    }

    #[test]
    fn the_painter_takes_less_time_on_a_processor() {
        let Some(mut own) = Drawn::new([1280, 800], true) else { return };
        let Some(mut other) = Drawn::new([1280, 800], false) else { return };
        if own.gpu.info.device_type != wgpu::DeviceType::Cpu {
            eprintln!("skipped: the adapter is not a processor, where egui-wgpu's own is used");
            return;
        }
        // The least of several, which other programs on the machine delay the least.
        let times: Vec<[Duration; 2]> = (0..9).map(|i| [own.frame(i), other.frame(i)]).collect();
        let least = |which: usize| times.iter().map(|pair| pair[which]).min().unwrap();
        let (own, other) = (least(0), least(1));
        eprintln!("{own:?} in place of {other:?}");
        assert!(own < other.mul_f32(0.7), "{own:?} in place of {other:?}");
    }
}
