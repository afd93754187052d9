//! The test harness of passes: runs one pass alone on a GPU with given inputs, through the real link and compile.
//! [`ShaderUse`] tests how a pass type reads a user's WGSL.
//!
//! ```no_run
//! # let PASS: &dyn pass::Pass = todo!();
//! use pass_test::Harness;
//! let outputs = Harness::new(PASS)
//!     .set("interleave_x", 1u32)
//!     .frame(8, 8)
//!     .input("lights", "VirtualLights", &[("count", 1)], pass_test::elements(&[0u8; 64]))
//!     .scene("plane")
//!     .run();
//! let Some(outputs) = outputs else { return }; // no adapter: see the note on stderr
//! let irradiance: Vec<[f32; 4]> = outputs.read("irradiance");
//! ```

use bytemuck::{NoUninit, Pod};
use executor::{Executor, FrameOptions, Gpu};
use frame_graph::plan::{Plan, PlannedPass, ResourceId};
use frame_graph::port::OutputOverride;
use frame_graph::{InputPort, ResourceDesc, Settings, Source, Value};
use glam::DVec3;
use half::f16;
use interfaces::INTERFACES;
use interfaces::virtual_lights::{self, VirtualLight};
use pass::{Library, Pass, Use, UseContext};
use scene::Scene;
use shader_library::{DiskFiles, ShaderFiles};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

mod clusters;
pub mod frame_mean;
mod given;
mod harness;
pub mod light_tree;
mod outputs;
pub mod points;
pub mod random;
pub mod reservoirs;
pub mod rooms;
mod shader_use;
pub mod statistics;
mod surface_points;
mod test_pass;
pub mod view;
pub mod visibility;

pub use clusters::RsmTexel;
/// The causes that reset a history buffer between two frames, for [`Harness::event`].
pub use frame_graph::ResetCause;
pub use harness::Harness;
pub use outputs::{maps, outputs_of};
pub use shader_use::ShaderUse;
pub use test_pass::{TestPass, TestPassTypes};

/// The outputs of a pass.
pub struct Outputs {
    executor: Executor,
    plan: Arc<Plan>,
    /// Name of the pass, and of its pass type.
    pass: &'static str,
    /// Whether it runs compute shaders.
    dispatches: bool,
}

/// Describes a buffer of `bytes`.
pub fn buffer(bytes: u64) -> ResourceDesc {
    ResourceDesc::buffer(bytes)
}

/// A member of an input: its name, its description and its bytes.
pub type Member<'a> = (&'a str, ResourceDesc, Vec<u8>);

/// Returns the member of an input that is one buffer with these elements.
pub fn elements<T: NoUninit>(elements: &[T]) -> Vec<Member<'static>> {
    vec![member("", buffer(size_of_val(elements) as u64), elements)]
}

/// The kind of a virtual light that is infinitely far.
pub const INFINITELY_FAR: u32 = 1;

/// Returns a virtual light of 1 W.
pub fn light_at(position: DVec3, normal: DVec3) -> VirtualLight {
    let [position, normal] = [position, normal].map(|v| v.as_vec3().to_array());
    VirtualLight { position, normal, flux: [1.0; 3], ..VirtualLight::default() }
}

/// Returns a texel of a format of half floats.
pub fn halves(texel: [f64; 4]) -> [u16; 4] {
    texel.map(|x| f16::from_f64(x).to_bits())
}

/// Returns a member with this content.
pub fn member<'a, T: NoUninit>(name: &'a str, desc: ResourceDesc, content: &[T]) -> Member<'a> {
    (name, desc, bytemuck::cast_slice(content).to_vec())
}

/// Returns the one device of a test process; `None`, with a note on stderr, where there is no adapter.
pub fn gpu() -> Option<Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    GPU.get_or_init(|| match Gpu::open() {
        Ok(gpu) => Some(gpu.with_shared_pipelines()),
        Err(error) => {
            eprintln!("skipped: {error}");
            None
        }
    })
    .clone()
}

