//! From a description to a flat one: `extends`, patches, subgraphs and parameters.

mod changed;
mod diff;
mod document;
mod figures;
mod flatten;
mod interfaces;
mod json;
mod localise;
mod locate;
mod lost;
mod old;
mod ports;
mod print;
mod settable;
mod template;
mod unused;
mod variant;

pub use changed::PassChange;
pub use diff::{Difference, diff};
pub use locate::named;
pub use settable::Settable;
pub use template::template;
pub use variant::variant;

use crate::codes;
use crate::description::{Body, Description, InputDecl, OutputDecl, PassDecl, parse_file};
use crate::port::PassTypes;
pub use data_file::Files;
use data_file::{
    Diagnostic, Diagnostics, Name, Place, Setting, Source, Sources, Span, Value, nearest_of_few,
    why_unreadable,
};
use flatten::{Assignment, Resolver};
use rustc_hash::FxHashMap;
use std::path::Path;
use std::sync::Arc;

/// Command-line overrides: values given from outside the files, by `--set parameter=v`, `--set pass.setting=v`, and the
/// axes of a study.
///
/// A later one of the same path wins.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides(pub Vec<(String, Value)>);

/// A flattened description, each value with its origin.
#[derive(Clone, Debug)]
pub struct Resolved {
    pub(crate) sources: Sources,
    /// What is no error of the files.
    pub(crate) notes: Vec<Diagnostic>,
    pub(crate) about: Option<String>,
    pub(crate) paper: Option<String>,
    pub(crate) parameters: Vec<Parameter>,
    /// Parameters of each sub-graph; of a file that was flattened before, none.
    pub(crate) part_parameters: Vec<(Name, Vec<Parameter>)>,
    /// Inputs, for a sub-graph.
    pub(crate) inputs: Vec<InputDecl>,
    pub(crate) nodes: Vec<Node>,
    pub(crate) outputs: Vec<OutputDecl>,
    pub(crate) index: FxHashMap<Name, u32>,
}

/// A parameter of a flattened pipeline, as far as the file describes it.
#[derive(Clone, Debug)]
pub(crate) struct Parameter {
    /// What it may be; where the file gives no default, the default here means nothing.
    pub(crate) setting: Setting,
    /// What it is; `None` where it is what the settings are that it is handed to.
    pub(crate) value: Option<Value>,
    pub(crate) place: Place,
    /// Where it is declared.
    pub(crate) declared: Place,
    /// The parameter of the file around the sub-graph that is handed to it as it is.
    pub(crate) outer: Option<Name>,
}

/// A pass, or the border of a sub-graph.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) name: Name,
    pub(crate) place: Place,
    /// The sub-graph that it is in.
    pub(crate) parent: Option<u32>,
    pub(crate) decl: Arc<PassDecl>,
}

/// The name of the sources of [`Overrides`].
const GIVEN: &str = "--set";

/// Flattens the pipeline at `path`.
///
/// # Errors
/// All that is wrong with the file and those that it names, as far as that can be determined without the pass types.
pub fn resolve(path: &str, files: &dyn Files, overrides: &Overrides) -> Result<Resolved, Diagnostics> {
    let Some(source) = files.read(path) else {
        return Err(no_pipeline(path, files).into());
    };
    let description = parse_file(source, 0).map_err(old::explain)?;
    resolve_description(path, &description, files, overrides)
}

/// Returns the error for a name that is that of no pipeline. The name comes from outside of any file, so no place is
/// shown.
fn no_pipeline(name: &str, files: &dyn Files) -> Diagnostic {
    if let Some(why) = why_unreadable(Path::new(name)) {
        return Diagnostic::new(&codes::NO_FILE, format!("the pipeline `{name}` cannot be read: {why}"));
    }
    let error = Diagnostic::new(&codes::NO_FILE, format!("there is no pipeline `{name}`"));
    let stem = |path: &str| path.strip_suffix(".ron").unwrap_or(path).to_owned();
    // Sub-graphs, which are in folders, are used by pipelines alone.
    let whole: Vec<String> =
        files.list().iter().map(|path| stem(path)).filter(|name| !name.contains('/')).collect();
    let near = nearest_of_few(&stem(name), whole.iter().map(String::as_str));
    let error = match near {
        Some(near) => error.note(format!("did you mean `{near}`?")),
        None => error,
    };
    error.note("`lightloom pipelines` lists all; a file is named by its path, with `.ron`")
}

