//! One step of a pass, ready to be encoded.

use crate::error::ExecutorError;
use crate::fill::layer_view;
use crate::gpu::Gpu;
use crate::object::{Object, ObjectUsage, SceneBinding};
use crate::pipeline::{Pipeline, PipelineKind, Pipelines, TargetFormats};
use frame_graph::plan::{AllocationId, HistoryId, Plan, PlannedPass, ResourceId};
use pass::{Draw, LinkedStep, Load, PastFact, Source, Step, Threads};
use shader_library::GlobalKind;
use std::collections::HashMap;
use std::sync::Arc;

/// A linked step with its pipeline, bind groups and place in the uniform buffer.
#[derive(Debug)]
pub(crate) struct LoadedStep {
    label: String,
    linked: LinkedStep,
    pipeline: Arc<Pipeline>,
    /// Offset and bytes of each uniform, as last written.
    uniforms: Vec<(u64, Vec<u8>)>,
    /// Bind groups by the objects that they hold: histories make two of them change places.
    groups: Vec<(Vec<AllocationId>, wgpu::BindGroup)>,
    views: HashMap<(AllocationId, u32), wgpu::TextureView>,
}

/// What encoding a step needs to know.
pub(crate) struct StepContext<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) scene_bindings: &'a HashMap<&'static str, SceneBinding>,
    pub(crate) scene_indices: u32,
    pub(crate) uniforms: Option<&'a wgpu::Buffer>,
    pub(crate) object_of: &'a dyn Fn(&Source) -> Option<(AllocationId, &'a Object)>,
}

/// Where a frame is timed: the queries, and for the last step of a pass the one that it writes at its end.
pub(crate) type StepQueries<'a> = Option<(&'a wgpu::QuerySet, Option<u32>)>;

impl LoadedStep {
    /// Makes the pipeline; the flag says whether it was not there before.
    pub(crate) fn new(
        gpu: &Gpu,
        pipelines: &mut Pipelines,
        plan: &Plan,
        pass: &PlannedPass,
        linked: LinkedStep,
    ) -> Result<(LoadedStep, bool), ExecutorError> {
        let format =
            |id: &ResourceId| plan.resources[id.0 as usize].desc.texture().map(|texture| texture.format);
        let formats = TargetFormats {
            colors: linked.targets.iter().filter_map(format).collect(),
            depth: linked.depth.as_ref().and_then(format),
        };
        let (pipeline, made) = pipelines.get(gpu, &pass.name, &linked, formats)?;
        let entry =
            linked.entries.first().map_or("", |&entry| linked.shader.interface.entries[entry].name.as_str());
        let label = format!("{}: {entry}", pass.name);
        let step = LoadedStep {
            label,
            linked,
            pipeline,
            uniforms: Vec::new(),
            groups: Vec::new(),
            views: HashMap::new(),
        };
        Ok((step, made))
    }

    pub(crate) fn shader_hash(&self) -> u128 {
        self.linked.shader.hash
    }

    /// Whether both do the same with the same resources' names; values of the uniforms included.
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

    /// Takes the values of another step, and keeps pipeline and bind groups. Gives the other back where it does not
    /// bind the same in the same way.
    pub(crate) fn take_values(&mut self, new: LoadedStep) -> Result<(), Box<LoadedStep>> {
        let binds = |step: &LinkedStep| {
            step.bindings.iter().map(|bound| (bound.global, bound.source.clone())).collect::<Vec<_>>()
        };
        let same = Arc::ptr_eq(&self.pipeline, &new.pipeline)
            && binds(&self.linked) == binds(&new.linked)
            && self.linked.targets == new.linked.targets
            && self.linked.depth == new.linked.depth
            && self.linked.indirect == new.linked.indirect;
        if !same {
            return Err(Box::new(new));
        }
        self.linked = new.linked;
        Ok(())
    }

    pub(crate) fn forget_bindings(&mut self) {
        self.groups.clear();
    }

    /// Forgets all that holds objects of the plan.
    pub(crate) fn forget_objects(&mut self) {
        self.groups.clear();
        self.views.clear();
    }

    /// Reserves places for the uniforms from `offset` on, each aligned; gives the end of the last.
    pub(crate) fn place_uniforms(&mut self, mut offset: u64, alignment: u64) -> u64 {
        self.uniforms.clear();
        for fill in &self.linked.uniforms {
            self.uniforms.push((offset, Vec::new()));
            offset += fill.size().next_multiple_of(alignment);
        }
        self.groups.clear();
        offset
    }

