//! A plan in the executor, as a renderer has it, for what goes past the renderer.

use anyhow::Result;
use executor::{Executor, FrameOptions, FrameReport, Gpu};
use frame_graph::plan::{PassId, Plan};
use frame_graph::{Change, CompileOptions, LinkContext, Overrides, Traits};
use renderer::{Catalog, Compiled};
use scene::{Pose, Scene};
use scene_upload::{Frame, SceneView};
use std::io::Write as _;
use std::sync::Arc;

/// A plan that runs, for frames of one time.
pub(super) struct Running<'a> {
    pub(super) executor: Executor,
    pub(super) plan: Arc<Plan>,
    pub(super) scene: &'a Scene,
    size: (u32, u32),
    view: SceneView,
    pose: Pose,
    change: Change,
}

impl Running<'_> {
    /// Loads a pipeline, given by its text, for a scene with these traits.
    pub(super) fn new<'a>(
        (gpu, catalog): (Gpu, &Catalog),
        (text, values): (&str, &Overrides),
        (scene, traits): (&'a Scene, Traits),
        size: (u32, u32),
    ) -> Result<Running<'a>> {
        let mut file = tempfile::Builder::new().suffix(".ron").tempfile()?;
        file.write_all(text.as_bytes())?;
        let path = file.path().to_string_lossy();
        let context = LinkContext { frame: size, traits };
        let compiled = Compiled::new(catalog, &path, values, &context, &CompileOptions::default())?;
        let mut executor = Executor::new(gpu);
        let mut view = SceneView::upload(&mut executor, scene);
        let bindings = compiled.steps.iter().flatten().flat_map(|step| step.scene_bindings());
        view.provide(&mut executor, scene, bindings)?;
        executor.load(Arc::clone(&compiled.plan), compiled.steps)?;
        let (plan, pose, change) = (compiled.plan, scene.at(0.0), Change::default());
        Ok(Running { executor, plan, scene, size, view, pose, change })
    }

    /// Runs a frame: what has something new to read and these passes, or all.
    pub(super) fn frame(&mut self, again: Option<&[PassId]>, options: FrameOptions) -> Result<&FrameReport> {
        let frame = Frame { index: 0, time: 0.0, step: 0.0, pad: 0.0 };
        self.scene.pose(0.0, &mut self.pose);
        self.change.clear();
        let (executor, change) = (&mut self.executor, &mut self.change);
        self.view.update(executor, self.scene, &self.pose, self.size, frame, change)?;
        change.all = again.is_none();
        change.again.extend_from_slice(again.unwrap_or_default());
        Ok(executor.frame(change, options)?)
    }
}
