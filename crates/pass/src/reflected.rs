//! A use of a pass type as its WGSL declares it: settings, ports, resources and steps, read from the shader.
//!
//! | in the shader | in the pipeline |
//! |---|---|
//! | `#input view: GBuffer` | the input `view`, whose members the globals `view_depth`, … read |
//! | `#output lights: VirtualLights(count: settings.count)` | the output `lights`, with its sizes and facts |
//! | a member of `struct Settings` with `[default: …]` | a setting |
//! | an `#option TAPS 9` | a setting `taps`, which selects the variant |
//! | an `#option PAST`, named as a port | nothing: whether the input is linked, the output is read |
//! | an `#option VIEW_SPECULAR`, named as a port and a member | nothing: whether the input has the member |
//! | an `#option TEXTURED`, named as a trait of the scene | nothing: the scene decides |
//! | an `#option GRID false internal` | nothing: the pass decides |
//! | `#lights` | the setting `lights`: names of the lights of the scene that the pass takes, the others being dark to it |
//! | `#exact maps: pass visibility-ray-traced` | nothing: what `lightloom blame` puts in the place of the approximation `maps` |
//! | a global with `[scratch]` | nothing: the entry points share it |
//! | a global with `[reads: K]` | nothing: what an earlier entry point has written to `K` |
//! | the entry points | the steps, in the order of the text |
//! | `camera`, `frame`, `scene_…` | nothing: they are scene bindings |
//!
//! The files of users may leave ports undeclared: a global `K`, or `K_member`, is the input `K` where `in:` links `K`, the
//! module of `#import interface "K"` is the input `K`, and what is written is an output.

mod checks;
mod exact;
mod facts;
mod options;
mod outputs;
mod scope;
mod shader_pass;
mod steps;
mod written;

use crate::link::{SAMPLE, SEED};
use crate::{
    InputPort, OutputContext, OutputDesc, PassTypeError, Ports, RecordContext, Recording, Request,
    SceneBindings, Setting, Settings, Traits, UseContext, Value, scene_bindings,
};
use options::Imported;
pub(crate) use options::Known;
use shader_library::{Access, Attributes, Entry, GlobalKind, Outline, Shader, Stage};
use std::fmt::Display;
use std::sync::Arc;
use written::Written;

pub use exact::{Exact, ExactBy, exact};
pub use shader_pass::ShaderPass;

/// The shader that declares what a use of a pass type is.
#[derive(Clone, Debug)]
pub struct MainShader {
    /// The file, for errors.
    pub path: String,
    /// The shader that is loaded: the file, or one that imports it.
    pub request: Request,
    /// The stage of the entry points that are run; `None` for all but those of vertices.
    pub stage: Option<Stage>,
    /// The folder all of whose files belong to the pass type; `None` for the file of a user.
    pub folder: Option<String>,
}

impl MainShader {
    /// Returns the main file of a folder of WGSL: `KIND.wgsl`.
    pub fn in_folder(folder: String, kind: &str) -> MainShader {
        let path = format!("{folder}/{kind}.wgsl");
        MainShader { request: Request::new(path.clone()), path, stage: None, folder: Some(folder) }
    }

    fn refused(&self, errors: impl Display) -> PassTypeError {
        PassTypeError::new(format!("`{}` is refused\n{errors}", self.path))
    }
}

/// A shader of a pass with its attributes.
#[derive(Debug)]
struct Loaded {
    shader: Arc<Shader>,
    attributes: Arc<Attributes>,
}

/// The shaders of a use of a pass type, in one variant.
#[derive(Debug)]
struct Reflected {
    main: MainShader,
    /// The declarations of the main shader.
    outline: Arc<Outline>,
    /// The main shader, then those of its folder that have entry points.
    files: Vec<Loaded>,
    /// The entry points of the main shader that are run, in the order of the text.
    entries: Vec<Entry>,
    written: Vec<Written>,
    imported: Vec<Imported>,
    /// The scene bindings of all entry points, in this variant and in that of a scene with all traits.
    scene_bindings: SceneBindings,
}

/// Returns the shader of a file by itself, with a stand-in for each interface whose module it imports; `main` is the main
/// file of its folder, which declares the ports.
///
/// # Errors
/// A file that cannot be composed, and an interface that has no modules.
pub fn by_itself(
    shaders: &crate::Library,
    interfaces: &[crate::Interface],
    path: &str,
    main: &str,
) -> Result<Request, PassTypeError> {
    let outputs = std::collections::BTreeMap::new();
    let use_ = frame_graph::Use { kind: "", shader: None, inputs: &[], outputs: &outputs };
    let cx = UseContext { use_, shaders, interfaces };
    let main = MainShader { path: main.to_owned(), request: Request::new(main), stage: None, folder: None };
    let declared = options::declared(&cx, &main)?;
    options::stand_in(&cx, &main, &Request::new(path), &declared).map(|(request, _)| request)
}