/// Returns the root of Lightloom's tree.
pub fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// Returns all WGSL of the tree.
pub fn shaders() -> Library {
    library_of(DiskFiles::new(root()))
}

fn library_of(files: impl ShaderFiles + 'static) -> Library {
    interfaces::import_from(Library::new(Arc::new(files)), INTERFACES)
}

/// Returns the WGSL of the tree that all tests of a process share, with threads in the order that a seed chooses.
fn library(order: Option<u32>) -> &'static Library {
    static LIBRARIES: Mutex<BTreeMap<Option<u32>, &'static Library>> = Mutex::new(BTreeMap::new());
    let mut libraries = LIBRARIES.lock().unwrap_or_else(PoisonError::into_inner);
    libraries.entry(order).or_insert_with(|| {
        Box::leak(Box::new(match order {
            Some(seed) => shaders().with_thread_order(seed),
            None => shaders(),
        }))
    })
}

/// Returns a context that contains only the shaders and interfaces of the tree: for functions that need the
/// layouts of structs.
pub fn use_context() -> UseContext<'static> {
    static OUTPUTS: BTreeMap<String, OutputOverride> = BTreeMap::new();
    let use_ = Use { kind: "", shader: None, inputs: &[], outputs: &OUTPUTS };
    UseContext { use_, shaders: library(None), interfaces: INTERFACES }
}

/// Returns a scene by name or path.
///
/// # Panics
/// Where it cannot be loaded.
pub fn scene(spec: &str) -> Scene {
    scene::load(spec, &SceneFolder).unwrap_or_else(|error| panic!("{error}"))
}

/// Loads a scene described in RON.
///
/// # Panics
/// Where the description is wrong.
pub fn scene_from(description: &str) -> Scene {
    scene::load("described", &Description(description)).unwrap_or_else(|error| panic!("{error}"))
}

/// Creates triangles with these corners \[m\], with the material of the scene `plane`.
pub fn soup(corners: &[[f32; 3]]) -> Scene {
    let mut soup = scene("plane");
    soup.vertices =
        corners.iter().map(|position| scene::Vertex { position: *position, ..soup.vertices[0] }).collect();
    soup.indices = (0..corners.len() as u32).collect();
    soup
}

/// Loads every variant of every shader of a pass. What it imports from an input is the stand-in of the interface of that
/// input.
///
/// # Panics
/// Where one is refused: the test fails with the message.
pub fn assert_shaders_are_valid(pass: &dyn Pass) {
    let library = shaders();
    let cx = use_context();
    let schema = pass.settings(&cx).unwrap_or_default();
    let defaults = Settings(schema.into_iter().map(|setting| (setting.name, setting.default)).collect());
    let ports = pass.ports(&cx, &defaults).unwrap_or_default();
    let module = |port: &InputPort| {
        let interface = INTERFACES.iter().find(|interface| interface.name == port.interface)?;
        Some((port.name.clone(), interface.stand_in?))
    };
    let modules: Vec<_> = ports.inputs.iter().filter_map(module).collect();
    for path in &pass.about(&library).shaders {
        let request = modules
            .iter()
            .fold(pass::request(path, &[]), |request, (port, module)| request.module(port, *module));
        let variants = library.variants(&request);
        for variant in variants.unwrap_or_else(|errors| panic!("{path}\n{errors}")) {
            library.load(&variant).unwrap_or_else(|errors| panic!("{variant:?}\n{errors}"));
        }
    }
}

/// Defines the test that every variant of the shaders of a pass is valid: see [`assert_shaders_are_valid`].
#[macro_export]
macro_rules! shaders_are_valid {
    ($pass:expr) => {
        #[test]
        fn every_variant_of_the_shaders_is_valid() {
            $crate::assert_shaders_are_valid($pass);
        }
    };
}

struct SceneFolder;

impl frame_graph::Files for SceneFolder {
    fn read(&self, path: &str) -> Option<Arc<Source>> {
        let text = std::fs::read_to_string(root().join("scenes").join(path)).ok()?;
        Some(Source::new(format!("scenes/{path}"), text))
    }

