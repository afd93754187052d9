//! A pipeline as its file says it, with the place of every value.

mod form;
mod grammar;
mod read;
mod symbols;
mod wanted;

pub use symbols::{Symbol, SymbolKind};
pub use wanted::{TypedPass, Wanted, first, typed_pass, wanted};

pub(crate) use form::{
    At, Body, Dim, Entry, Formula, Group, HistoryPolicy, InputDecl, Link, Off, OutDecl, OutputDecl,
    ParameterDecl, PassDecl, Patch, SaidFact, Set, SetValue, Size, Sub, Target,
};
pub(crate) use read::{out_overrides, parse_file};

use self::grammar::PipelineFile;
use data_file::grammar::{Expected, Spanned};
use data_file::{Diagnostics, Source, Value};
use std::sync::Arc;

/// A parsed pipeline file.
#[derive(Clone, Debug)]
pub struct Description {
    /// The file.
    pub source: Arc<Source>,
    pub(crate) about: Option<At<String>>,
    pub(crate) paper: Option<At<String>>,
    pub(crate) extends: Option<At<String>>,
    pub(crate) parameters: Vec<ParameterDecl>,
    pub(crate) inputs: Vec<InputDecl>,
    pub(crate) passes: Vec<Entry>,
    pub(crate) outputs: Vec<OutputDecl>,
    pub(crate) patch: Vec<Patch>,
}

/// Reads a pipeline file. All errors of the file are reported at once.
///
/// # Errors
/// If the text is not RON, or not a pipeline.
pub fn parse(source: Arc<Source>) -> Result<Description, Diagnostics> {
    parse_file(source, 0)
}

/// Reads what can be read of a pipeline file that may be broken: stand-ins take the place of the rest.
pub fn parse_broken(source: &Arc<Source>) -> Option<Description> {
    read::parse_broken(source)
}

/// Returns which fields and forms may stand at a byte of a pipeline file.
pub fn expected(text: &str, at: usize) -> Expected {
    data_file::grammar::expected::<Spanned<PipelineFile>>(text, at)
}

impl Description {
    /// Returns what it renders, in one line.
    pub fn about(&self) -> Option<&str> {
        self.about.as_ref().map(|about| about.value.as_str())
    }

    /// Returns the paper and section that it renders.
    pub fn paper(&self) -> Option<&str> {
        self.paper.as_ref().map(|paper| paper.value.as_str())
    }

    /// Returns the file of which this one is a variant.
    pub fn extends(&self) -> Option<&str> {
        self.extends.as_ref().map(|file| file.value.as_str())
    }

    /// Returns what `set:` of a pass says, in order; parameters are left out.
    pub fn settings(&self, pass: &str) -> Vec<(&str, &Value)> {
        let entry = self.passes.iter().find(|entry| entry.name.value == *pass);
        let set = entry.map_or(&[][..], |entry| &entry.decl.set);
        set.iter().filter_map(|set| Some((&*set.name.value, set.value.get()?))).collect()
    }

    /// Returns whether it is a sub-graph, to be used with `Sub`: it has inputs.
    pub fn is_part(&self) -> bool {
        !self.inputs.is_empty()
    }

    /// Returns the files that it names: what must be watched beside it.
    pub fn files(&self) -> Vec<&str> {
        let patched = self.patch.iter().filter_map(|patch| match patch {
            Patch::Replace { decl, .. } | Patch::Insert { decl, .. } => Some(decl),
            Patch::Set { .. } | Patch::Remove { .. } => None,
        });
        let decls = self.passes.iter().map(|entry| &entry.decl).chain(patched);
        let mut files: Vec<&str> = self.extends().into_iter().collect();
        decls.for_each(|decl| named_files(decl, &mut files));
        files
    }
}

/// Adds the files that a sub-graph names.
fn named_files<'d>(decl: &'d PassDecl, files: &mut Vec<&'d str>) {
    match &decl.body {
        Body::Sub(Sub::File(file)) => files.push(file.value.as_str()),
        Body::Sub(Sub::Inline { passes, .. }) => {
            passes.iter().for_each(|entry| named_files(&entry.decl, files));
        }
        Body::Pass { .. } | Body::Group(_) | Body::Removed => {}
    }
}
