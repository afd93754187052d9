//! A use of a pass type in WGSL alone: its settings, ports, resources and steps, read from the shader.
//!
//! | in the shader | in the pipeline |
//! |---|---|
//! | a member of `struct Settings` with `[default: …]` | a setting |
//! | an `#option TAPS 9` | a setting `taps`, which selects the variant |
//! | an `#option TEXTURED`, named as a trait of the scene | nothing: the scene decides |
//! | a global `K`, or `K_member` where `in:` links `K` | the input `K` |
//! | `#import interface "K"` | the input `K`, whose producer provides the module |
//! | a global `K`, or `K_member` where `out:` names `K` | the output `K`; with `[scratch]`, nothing |
//! | a global with `[reads: K]` | nothing: what an earlier entry point has written to `K` |
//! | the entry points of the pass type's stage | the steps, in the order of the text |
//! | `camera`, `frame`, `scene_…` | nothing: they are scene bindings |

mod facts;
mod options;
mod outputs;
mod shader_pass;
mod steps;

use crate::{
    InputPort, PassTypeError, Ports, Request, SceneBindings, Setting, Settings, UseContext, scene_bindings,
};
use options::Imported;
use outputs::Written;
use shader_library::{Access, Attributes, Entry, GlobalKind, Shader, Stage};
use std::fmt::Display;
use std::sync::Arc;

pub use shader_pass::ShaderPass;

/// The file that a use names, and how a pass type runs it.
#[derive(Clone, Debug)]
struct UserShader<'a> {
    /// The file, as the use names it.
    path: &'a str,
    /// The shader that is run: the file, or one that imports it.
    request: Request,
    /// The stage of its entry points.
    stage: Stage,
}

/// A user's shader, as a pass.
#[derive(Debug)]
struct Reflected {
    shader: Arc<Shader>,
    /// The entry points of the pass type's stage, in the order of the text.
    entries: Vec<Entry>,
    attributes: Attributes,
    written: Vec<Written>,
    imported: Vec<Imported>,
}

impl Reflected {
    /// Loads the variant that `settings` select of the shader of a use. Options that `settings` do not have are at
    /// their defaults, and modules of interfaces are stand-ins: producers are not known yet.
    ///
    /// # Errors
    /// A shader that is refused, one without an entry point of the stage, attributes that cannot be read.
    fn new(
        cx: &UseContext<'_>,
        user: &UserShader<'_>,
        settings: &Settings,
    ) -> Result<Reflected, PassTypeError> {
        let path = user.path;
        let (request, imported) = options::stand_in(cx, user)?;
        let request = options::select(cx.shaders, request, settings);
        let refused = |errors| PassTypeError::new(format!("`{path}` is refused\n{errors}"));
        let shader = cx.shaders.load(&request).map_err(refused)?;
        let attributes = shader.attributes().map_err(refused)?;
        let of_stage = |entry: &&Entry| entry.stage == user.stage;
        let entries: Vec<Entry> = shader.interface.entries.iter().filter(of_stage).cloned().collect();
        if entries.is_empty() {
            let attribute = format!("@{:?}", user.stage).to_lowercase();
            return Err(PassTypeError::new(format!("`{path}` has no {attribute} entry point")));
        }
        let written = outputs::written(&shader, &attributes, &entries, cx.use_.inputs)?;
        Ok(Reflected { shader, entries, attributes, written, imported })
    }

    /// Returns the ports.
    ///
    /// # Errors
    /// Links that no global takes, globals that no link can fill, and attributes that name nothing.
    fn ports(&self, cx: &UseContext<'_>, settings: &Settings) -> Result<Ports, PassTypeError> {
        let interface = &self.shader.interface;
        let mut ports = Ports::default();
        for &global in self.entries.iter().flat_map(|entry| &entry.globals) {
            if let Some(part) = scene_bindings::of_global(&interface.globals[global].name) {
                ports.scene_bindings = ports.scene_bindings.and(part);
            }
        }
        if self.shader.files().iter().any(|file| file == scene_bindings::SAMPLE_MODULE) {
            ports.scene_bindings = ports.scene_bindings.and(SceneBindings::SAMPLE);
        }
        for port in cx.use_.inputs {
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
        for imported in self.imported.iter().filter(|imported| !cx.use_.inputs.contains(&imported.port)) {
            ports.inputs.push(imported.input());
        }
        for name in self.readable().filter(|name| covering(name, cx.use_.inputs).is_none()) {
            ports.inputs.push(self.input(name, &[name], false)?);
        }
        ports.outputs = self.output_ports(cx)?;
        self.check_steps(&ports, settings)?;
        Ok(ports)
    }

    /// Globals that a port can fill.
    fn readable(&self) -> impl Iterator<Item = &str> {
        let names = self.shader.interface.globals.iter().map(|global| global.name.as_str());
        names.filter(|name| {
            let reads = |said: &shader_library::GlobalAttributes| said.name == *name && said.reads.is_some();
            *name != "settings"
                && scene_bindings::of_global(name).is_none()
                && !self.written.iter().any(|written| written.name == *name)
                && !self.attributes.globals.iter().any(reads)
                && !self.imported.iter().any(|imported| imported.fills(name))
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
            let kind = self.shader.interface.global(name).map(|(_, global)| &global.kind);
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

/// Returns the settings of a use: the options of its shader, and what `struct Settings` declares in any variant.
///
/// # Errors
/// A shader that is refused, and declarations that cannot be read.
fn settings(cx: &UseContext<'_>, user: &UserShader<'_>) -> Result<Vec<Setting>, PassTypeError> {
    options::settings(cx, user)
}

/// The part of a global's name behind `port_`.
fn member_of<'a>(global: &'a str, port: &str) -> Option<&'a str> {
    global.strip_prefix(port)?.strip_prefix('_')
}

/// The linked port that fills a global: of `view` and `view_depth`, the longer.
fn covering<'a>(global: &str, linked: &'a [String]) -> Option<&'a String> {
    let covers = |port: &&String| global == **port || member_of(global, port).is_some();
    linked.iter().filter(covers).max_by_key(|port| port.len())
}

/// `a`, `b`, `c`
fn list(names: impl IntoIterator<Item = impl Display>) -> String {
    let names: Vec<String> = names.into_iter().map(|name| format!("`{name}`")).collect();
    if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
}