    fn list(&self) -> Vec<String> {
        Vec::new()
    }
}

impl scene::SceneFiles for SceneFolder {}

/// A description in place of files.
struct Description<'a>(&'a str);

impl frame_graph::Files for Description<'_> {
    fn read(&self, path: &str) -> Option<Arc<Source>> {
        Some(Source::new(path, self.0))
    }

    fn list(&self) -> Vec<String> {
        Vec::new()
    }
}

impl scene::SceneFiles for Description<'_> {}

impl Outputs {
    /// Finds a resource of the pass, or one that it was given.
    fn find(&self, name: &str) -> ResourceId {
        let port = name.split('.').next().unwrap_or_default();
        let own = self.plan.resource(&format!("{}.{name}", self.pass));
        own.or_else(|| self.plan.resource(&format!("given-{port}.{name}"))).unwrap_or_else(|| {
            let names: Vec<&str> =
                self.plan.resources.iter().map(|resource| resource.name.as_str()).collect();
            panic!("no resource `{name}` among {names:?}")
        })
    }

    fn planned(&self) -> &PlannedPass {
        let pass = self.plan.passes.iter().find(|pass| pass.name.as_str() == self.pass);
        pass.expect("the pass under test is in the plan")
    }

    /// Asserts that all output ports hold the bits of another run's, as far as both were written. Scratch may differ.
    fn assert_same_bits(&self, other: &Outputs) {
        let ports = self.planned().outputs.iter().filter(|port| !port.interface.is_empty());
        for (_, id) in ports.flat_map(|port| &port.members) {
            let name = &self.plan.resources[id.0 as usize].name;
            let [first, second] = [self, other].map(|outputs| {
                let bytes = outputs.executor.read(*id).unwrap_or_else(|error| panic!("{error}"));
                bytemuck::pod_collect_to_vec::<u8, u32>(&bytes)
            });
            let unwritten =
                [FrameOptions::NAN, harness::OTHER_POISON].map(|byte| u32::from_ne_bytes([byte; 4]));
            let differs = |i: &usize| first[*i] != second[*i] && [first[*i], second[*i]] != unwritten;
            let differ: Vec<usize> = (0..first.len()).filter(differs).collect();
            if let Some(&word) = differ.first() {
                panic!(
                    "`{name}` depends on the order of threads, or on what was not written: {} of {} words differ, the \
                     first at {word}: {:#010x} and {:#010x} ({} and {})",
                    differ.len(),
                    first.len(),
                    first[word],
                    second[word],
                    f32::from_bits(first[word]),
                    f32::from_bits(second[word]),
                );
            }
        }
    }

    /// Returns the elements of an output, scratch or input, by `port` or `port.member`.
    ///
    /// # Panics
    /// Where there is none of that name, or its size is no multiple of an element's.
    pub fn read<T: Pod>(&self, name: &str) -> Vec<T> {
        let bytes = self.executor.read(self.find(name)).unwrap_or_else(|error| panic!("{error}"));
        bytemuck::pod_collect_to_vec(&bytes)
    }

    /// Returns the virtual lights of a port.
    ///
    /// # Panics
    /// Where there is none of that name, or its count is more than the lights that it holds.
    pub fn lights(&self, name: &str) -> Vec<VirtualLight> {
        let lights = virtual_lights::from_bytes(&self.read(name));
        lights.unwrap_or_else(|| panic!("`{name}` holds fewer lights than its count"))
    }

    /// Returns the description of a resource.
    pub fn desc(&self, name: &str) -> &ResourceDesc {
        &self.plan.resources[self.find(name).0 as usize].desc
    }

    /// Returns a fact of an output port.
    ///
    /// # Panics
    /// Where there is none of that name.
    pub fn fact(&self, port: &str, name: &str) -> &Value {
        let found = self.planned().outputs.iter().find(|output| output.port.as_str() == port);
        let fact = found.and_then(|output| output.facts.get(name));
        fact.unwrap_or_else(|| panic!("no fact `{name}` of an output `{port}`"))
    }
}
