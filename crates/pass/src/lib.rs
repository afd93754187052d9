//! Defines what a pass is. A crate under `passes/` needs this one, and `interfaces` for the types of its ports.
//!
//! A pass declares four things, each by a pure function: its settings, its ports, the resources of its outputs, and
//! the steps that write them. The steps are a plain list of dispatches and draws; an executor runs them. A shader's
//! resources are bound by name, so a pass declares no binding numbers and no layouts:
//!
//! | a global in WGSL | is bound to |
//! |---|---|
//! | `view_depth` | member `depth` of the port `view` |
//! | `irradiance` | the only resource of the port (or scratch) `irradiance` |
//! | `settings` | a uniform filled by the names of its members: see [`Step`] |
//! | `view_facts` | a uniform of the module of the port `view`, filled with the facts of the port |
//! | `camera`, `frame`, `scene_…` | the scene bindings: see [`scene_bindings`] |

pub mod codes;
pub mod declaration;
pub mod lights;
mod link;
mod record;
pub mod reflected;
pub mod scene_bindings;
mod settings;
mod split;

pub use frame_graph::{
    Clear, Content, Extent, Fact, FactDecl, FactValue, Facts, Figure, Format, InputPort, Interface,
    LightSource, Member, Module, Name, OutputContext, OutputDesc, OutputPort, PassTypeError, Ports,
    ResourceDesc, SceneBindings, Setting, Settings, Struct, Traits, Usage, Use, Value, ValueType,
};
pub use link::{
    Bound, BoundLayout, FrameValue, FrameWord, LinkedStep, LinkedSteps, PastFact, Source, UniformFill,
    layout_of, link_steps, pass_seed,
};
pub use record::{
    Compute, DepthTarget, Draw, LARGEST_WINDOW, Load, PortDesc, Raster, RecordContext, Recording, Step,
    Target, Threads, WINDOW_ALIGNMENT, request, request_of_module,
};
pub use reflected::{Exact, ExactBy, MainShader};
pub use settings::ReadSettings;
use shader_library::TypeLayout;
pub use shader_library::{Define, Library, Request};
pub use split::{most_items, split_count};
use std::ops::Deref;
use std::path::Path;
pub use wgsl_structs::files;

/// WGSL files: paths, and texts.
pub type Files = &'static [(&'static str, &'static str)];

/// The documentation of a pass type.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct About {
    /// What it computes: the first paragraph of the comment with which its main file begins.
    pub about: String,
    /// The paper and section that it implements: what stands there in brackets. Empty for none.
    pub paper: String,
    /// Its WGSL files, from the root of the tree.
    pub shaders: Vec<String>,
}

/// A pass type.
///
/// It holds no state, names no other pass, reads no global and never waits for the GPU. What it keeps from one frame to
/// the next goes through `prev` links of the pipeline.
///
/// Its WGSL declares it: see [`reflected`]. A pass type implements only the methods for what WGSL cannot say, and may call
/// the functions of [`reflected`] there.
pub trait Pass: Send + Sync {
    /// Returns the name in RON, in kebab-case; also the name of the folder.
    fn kind(&self) -> &'static str;

    /// Returns whether a use names a WGSL file with `shader:`.
    fn takes_shader(&self) -> bool {
        false
    }

    /// Returns the folder of its WGSL, from the root of the tree.
    fn folder(&self) -> String {
        format!("passes/{}", self.kind())
    }

    /// Returns the WGSL that the program carries with it, as paths in the folder with their texts: [`files!`]. What lies in the
    /// folder on disk takes precedence.
    fn files(&self) -> Files {
        &[]
    }

    /// Returns the shader that declares a use: `KIND.wgsl` of the folder.
    ///
    /// # Errors
    /// Where the use has to name one, and does not.
    fn main_shader(&self, _: &Use<'_>) -> Result<MainShader, PassTypeError> {
        Ok(MainShader::in_folder(self.folder(), self.kind()))
    }

