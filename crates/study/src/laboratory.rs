//! What a study asks of the renderer.

use crate::record::{AxisValue, Memory, SceneRecord};
use frame_graph::{Settable, Value};
use metrics::Image;
use metrics::temporal::Pinhole;
use metrics::virtual_lights::VirtualLight;
use std::collections::BTreeMap;

/// What there is to study, asked before anything runs. It needs no GPU.
pub trait Registry {
    /// Names of the scenes, for errors that offer the nearest.
    fn scenes(&self) -> Vec<String>;

    /// A scene by name or path.
    ///
    /// # Errors
    /// Why it cannot be loaded, for the user to read.
    fn scene(&self, name: &str) -> Result<SceneFacts, String>;

    /// Names of the pipelines that are no parts.
    fn pipelines(&self) -> Vec<String>;

    /// A pipeline by name or path.
    ///
    /// # Errors
    /// What is wrong with it, for the user to read.
    fn pipeline(&self, name: &str) -> Result<PipelineFacts, String>;

    /// What the second differs in from the first, each with values by path: lines of `lightloom diff`.
    fn differences(&self, first: (&str, &Values), second: (&str, &Values)) -> Vec<String>;
}

/// Values by path, applied in order.
pub type Values = Vec<(String, AxisValue)>;

/// What a study asks of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFacts {
    /// For the record.
    pub record: SceneRecord,
    /// Whether camera, lights or geometry move: then every frame has a reference of its own.
    pub moves: bool,
    /// Time from frame to frame \[s\].
    pub seconds_per_frame: f64,
    /// A length that is nothing in the scene, by which a virtual light may be elsewhere without having moved \[m\].
    pub small_length: f32,
}

/// What a study asks of a pipeline.
#[derive(Clone, Debug, PartialEq)]
pub struct PipelineFacts {
    /// What it renders.
    pub about: String,
    /// Its paper; empty for none.
    pub paper: String,
    /// Names of its outputs.
    pub outputs: Vec<String>,
    /// Names of its passes, those that are switched off too: `lights`, or `shadows/splat` within a part.
    pub passes: Vec<String>,
    /// All that values can be given to.
    pub settings: Vec<Settable>,
}

/// Whether something stands between two points \[m\].
pub type Occluded = Box<dyn Fn([f32; 3], [f32; 3]) -> bool + Sync>;

/// Renders cells. The program's own is over a GPU; tests have one of their own.
pub trait Laboratory {
    /// Adapter and driver, in words; part of every cell's key.
    fn adapter(&self) -> String;

    /// What a request depends on, without running it: its plan, shaders and scene.
    ///
    /// # Errors
    /// What is wrong with the pipeline, its values or the scene, for the user to read.
    fn identity(&mut self, request: &RunRequest) -> Result<Identity, String>;

    /// Runs a request, and hands every measured frame to `observe`, in order.
    ///
    /// # Errors
    /// What the device or the pipeline said, or what `observe` returned. Other cells go on.
    fn run(
        &mut self,
        request: &RunRequest,
        observe: &mut dyn FnMut(Observed) -> Result<(), String>,
    ) -> Result<CellRun, String>;

    /// Tells what stands between points of a scene in a frame, for the measure `lights-that-reach`.
    ///
    /// # Errors
    /// Why that cannot be told.
    fn occluded(&mut self, scene: &str, frame: u32) -> Result<Occluded, String>;
}

/// One pipeline with its values on one scene.
#[derive(Clone, Debug, PartialEq)]
pub struct RunRequest {
    /// Name or path of the scene.
    pub scene: String,
    /// Name or path of the pipeline.
    pub pipeline: String,
    /// Values by path, applied in order.
    pub set: Values,
    /// Output that is judged.
    pub output: String,
    /// Size of frames \[px\].
    pub size: (u32, u32),
    /// Seed.
    pub seed: u32,
    /// Number of the first frame that runs, which sets the time of animations.
    pub first_frame: u32,
    /// Frames that run before the measured ones, after the first frame was repeated, untimed, until the pipeline's
    /// output `progress` says that it is done, where it has one.
    pub warm_up: u32,
    /// Measured frames. For a pipeline that accumulates until it says that it is done: the most there may be.
    pub frames: u32,
    /// Whether to time passes: then every pass runs in every frame.
    pub timed: bool,
    /// Whether the sequence needs depth and camera in [`Observed`].
    pub views: bool,
    /// Whether it needs the virtual lights.
    pub lights: bool,
    /// Stops before `frames` when so much GPU time \[ms\] has gone into measured frames.
    pub stop_after_ms: Option<f64>,
    /// Stops when the pipeline's output `progress` says that it is done. Time stands still then: every frame is that
    /// of `first_frame`, and only the last is handed to `observe`.
    pub until_done: bool,
}

/// What a request depends on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Plan, shaders, scene and version: equal where the pictures are.
    pub hash: u128,
}

/// One measured frame.
#[derive(Clone, Debug)]
pub struct Observed {
    /// Its number.
    pub frame: u32,
    /// The judged output.
    pub image: Image,
    /// GPU time of each pass \[ms\], in the plan's order; empty where not timed.
    pub passes: Vec<(String, f64)>,
    /// Distance along the viewing axis \[m\], where asked for and the pipeline has a G-buffer.
    pub depth: Option<Image>,
    /// Unit normals, where asked for and the pipeline has a G-buffer.
    pub normal: Option<Image>,
    /// The camera.
    pub camera: Pinhole,
    /// The virtual lights, where asked for and the pipeline has any.
    pub lights: Option<Vec<VirtualLight>>,
    /// Indirect irradiance with the luminance of what clamping removed in alpha, where there is any.
    pub irradiance: Option<Image>,
}

/// What a run tells besides its frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellRun {
    /// Memory of the plan.
    pub memory: Memory,
    /// Provenance, as in pictures.
    pub provenance: String,
    /// Values that were in force for the parameters, for the record.
    pub parameters: BTreeMap<String, AxisValue>,
    /// Estimated relMSE of the pipeline's own picture, where it says so (output `progress`).
    pub noise: Option<f64>,
}

impl AxisValue {
    /// Converts it to a value of the frame graph: an integer where it is one.
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

    /// Converts a value of the frame graph. A real number is the shortest decimal that stands for it; a vector is text.
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
