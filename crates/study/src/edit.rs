//! Changes to a study that are given on the command line.

use crate::description::{At, Budget, Group, Reference, SIZE, Set, Study, Vary, size_of, size_value};
use crate::record::AxisValue;
use frame_graph::{Diagnostics, Source, Span};

/// Values that replace those of the file for one run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Edits {
    /// Scenes.
    pub scenes: Vec<String>,
    /// Size of frames \[px\].
    pub size: Option<(u32, u32)>,
    /// Values by path: an axis of that path is pinned to the value. Pipelines without the path are run
    /// without it.
    pub set: Vec<(String, AxisValue)>,
    /// Values of the pipeline that renders references.
    pub set_reference: Vec<(String, AxisValue)>,
    /// Number of seeds.
    pub seeds: Option<u32>,
    /// Measured frames.
    pub frames: Option<u32>,
    /// Time of a frame, or of all frames of a cell, in place of that of a budget of time \[ms\]; > 0.
    pub ms: Option<f64>,
    /// A quick preview: a quarter of each side, one seed, first and last value of each axis.
    pub quick: bool,
    /// A run that shows what cells cost: one seed, first and last value of each axis, in frames of full size.
    pub timing: bool,
}

impl Study {
    /// Changes the study. Names and values are checked later, together with the others, by
    /// [`Plan::new`](crate::Plan::new).
    ///
    /// # Errors
    /// Contradictions after the change: for example a measure that needs more frames or seeds than there are
    /// now.
    pub fn edit(&mut self, edits: &Edits) -> Result<(), Diagnostics> {
        if edits.quick || edits.timing {
            self.thin_out();
        }
        if edits.quick {
            self.shrink();
        }
        if let Some(size) = edits.size {
            self.size = size;
            self.vary.iter_mut().for_each(|group| {
                group.axes_mut().retain(|axis| axis.path.value != SIZE);
            });
            self.vary.retain(|group| !group.axes().is_empty());
        }
        if let Some(seeds) = edits.seeds {
            self.seeds = (1..=seeds).collect();
        }
        if let Some(wanted) = edits.frames {
            match &mut self.budget {
                Budget::Frames(frames) | Budget::Time { frames, .. } | Budget::Lights { frames, .. } => {
                    *frames = wanted;
                }
            }
        }
        if let (Some(wanted), Budget::Time { ms, .. }) = (edits.ms, &mut self.budget) {
            *ms = wanted;
        }
        if !edits.scenes.is_empty() {
            self.scenes = edits.scenes.iter().map(|scene| given("--scene", scene)).collect();
        }
        for (path, value) in &edits.set {
            self.pin(path, value);
        }
        if let Reference::Pipeline { set, .. } = &mut self.reference {
            for (path, value) in &edits.set_reference {
                set.retain(|set| set.path.value != *path);
                set.push(from_outside("--set-reference", path, value, false));
            }
        }
        self.consistent()
    }

    /// Reduces the frames of the study to a quarter of each side.
    fn shrink(&mut self) {
        let quarter = |(width, height): (u32, u32)| (width.div_ceil(4), height.div_ceil(4));
        self.size = quarter(self.size);
        for axis in self.vary.iter_mut().flat_map(Group::axes_mut) {
            for size in axis.values.iter_mut().filter_map(|at| Some((size_of(&at.value)?, at))) {
                size.1.value = size_value(quarter(size.0));
            }
        }
    }

    /// Reduces the study to as few seeds as the measures allow, and to the first and last value of each axis.
    fn thin_out(&mut self) {
        let over_seeds = self.measures.iter().any(|at| at.value.is_over_seeds());
        self.seeds.truncate(if over_seeds { 2 } else { 1 });
        for axis in self.vary.iter_mut().flat_map(Group::axes_mut) {
            if axis.values.len() > 2 {
                axis.values.drain(1..axis.values.len() - 1);
            }
        }
    }

    /// Gives a path one value, and removes the values that the file gives it.
    fn pin(&mut self, path: &str, value: &AxisValue) {
        let set = from_outside("--set", path, value, true);
        let pinned = |axis: &Vary| axis.path.value == path;
        for axis in self.vary.iter_mut().flat_map(Group::axes_mut).filter(|axis| pinned(axis)) {
            axis.values = axis.values.iter().map(|_| set.value.clone()).collect();
        }
        for group in &mut self.vary {
            if let Group::Grid(axes) = group {
                axes.iter_mut().filter(|axis| pinned(axis)).for_each(|axis| axis.values.truncate(1));
            }
        }
        if !self.vary.iter().flat_map(Group::axes).any(pinned) {
            self.set.retain(|set| set.path.value != path);
            self.set.push(set);
        }
    }
}

fn given(option: &str, text: &str) -> At<String> {
    let source = Source::new(option, text);
    At { value: text.to_owned(), span: Span { source, start: 0, end: text.len() as u32 } }
}

fn from_outside(option: &str, path: &str, value: &AxisValue, optional: bool) -> Set {
    let written = value.to_string();
    let source = Source::new(option, format!("{path}={written}"));
    let (from, to) = (path.len() as u32, (path.len() + 1 + written.len()) as u32);
    let span = |start, end| Span { source: std::sync::Arc::clone(&source), start, end };
    Set {
        path: At { value: path.to_owned(), span: span(0, from) },
        value: At { value: value.clone(), span: span(from + 1, to) },
        optional,
    }
}