    /// Returns the documentation.
    fn about(&self, library: &Library) -> About {
        let files = library.folder(&self.folder());
        let main = format!("{}/{}.wgsl", self.folder(), self.kind());
        let header = files.iter().find(|file| file.path == main);
        About {
            about: header.map_or_else(String::new, |header| header.about.clone()),
            paper: header.map_or_else(String::new, |header| header.paper.clone()),
            shaders: files.iter().map(|file| file.path.clone()).collect(),
        }
    }

    /// Returns its settings. Only a pass type that takes a shader reads the use.
    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        reflected::settings(cx, &self.main_shader(&cx.use_)?)
    }

    /// Returns its ports, which depend on the settings and on which inputs are linked.
    fn ports(&self, cx: &UseContext<'_>, settings: &Settings) -> Result<Ports, PassTypeError> {
        reflected::ports(cx, &self.main_shader(&cx.use_)?, settings)
    }

    /// Describes the resources of its outputs, and scratch.
    fn outputs(
        &self,
        cx: &UseContext<'_>,
        outputs: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        reflected::outputs(cx, &self.main_shader(&cx.use_)?, outputs)
    }

    /// Returns what a use with these settings approximates, with what is exact in its place.
    fn exact(&self, cx: &UseContext<'_>, settings: &Settings) -> Result<Vec<Exact>, PassTypeError> {
        reflected::exact(cx, &self.main_shader(&cx.use_)?, settings)
    }

    /// Returns the interfaces that the pass adds to those of the tree: for the ports of passes outside it.
    fn interfaces(&self) -> &'static [Interface] {
        &[]
    }

    /// Returns the steps that write the outputs.
    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        reflected::record(cx)
    }
}

/// Declares the pass type of a crate that its WGSL declares: `PASS`, named as the package without `lightloom-`. Functions of the names `outputs` and
/// `record`, which it may list, say in Rust what WGSL cannot: see [`FromWgsl`].
#[macro_export]
macro_rules! from_wgsl {
    ($($function:ident),*) => {
        /// The pass type, as its WGSL declares it.
        pub const PASS: &dyn $crate::Pass = &$crate::FromWgsl {
            $($function,)*
            files: $crate::files!(),
            ..$crate::FromWgsl::new(env!("CARGO_PKG_NAME"), file!())
        };
    };
}

/// A pass type that its WGSL declares: see [`from_wgsl`].
#[derive(Clone, Copy, Debug)]
pub struct FromWgsl {
    /// The name in RON; `lightloom-` before it is left out.
    pub package: &'static str,
    /// The folder of its WGSL, or the Rust file of the pass in it: `FOLDER/src/lib.rs`. Where that is no path in a tree, as in a
    /// package from a registry, the folder is `passes/KIND`.
    pub file: &'static str,
    /// The WGSL that the program carries with it.
    pub files: Files,
    /// Describes the outputs, and scratch: those of the WGSL, or more.
    pub outputs: fn(&Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError>,
    /// Returns the steps.
    pub record: fn(&RecordContext<'_>) -> Result<Recording, PassTypeError>,
}

impl FromWgsl {
    /// Creates a pass type of which the WGSL says everything.
    pub const fn new(package: &'static str, file: &'static str) -> FromWgsl {
        FromWgsl { package, file, files: &[], outputs: |cx| cx.declared(), record: reflected::record }
    }
}

impl Pass for FromWgsl {
    fn kind(&self) -> &'static str {
        self.package.strip_prefix("lightloom-").unwrap_or(self.package)
    }

    fn folder(&self) -> String {
        let file = self.file.replace('\\', "/");
        if Path::new(self.file).is_absolute() || file == "src/lib.rs" {
            return format!("passes/{}", self.kind());
        }
        file.trim_end_matches("/src/lib.rs").to_owned()
    }

    fn files(&self) -> Files {
        self.files
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        (self.outputs)(&Outputs { use_cx: *use_cx, cx, main: self.main_shader(&cx.use_)? })
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        (self.record)(cx)
    }
}

/// The context in which a pass type that its WGSL declares describes its outputs.
pub struct Outputs<'a> {
    /// The use, and what it may depend on.
    pub use_cx: UseContext<'a>,
    cx: &'a OutputContext<'a>,
    main: MainShader,
}