/// Returns the settings of a use: the options of its shaders, and what `struct Settings` declares in any variant.
///
/// # Errors
/// A shader that is refused, and declarations that cannot be read.
pub fn settings(cx: &UseContext<'_>, main: &MainShader) -> Result<Vec<Setting>, PassTypeError> {
    match &main.folder {
        Some(folder) => options::settings_of_folder(cx, main, folder),
        None => options::settings_of_file(cx, main),
    }
}

/// Returns the ports of a use.
///
/// # Errors
/// Shaders that are refused, links that no global takes, globals that no link can fill, and attributes that name nothing.
pub fn ports(cx: &UseContext<'_>, main: &MainShader, settings: &Settings) -> Result<Ports, PassTypeError> {
    let known = Known {
        settings,
        traits: None,
        linked: &|port| cx.use_.inputs.iter().any(|input| input == port),
        read: &|_| true,
        member: &|_, _| None,
        of_module: &|_| None,
    };
    Reflected::new(cx, main, &known)?.ports(cx, settings)
}

/// Returns the resources of the outputs of a use, and of scratch.
///
/// # Errors
/// As [`ports`]; formats that do not fit, and sizes that nothing gives.
pub fn outputs(
    cx: &UseContext<'_>,
    main: &MainShader,
    outputs: &OutputContext<'_>,
) -> Result<Vec<OutputDesc>, PassTypeError> {
    outputs_with(cx, main, outputs, &[])
}

/// Returns the same, where directives and attributes also name `values` that Rust computes. A setting of the same name
/// goes before such a value.
///
/// # Errors
/// As [`outputs`].
pub fn outputs_with(
    cx: &UseContext<'_>,
    main: &MainShader,
    outputs: &OutputContext<'_>,
    values: &[(&str, Value)],
) -> Result<Vec<OutputDesc>, PassTypeError> {
    crate::lights::check(outputs.settings, outputs.traits)?;
    with_known(outputs, |known| Reflected::new(cx, main, &known.of(main)))?.outputs(cx, outputs, values)
}

/// The help for a name that is not known: the nearest of those that are, or all of them.
fn instead<'a>(name: &str, all: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    match frame_graph::nearest(name, known.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None if known.is_empty() => format!("{all} none"),
        None => format!("{all} {}", list(known)),
    }
}

/// Calls `f` with what is known when outputs are described. All outputs count as read.
fn with_known<T>(cx: &OutputContext<'_>, f: impl FnOnce(&Known<'_>) -> T) -> T {
    f(&Known {
        settings: cx.settings,
        traits: Some(cx.traits),
        linked: &|port| cx.input(port).is_some(),
        read: &|_| true,
        member: &|port, member| Some(cx.input(port)?.member(member).is_some()),
        of_module: &|_| None,
    })
}

/// Returns the steps of a use: the entry points of the main shader in order, each as often as it says.
///
/// # Errors
/// As [`outputs`], and numbers of threads that nothing gives.
pub fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let Some(main) = cx.main else { return Err(PassTypeError::new("the pass type has no main shader")) };
    cx.with_known(|known| Reflected::new(&cx.use_context(), main, &known.of(main)))?.record(cx)
}

