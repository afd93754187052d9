//! Pipelines of linked steps, kept while shader, layout and targets stay the same.

use crate::error::ExecutorError;
use crate::format::{sample_type, storage_format, texture_format};
use crate::gpu::Gpu;
use crate::stored::{store_uniforms, uniforms_are_stored};
use frame_graph::Format;
use frame_graph::plan::{Plan, ResourceId};
use frame_graph::resource::SampleKind;
use pass::{Draw, LinkedStep, Step};
use rayon::prelude::*;
use shader_library::{Access, Dimension, GlobalKind, Sample, Stage};
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;
use wgpu::ShaderStages;

/// A pipeline with the layout of its one bind group.
#[derive(Debug)]
pub(crate) struct Pipeline {
    pub(crate) kind: PipelineKind,
    pub(crate) layout: wgpu::BindGroupLayout,
}

#[derive(Debug)]
pub(crate) enum PipelineKind {
    Compute(wgpu::ComputePipeline),
    Render(wgpu::RenderPipeline),
}

/// All that distinguishes one pipeline from another.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Key {
    shader: u128,
    entries: Vec<usize>,
    targets: Vec<Format>,
    depth: Option<Format>,
    vertices: bool,
}

/// Pipelines made so far, and shader modules by hash.
#[derive(Debug, Default)]
pub(crate) struct Pipelines {
    made: HashMap<Key, Arc<Pipeline>>,
    modules: HashMap<u128, wgpu::ShaderModule>,
    /// The most pipelines out of use that are kept.
    most_unused: usize,
}

/// Formats of a step's targets.
pub(crate) struct TargetFormats {
    pub(crate) colors: Vec<Format>,
    pub(crate) depth: Option<Format>,
}

impl TargetFormats {
    /// Returns the formats of the resources that a step of a plan draws to.
    pub(crate) fn of(plan: &Plan, step: &LinkedStep) -> TargetFormats {
        let format =
            |id: &ResourceId| plan.resources[id.0 as usize].desc.texture().map(|texture| texture.format);
        TargetFormats {
            colors: step.targets.iter().filter_map(format).collect(),
            depth: step.depth.as_ref().and_then(format),
        }
    }
}

impl Pipelines {
    /// Creates the pipelines of steps that have none yet, in parallel, and returns their number. Each step comes with
    /// the name of its pass.
    pub(crate) fn create<'a>(
        &mut self,
        gpu: &Gpu,
        steps: impl Iterator<Item = (&'a str, &'a LinkedStep, TargetFormats)>,
    ) -> Result<usize, ExecutorError> {
        let mut seen = HashSet::new();
        let missing: Vec<(Key, &str, &LinkedStep)> = steps
            .map(|(pass, step, formats)| (Key::new(step, formats), pass, step))
            .filter(|(key, ..)| !self.made.contains_key(key) && seen.insert(key.clone()))
            .collect();
        let mut seen = HashSet::new();
        let mut new = |shader: u128| !self.modules.contains_key(&shader) && seen.insert(shader);
        let shaders: Vec<_> = missing.iter().filter(|(key, ..)| new(key.shader)).collect();
        // wgpu validates each shader again, and translates it, on the thread that hands it over.
        let modules: Vec<_> =
            shaders.par_iter().map(|(_, pass, step)| caught(gpu, pass, || module(gpu, step))).collect();
        for ((key, ..), module) in shaders.into_iter().zip(modules) {
            self.modules.insert(key.shader, module?);
        }
        let build = |(key, pass, step): &(Key, &str, &LinkedStep)| {
            caught(gpu, pass, || build(gpu, pass, &self.modules[&key.shader], step, key))
        };
        // Collected first, so that the first error in order is reported.
        let pipelines: Vec<_> = missing.par_iter().map(build).collect();
        let pipelines = pipelines.into_iter().collect::<Result<Vec<Pipeline>, ExecutorError>>()?;
        let created = pipelines.len();
        let keys = missing.into_iter().map(|(key, ..)| key);
        self.made.extend(keys.zip(pipelines.into_iter().map(Arc::new)));
        Ok(created)
    }

    /// Returns the pipeline of a step, which [`Pipelines::create`] has created.
    pub(crate) fn get(&self, step: &LinkedStep, formats: TargetFormats) -> Arc<Pipeline> {
        Arc::clone(&self.made[&Key::new(step, formats)])
    }

    /// Creates an empty set that keeps so many pipelines out of use.
    pub(crate) fn keeping(most_unused: usize) -> Pipelines {
        Pipelines { most_unused, ..Pipelines::default() }
    }

    /// Drops pipelines and modules of shaders that are in use no more, where there are more of them than are kept.
    pub(crate) fn trim(&mut self, used: &HashSet<u128>) {
        if self.made.keys().filter(|key| !used.contains(&key.shader)).count() <= self.most_unused {
            return;
        }
        self.made.retain(|key, _| used.contains(&key.shader));
        self.modules.retain(|hash, _| used.contains(hash));
    }
}

