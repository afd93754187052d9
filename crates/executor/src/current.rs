//! The objects that hold the resources of a plan in a frame, and the views that are drawn to.

use crate::object::{Object, ObjectUsage};
use frame_graph::frame::FrameSchedule;
use frame_graph::plan::{AllocationId, HistoryId, Plan, ResourceId};
use pass::Source;

/// The objects of a plan, as a frame uses them.
#[derive(Clone, Copy)]
pub(crate) struct FrameObjects<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) schedule: &'a FrameSchedule,
    pub(crate) objects: &'a [(ObjectUsage, Object)],
}

impl<'a> FrameObjects<'a> {
    /// The object that holds this frame's version of a resource.
    pub(crate) fn current(self, id: ResourceId) -> AllocationId {
        let resource = &self.plan.resources[id.0 as usize];
        match resource.history {
            Some(history) => {
                let slot = &self.schedule.histories[history.0 as usize];
                self.plan.histories[history.0 as usize].copies[slot.current]
            }
            None => resource.allocation,
        }
    }

    /// The object that holds the past version of a history.
    pub(crate) fn past(self, id: HistoryId) -> AllocationId {
        self.plan.histories[id.0 as usize].copies[self.schedule.histories[id.0 as usize].previous]
    }

    /// The object of what a global is bound to; `None` where that is no resource of the plan.
    pub(crate) fn of(self, source: &Source) -> Option<AllocationId> {
        match source {
            Source::Resource(id) => Some(self.current(*id)),
            Source::Past(id) => Some(self.past(*id)),
            Source::SceneBinding(_) | Source::ChosenLights { .. } | Source::Uniform(_) => None,
        }
    }

    pub(crate) fn object(self, id: AllocationId) -> &'a Object {
        &self.objects[id.0 as usize].1
    }
}

/// Views of single layers, as attachments: made when they are first drawn to.
#[derive(Debug, Default)]
pub(crate) struct LayerViews {
    /// The views, by object and then by layer.
    views: Vec<Vec<Option<wgpu::TextureView>>>,
}

impl LayerViews {
    /// Returns the view of a layer of an object, made if it is not there.
    pub(crate) fn get(
        &mut self,
        id: AllocationId,
        layer: u32,
        texture: &wgpu::Texture,
    ) -> &wgpu::TextureView {
        let (object, index) = (id.0 as usize, layer as usize);
        if self.views.len() <= object {
            self.views.resize_with(object + 1, Vec::new);
        }
        let layers = &mut self.views[object];
        if layers.len() <= index {
            layers.resize(index + 1, None);
        }
        layers[index].get_or_insert_with(|| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer: layer,
                array_layer_count: Some(1),
                ..Default::default()
            })
        })
    }

    /// Forgets all views, and with them the textures that they hold.
    pub(crate) fn clear(&mut self) {
        self.views.clear();
    }
}
