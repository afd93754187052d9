//! One pipeline that renders the scene.

use super::measure::to_screen;
use super::model::{Look, Looked, SideView};
use super::statistics::PassTimes;
use eframe::egui::{Color32, ColorImage};
use frame_graph::plan::{PlannedOutput, ResourceId};
use frame_graph::resolve::Settable;
use frame_graph::{Overrides, PassTypes, ResourceDesc};
use interfaces::virtual_lights::{self, VirtualLight};
use metrics::{Display, Image};
use pass::LinkedSteps;
use renderer::{Catalog, FrameOptions, LoadReport, Progress, RenderError, Renderer};
use std::sync::Arc;
use std::time::Instant;

/// The output that is shown.
const SHOWN: &str = "display";

/// A renderer, and what is known of its frames.
pub(super) struct Side {
    pub(super) renderer: Renderer,
    /// The pipeline that was asked for, where it could not be loaded: whenever a file changes it is tried again.
    pub(super) wanted: Option<(String, Overrides)>,
    about: String,
    settable: Arc<Vec<Settable>>,
    steps: Arc<Vec<LinkedSteps>>,
    picture: Option<Arc<ColorImage>>,
    version: u64,
    frames: u64,
    ran: Vec<bool>,
    times: Arc<Vec<PassTimes>>,
    timed_frame: Option<u64>,
    /// The first frame whose times count.
    times_from: u64,
    /// Whether all passes run in every frame.
    runs_everything: bool,
    whole: PassTimes,
    progress: Option<Progress>,
    /// Whether the last frame ran nothing.
    idle: bool,
}

impl Side {
    /// A side without a pipeline yet.
    pub(super) fn new(renderer: Renderer) -> Side {
        let mut side = Side {
            renderer,
            wanted: None,
            about: String::new(),
            settable: Arc::default(),
            steps: Arc::default(),
            picture: None,
            version: 0,
            frames: 0,
            ran: Vec::new(),
            times: Arc::default(),
            timed_frame: None,
            times_from: 0,
            runs_everything: false,
            whole: PassTimes::default(),
            progress: None,
            idle: false,
        };
        side.time(true);
        side
    }

    /// Sets whether each pass is timed.
    pub(super) fn time(&mut self, timed: bool) {
        self.renderer.set_frame_options(FrameOptions { monitored: timed, ..FrameOptions::default() });
    }

    /// Takes note of another plan: after a pipeline, a value, a size or a scene was set, or files were read again.
    pub(super) fn loaded(&mut self, catalog: &Catalog) {
        let Some(compiled) = self.renderer.compiled() else { return };
        self.about = compiled.resolved.about().unwrap_or_default().to_owned();
        self.settable = Arc::new(compiled.resolved.settable(catalog as &dyn PassTypes));
        self.steps = Arc::new(compiled.steps.clone());
        if self.times.len() != compiled.plan.passes.len() {
            self.times = Arc::new(vec![PassTimes::default(); compiled.plan.passes.len()]);
            self.timed_frame = None;
        }
        self.idle = false;
        self.progress = None;
    }

    /// Begins to count frames and to remember times again: for another pipeline.
    pub(super) fn begin(&mut self) {
        self.frames = 0;
        self.whole = PassTimes::default();
        self.times = Arc::default();
    }

    /// Forgets the times: those of another resolution, or at the user's wish.
    pub(super) fn forget_times(&mut self) {
        self.whole = PassTimes::default();
        self.times = Arc::new(vec![PassTimes::default(); self.times.len()]);
        self.times_from = self.renderer.report().frame + 1;
    }

    /// Sets whether all passes run in every frame.
    pub(super) fn run_everything(&mut self, all: bool) {
        self.runs_everything = all;
        self.idle = false;
    }

    /// The times of whole frames.
    pub(super) fn whole(&self) -> &PassTimes {
        &self.whole
    }

    /// Whether the next frame is the first of the pipeline.
    pub(super) fn is_new(&self) -> bool {
        self.frames == 0
    }

    /// Something changed: the next frame has something to do.
    pub(super) fn wake(&mut self) {
        self.idle = false;
    }

    /// Whether another frame would bring something new, as far as is known.
    pub(super) fn wants_a_frame(&self) -> bool {
        !self.idle && self.renderer.plan().is_some()
    }

    /// Whether its pictures take several frames.
    pub(super) fn has_progress(&self) -> bool {
        self.progress.is_some()
    }