impl Key {
    fn new(step: &LinkedStep, formats: TargetFormats) -> Key {
        Key {
            shader: step.shader.hash,
            entries: step.entries.clone(),
            targets: formats.colors,
            depth: formats.depth,
            vertices: matches!(&step.step, Step::Raster(raster) if raster.draw == Draw::Scene),
        }
    }
}

/// Returns what `create` does, or the error that wgpu reports meanwhile on this thread.
fn caught<T>(gpu: &Gpu, pass: &str, create: impl FnOnce() -> T) -> Result<T, ExecutorError> {
    let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let created = create();
    match pollster::block_on(scope.pop()) {
        Some(error) => Err(ExecutorError::Pass { pass: pass.to_owned(), message: error.to_string() }),
        None => Ok(created),
    }
}

fn module(gpu: &Gpu, step: &LinkedStep) -> wgpu::ShaderModule {
    let _phase = tracing::info_span!(target: "phase", "shaders in wgpu").entered();
    let module = match uniforms_are_stored(gpu, &step.shader) {
        true => store_uniforms(&step.shader),
        false => step.shader.module.clone(),
    };
    gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: step.shader.files().first().map(String::as_str),
        source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
    })
}

fn build(gpu: &Gpu, pass: &str, module: &wgpu::ShaderModule, step: &LinkedStep, key: &Key) -> Pipeline {
    let _phase = tracing::info_span!(target: "phase", "GPU pipelines").entered();
    let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(pass),
        entries: &layout_entries(gpu, step),
    });
    let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(pass),
        bind_group_layouts: &[Some(&layout)],
        immediate_size: 0,
    });
    // The defaults, by which workgroup memory begins as zero, as WGSL says: shaders of users may count on it.
    let compilation_options = wgpu::PipelineCompilationOptions::default();
    let entry = |index: usize| Some(step.shader.interface.entries[step.entries[index]].name.as_str());
    let kind = match &step.step {
        Step::Compute(_) => {
            PipelineKind::Compute(gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(pass),
                layout: Some(&pipeline_layout),
                module,
                entry_point: entry(0),
                compilation_options,
                cache: None,
            }))
        }
        Step::Raster(raster) => {
            let targets: Vec<Option<wgpu::ColorTargetState>> =
                key.targets.iter().map(|format| Some(texture_format(*format).into())).collect();
            PipelineKind::Render(gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(pass),
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module,
                    entry_point: entry(0),
                    compilation_options: compilation_options.clone(),
                    buffers: if key.vertices { SCENE_VERTICES } else { &[] },
                },
                primitive: wgpu::PrimitiveState { cull_mode: None, ..Default::default() },
                depth_stencil: key.depth.map(|format| wgpu::DepthStencilState {
                    format: texture_format(format),
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState::default(),
                fragment: raster.fragment.as_ref().map(|_| wgpu::FragmentState {
                    module,
                    entry_point: entry(1),
                    compilation_options,
                    targets: &targets,
                }),
                multiview_mask: None,
                cache: None,
            }))
        }
    };
    Pipeline { kind, layout }
}

