//! One step of a pass, ready to be encoded.

use crate::current::{FrameObjects, LayerViews};
use crate::gpu::Gpu;
use crate::object::{ChosenLights, Object, ObjectUsage, SceneBinding};
use crate::pipeline::{Pipeline, PipelineKind, Pipelines, TargetFormats};
use frame_graph::ResourceDesc;
use frame_graph::plan::{AllocationId, Plan, PlannedPass, ResourceId};
use pass::{Bound, Draw, LinkedStep, Load, Raster, Source, Step, Threads, UniformFill};
use shader_library::GlobalKind;
use std::collections::HashMap;
use std::sync::Arc;

/// A linked step with its pipeline, its bind groups and its place in the uniform buffer.
#[derive(Debug)]
pub(crate) struct LoadedStep {
    label: String,
    /// Behind a pointer, so that what a dispatch needs lies close together.
    linked: Arc<LinkedStep>,
    pipeline: Arc<Pipeline>,
    workgroups: Workgroups,
    /// Offset of each uniform.
    uniforms: Vec<u64>,
    /// The sources that are bound to resources with a history buffer: their objects alternate.
    alternating: Vec<Source>,
    /// Bind groups by the objects of `alternating`.
    groups: Vec<(Vec<AllocationId>, wgpu::BindGroup)>,
    /// The bind group that was used last.
    bound: Option<wgpu::BindGroup>,
}

/// The size of a dispatch, in workgroups.
#[derive(Clone, Copy, Debug)]
enum Workgroups {
    Known([u32; 3]),
    /// Written by the GPU, at this offset of a buffer.
    Indirect(u64),
}

/// The values that encoding a step needs.
#[derive(Clone, Copy)]
pub(crate) struct StepContext<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) scene_bindings: &'a HashMap<&'static str, SceneBinding>,
    pub(crate) chosen_lights: &'a HashMap<ChosenLights, wgpu::Buffer>,
    pub(crate) scene_indices: u32,
    pub(crate) uniforms: Option<&'a wgpu::Buffer>,
    pub(crate) objects: FrameObjects<'a>,
}

/// The queries of a timed frame, and for the last step of a pass the query that it writes at its end.
pub(crate) type StepQueries<'a> = Option<(&'a wgpu::QuerySet, Option<u32>)>;

/// A compute pass that later dispatches can join.
pub(crate) struct OpenPass {
    pass: wgpu::ComputePass<'static>,
    /// The current pipeline, so that it is not set twice.
    pipeline: Option<Arc<Pipeline>>,
}

/// A dispatch that an executor has encoded.
#[derive(Clone, Copy, Debug)]
pub struct Dispatch<'a> {
    /// The pipeline.
    pub pipeline: &'a wgpu::ComputePipeline,
    /// The bind group, at index 0.
    pub bind_group: &'a wgpu::BindGroup,
    /// The workgroups in each dimension.
    pub workgroups: [u32; 3],
}

/// The greatest number of color attachments: wgpu allows this many on every adapter.
const MAX_COLOR_ATTACHMENTS: usize = 8;

impl LoadedStep {
    /// Creates the step with its pipeline, which exists.
    pub(crate) fn new(
        gpu: &Gpu,
        pipelines: &Pipelines,
        plan: &Plan,
        pass: &PlannedPass,
        linked: Arc<LinkedStep>,
    ) -> LoadedStep {
        let pipeline = pipelines.get(&linked, TargetFormats::of(plan, &linked));
        let entry =
            linked.entries.first().map_or("", |&entry| linked.shader.interface.entries[entry].name.as_str());
        let alternates = |source: &Source| match source {
            Source::Resource(id) => plan.resources[id.0 as usize].history.is_some(),
            Source::Past(_) => true,
            Source::SceneBinding(_) | Source::ChosenLights { .. } | Source::Uniform(_) => false,
        };
        let bound = linked.bindings.iter().map(|bound| &bound.source);
        LoadedStep {
            label: format!("{}: {entry}", pass.name),
            workgroups: workgroups(&linked, gpu.limits().max_compute_workgroups_per_dimension),
            alternating: bound.filter(|source| alternates(source)).cloned().collect(),
            linked,
            pipeline,
            uniforms: Vec::new(),
            groups: Vec::new(),
            bound: None,
        }
    }

    /// Whether it was made from this step.
    pub(crate) fn is(&self, linked: &Arc<LinkedStep>) -> bool {
        Arc::ptr_eq(&self.linked, linked)
    }

    pub(crate) fn shader_hash(&self) -> u128 {
        self.linked.shader.hash
    }