impl Reflected {
    /// Loads the variant that `known` selects of the shaders of a use. Other options are at their defaults, and modules of
    /// interfaces are stand-ins: producers are not known yet.
    ///
    /// # Errors
    /// A shader that is refused, one of a user without an entry point of the stage, attributes that cannot be read.
    fn new(cx: &UseContext<'_>, main: &MainShader, known: &Known<'_>) -> Result<Reflected, PassTypeError> {
        let library = cx.shaders;
        let declared = options::declared(cx, main)?;
        let (request, imported) = options::stand_in(cx, main, &main.request, &declared)?;
        let mut scene_bindings = SceneBindings::NONE;
        let all_traits =
            scene_bindings::TRAITS.iter().map(|name| ((*name).to_owned(), Value::Bool(true))).collect();
        let all_traits = Traits::new(all_traits);
        let of_any_scene = Known { traits: Some(&all_traits), ..*known };
        let mut load = |request: Request| {
            let selected = known.select(library, request.clone(), &declared);
            let shader = library.load(&selected).map_err(|errors| main.refused(errors))?;
            let attributes = shader.attributes().map_err(|errors| main.refused(errors))?;
            scene_bindings = scene_bindings.and(of_entries(&shader, main.stage));
            if attributes.entries.iter().any(|entry| entry.sampled) {
                scene_bindings = scene_bindings.and(SceneBindings::SAMPLE);
            }
            let largest = of_any_scene.select(library, request, &declared);
            if largest != selected
                && let Ok(shader) = library.load(&largest)
            {
                scene_bindings = scene_bindings.and(of_entries(&shader, main.stage));
            }
            Ok::<_, PassTypeError>(Loaded { shader, attributes })
        };
        let mut files = vec![load(request)?];
        for other in options::others(cx, main, &declared)? {
            files.push(load(other)?);
        }
        let shader = &files[0].shader;
        let of_stage = |entry: &&Entry| is_run(entry, main.stage);
        let entries: Vec<Entry> = shader.interface.entries.iter().filter(of_stage).cloned().collect();
        if entries.is_empty() && main.folder.is_none() {
            let attribute =
                main.stage.map_or_else(String::new, |stage| format!("@{stage:?} ").to_lowercase());
            return Err(PassTypeError::new(format!("`{}` has no {attribute}entry point", main.path)));
        }
        let outline = known.outline(library, &main.request, &declared).unwrap_or(declared);
        let of_user = if main.folder.is_none() { cx.use_.inputs } else { &[] };
        let inputs: Vec<&String> = outline.inputs.iter().map(|input| &input.name).chain(of_user).collect();
        let mut written: Vec<Written> = Vec::new();
        for (index, file) in files.iter().enumerate() {
            let entries = if index == 0 { &entries[..] } else { &[] };
            let is_users = main.folder.is_none();
            for one in written::written(&file.shader, &file.attributes, entries, &inputs, is_users)? {
                match written.iter_mut().find(|known| known.name == one.name) {
                    Some(known) => known.merge(one),
                    None => written.push(one),
                }
            }
        }
        let main = main.clone();
        Ok(Reflected { main, outline, files, entries, written, imported, scene_bindings })
    }

    /// Whether the main file is that of a user.
    fn is_users(&self) -> bool {
        self.main.folder.is_none()
    }

    fn shader(&self) -> &Shader {
        &self.files[0].shader
    }

    fn attributes(&self) -> &Attributes {
        &self.files[0].attributes
    }

    /// Returns the ports.
    fn ports(&self, cx: &UseContext<'_>, settings: &Settings) -> Result<Ports, PassTypeError> {
        let mut ports = Ports { scene_bindings: self.scene_bindings, ..Ports::default() };
        ports.inputs.extend(self.outline.inputs.iter().map(|declared| InputPort {
            name: declared.name.clone(),
            interface: declared.interface.clone(),
            optional: declared.optional,
            doc: declared.doc.clone(),
        }));
        if self.is_users() {
            self.add_undeclared(cx, &mut ports)?;
        }
        ports.outputs = self.output_ports(cx)?;
        self.check_steps(&ports, settings)?;
        Ok(ports)
    }

    /// Adds the inputs that a user's file does not declare.
    fn add_undeclared(&self, cx: &UseContext<'_>, ports: &mut Ports) -> Result<(), PassTypeError> {
        let is_declared = |port: &str| self.outline.inputs.iter().any(|declared| declared.name == port);
        let linked: Vec<&String> = cx.use_.inputs.iter().filter(|port| !is_declared(port)).collect();
        for port in linked {
            if let Some(imported) = self.imported.iter().find(|imported| imported.port == *port) {
                ports.inputs.push(imported.input());
                continue;
            }
            let globals: Vec<&str> =
                self.readable().filter(|name| covering(name, cx.use_.inputs) == Some(port)).collect();
            if globals.is_empty() {
                let message =
                    format!("the shader has no global `{port}` and none that begins with `{port}_`");
                let others = self.readable().collect::<Vec<_>>();
                let help = if others.is_empty() {
                    "it has no global that a link can fill".to_owned()
                } else {
                    format!("it has {}", list(others))
                };
                return Err(PassTypeError::input(port, message).help(help));
            }
            ports.inputs.push(self.input(port, &globals, true)?);
        }
        let unlinked = self
            .imported
            .iter()
            .filter(|imported| !is_declared(&imported.port) && !cx.use_.inputs.contains(&imported.port));
        ports.inputs.extend(unlinked.map(Imported::input));
        for name in self.readable().filter(|name| covering(name, cx.use_.inputs).is_none()) {
            ports.inputs.push(self.input(name, &[name], false)?);
        }
        Ok(())
    }

