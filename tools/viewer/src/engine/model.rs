//! The commands that the interface sends to the engine, and the state that the engine publishes.

use super::jobs::Job;
use super::measure::{Measured, Measures};
use super::statistics::PassTimes;
use eframe::egui::ColorImage;
use frame_graph::resolve::Settable;
use frame_graph::{Overrides, Plan, ResourceDesc, Value};
use interfaces::virtual_lights::VirtualLight;
use metrics::Image;
use pass::LinkedSteps;
use renderer::Progress;
use scene::{Camera, Light};
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Instant;

/// One of the pipelines that render the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum SideId {
    /// The pipeline that is being worked on.
    A,
    /// The one that it is compared with.
    B,
    /// The reference that converges while nothing moves.
    Reference,
}

impl SideId {
    /// Returns the name in the interface.
    pub(crate) fn name(self) -> &'static str {
        match self {
            SideId::A => "A",
            SideId::B => "B",
            SideId::Reference => "reference",
        }
    }
}

/// Something that the engine is to do.
#[derive(Clone, Debug)]
pub(crate) enum Command {
    /// Renders by a pipeline, with values for its parameters and settings.
    Pipeline(SideId, String, Overrides),
    /// Ends a side; A stays.
    Close(SideId),
    /// Renders another scene.
    Scene(String),
    /// Sets the value of a parameter or setting.
    Value(SideId, String, Value),
    /// Takes a value back to what the pipeline's files say.
    Reset(SideId, String),
    /// Replaces the scene's camera; `None` restores it. A cut says that it jumps.
    Camera(Option<Camera>, bool),
    /// Replaces the scene's lights; `None` restores them.
    Lights(Option<Vec<Light>>),
    /// Lets the time of animations run, or stops it.
    Play(bool),
    /// Sets the time of animations \[s\].
    Time(f32),
    /// Sets the size of the frame in pixels.
    Size((u32, u32)),
    /// Reads a resource back in every frame; `None` for none.
    Look(Option<Look>),
    /// Whether the virtual lights of side A are read back.
    VirtualLights(bool),
    /// Sets the measures that are computed.
    Measure(Measures),
    /// Whether each pass is timed.
    Timing(bool),
    /// Whether every pass of A and B runs in every frame, also where nothing changes: for measurements.
    RunEverything(bool),
    /// Forgets the times so far.
    ForgetTimes,
    /// Writes something into a file, or sends it.
    Job(Job),
    /// Ends the session.
    Quit,
}

/// A resource to look at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Look {
    /// The side of the resource.
    pub(crate) side: SideId,
    /// An output of the pipeline, or `pass`, `pass.port`, `pass.member`.
    pub(crate) name: String,
    /// Layer of an array.
    pub(crate) layer: u32,
}

/// The content of a resource.
#[derive(Clone, Debug)]
pub(crate) struct Looked {
    /// The request.
    pub(crate) look: Look,
    /// The full name of the resource.
    pub(crate) resource: String,
    /// Its description.
    pub(crate) desc: ResourceDesc,
    /// The layer as a picture; `None` for a buffer.
    pub(crate) picture: Option<Arc<Image>>,
    /// The bytes of a buffer; empty for a texture.
    pub(crate) bytes: Arc<Vec<u8>>,
    /// The number of the frame.
    pub(crate) frame: u64,
}

impl Command {
    /// Whether it moves or adjusts something, as a hand does that goes on with it.
    pub(crate) fn moves(&self) -> bool {
        matches!(
            self,
            Command::Value(..)
                | Command::Reset(..)
                | Command::Camera(..)
                | Command::Lights(_)
                | Command::Play(_)
                | Command::Time(_)
        )
    }

    /// Whether this command makes `earlier` pointless, where both came since the last frame: of the places of a slider only
    /// the last counts.
    pub(crate) fn supersedes(&self, earlier: &Command) -> bool {
        match (self, earlier) {
            (Command::Value(side, path, _), Command::Value(other_side, other, _)) => {
                side == other_side && path == other
            }
            (Command::Lights(_), Command::Lights(_))
            | (Command::Time(_), Command::Time(_))
            | (Command::Size(_), Command::Size(_))
            | (Command::Look(_), Command::Look(_))
            | (Command::Measure(_), Command::Measure(_)) => true,
            // A jump is not forgotten.
            (Command::Camera(..), Command::Camera(_, cut)) => !cut,
            _ => false,
        }
    }
}

/// Something that is wrong, until it is mended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Trouble {
    /// Its subject: `A`, `B`, `reference`, `scene`.
    pub(crate) of: &'static str,
    /// The text, of several lines.
    pub(crate) text: String,
    /// Until when it is shown, where there is nothing to mend: a value that was refused. `None` until it is mended.
    pub(crate) until: Option<Instant>,
}

impl Trouble {
    /// Returns whether it is to be shown.
    pub(crate) fn stands(&self) -> bool {
        self.until.is_none_or(|until| Instant::now() < until)
    }
}