    /// Whether it adds sample to sample, and is not done.
    pub(super) fn converges(&self) -> bool {
        self.progress.is_some_and(|progress| !progress.is_done())
    }

    /// Describes how far a result is that takes several frames.
    pub(super) fn step(&self) -> String {
        self.progress
            .map_or(String::new(), |progress| format!("step {} of {}", progress.step, progress.steps))
    }

    /// Runs a frame and reads its picture.
    pub(super) fn frame(&mut self) -> Result<(), RenderError> {
        let begun = Instant::now();
        if self.runs_everything {
            self.renderer.run_everything();
        }
        let report = self.renderer.frame()?;
        let (frame, encoded) = (report.frame, begun.elapsed());
        let encoding = report.encoding.clone();
        let ran = report.ran.contains(&true);
        if ran {
            self.ran.clone_from(&report.ran);
        }
        if ran || self.picture.is_none() {
            self.read_picture()?;
            self.frames += 1;
            self.whole.add(begun.elapsed().as_secs_f64() * 1e3);
            self.whole.set_cpu(encoded.as_secs_f64() * 1e3);
        }
        self.progress = self.renderer.progress()?;
        let done = !ran || self.progress.is_some_and(|progress| progress.is_done());
        self.idle = done && !self.runs_everything;
        self.take_times(frame, &encoding);
        Ok(())
    }

    fn read_picture(&mut self) -> Result<(), RenderError> {
        let plan = self.renderer.plan().cloned().ok_or(RenderError::NoPipeline)?;
        let picture = if plan.output(SHOWN).is_some() {
            let bytes = self.renderer.resource_bytes(self.renderer.find_output(SHOWN)?)?;
            let pixels = bytes.chunks_exact(4).map(|p| Color32::from_rgb(p[0], p[1], p[2])).collect();
            ColorImage::new([plan.frame.0 as usize, plan.frame.1 as usize], pixels)
        } else {
            to_screen(&Display::default().apply(&self.image()?))
        };
        self.picture = Some(Arc::new(picture));
        self.version += 1;
        Ok(())
    }

    /// Takes the times of the newest frame that has finished.
    fn take_times(&mut self, frame: u64, encoding: &[f64]) {
        let newest =
            self.renderer.timings().filter(|timings| self.timed_frame != Some(timings.frame)).cloned();
        let passes = Arc::make_mut(&mut self.times);
        for (pass, ms) in passes.iter_mut().zip(encoding).filter(|(_, ms)| **ms > 0.0) {
            pass.set_cpu(*ms);
        }
        let Some(newest) = newest.filter(|newest| newest.frame >= self.times_from) else { return };
        // The first frame of a pipeline is that in which the driver compiles.
        let first = self.timed_frame.is_none() && newest.frame == frame;
        self.timed_frame = Some(newest.frame);
        for (pass, ms) in passes.iter_mut().zip(&newest.times).filter(|(_, ms)| **ms > 0.0 && !first) {
            pass.add(*ms);
        }
    }

    /// Reads a resource back.
    pub(super) fn look(&self, look: &Look) -> Result<Looked, RenderError> {
        let id = self.renderer.find(&look.name).or_else(|_| self.renderer.find_output(&look.name))?;
        let plan = self.renderer.plan().ok_or(RenderError::NoPipeline)?;
        let resource = &plan.resources[id.0 as usize];
        let (picture, bytes) = match resource.desc {
            ResourceDesc::Texture(_) => {
                (Some(Arc::new(self.renderer.resource_picture(id, look.layer)?)), Vec::new())
            }
            ResourceDesc::Buffer(_) => (None, self.renderer.resource_bytes(id)?),
        };
        Ok(Looked {
            look: look.clone(),
            resource: resource.name.to_string(),
            desc: resource.desc.clone(),
            picture,
            bytes: Arc::new(bytes),
            frame: self.frames,
        })
    }

    /// The resource of the virtual lights that the last pass in the order outputs; `None` where there are no such.
    fn lights_resource(&self) -> Option<ResourceId> {
        let plan = self.renderer.plan()?;
        let interface = virtual_lights::INTERFACE.name;
        let ports = plan.passes.iter().rev().flat_map(|pass| &pass.outputs);
        let port = ports.filter(|port| port.interface.as_str() == interface).find(|port| port.connected)?;
        port.members.first().map(|(_, id)| *id)
    }