    /// Writes the uniforms that are not what was written last.
    pub(crate) fn write_uniforms(
        &mut self,
        gpu: &Gpu,
        buffer: &wgpu::Buffer,
        seed: u32,
        past: impl Fn(HistoryId, PastFact) -> u32,
    ) {
        for (fill, (offset, written)) in self.linked.uniforms.iter().zip(&mut self.uniforms) {
            let mut bytes = fill.bytes(seed, &past);
            bytes.resize(bytes.len().next_multiple_of(16), 0);
            if bytes != *written {
                gpu.queue.write_buffer(buffer, *offset, &bytes);
                *written = bytes;
            }
        }
    }

    /// Tells what each resource of the plan is used for.
    pub(crate) fn usages(&self, plan: &Plan, add: &mut impl FnMut(ResourceId, ObjectUsage)) {
        let attachment = ObjectUsage { attachment: true, ..ObjectUsage::default() };
        self.linked.targets.iter().chain(&self.linked.depth).for_each(|id| add(*id, attachment));
        for bound in &self.linked.bindings {
            if let Source::Resource(id) = &bound.source
                && matches!(
                    self.linked.shader.interface.globals[bound.global].kind,
                    GlobalKind::StorageTexture { .. }
                )
            {
                add(*id, ObjectUsage { storage: true, ..ObjectUsage::default() });
            }
        }
        let indirect = match &self.linked.indirect {
            Some(Source::Resource(id)) => Some(*id),
            Some(Source::Past(history)) => Some(plan.histories[history.0 as usize].resource),
            _ => None,
        };
        if let Some(id) = indirect {
            add(id, ObjectUsage { indirect: true, ..ObjectUsage::default() });
        }
    }

