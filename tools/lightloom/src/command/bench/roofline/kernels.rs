//! The kernels of shaders/bench/ceilings.wgsl, on buffers and textures of their own.

use super::super::Bench;
use super::ceiling::Ceiling;
use super::probe::{Probe, Record};
use anyhow::{Context as _, Result};
use executor::wgpu::{Buffer, ShaderModule, TextureFormat, TextureView};
use executor::{Gpu, wgpu};
use shader_library::{Request, Shader};
use std::borrow::Cow;
use std::sync::Arc;

const SHADER: &str = "shaders/bench/ceilings.wgsl";

/// The most bytes that are loaded from and stored to, beyond what caches hold.
const MOST_BYTES: u64 = 256 << 20;

/// Bytes that a cache holds.
const NEAR_BYTES: u64 = 1 << 20;

/// Bytes of a vector of four.
const VECTOR: f64 = 16.0;

/// The resources of the kernels, with their sizes.
pub(super) struct Kernels {
    gpu: Gpu,
    shader: Arc<Shader>,
    module: ShaderModule,
    /// Constants of the shader.
    per_thread: f64,
    group: f64,
    /// Beyond what caches hold.
    far: Buffer,
    far_copy: Buffer,
    near: Buffer,
    kept: Buffer,
    texels: TextureView,
    image: TextureView,
    image_side: u32,
    target_side: u32,
    /// Whether all sizes are smaller, for a quick preview.
    quick: bool,
    /// Workgroups of GPUs over those of CPUs, which a few fill.
    wide: u32,
}