    /// Reads the virtual lights. Their object may hold another resource by now, unless it is kept.
    pub(super) fn virtual_lights(&self) -> Option<Vec<VirtualLight>> {
        virtual_lights::from_bytes(&self.renderer.resource_bytes(self.lights_resource()?).ok()?)
    }

    /// The name of the resource of the virtual lights, to be kept.
    pub(super) fn virtual_lights_name(&self) -> Option<String> {
        let id = self.lights_resource()?;
        Some(self.renderer.plan()?.resources[id.0 as usize].name.to_string())
    }

    /// The picture, as it goes to the screen; `None` before there is one.
    pub(super) fn picture(&self) -> Option<&ColorImage> {
        self.picture.as_deref()
    }

    /// The version of the picture; `None` before there is one.
    pub(super) fn picture_version(&self) -> Option<u64> {
        self.picture.as_ref().map(|_| self.version)
    }

    /// Reads the linear picture: the output `image`, or the first picture among the outputs of a pipeline without one.
    pub(super) fn image(&self) -> Result<Image, RenderError> {
        let plan = self.renderer.plan().ok_or(RenderError::NoPipeline)?;
        let is_picture = |output: &&PlannedOutput| {
            output
                .members
                .first()
                .is_some_and(|(_, id)| plan.resources[id.0 as usize].desc.texture().is_some())
        };
        let first = plan.outputs.iter().find(is_picture).map(|output| output.name.as_str());
        let name = if plan.output("image").is_some() { "image" } else { first.unwrap_or("image") };
        self.renderer.output(name)
    }

    /// Returns the state for the interface.
    pub(super) fn view(&self) -> Option<SideView> {
        Some(SideView {
            name: self.renderer.pipeline_name().to_owned(),
            about: self.about.clone(),
            overrides: self.overrides(),
            settable: Arc::clone(&self.settable),
            plan: Arc::clone(self.renderer.plan()?),
            steps: Arc::clone(&self.steps),
            picture: self.picture.clone(),
            version: self.version,
            frames: self.frames,
            ran: self.ran.clone(),
            times: Arc::clone(&self.times),
            whole: self.whole.clone(),
            progress: self.progress,
            idle: self.idle,
            bytes: self.renderer.held_bytes(),
        })
    }

    /// The values that were set.
    pub(super) fn overrides(&self) -> Overrides {
        self.renderer.overrides().cloned().unwrap_or_default()
    }

    /// Describes a load in a line.
    pub(super) fn describe(&self, report: &LoadReport) -> String {
        let Some(plan) = self.renderer.plan() else { return String::new() };
        let all = plan.passes.len();
        let changed: Vec<&str> =
            report.changed.iter().map(|id| plan.passes[id.0 as usize].name.as_str()).collect();
        let rebuilt = match changed.len() {
            0 => "nothing rebuilt".to_owned(),
            n if n == all => "all passes rebuilt".to_owned(),
            n if n > 6 => format!("{n} of {all} passes rebuilt"),
            _ => format!("rebuilt {}, kept {} other passes", changed.join(", "), all - changed.len()),
        };
        let pipelines = match report.pipelines {
            0 => String::new(),
            n => format!("; {n} GPU pipeline{} compiled", if n == 1 { "" } else { "s" }),
        };
        let objects = if report.kept { "; all objects kept" } else { "" };
        format!("{rebuilt}{pipelines}{objects}")
    }

    /// Lists the history buffers that ended in the last frame, with the causes; empty where none did.
    pub(super) fn ended(&self) -> String {
        let Some(plan) = self.renderer.plan() else { return String::new() };
        let all = plan.histories.len();
        let resets = &self.renderer.report().resets;
        let name = |history: &frame_graph::plan::History| {
            plan.resources[history.resource.0 as usize].name.to_string()
        };
        let ended: Vec<String> = resets
            .iter()
            .filter_map(|(id, cause)| Some(format!("{} ({cause})", name(plan.histories.get(id.0 as usize)?))))
            .collect();
        match (all, ended.len()) {
            (0, _) => String::new(),
            (all, 0) => format!("; {all} histories go on"),
            (all, n) if n == all && n > 3 => format!("; all {n} histories ended"),
            (_, n) if n > 3 => format!("; {n} of {all} histories ended"),
            _ => format!("; histories ended: {}", ended.join(", ")),
        }
    }
}