    /// Returns whether both do the same work with resources of the same names, including the values of
    /// uniforms.
    pub(crate) fn same_work(&self, other: &LoadedStep) -> bool {
        self.linked.shader.hash == other.linked.shader.hash
            && self.linked.entries == other.linked.entries
            && self.linked.step == other.linked.step
            && self.linked.uniforms.iter().map(|fill| &fill.values).eq(other
                .linked
                .uniforms
                .iter()
                .map(|fill| &fill.values))
    }

    /// Takes the values of another step, and keeps pipeline and bind groups. Returns the other step as an
    /// error if its bindings differ.
    pub(crate) fn take_values(&mut self, new: LoadedStep) -> Result<(), Box<LoadedStep>> {
        let binds = |step: &LinkedStep| {
            step.bindings
                .iter()
                .map(|bound| (bound.global, bound.source.clone(), bound.window.clone()))
                .collect::<Vec<_>>()
        };
        let same = Arc::ptr_eq(&self.pipeline, &new.pipeline)
            && binds(&self.linked) == binds(&new.linked)
            && self.linked.targets == new.linked.targets
            && self.linked.depth == new.linked.depth
            && self.linked.indirect == new.linked.indirect;
        if !same {
            return Err(Box::new(new));
        }
        (self.linked, self.workgroups) = (new.linked, new.workgroups);
        Ok(())
    }

    /// Drops the bind groups, which hold objects of the plan.
    pub(crate) fn forget_bindings(&mut self) {
        self.groups.clear();
        self.bound = None;
    }

    /// Drops the bind groups if they hold this scene binding.
    pub(crate) fn forget_binding(&mut self, name: &str) {
        if self.linked.scene_bindings().any(|read| read == name) {
            self.forget_bindings();
        }
    }

    /// Reserves aligned places for the uniforms from `offset` on; returns the end of the last.
    pub(crate) fn place_uniforms(&mut self, mut offset: u64, alignment: u64) -> u64 {
        self.uniforms.clear();
        for fill in &self.linked.uniforms {
            self.uniforms.push(offset);
            offset += fill.size().next_multiple_of(alignment);
        }
        self.forget_bindings();
        offset
    }

    /// Returns the uniforms, each with its place in the buffer.
    pub(crate) fn uniforms(&self) -> impl Iterator<Item = (&UniformFill, u64)> {
        self.linked.uniforms.iter().zip(self.uniforms.iter().copied())
    }

    /// Encodes the step. Consecutive dispatches share one compute pass unless they are timed.
    pub(crate) fn encode(
        &mut self,
        context: StepContext<'_>,
        views: &mut LayerViews,
        encoder: &mut wgpu::CommandEncoder,
        open: &mut Option<OpenPass>,
        queries: StepQueries<'_>,
    ) {
        self.find_group(context);
        let Some(group) = &self.bound else { unreachable!("a bind group is found or made") };
        if queries.is_some() {
            *open = None;
        }
        match &self.pipeline.kind {
            PipelineKind::Compute(pipeline) => {
                let joined = open.get_or_insert_with(|| {
                    let descriptor = wgpu::ComputePassDescriptor {
                        label: Some(&self.label),
                        timestamp_writes: queries.filter(|(_, end)| end.is_some()).map(|(query_set, end)| {
                            wgpu::ComputePassTimestampWrites {
                                query_set,
                                beginning_of_pass_write_index: None,
                                end_of_pass_write_index: end,
                            }
                        }),
                    };
                    let pass = encoder.begin_compute_pass(&descriptor).forget_lifetime();
                    OpenPass { pass, pipeline: None }
                });
                if joined.pipeline.as_ref().is_none_or(|set| !Arc::ptr_eq(set, &self.pipeline)) {
                    joined.pass.set_pipeline(pipeline);
                    joined.pipeline = Some(Arc::clone(&self.pipeline));
                }
                joined.pass.set_bind_group(0, group, &[]);
                match self.workgroups {
                    Workgroups::Known([x, y, z]) => joined.pass.dispatch_workgroups(x, y, z),
                    Workgroups::Indirect(offset) => {
                        joined.pass.dispatch_workgroups_indirect(self.indirect_buffer(context), offset);
                    }
                }
                if queries.is_some() {
                    *open = None;
                }
            }
            PipelineKind::Render(pipeline) => {
                *open = None;
                if let Step::Raster(raster) = &self.linked.step {
                    self.draw(context, views, encoder, (pipeline, group, raster), queries);
                }
            }
        }
    }