impl Outputs<'_> {
    /// Returns the outputs and scratch that the WGSL declares.
    ///
    /// # Errors
    /// As [`reflected::outputs`].
    pub fn declared(&self) -> Result<Vec<OutputDesc>, PassTypeError> {
        self.declared_with(&[])
    }

    /// Returns the same, where directives and attributes also name `values` that Rust computes.
    ///
    /// # Errors
    /// As [`reflected::outputs_with`].
    pub fn declared_with(&self, values: &[(&str, Value)]) -> Result<Vec<OutputDesc>, PassTypeError> {
        reflected::outputs_with(&self.use_cx, &self.main, self.cx, values)
    }

    /// Describes scratch that is a buffer of a struct: see [`UseContext::buffer`].
    ///
    /// # Errors
    /// As [`UseContext::buffer`].
    pub fn scratch(&self, name: &str, structure: Struct, elements: u32) -> Result<OutputDesc, PassTypeError> {
        Ok(OutputDesc::scratch(name, self.use_cx.buffer(structure, elements.into())?))
    }
}

impl<'a> Deref for Outputs<'a> {
    type Target = OutputContext<'a>;

    fn deref(&self) -> &OutputContext<'a> {
        self.cx
    }
}

/// One use of a pass type in a pipeline, and the shaders from which a pass type that takes one derives its ports.
#[derive(Clone, Copy)]
pub struct UseContext<'a> {
    /// The use.
    pub use_: Use<'a>,
    /// All WGSL.
    pub shaders: &'a Library,
    /// All interfaces.
    pub interfaces: &'a [Interface],
}

impl UseContext<'_> {
    /// Describes a buffer of a struct: with `elements` elements in the array of no fixed size that ends the struct, or,
    /// of a struct of fixed size, with as many structs one after the other. The layout is that of the WGSL.
    ///
    /// # Errors
    /// Where the file of the struct is refused, or has no such struct.
    pub fn buffer(&self, structure: Struct, elements: u64) -> Result<ResourceDesc<Extent>, PassTypeError> {
        Ok(ResourceDesc::buffer(self.content(structure)?.bytes(elements)))
    }

    /// Returns the size of a struct of fixed size in bytes, by the layout of the WGSL.
    ///
    /// # Errors
    /// As [`UseContext::buffer`].
    pub fn size_of(&self, structure: Struct) -> Result<u64, PassTypeError> {
        Ok(self.content(structure)?.bytes(1))
    }

    fn content(&self, structure: Struct) -> Result<TypeLayout, PassTypeError> {
        let content = self.shaders.content(structure.file, structure.name);
        content.map_err(|errors| PassTypeError::new(errors.to_string()))
    }

    /// Returns a `const` of the type u32 that a WGSL file declares or imports.
    ///
    /// # Errors
    /// Where the file is refused with its options at their defaults, or has no such constant.
    pub fn constant(&self, file: &str, name: &str) -> Result<u32, PassTypeError> {
        self.shaders.constant(file, name).map_err(|errors| PassTypeError::new(errors.to_string()))
    }
}

/// Declares an input port that must be linked.
pub fn input(name: &str, interface: &str, doc: &str) -> InputPort {
    InputPort { name: name.into(), interface: interface.into(), optional: false, doc: doc.into() }
}

/// Declares an input port that may be left unlinked.
pub fn optional(name: &str, interface: &str, doc: &str) -> InputPort {
    InputPort { optional: true, ..input(name, interface, doc) }
}

/// Declares an output port.
pub fn output(name: &str, interface: &str, doc: &str) -> OutputPort {
    OutputPort { name: name.into(), interface: interface.into(), doc: doc.into() }
}
