//! Draws the interface by a shader that is cheap on a processor.
//!
//! The shader of egui-wgpu 0.37 has a branch on a uniform: one side samples a texture, the other filters by hand for tests. A
//! driver that renders on the processor computes both for each pixel, and a window of 1280×800 takes 50 ms. Here the
//! shapes of a frame become one callback of egui-wgpu, which draws them by `painter.wgsl`.

use eframe::egui::emath::TSTransform;
use eframe::egui::epaint::{
    ClippedShape, ImageData, ImageDelta, PaintCallbackInfo, Primitive, Shape, Vertex,
};
use eframe::egui::{ClippedPrimitive, Context, FullOutput, Plugin, Rect};
use eframe::egui::{TextureFilter, TextureId, TextureOptions, TextureWrapMode};
use eframe::egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState, ScreenDescriptor};
use renderer::wgpu;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// Lets the shader of this module draw the interface where that is faster than egui-wgpu's own.
pub(crate) fn install(context: &Context, state: &RenderState) {
    let on_cpu = state.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
    // The shader writes gamma, as egui does where it can choose.
    if on_cpu && !state.target_format.is_srgb() {
        context.add_plugin(Hook::new(&state.device, state.target_format));
    }
}

/// Takes the shapes and textures of each frame from egui-wgpu.
struct Hook {
    painter: Arc<Mutex<Painter>>,
}

impl Hook {
    fn new(device: &wgpu::Device, target: wgpu::TextureFormat) -> Hook {
        Hook { painter: Arc::new(Mutex::new(Painter::new(device, target))) }
    }
}

impl Plugin for Hook {
    fn debug_name(&self) -> &'static str {
        "painter"
    }

    fn output_hook(&mut self, context: &Context, output: &mut FullOutput) {
        let shapes = std::mem::take(&mut output.shapes);
        let primitives = context.tessellate(shapes, output.pixels_per_point);
        // A frame may be left out, where the window is hidden; what it changes in textures may not.
        let mut painter = self.painter.lock().unwrap_or_else(PoisonError::into_inner);
        painter
            .changes
            .extend(output.textures_delta.set.drain().map(|(id, deltas)| (id, Vec::from_iter(deltas))));
        painter.unused.extend(output.textures_delta.free.drain());
        drop(painter);
        let all = context.viewport_rect();
        let frame = Frame { painter: Arc::clone(&self.painter), primitives };
        let shape = Shape::Callback(Callback::new_paint_callback(all, frame));
        let transform_after_tessellation = TSTransform::IDENTITY;
        output.shapes = vec![ClippedShape { clip_rect: all, shape, transform_after_tessellation }];
    }
}

/// One frame of the interface.
struct Frame {
    painter: Arc<Mutex<Painter>>,
    primitives: Vec<ClippedPrimitive>,
}

impl CallbackTrait for Frame {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        screen: &ScreenDescriptor,
        _: &mut wgpu::CommandEncoder,
        _: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let mut painter = self.painter.lock().unwrap_or_else(PoisonError::into_inner);
        painter.upload(device, queue, &self.primitives, screen);
        Vec::new()
    }

    fn paint(&self, _: PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, _: &CallbackResources) {
        self.painter.lock().unwrap_or_else(PoisonError::into_inner).draw(pass);
    }
}

/// A range of triangles with one texture and one scissor rectangle.
struct Draw {
    texture: TextureId,
    /// x, y, width and height in pixels.
    scissor: [u32; 4],
    indices: Range<u32>,
    base_vertex: i32,
}

struct Texture {
    texture: wgpu::Texture,
    options: TextureOptions,
    group: wgpu::BindGroup,
}

/// The objects on the device that draws the window.
struct Painter {
    pipeline: wgpu::RenderPipeline,
    texture_layout: wgpu::BindGroupLayout,
    screen: wgpu::Buffer,
    screen_group: wgpu::BindGroup,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    textures: HashMap<TextureId, Texture>,
    samplers: HashMap<TextureOptions, wgpu::Sampler>,
    /// What frames changed in textures since the last upload.
    changes: Vec<(TextureId, Vec<ImageDelta>)>,
    /// Textures that no frame after the one to come uses.
    unused: Vec<TextureId>,
    draws: Vec<Draw>,
}