    /// Returns the dispatch that was encoded last; `None` for draws, for sizes on the GPU, and before the
    /// first.
    pub(crate) fn dispatch(&self) -> Option<Dispatch<'_>> {
        let PipelineKind::Compute(pipeline) = &self.pipeline.kind else { return None };
        let bind_group = self.bound.as_ref()?;
        let Workgroups::Known(workgroups) = self.workgroups else { return None };
        Some(Dispatch { pipeline, bind_group, workgroups })
    }

    /// Returns the buffer that holds the size of the dispatch or draw.
    fn indirect_buffer<'a>(&self, context: StepContext<'a>) -> &'a wgpu::Buffer {
        let found = self.linked.indirect.as_ref().and_then(|source| context.objects.of(source));
        match found.map(|id| context.objects.object(id)) {
            Some(Object::Buffer(buffer)) => buffer,
            _ => unreachable!("linking gives every indirect step a buffer of the plan"),
        }
    }

    fn draw(
        &self,
        context: StepContext<'_>,
        views: &mut LayerViews,
        encoder: &mut wgpu::CommandEncoder,
        (pipeline, group, raster): (&wgpu::RenderPipeline, &wgpu::BindGroup, &Raster),
        queries: StepQueries<'_>,
    ) {
        let mut view = |id: &ResourceId, layer: u32| {
            let id = context.objects.current(*id);
            let Object::Texture { texture, .. } = context.objects.object(id) else { return None };
            Some(views.get(id, layer, texture).clone())
        };
        // An array instead of a list on the heap, since a frame should not allocate.
        let mut color_views = [const { None }; MAX_COLOR_ATTACHMENTS];
        for ((place, id), target) in color_views.iter_mut().zip(&self.linked.targets).zip(&raster.targets) {
            *place = view(id, target.layer);
        }
        let depth_view = self.linked.depth.as_ref().zip(raster.depth.as_ref());
        let depth_view = depth_view.and_then(|(id, target)| Some((view(id, target.layer)?, target.clear)));
        let mut colors = [const { None }; MAX_COLOR_ATTACHMENTS];
        for ((place, view), target) in colors.iter_mut().zip(&color_views).zip(&raster.targets) {
            let load = match target.load {
                Load::Clear([r, g, b, a]) => wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
                Load::Keep => wgpu::LoadOp::Load,
            };
            *place = view.as_ref().map(|view| wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
            });
        }
        let depth = depth_view.as_ref().map(|(view, clear)| wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(*clear),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(&self.label),
            color_attachments: &colors[..raster.targets.len().min(MAX_COLOR_ATTACHMENTS)],
            depth_stencil_attachment: depth,
            timestamp_writes: queries.filter(|(_, end)| end.is_some()).map(|(query_set, end)| {
                wgpu::RenderPassTimestampWrites {
                    query_set,
                    beginning_of_pass_write_index: None,
                    end_of_pass_write_index: end,
                }
            }),
            ..Default::default()
        });
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, group, &[]);
        match &raster.draw {
            Draw::Fullscreen => pass.draw(0..3, 0..1),
            Draw::Vertices { vertices, instances } => pass.draw(0..*vertices, 0..*instances),
            Draw::Indirect { offset, .. } => pass.draw_indirect(self.indirect_buffer(context), *offset),
            Draw::Scene => {
                if let (Some(SceneBinding::Buffer(vertices)), Some(SceneBinding::Buffer(indices))) = (
                    context.scene_bindings.get("scene_vertices"),
                    context.scene_bindings.get("scene_indices"),
                ) {
                    pass.set_vertex_buffer(0, vertices.slice(..));
                    pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
                    pass.draw_indexed(0..context.scene_indices, 0, 0..1);
                }
            }
        }
    }

    /// Finds the bind group for the objects of this frame, and creates it if it is missing.
    fn find_group(&mut self, context: StepContext<'_>) {
        if self.alternating.is_empty() && self.bound.is_some() {
            return;
        }
        let wanted = || self.alternating.iter().filter_map(|source| context.objects.of(source));
        let found = self.groups.iter().find(|(held, _)| held.iter().copied().eq(wanted()));
        let group = match found {
            Some((_, group)) => group.clone(),
            None => {
                let made = self.make_group(context);
                self.groups.push((wanted().collect(), made.clone()));
                made
            }
        };
        self.bound = Some(group);
    }

    fn make_group(&self, context: StepContext<'_>) -> wgpu::BindGroup {
        let globals = &self.linked.shader.interface.globals;
        let entries: Vec<wgpu::BindGroupEntry<'_>> = self
            .linked
            .bindings
            .iter()
            .map(|bound| {
                let global = &globals[bound.global];
                let resource = self.resource(context, bound, &global.name);
                wgpu::BindGroupEntry { binding: global.binding, resource }
            })
            .collect();
        context.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(&self.label),
            layout: &self.pipeline.layout,
            entries: &entries,
        })
    }

    fn resource<'a>(&self, context: StepContext<'a>, bound: &Bound, name: &str) -> wgpu::BindingResource<'a> {
        let source = &bound.source;
        match source {
            Source::Resource(_) | Source::Past(_) => {
                match context.objects.of(source).map(|id| context.objects.object(id)) {
                    Some(Object::Texture { view, .. }) => wgpu::BindingResource::TextureView(view),
                    Some(Object::Buffer(buffer)) => match &bound.window {
                        Some(bytes) => wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                            buffer,
                            offset: bytes.start,
                            size: std::num::NonZeroU64::new(bytes.end - bytes.start),
                        }),
                        None => buffer.as_entire_binding(),
                    },
                    None => unreachable!("loading gives every resource of the plan an object"),
                }
            }
            Source::SceneBinding(global) => match context.scene_bindings.get(global) {
                Some(SceneBinding::Buffer(buffer)) => buffer.as_entire_binding(),
                Some(SceneBinding::Texture(view)) => wgpu::BindingResource::TextureView(view),
                Some(SceneBinding::Sampler(sampler)) => wgpu::BindingResource::Sampler(sampler),
                Some(SceneBinding::AccelerationStructure(tlas)) => tlas.as_binding(),
                None => panic!("{}: the application has not set the scene binding `{name}`", self.label),
            },
            Source::ChosenLights { global, names } => {
                match context.chosen_lights.get(&(*global, Arc::clone(names))) {
                    Some(buffer) => buffer.as_entire_binding(),
                    None => {
                        panic!("{}: the application has not set `{name}` of {}", self.label, names.join(", "))
                    }
                }
            }
            Source::Uniform(index) => {
                let buffer = context.uniforms.expect("a step that has uniforms has a place for them");
                wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer,
                    offset: self.uniforms[*index],
                    size: std::num::NonZeroU64::new(self.linked.uniforms[*index].size()),
                })
            }
        }
    }
}