/// Attributes of `scene::Vertex`: position, normal, uv, material, instance.
static SCENE_VERTICES: &[Option<wgpu::VertexBufferLayout<'static>>] = &[Some(wgpu::VertexBufferLayout {
    array_stride: 48,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &[
        wgpu::VertexAttribute { format: wgpu::VertexFormat::Float32x3, offset: 0, shader_location: 0 },
        wgpu::VertexAttribute { format: wgpu::VertexFormat::Float32x3, offset: 16, shader_location: 1 },
        wgpu::VertexAttribute { format: wgpu::VertexFormat::Float32x2, offset: 32, shader_location: 2 },
        wgpu::VertexAttribute { format: wgpu::VertexFormat::Uint32, offset: 12, shader_location: 3 },
        wgpu::VertexAttribute { format: wgpu::VertexFormat::Uint32, offset: 28, shader_location: 4 },
    ],
})];

fn layout_entries(gpu: &Gpu, step: &LinkedStep) -> Vec<wgpu::BindGroupLayoutEntry> {
    let stored = uniforms_are_stored(gpu, &step.shader);
    step.bindings
        .iter()
        .map(|bound| {
            let global = &step.shader.interface.globals[bound.global];
            wgpu::BindGroupLayoutEntry {
                binding: global.binding,
                visibility: stages(step, bound.global),
                ty: binding_type(&global.kind, stored),
                count: None,
            }
        })
        .collect()
}

fn stages(step: &LinkedStep, global: usize) -> ShaderStages {
    step.entries
        .iter()
        .map(|&entry| &step.shader.interface.entries[entry])
        .filter(|entry| entry.globals.contains(&global))
        .map(|entry| match entry.stage {
            Stage::Compute => ShaderStages::COMPUTE,
            Stage::Vertex => ShaderStages::VERTEX,
            Stage::Fragment => ShaderStages::FRAGMENT,
        })
        .fold(ShaderStages::NONE, ShaderStages::union)
}

fn binding_type(kind: &GlobalKind, stored: bool) -> wgpu::BindingType {
    let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    match kind {
        GlobalKind::Uniform { .. } if stored => buffer(wgpu::BufferBindingType::Storage { read_only: true }),
        GlobalKind::Uniform { .. } => buffer(wgpu::BufferBindingType::Uniform),
        GlobalKind::Storage { writable, .. } => {
            buffer(wgpu::BufferBindingType::Storage { read_only: !writable })
        }
        GlobalKind::Texture { dimension, sample, multisampled } => wgpu::BindingType::Texture {
            sample_type: match sample {
                Sample::Float { sampled } => sample_type(SampleKind::Float, *sampled),
                Sample::Uint => sample_type(SampleKind::Uint, false),
                Sample::Sint => wgpu::TextureSampleType::Sint,
                Sample::Depth => sample_type(SampleKind::Depth, false),
            },
            view_dimension: match dimension {
                Dimension::D1 => wgpu::TextureViewDimension::D1,
                Dimension::D2 => wgpu::TextureViewDimension::D2,
                Dimension::D2Array => wgpu::TextureViewDimension::D2Array,
                Dimension::Cube => wgpu::TextureViewDimension::Cube,
                Dimension::CubeArray => wgpu::TextureViewDimension::CubeArray,
                Dimension::D3 => wgpu::TextureViewDimension::D3,
            },
            multisampled: *multisampled,
        },
        GlobalKind::StorageTexture { format, access, dimension } => wgpu::BindingType::StorageTexture {
            access: match access {
                Access::Read => wgpu::StorageTextureAccess::ReadOnly,
                Access::Write => wgpu::StorageTextureAccess::WriteOnly,
                Access::ReadWrite => wgpu::StorageTextureAccess::ReadWrite,
                Access::Atomic => wgpu::StorageTextureAccess::Atomic,
            },
            format: storage_format(format).unwrap_or(wgpu::TextureFormat::Rgba32Float),
            view_dimension: if *dimension == Dimension::D2Array {
                wgpu::TextureViewDimension::D2Array
            } else {
                wgpu::TextureViewDimension::D2
            },
        },
        GlobalKind::AccelerationStructure => {
            wgpu::BindingType::AccelerationStructure { vertex_return: false }
        }
        GlobalKind::Sampler { comparison } => wgpu::BindingType::Sampler(if *comparison {
            wgpu::SamplerBindingType::Comparison
        } else {
            wgpu::SamplerBindingType::Filtering
        }),
    }
}