/// Flattens a description that has been parsed from the file at `path`.
///
/// # Errors
/// As [`resolve`].
pub fn resolve_description(
    path: &str,
    description: &Description,
    files: &dyn Files,
    overrides: &Overrides,
) -> Result<Resolved, Diagnostics> {
    let mut resolver = Resolver::new(files, Arc::clone(&description.source));
    let given = overrides.0.iter().map(|(path, value)| {
        let text = format!("{path}={value}");
        let file = resolver.sources.add(Source::new(GIVEN, text));
        Assignment::given(path, value.clone(), file)
    });
    let given = given.collect();
    // By the name of its source, as those that it names.
    let path = if description.source.name.ends_with(".ron") { &*description.source.name } else { path };
    let document = resolver.document(path, description);
    resolver.pipeline(path, document, given).map_err(old::explain)
}

impl Resolved {
    /// Returns what it renders, in one line.
    pub fn about(&self) -> Option<&str> {
        self.about.as_deref()
    }

    /// Returns the paper and section that it renders.
    pub fn paper(&self) -> Option<&str> {
        self.paper.as_deref()
    }

    /// Returns the place of a pass, by its name in the flattened pipeline, in the file that says it.
    pub fn pass_span(&self, name: &str) -> Option<Span> {
        let node = &self.nodes[*self.index.get(name)? as usize];
        Some(self.sources.span(node.place))
    }

    /// Returns the names and pass types of all passes, in the order of the file.
    pub fn passes(&self) -> impl Iterator<Item = (&Name, &Name)> {
        self.nodes.iter().filter_map(|node| match &node.decl.body {
            Body::Pass { kind, .. } => Some((&node.name, &kind.value)),
            Body::Sub(_) | Body::Group(_) | Body::Removed => None,
        })
    }

    /// Returns the name and WGSL file of each pass that has one.
    pub fn shaders(&self) -> impl Iterator<Item = (&Name, &Name)> {
        self.nodes.iter().filter_map(|node| match &node.decl.body {
            Body::Pass { shader: Some(shader), .. } => Some((&node.name, &shader.value)),
            _ => None,
        })
    }

    /// Returns the names of the outputs, in the order of the file; without those that are lost with a pass that was
    /// removed.
    pub fn outputs(&self) -> impl Iterator<Item = &Name> {
        let outputs = self.outputs.iter().filter(|output| self.removed(&output.link).is_none());
        outputs.map(|output| &output.name.value)
    }

    /// Returns whether it is a sub-graph, to be used with `Sub`: it has inputs.
    pub fn is_part(&self) -> bool {
        !self.inputs.is_empty()
    }

    /// Returns the files that it was made from: what must be watched.
    pub fn sources(&self) -> &[Arc<Source>] {
        &self.sources.0
    }

    /// Returns whether both were made from files of the same text.
    pub(crate) fn same_files(&self, other: &Resolved) -> bool {
        fn files(resolved: &Resolved) -> impl Iterator<Item = (&str, &str)> {
            let sources = resolved.sources.0.iter().map(|source| (&*source.name, &*source.text));
            sources.filter(|(name, _)| *name != GIVEN)
        }
        files(self).eq(files(other))
    }

    /// Returns the pipeline as one file, without `extends`, `patch` and parameters of sub-graphs. With `origins`, a
    /// comment with its origin stands behind each value that was inherited, patched or given from outside. Read again,
    /// the file gives the same pipeline.
    pub fn to_ron(&self, kinds: &dyn PassTypes, origins: bool) -> String {
        print::print(self, kinds, origins)
    }
}