/// Reports how many bytes of each buffer of the plan a step binds.
pub(crate) fn bound_bytes(step: &LinkedStep, plan: &Plan, add: &mut impl FnMut(ResourceId, u64)) {
    for bound in &step.bindings {
        let id = match &bound.source {
            Source::Resource(id) => *id,
            Source::Past(history) => plan.histories[history.0 as usize].resource,
            Source::SceneBinding(_) | Source::ChosenLights { .. } | Source::Uniform(_) => continue,
        };
        if let ResourceDesc::Buffer(buffer) = &plan.resources[id.0 as usize].desc {
            add(id, bound.window.as_ref().map_or(buffer.bytes, |bytes| bytes.end - bytes.start));
        }
    }
}

/// Reports the usage of each resource of the plan by a step.
pub(crate) fn usages(step: &LinkedStep, plan: &Plan, add: &mut impl FnMut(ResourceId, ObjectUsage)) {
    let attachment = ObjectUsage { attachment: true, ..ObjectUsage::default() };
    step.targets.iter().chain(&step.depth).for_each(|id| add(*id, attachment));
    for bound in &step.bindings {
        if let Source::Resource(id) = &bound.source
            && matches!(step.shader.interface.globals[bound.global].kind, GlobalKind::StorageTexture { .. })
        {
            add(*id, ObjectUsage { storage: true, ..ObjectUsage::default() });
        }
    }
    let indirect = match &step.indirect {
        Some(Source::Resource(id)) => Some(*id),
        Some(Source::Past(history)) => Some(plan.histories[history.0 as usize].resource),
        _ => None,
    };
    if let Some(id) = indirect {
        add(id, ObjectUsage { indirect: true, ..ObjectUsage::default() });
    }
}

/// Returns the workgroups of a step, of which one dimension has at most `most`; none for a draw.
fn workgroups(linked: &LinkedStep, most: u32) -> Workgroups {
    let Step::Compute(compute) = &linked.step else { return Workgroups::Known([0; 3]) };
    let size = linked.shader.interface.entries[linked.entries[0]].workgroup_size;
    let groups = |threads: u32, axis: usize| threads.div_ceil(size[axis].max(1));
    match &compute.threads {
        Threads::Grid(threads) => Workgroups::Known(std::array::from_fn(|axis| groups(threads[axis], axis))),
        Threads::Row(threads) => {
            let all = groups(*threads, 0);
            let rows = all.div_ceil(most).max(1);
            Workgroups::Known([all.div_ceil(rows), rows, 1])
        }
        Threads::Indirect { offset, .. } => Workgroups::Indirect(*offset),
    }
}