impl Painter {
    fn new(device: &wgpu::Device, target: wgpu::TextureFormat) -> Painter {
        let shader = device.create_shader_module(wgpu::include_wgsl!("painter.wgsl"));
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
            layout: None,
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
        let screen = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("size of the window"),
            size: size_of::<[f32; 2]>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let screen_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("size of the window"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: screen.as_entire_binding() }],
        });
        Painter {
            texture_layout: pipeline.get_bind_group_layout(1),
            pipeline,
            screen,
            screen_group,
            vertices: buffer(device, wgpu::BufferUsages::VERTEX, 1 << 16),
            indices: buffer(device, wgpu::BufferUsages::INDEX, 1 << 16),
            textures: HashMap::new(),
            samplers: HashMap::new(),
            changes: Vec::new(),
            unused: Vec::new(),
            draws: Vec::new(),
        }
    }

    /// Uploads what changed in textures, and the triangles of a frame.
    fn upload(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        primitives: &[ClippedPrimitive],
        screen: &ScreenDescriptor,
    ) {
        for (id, deltas) in std::mem::take(&mut self.changes) {
            for delta in deltas {
                self.change(device, queue, id, &delta);
            }
        }
        let mut vertices: Vec<Vertex> = Vec::new();
        let mut indices: Vec<u32> = Vec::new();
        self.draws.clear();
        for ClippedPrimitive { clip_rect, primitive } in primitives {
            let Primitive::Mesh(mesh) = primitive else { continue };
            let scissor = scissor(clip_rect, screen);
            let (from, base_vertex) = (indices.len() as u32, vertices.len() as i32);
            vertices.extend(&mesh.vertices);
            indices.extend(&mesh.indices);
            if scissor[2] > 0 && scissor[3] > 0 {
                let indices = from..indices.len() as u32;
                self.draws.push(Draw { texture: mesh.texture_id, scissor, indices, base_vertex });
            }
        }
        let points = screen.size_in_pixels.map(|size| size as f32 / screen.pixels_per_point);
        queue.write_buffer(&self.screen, 0, bytemuck::bytes_of(&points));
        fill(device, queue, &mut self.vertices, bytemuck::cast_slice(&vertices));
        fill(device, queue, &mut self.indices, bytemuck::cast_slice(&indices));
    }

    /// Changes a texture, or makes it.
    fn change(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, id: TextureId, delta: &ImageDelta) {
        let ImageData::Color(image) = &delta.image;
        let [width, height] = image.size.map(|side| side as u32);
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        let texture = match (delta.pos, self.textures.get(&id)) {
            (Some(_), Some(known)) => known.texture.clone(),
            // Part of a texture that there is not: nothing refers to it.
            (Some(_), None) => return,
            (None, _) => device.create_texture(&wgpu::TextureDescriptor {
                label: Some("interface"),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba8Unorm,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            }),
        };
        let [x, y] = delta.pos.unwrap_or_default().map(|at| at as u32);
        queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &texture,
                mip_level: 0,
                origin: wgpu::Origin3d { x, y, z: 0 },
                aspect: wgpu::TextureAspect::All,
            },
            bytemuck::cast_slice(&image.pixels),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None },
            size,
        );
        let same = |known: &Texture| known.texture == texture && known.options == delta.options;
        if self.textures.get(&id).is_some_and(same) {
            return;
        }
        let options = delta.options;
        let sampler = self.samplers.entry(options).or_insert_with(|| sampler(device, options));
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("interface"),
            layout: &self.texture_layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(&texture.create_view(&Default::default())),
                },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(sampler) },
            ],
        });
        self.textures.insert(id, Texture { texture, options, group });
    }

    /// Draws the frame that was uploaded, and frees what no other uses.
    fn draw(&mut self, pass: &mut wgpu::RenderPass<'static>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.screen_group, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        for Draw { texture, scissor: [x, y, width, height], indices, base_vertex } in &self.draws {
            let Some(texture) = self.textures.get(texture) else { continue };
            pass.set_bind_group(1, &texture.group, &[]);
            pass.set_scissor_rect(*x, *y, *width, *height);
            pass.draw_indexed(indices.clone(), *base_vertex, 0..1);
        }
        for id in self.unused.drain(..) {
            self.textures.remove(&id);
        }
    }
}