impl Kernels {
    pub(super) fn new(bench: &Bench<'_>, gpu: &Gpu) -> Result<Kernels> {
        let shader = bench.catalog().shaders().load(&Request::new(SHADER))?;
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(SHADER),
            source: wgpu::ShaderSource::Naga(Cow::Owned(shader.module.clone())),
        });
        let limits = gpu.limits();
        let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size).min(MOST_BYTES);
        let most = if bench.args.quick { 4 * NEAR_BYTES } else { 1 << most.ilog2() };
        let image_side = bench.size(1024, 128);
        let constant = |name: &str| -> Result<f64> {
            let found = shader.interface.constant(name).and_then(|value| value.as_u32());
            Ok(f64::from(found.with_context(|| format!("{SHADER} has no constant `{name}`"))?))
        };
        Ok(Kernels {
            per_thread: constant("PER_THREAD")?,
            group: constant("GROUP_SIZE")?,
            far: buffer(gpu, most),
            far_copy: buffer(gpu, most),
            near: buffer(gpu, NEAR_BYTES),
            kept: buffer(gpu, 16),
            texels: texture(gpu, image_side, TextureFormat::R32Float, wgpu::TextureUsages::COPY_DST),
            image: texture(gpu, image_side, TextureFormat::R32Float, wgpu::TextureUsages::STORAGE_BINDING),
            image_side,
            target_side: bench.size(2048, 256),
            quick: bench.args.quick,
            wide: if gpu.info.device_type == wgpu::DeviceType::Cpu { 1 } else { 16 },
            gpu: gpu.clone(),
            module,
            shader,
        })
    }

    /// Returns all probes, in the order of tables.
    pub(super) fn probes(&self) -> Result<Vec<Probe>> {
        let constant = |name: &str| self.shader.interface.constant(name).and_then(|value| value.as_u32());
        let each = |name: &str| f64::from(constant(name).unwrap_or(1));
        let far = (self.far.size() as f64 / (VECTOR * self.per_thread * self.group)) as u32;
        let near = if self.quick { 64 } else { 4096 * self.wide };
        let few = if self.quick { 16 } else { 1024 * self.wide };
        let waits = each("WAITING") * each("WAITS") / self.group;
        // A vector has four numbers, and each is multiplied and added.
        let multiplications = 8.0 * each("MULTIPLICATIONS");
        let (n, bytes) = (self.per_thread, self.per_thread * VECTOR);
        let threads = [
            (Ceiling::Store, "store_in_order", Some(&self.far), far, bytes),
            (Ceiling::StoreNear, "store_in_order", Some(&self.near), near, bytes),
            (Ceiling::Load, "load_in_order", Some(&self.far), far, bytes),
            (Ceiling::LoadNear, "load_in_order", Some(&self.near), near, bytes),
            (Ceiling::LoadWordsInOrder, "load_words_in_order", Some(&self.near), near, n),
            (Ceiling::LoadWords, "load_words", Some(&self.far), far, n),
            (Ceiling::LoadWordsNear, "load_words", Some(&self.near), near, n),
            (Ceiling::LoadVectors, "load_vectors", Some(&self.far), far, n),
            (Ceiling::LoadVectorsNear, "load_vectors", Some(&self.near), near, n),
            (Ceiling::Atomics, "minimum_anywhere", Some(&self.far), far, n),
            (Ceiling::AtomicsNear, "minimum_anywhere", Some(&self.near), near, n),
            (Ceiling::AtomicsOfOne, "minimum_of_one", Some(&self.near), few, n),
            (Ceiling::Threads, "start", None, 64 * few, 1.0),
            (Ceiling::Barriers, "wait", None, few, waits),
            (Ceiling::Multiplications, "multiply", None, few, multiplications),
        ];
        let most = self.gpu.limits().max_compute_workgroups_per_dimension;
        let mut probes = vec![self.copies()];
        for (ceiling, entry, buffer, groups, work) in threads {
            let groups = groups.min(most);
            let amount = f64::from(groups) * self.group * work;
            probes.push(Probe::new(ceiling, amount, self.dispatches(entry, buffer, [groups, 1, 1])?));
        }
        let side = self.image_side / 8;
        let texels = f64::from(self.image_side).powi(2);
        let load = self.dispatches("load_texels", None, [side, side, 1])?;
        probes.push(Probe::new(Ceiling::LoadTexels, texels * n, load));
        let store = self.dispatches("store_texels", None, [side, side, 1])?;
        probes.push(Probe::new(Ceiling::StoreTexels, texels, store));
        probes.push(Probe::new(Ceiling::Dispatches, 1.0, self.dispatches("start", None, [1, 1, 1])?));
        let pixels = f64::from(self.target_side).powi(2);
        for (ceiling, format) in [
            (Ceiling::Fragments, TextureFormat::R32Float),
            (Ceiling::FragmentsOfFour, TextureFormat::Rgba16Float),
        ] {
            let record = self.draws("fullscreen", format, self.target_side, 3);
            probes.push(Probe::new(ceiling, pixels, record));
        }
        let triangles = if self.quick { 20_000 } else { 100_000 * self.wide };
        let side = constant("TARGET_SIDE").unwrap_or(1);
        for (ceiling, vertex) in [(Ceiling::Triangles, "tiny"), (Ceiling::TrianglesOutOfView, "out_of_view")]
        {
            let record = self.draws(vertex, TextureFormat::R32Float, side, 3 * triangles);
            probes.push(Probe::new(ceiling, f64::from(triangles), record));
        }
        Ok(probes)
    }

    fn copies(&self) -> Probe {
        let (from, to) = (self.far.clone(), self.far_copy.clone());
        let bytes = 2.0 * self.far.size() as f64;
        Probe::new(
            Ceiling::Copy,
            bytes,
            Box::new(move |encoder, times| {
                (0..times).for_each(|_| encoder.copy_buffer_to_buffer(&from, 0, &to, 0, from.size()));
            }),
        )
    }

    /// Records dispatches of an entry point in one compute pass, in which globals of buffers are all bound to the same one.
    fn dispatches(&self, entry: &str, buffer: Option<&Buffer>, groups: [u32; 3]) -> Result<Record> {
        let pipeline = self.gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry),
            layout: None,
            module: &self.module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let interface = &self.shader.interface;
        let globals = &interface.entry(entry).with_context(|| format!("{SHADER} has no `{entry}`"))?.globals;
        let entries = globals.iter().map(|&global| {
            let global = &interface.globals[global];
            let resource = match global.name.as_str() {
                "kept" => self.kept.as_entire_binding(),
                "texels" => wgpu::BindingResource::TextureView(&self.texels),
                "image" => wgpu::BindingResource::TextureView(&self.image),
                name => buffer.with_context(|| format!("`{name}` needs a buffer"))?.as_entire_binding(),
            };
            Ok(wgpu::BindGroupEntry { binding: global.binding, resource })
        });
        let entries = entries.collect::<Result<Vec<_>>>()?;
        // A pipeline without resources has no layout of a group.
        let group = (!entries.is_empty()).then(|| {
            self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(entry),
                layout: &pipeline.get_bind_group_layout(0),
                entries: &entries,
            })
        });
        let [x, y, z] = groups;
        Ok(Box::new(move |encoder, times| {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&pipeline);
            if let Some(group) = &group {
                pass.set_bind_group(0, group, &[]);
            }
            (0..times).for_each(|_| pass.dispatch_workgroups(x, y, z));
        }))
    }

    /// Records draws of `vertices` vertices, each in a pass of its own. Two targets take turns: a driver may leave out what is
    /// drawn over in the same one.
    fn draws(&self, vertex: &str, format: TextureFormat, side: u32, vertices: u32) -> Record {
        let pipeline = self.gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(vertex),
            layout: None,
            vertex: wgpu::VertexState {
                module: &self.module,
                entry_point: Some(vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &self.module,
                entry_point: Some("paint"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let targets =
            [(); 2].map(|()| texture(&self.gpu, side, format, wgpu::TextureUsages::RENDER_ATTACHMENT));
        Box::new(move |encoder, times| {
            for view in targets.iter().cycle().take(times as usize) {
                let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                    color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                        view,
                        depth_slice: None,
                        resolve_target: None,
                        ops: wgpu::Operations {
                            load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                            store: wgpu::StoreOp::Store,
                        },
                    })],
                    ..Default::default()
                });
                pass.set_pipeline(&pipeline);
                pass.draw(0..vertices, 0..1);
            }
        })
    }
}

fn buffer(gpu: &Gpu, size: u64) -> Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("ceilings"),
        size,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Creates a texture, and returns its view, which keeps it.
fn texture(gpu: &Gpu, side: u32, format: TextureFormat, usage: wgpu::TextureUsages) -> TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("ceilings"),
        size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: usage | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