    /// Encodes the step. Dispatches that follow each other share one compute pass unless they are timed.
    pub(crate) fn encode(
        &mut self,
        context: &StepContext<'_>,
        encoder: &mut wgpu::CommandEncoder,
        open: &mut Option<wgpu::ComputePass<'static>>,
        queries: StepQueries<'_>,
    ) {
        let group = self.bind_group(context);
        match &self.pipeline.kind {
            PipelineKind::Compute(pipeline) => {
                if queries.is_some() {
                    *open = None;
                }
                let mut pass = open.take().unwrap_or_else(|| {
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
                    encoder.begin_compute_pass(&descriptor).forget_lifetime()
                });
                pass.push_debug_group(&self.label);
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, &group, &[]);
                self.dispatch(context, &mut pass);
                pass.pop_debug_group();
                if queries.is_none() {
                    *open = Some(pass);
                }
            }
            PipelineKind::Render(pipeline) => {
                *open = None;
                let pipeline = pipeline.clone();
                self.draw(context, encoder, &pipeline, &group, queries);
            }
        }
    }

    fn dispatch(&self, context: &StepContext<'_>, pass: &mut wgpu::ComputePass<'static>) {
        let Step::Compute(compute) = &self.linked.step else { return };
        let size = self.linked.shader.interface.entries[self.linked.entries[0]].workgroup_size;
        let groups = |threads: u32, axis: usize| threads.div_ceil(size[axis].max(1));
        match &compute.threads {
            Threads::Grid(threads) => {
                pass.dispatch_workgroups(groups(threads[0], 0), groups(threads[1], 1), groups(threads[2], 2));
            }
            Threads::Row(threads) => {
                let most = context.gpu.limits().max_compute_workgroups_per_dimension;
                let all = groups(*threads, 0);
                let rows = all.div_ceil(most).max(1);
                pass.dispatch_workgroups(all.div_ceil(rows), rows, 1);
            }
            Threads::Indirect { offset, .. } => {
                pass.dispatch_workgroups_indirect(self.indirect_buffer(context), *offset);
            }
        }
    }

    /// The buffer that holds the size of the dispatch or draw.
    fn indirect_buffer<'a>(&self, context: &StepContext<'a>) -> &'a wgpu::Buffer {
        match self.linked.indirect.as_ref().and_then(|source| (context.object_of)(source)) {
            Some((_, Object::Buffer(buffer))) => buffer,
            _ => unreachable!("linking gives every indirect step a buffer of the plan"),
        }
    }

    fn draw(
        &mut self,
        context: &StepContext<'_>,
        encoder: &mut wgpu::CommandEncoder,
        pipeline: &wgpu::RenderPipeline,
        group: &wgpu::BindGroup,
        queries: StepQueries<'_>,
    ) {
        let Step::Raster(raster) = &self.linked.step else { return };
        let layers = raster
            .targets
            .iter()
            .map(|target| target.layer)
            .chain(raster.depth.iter().map(|depth| depth.layer));
        let ids = self.linked.targets.iter().chain(&self.linked.depth);
        let keys: Vec<(AllocationId, u32)> = ids
            .zip(layers)
            .filter_map(|(id, layer)| {
                let (allocation, object) = (context.object_of)(&Source::Resource(*id))?;
                let Object::Texture { texture, .. } = object else { return None };
                self.views.entry((allocation, layer)).or_insert_with(|| layer_view(texture, layer));
                Some((allocation, layer))
            })
            .collect();
        let colors: Vec<Option<wgpu::RenderPassColorAttachment<'_>>> = raster
            .targets
            .iter()
            .zip(&keys)
            .map(|(target, key)| {
                let load = match target.load {
                    Load::Clear([r, g, b, a]) => wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
                    Load::Keep => wgpu::LoadOp::Load,
                };
                Some(wgpu::RenderPassColorAttachment {
                    view: &self.views[key],
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
                })
            })
            .collect();
        let depth = raster.depth.as_ref().zip(keys.get(raster.targets.len())).map(|(target, key)| {
            wgpu::RenderPassDepthStencilAttachment {
                view: &self.views[key],
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(target.clear),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(&self.label),
            color_attachments: &colors,
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

    fn bind_group(&mut self, context: &StepContext<'_>) -> wgpu::BindGroup {
        let objects: Vec<Option<(AllocationId, &Object)>> =
            self.linked.bindings.iter().map(|bound| (context.object_of)(&bound.source)).collect();
        let key: Vec<AllocationId> = objects.iter().flatten().map(|(allocation, _)| *allocation).collect();
        if let Some((_, group)) = self.groups.iter().find(|(held, _)| *held == key) {
            return group.clone();
        }
        let entries: Vec<wgpu::BindGroupEntry<'_>> = self
            .linked
            .bindings
            .iter()
            .zip(&objects)
            .map(|(bound, object)| {
                let global = &self.linked.shader.interface.globals[bound.global];
                wgpu::BindGroupEntry {
                    binding: global.binding,
                    resource: self.resource(
                        context,
                        &bound.source,
                        object.map(|(_, object)| object),
                        &global.name,
                    ),
                }
            })
            .collect();
        let group = context.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(&self.label),
            layout: &self.pipeline.layout,
            entries: &entries,
        });
        self.groups.push((key, group.clone()));
        group
    }

    fn resource<'a>(
        &self,
        context: &StepContext<'a>,
        source: &Source,
        object: Option<&'a Object>,
        name: &str,
    ) -> wgpu::BindingResource<'a> {
        match (source, object) {
            (_, Some(Object::Texture { view, .. })) => wgpu::BindingResource::TextureView(view),
            (_, Some(Object::Buffer(buffer))) => buffer.as_entire_binding(),
            (Source::SceneBinding(external), _) => match context.scene_bindings.get(external) {
                Some(SceneBinding::Buffer(buffer)) => buffer.as_entire_binding(),
                Some(SceneBinding::Texture(view)) => wgpu::BindingResource::TextureView(view),
                Some(SceneBinding::Sampler(sampler)) => wgpu::BindingResource::Sampler(sampler),
                Some(SceneBinding::AccelerationStructure(tlas)) => tlas.as_binding(),
                None => panic!("{}: the application has not set the external `{name}`", self.label),
            },
            (Source::Uniform(index), _) => {
                let buffer = context.uniforms.expect("a step that has uniforms has a place for them");
                wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer,
                    offset: self.uniforms[*index].0,
                    size: std::num::NonZeroU64::new(self.linked.uniforms[*index].size()),
                })
            }
            (Source::Resource(_) | Source::Past(_), None) => {
                unreachable!("loading gives every resource of the plan an object")
            }
        }
    }
}
