//! The interface between a study and the renderer.

use crate::error::Failure;
use crate::external::External;
use crate::record::{AxisValue, Memory, SceneRecord};
use frame_graph::{Settable, Value};
use metrics::Image;
use metrics::temporal::Pinhole;
use metrics::virtual_lights::VirtualLight;
use std::path::PathBuf;

/// Describes the scenes and pipelines that can be studied, before anything runs. It needs no GPU.
pub trait Registry {
    /// Returns the names of the scenes, for errors that suggest the nearest one.
    fn scenes(&self) -> Vec<String>;

    /// Returns a scene by name or path.
    ///
    /// # Errors
    /// The reason why it cannot be loaded, for the user to read.
    fn scene(&self, name: &str) -> Result<SceneFacts, Failure>;

    /// Returns the names of the pipelines, without those that are only sub-graphs.
    fn pipelines(&self) -> Vec<String>;

    /// Returns a pipeline by name or path.
    ///
    /// # Errors
    /// The error, for the user to read.
    fn pipeline(&self, name: &str) -> Result<PipelineFacts, Failure>;

    /// Returns the differences between two pipelines, each with values by path: the lines of `lightloom
    /// diff`.
    fn differences(&self, first: (&str, &Values), second: (&str, &Values)) -> Vec<String>;

    /// Returns the path of the scene or pipeline that a file at `by` means by a name, where that lies in the folder of the
    /// file. The default is that nothing does.
    fn beside(&self, by: &str, name: &str) -> Option<String> {
        let _ = (by, name);
        None
    }

    /// Returns the path of the file that a name would mean if there were none at `own`, in the folder of the study: a scene
    /// (`folder` is `scenes`) or a pipeline (`pipelines`) of the roots that is another one. The default is that there is none.
    fn shadowed(&self, folder: &str, name: &str, own: &str) -> Option<String> {
        let _ = (folder, name, own);
        None
    }

    /// Returns the folders on disk in which files may be that a study names, beside its own folder and the working
    /// folder. The default is that there are none.
    fn roots(&self) -> Vec<PathBuf> {
        Vec::new()
    }
}

/// Values by path, applied in order.
pub type Values = Vec<(String, AxisValue)>;

/// The properties of a scene that a study uses.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFacts {
    /// The entry in the study's record.
    pub record: SceneRecord,
    /// Whether camera, lights or geometry move: then every frame has its own reference.
    pub moves: bool,
    /// Time from frame to frame \[s\].
    pub seconds_per_frame: f64,
    /// A distance that is negligible in the scene: a virtual light that is displaced by less counts as
    /// unmoved \[m\].
    pub small_length: f32,
}

/// The properties of a pipeline that a study uses.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PipelineFacts {
    /// A description.
    pub about: String,
    /// Its paper; empty for none.
    pub paper: String,
    /// Names of its outputs.
    pub outputs: Vec<String>,
    /// Names of its passes, including those that are switched off: `lights`, or `shadows/splat` within a
    /// sub-graph.
    pub passes: Vec<String>,
    /// Names of its figures: `pass.port.figure`.
    pub figures: Vec<String>,
    /// Everything to which values can be given.
    pub settings: Vec<Settable>,
}

impl PipelineFacts {
    /// Returns whether a study can measure a picture of that name: an output, a pass, or `pass.port`.
    pub fn has_output(&self, name: &str) -> bool {
        let pass = name.split_once('.').map_or(name, |(pass, _)| pass);
        self.outputs.iter().any(|output| output == name) || self.passes.iter().any(|known| known == pass)
    }
}

/// Returns whether something lies between two points \[m\].
pub type Occluded = Box<dyn Fn([f32; 3], [f32; 3]) -> bool + Sync>;

/// Renders cells. The implementation of the program uses a GPU; tests have their own.
pub trait Laboratory {
    /// Returns adapter and driver as text; they are part of every cell's key.
    fn adapter(&self) -> String;

    /// Returns a hash of plan, shaders, scene and version of a request, without running it: equal hashes give equal
    /// pictures.
    ///
    /// # Errors
    /// The error of the pipeline, its values or the scene, for the user to read.
    fn identity(&mut self, request: &RunRequest) -> Result<u128, Failure>;

    /// Runs a request, and passes every measured frame to `observe`, in order. A pipeline that accumulates reports its
    /// progress to `step` after each frame.
    ///
    /// # Errors
    /// The error of the device, of the pipeline or of `observe`. Other cells still run.
    fn run(
        &mut self,
        request: &RunRequest,
        observe: &mut dyn FnMut(Observed) -> Result<(), Failure>,
        step: &mut dyn FnMut(Step),
    ) -> Result<CellRun, Failure>;

    /// Runs a cell of the plan in a process of its own, which writes its record into the folder of the study; `None` where
    /// cells run in this process, as is the default.
    fn apart(&mut self, cell: usize) -> Option<Result<(), Failure>> {
        let _ = cell;
        None
    }

    /// Returns a function that tests whether something lies between two points of a scene in a frame, for the
    /// measure `lights-that-reach`.
    ///
    /// # Errors
    /// The reason why that cannot be tested.
    fn occluded(&mut self, scene: &str, frame: u32) -> Result<Occluded, Failure>;
}