/// Something that happened.
#[derive(Clone, Debug)]
pub(crate) struct Message {
    /// The time of the message.
    pub(crate) time: Instant,
    /// One line, or an error of several.
    pub(crate) text: String,
    /// Whether it is an error.
    pub(crate) error: bool,
}

/// The scene as the interface knows it.
#[derive(Clone, Debug)]
pub(crate) struct SceneView {
    /// The scene.
    pub(crate) scene: Arc<scene::Scene>,
    /// Its file, where it has one that can be written.
    pub(crate) file: Option<std::path::PathBuf>,
}

/// A pipeline as the interface knows it.
#[derive(Clone, Debug)]
pub(crate) struct SideView {
    /// Name or path.
    pub(crate) name: String,
    /// A line about it.
    pub(crate) about: String,
    /// Values that were set.
    pub(crate) overrides: Overrides,
    /// All that can be set.
    pub(crate) settable: Arc<Vec<Settable>>,
    /// The plan.
    pub(crate) plan: Arc<Plan>,
    /// The linked steps of the plan's passes.
    pub(crate) steps: Arc<Vec<LinkedSteps>>,
    /// The picture, as it goes to the screen.
    pub(crate) picture: Option<Arc<ColorImage>>,
    /// Grows with every picture.
    pub(crate) version: u64,
    /// Number of frames since the pipeline was loaded.
    pub(crate) frames: u64,
    /// Whether each pass ran in the last frame that had something to do.
    pub(crate) ran: Vec<bool>,
    /// The times of each pass.
    pub(crate) times: Arc<Vec<PassTimes>>,
    /// The time of whole frames: from the call to pixels in memory.
    pub(crate) whole: PassTimes,
    /// The progress of a result that takes several frames.
    pub(crate) progress: Option<Progress>,
    /// Whether nothing runs, because nothing changes.
    pub(crate) idle: bool,
    /// Bytes of all objects.
    pub(crate) bytes: u64,
}

/// Something that takes long.
#[derive(Clone, Debug)]
pub(crate) struct Stage {
    text: String,
    begun: Instant,
}

impl Stage {
    /// Begins now.
    pub(crate) fn new(text: String) -> Stage {
        Stage { text, begun: Instant::now() }
    }

    /// Describes it, with its duration once that is a second.
    pub(crate) fn describe(&self) -> String {
        match self.begun.elapsed().as_secs() {
            0 => format!("{}…", self.text),
            seconds => format!("{}… {seconds} s", self.text),
        }
    }
}

/// The state that the engine has published.
#[derive(Clone, Debug, Default)]
pub(crate) struct Published {
    /// Adapter and driver.
    pub(crate) adapter: String,
    /// Whether the adapter is a processor: pictures are smaller there unless the user says otherwise.
    pub(crate) on_cpu: bool,
    /// The step that takes long at the moment.
    pub(crate) stage: Option<Stage>,
    /// Why there is no session.
    pub(crate) fatal: Option<String>,
    /// The scene.
    pub(crate) scene: Option<SceneView>,
    /// The camera of the last frame.
    pub(crate) camera: Option<Camera>,
    /// The lights of the last frame.
    pub(crate) lights: Vec<Light>,
    /// The time of animations \[s\].
    pub(crate) time: f32,
    /// Whether that runs.
    pub(crate) playing: bool,
    /// The pipelines.
    pub(crate) sides: Vec<(SideId, SideView)>,
    /// The number of commands that were carried out, or that a later one made pointless.
    pub(crate) executed: u64,
    /// The pipelines and their values after these commands, also of those that could not be loaded.
    pub(crate) settings: Vec<(SideId, String, Overrides)>,
    /// The resource that is looked at.
    pub(crate) looked: Option<Looked>,
    /// Why the resource that is asked for cannot be looked at.
    pub(crate) look_error: Option<String>,
    /// The virtual lights of side A, and whether each differs from the frame before.
    pub(crate) virtual_lights: Arc<Vec<(VirtualLight, bool)>>,
    /// The errors that are not mended yet.
    pub(crate) troubles: Vec<Trouble>,
    /// The messages, the newest last.
    pub(crate) messages: Arc<VecDeque<Message>>,
    /// The newest comparison.
    pub(crate) measured: Option<Arc<Measured>>,
    /// Frames a second, over the last second or the last two frames; 0 before there are two.
    pub(crate) frames_per_second: f32,
    /// The newest reload: from the time of the file to the picture \[ms\].
    pub(crate) reload_ms: Option<f32>,
}

/// The most messages that are kept.
const MOST_MESSAGES: usize = 500;

impl Published {
    /// Returns a side.
    pub(crate) fn side(&self, id: SideId) -> Option<&SideView> {
        self.sides.iter().find(|(known, _)| *known == id).map(|(_, side)| side)
    }

    /// Adds a message, and forgets the oldest.
    pub(crate) fn say(&mut self, text: String, error: bool) {
        let messages = Arc::make_mut(&mut self.messages);
        if messages.len() == MOST_MESSAGES {
            messages.pop_front();
        }
        messages.push_back(Message { time: Instant::now(), text, error });
    }
}