/// Returns a rectangle in points as one in whole pixels of the window: x, y, width and height.
fn scissor(clip: &Rect, screen: &ScreenDescriptor) -> [u32; 4] {
    let pixel = |point: f32, size: u32| ((point * screen.pixels_per_point).round() as u32).min(size);
    let [width, height] = screen.size_in_pixels;
    let (x, y) = (pixel(clip.min.x, width), pixel(clip.min.y, height));
    [x, y, pixel(clip.max.x, width).saturating_sub(x), pixel(clip.max.y, height).saturating_sub(y)]
}

fn buffer(device: &wgpu::Device, usage: wgpu::BufferUsages, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("interface"),
        size,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Writes into a buffer; one that is too small is replaced.
fn fill(device: &wgpu::Device, queue: &wgpu::Queue, into: &mut wgpu::Buffer, bytes: &[u8]) {
    let size = bytes.len() as u64;
    if into.size() < size {
        *into = buffer(device, into.usage(), size.next_power_of_two());
    }
    queue.write_buffer(into, 0, bytes);
}

fn sampler(device: &wgpu::Device, options: TextureOptions) -> wgpu::Sampler {
    let filter = |filter| match filter {
        TextureFilter::Nearest => wgpu::FilterMode::Nearest,
        TextureFilter::Linear => wgpu::FilterMode::Linear,
    };
    let address = match options.wrap_mode {
        TextureWrapMode::ClampToEdge => wgpu::AddressMode::ClampToEdge,
        TextureWrapMode::Repeat => wgpu::AddressMode::Repeat,
        TextureWrapMode::MirroredRepeat => wgpu::AddressMode::MirrorRepeat,
    };
    device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: filter(options.magnification),
        min_filter: filter(options.minification),
        address_mode_u: address,
        address_mode_v: address,
        ..wgpu::SamplerDescriptor::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{CentralPanel, Color32, ColorImage, Panel, RawInput, pos2, vec2};
    use eframe::egui_wgpu::{Renderer, RendererOptions};
    use renderer::Gpu;
    use std::time::{Duration, Instant};

    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

    /// A context of egui and what draws it, into a texture.
    struct Drawn {
        gpu: Gpu,
        context: Context,
        renderer: Renderer,
        target: wgpu::Texture,
        picture: Option<eframe::egui::TextureHandle>,
    }

    impl Drawn {
        /// As eframe draws a window of a size in pixels, with this painter or without; `None` where there is no adapter.
        fn new(size: [u32; 2], painted: bool) -> Option<Drawn> {
            if Gpu::adapters().is_empty() {
                eprintln!("skipped: no graphics adapter");
                return None;
            }
            let gpu = Gpu::open().expect("there is an adapter");
            let context = Context::default();
            if painted {
                context.add_plugin(Hook::new(&gpu.device, FORMAT));
            }
            let options = RendererOptions { dithering: false, ..RendererOptions::default() };
            let renderer = Renderer::new(&gpu.device, FORMAT, options);
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
                    self.renderer.update_texture(device, queue, id, &delta);
                }
            }
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            self.renderer.update_buffers(device, queue, &mut encoder, &primitives, &screen);
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
            self.renderer.render(&mut pass, &primitives, &screen);
            drop(pass);
            let begun = Instant::now();
            queue.submit([encoder.finish()]);
            device.poll(wgpu::PollType::wait_indefinitely()).expect("the device is there");
            let took = begun.elapsed();
            for id in output.textures_delta.free.drain() {
                self.renderer.free_texture(&id);
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
            assert!(colors.len() > 60, "frame {number} has {} colours only", colors.len());
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
        let mut times: Vec<[Duration; 2]> = (0..9).map(|i| [own.frame(i), other.frame(i)]).collect();
        let mut median = |which: usize| {
            times.sort_by_key(|pair| pair[which]);
            times[times.len() / 2][which]
        };
        let (own, other) = (median(0), median(1));
        assert!(own < other.mul_f32(0.7), "{own:?} in place of {other:?}");
    }
}