    /// Globals that an undeclared port can fill.
    fn readable(&self) -> impl Iterator<Item = &str> {
        let names = self.shader().interface.globals.iter().map(|global| global.name.as_str());
        names.filter(|name| {
            let reads = |said: &shader_library::GlobalAttributes| said.name == *name && said.reads.is_some();
            let declared = |input: &shader_library::DeclaredPort| begins(name, &input.name);
            *name != "settings"
                && scene_bindings::of_global(name).is_none()
                && !self.written.iter().any(|written| written.name == *name)
                && !self.attributes().globals.iter().any(reads)
                && !self.imported.iter().any(|imported| imported.fills(name))
                && !self.outline.inputs.iter().any(declared)
        })
    }

    /// The port that fills these globals.
    fn input(&self, port: &str, globals: &[&str], linked: bool) -> Result<InputPort, PassTypeError> {
        let mut interface = "Any";
        for &name in globals {
            let refused = |message: String, help: &str| {
                let error =
                    if linked { PassTypeError::input(port, message) } else { PassTypeError::new(message) };
                Err(error.help(help))
            };
            let kind = self.shader().interface.global(name).map(|(_, global)| &global.kind);
            let sort = match kind {
                Some(
                    GlobalKind::Texture { .. } | GlobalKind::StorageTexture { access: Access::Read, .. },
                ) => "Texture",
                Some(GlobalKind::Storage { writable: false, .. }) => "Buffer",
                Some(GlobalKind::Sampler { .. }) => {
                    let help = "there are `linear_sampler` and `nearest_sampler`; else read by `textureLoad`";
                    return refused(format!("`{name}` is a sampler, which cannot be linked"), help);
                }
                Some(GlobalKind::Uniform { .. }) => {
                    let help =
                        "numbers are members of `struct Settings`, in `var<uniform> settings: Settings`";
                    return refused(format!("`{name}` is a uniform, which cannot be linked"), help);
                }
                Some(GlobalKind::AccelerationStructure) => {
                    let message = format!("`{name}` is an acceleration structure, which cannot be linked");
                    return refused(message, "there is `scene_acceleration`");
                }
                _ => {
                    let message = format!("`{name}` is written by the shader, and inputs are only read");
                    return refused(message, "write another global; it becomes an output");
                }
            };
            if name == port && globals.len() == 1 {
                interface = sort;
            }
        }
        let doc = format!("Read as {}.", list(globals));
        Ok(InputPort { name: port.into(), interface: interface.into(), optional: false, doc })
    }
}

/// Whether an entry point is run by a pass of that stage.
fn is_run(entry: &Entry, stage: Option<Stage>) -> bool {
    stage.map_or(entry.stage != Stage::Vertex, |stage| entry.stage == stage)
}

/// The scene bindings that the entry points of a shader read.
fn of_entries(shader: &Shader, stage: Option<Stage>) -> SceneBindings {
    let interface = &shader.interface;
    let run = interface.entries.iter().filter(|entry| stage.is_none() || is_run(entry, stage));
    let read = run.flat_map(|entry| &entry.globals).map(|&global| &interface.globals[global]);
    let bindings = read.filter_map(|global| match &global.kind {
        GlobalKind::Uniform { layout }
            if [SEED, SAMPLE].iter().any(|name| interface.member(&layout.ty, name).is_some()) =>
        {
            Some(SceneBindings::SEED)
        }
        _ => scene_bindings::of_global(&global.name),
    });
    bindings.fold(SceneBindings::NONE, SceneBindings::and)
}

/// The part of a global's name behind `port_`.
fn member_of<'a>(global: &'a str, port: &str) -> Option<&'a str> {
    global.strip_prefix(port)?.strip_prefix('_')
}

/// Whether a global has the name of a port, or that of a member of it.
fn begins(global: &str, port: &str) -> bool {
    global == port || member_of(global, port).is_some()
}

/// The linked port that fills a global: of `view` and `view_depth`, the longer.
fn covering<'a>(global: &str, linked: &'a [String]) -> Option<&'a String> {
    linked.iter().filter(|port| begins(global, port)).max_by_key(|port| port.len())
}

/// `a`, `b`, `c`
fn list(names: impl IntoIterator<Item = impl Display>) -> String {
    let names: Vec<String> = names.into_iter().map(|name| format!("`{name}`")).collect();
    if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
}