/// One pipeline with its values on one scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunRequest {
    /// Name or path of the scene.
    pub scene: String,
    /// Name or path of the pipeline.
    pub pipeline: String,
    /// Values by path, applied in order.
    pub set: Values,
    /// The output that is measured.
    pub output: String,
    /// Size of frames \[px\].
    pub size: (u32, u32),
    /// Seed.
    pub seed: u32,
    /// Number of the first frame that runs, which sets the time of animations.
    pub first_frame: u32,
    /// Frames that run before the measured ones. If the pipeline has an output `progress`, the first frame is
    /// repeated before them, untimed, until `progress` says that it has converged.
    pub warm_up: u32,
    /// Number of measured frames; for a pipeline that accumulates until it has converged, the greatest
    /// number.
    pub frames: u32,
    /// Whether to time passes: if so, every pass runs in every frame.
    pub timed: bool,
    /// Whether [`Observed`] needs depth and camera.
    pub views: bool,
    /// Whether [`Observed`] needs the virtual lights.
    pub lights: bool,
    /// The figures that [`Observed`] needs: `pass.port.figure`.
    pub figures: Vec<String>,
    /// GPU time of measured frames \[ms\] after which the run stops, even before `frames`.
    pub stop_after_ms: Option<f64>,
    /// Whether to stop when the pipeline's output `progress` says that it has converged. If set, time stands
    /// still: every frame is that of `first_frame`, and only the last one is passed to `observe`.
    pub until_done: bool,
    /// The program that renders in place of a pipeline. `stop_after_ms` is then the time of each frame.
    pub external: Option<External>,
}

impl RunRequest {
    /// Formats all fields, for keys. What does not occur adds no text, so that keys from before it existed stay valid.
    pub(crate) fn text(&self) -> String {
        format!("{self:?}").replace(", external: None", "")
    }

    /// Returns pixels × frames × samples: an upper bound of how much longer a run takes than one that has less of them. 0 where
    /// a time ends it.
    pub(crate) fn work(&self) -> f64 {
        if self.stop_after_ms.is_some() {
            return 0.0;
        }
        let (width, height) = self.size;
        let frames = if self.until_done { 1 } else { self.warm_up + self.frames };
        let samples = self.set.iter().rev().find_map(|(path, value)| match value {
            AxisValue::Number(samples) if path == "samples" => Some(*samples),
            _ => None,
        });
        f64::from(width) * f64::from(height) * f64::from(frames) * samples.unwrap_or(1.0)
    }
}

/// The progress of a pipeline with an output `progress`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Steps so far: samples, iterations, whatever the pipeline counts.
    pub step: u32,
    /// The greatest number of steps.
    pub steps: u32,
    /// Its estimate of the error that is left; `None` as long as there is none.
    pub noise: Option<f64>,
}

/// One measured frame.
#[derive(Clone, Debug)]
pub struct Observed {
    /// Its number.
    pub frame: u32,
    /// The measured output.
    pub image: Image,
    /// GPU time of each pass \[ms\], in the plan's order; empty if not timed.
    pub passes: Vec<(String, f64)>,
    /// Distance along the viewing axis \[m\], if requested and the pipeline has a G-buffer.
    pub depth: Option<Image>,
    /// Unit normals, if requested and the pipeline has a G-buffer.
    pub normal: Option<Image>,
    /// The camera.
    pub camera: Pinhole,
    /// The virtual lights, if requested and the pipeline has any.
    pub lights: Option<Vec<VirtualLight>>,
    /// The requested figures; those that the pipeline has.
    pub figures: Vec<(String, f64)>,
    /// Indirect irradiance, with the luminance of what clamping removed in alpha, if the pipeline computes
    /// it.
    pub irradiance: Option<Image>,
}

impl Observed {
    /// A frame of which the picture alone is known.
    pub fn picture(frame: u32, image: Image) -> Observed {
        Observed {
            frame,
            image,
            passes: Vec::new(),
            depth: None,
            normal: None,
            camera: Pinhole::default(),
            lights: None,
            figures: Vec::new(),
            irradiance: None,
        }
    }
}

/// The results of a run other than its frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellRun {
    /// Memory of the plan.
    pub memory: Memory,
    /// Provenance, as stored in pictures.
    pub provenance: String,
    /// Estimated relMSE of the pipeline's own picture, if it has an output `progress`.
    pub noise: Option<f64>,
    /// What the laboratory reports beside measures, for the record.
    pub details: serde_json::Value,
}

impl AxisValue {
    /// Converts it to a value of the frame graph: an integer if it is one.
    pub fn to_value(&self) -> Value {
        match self {
            AxisValue::Bool(truth) => Value::Bool(*truth),
            AxisValue::Text(text) => Value::Text(text.clone()),
            AxisValue::Number(number) => {
                let whole = number.fract() == 0.0;
                if whole && (0.0..=f64::from(u32::MAX)).contains(number) {
                    Value::U32(*number as u32)
                } else if whole && (f64::from(i32::MIN)..0.0).contains(number) {
                    Value::I32(*number as i32)
                } else {
                    Value::F32(*number as f32)
                }
            }
        }
    }

    /// Converts a value of the frame graph. A real number becomes the shortest decimal that represents it; a
    /// vector becomes text.
    pub fn from_value(value: &Value) -> AxisValue {
        match value {
            Value::Bool(truth) => AxisValue::Bool(*truth),
            Value::U32(number) => AxisValue::Number(f64::from(*number)),
            Value::I32(number) => AxisValue::Number(f64::from(*number)),
            Value::F32(number) => AxisValue::Number(number.to_string().parse().unwrap_or(f64::from(*number))),
            Value::Text(text) => AxisValue::Text(text.clone()),
            Value::Vector(_) => AxisValue::Text(value.to_string()),
        }
    }
}
