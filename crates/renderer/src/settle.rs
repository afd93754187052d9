//! Frames that are repeated until a picture is done.

use crate::{FrameReport, Progress, RenderError, Renderer};
use frame_graph::Plan;
use std::ops::ControlFlow;

impl Renderer {
    /// Runs frames of the same number, and so of the same time, until the output `progress` reports convergence; one
    /// frame if the pipeline has no such output. `report` is called after each frame, and may stop early.
    ///
    /// Frames between the first and the last leave out passes on which neither `progress` nor a history buffer depends, but for
    /// those that catch up: see [`FrameReport::partial`]. So does the first frame of a plan with `progress` in which some catch up, for
    /// which several frames are expected.
    ///
    /// # Errors
    /// As [`Renderer::frame`] and [`Renderer::progress`].
    pub fn frame_until_done(
        &mut self,
        report: impl FnMut(&FrameReport, Option<Progress>) -> ControlFlow<()>,
    ) -> Result<&FrameReport, RenderError> {
        self.frames_until_done(u32::MAX, report)
    }

    /// Runs frames as [`Renderer::frame_until_done`] does, at most so many, and at least one.
    ///
    /// # Errors
    /// As [`Renderer::frame_until_done`].
    pub fn frames_until_done(
        &mut self,
        most: u32,
        mut report: impl FnMut(&FrameReport, Option<Progress>) -> ControlFlow<()>,
    ) -> Result<&FrameReport, RenderError> {
        let index = self.index;
        let needed = self.plan().map_or_else(Vec::new, |plan| needed_to_go_on(plan));
        let mut steps_before = 0;
        let mut is_whole =
            !(self.executor.is_fresh() && self.plan().is_some_and(|plan| expects_several(plan)));
        for left in (0..most.max(1)).rev() {
            self.index = index;
            if needed.contains(&false) && !is_whole && left > 0 {
                self.change.only.clone_from(&needed);
            }
            self.frame()?;
            let progress = self.progress()?;
            let broken_off = report(self.report(), progress).is_break();
            let Some(Progress { step, steps, .. }) =
                progress.filter(|progress| !progress.is_done() && !broken_off)
            else {
                // What converges before it has taken all its steps leaves the rest to another frame.
                if self.report().partial && !broken_off {
                    self.index = index;
                    self.frame()?;
                    let progress = self.progress()?;
                    // It is the last in any case.
                    let _ = report(self.report(), progress);
                }
                break;
            };
            // The last frame is whole: the one that takes what steps are left.
            is_whole = step.saturating_add(step.saturating_sub(steps_before)) >= steps;
            steps_before = step;
        }
        Ok(self.report())
    }
}

/// Returns for each pass whether the output `progress` depends on it, or what goes on from frame to frame.
fn needed_to_go_on(plan: &Plan) -> Vec<bool> {
    let of_progress =
        plan.output("progress").into_iter().flat_map(|output| &output.members).map(|(_, id)| *id);
    let of_histories = plan.histories.iter().filter(|history| !history.catches_up);
    let of_histories = of_histories.map(|history| history.resource);
    plan.upstream(of_progress.chain(of_histories).map(|id| plan.producer(id)))
}

/// Returns whether a picture takes several frames from the beginning, for which what catches up can wait.
fn expects_several(plan: &Plan) -> bool {
    plan.output("progress").is_some() && plan.histories.iter().any(|history| history.catches_up)
}
