//! What a pass approximates, and what is exact in its place: the lines `#exact` of its shader.

use super::scope::Scope;
use super::{MainShader, options};
use crate::{PassTypeError, Settings, UseContext, Value};
use frame_graph::PassChange;
use shader_library::{Argument, ExactForm};

/// An approximation of a pass, with what is exact in its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Exact {
    /// The name of the approximation: `interleaving`. Passes of one name are made exact together.
    pub name: String,
    /// What is exact, in words.
    pub doc: String,
    /// How the picture becomes exact.
    pub by: ExactBy,
}

/// How a picture becomes exact.
#[derive(Clone, Debug, PartialEq)]
pub enum ExactBy {
    /// The pass is changed.
    Change(PassChange),
    /// Nothing can be put in its place; a reference with these values has the same error.
    Reference(Vec<(String, Value)>),
    /// The pass is changed into one that does the same by other means, with more noise: its bias alone counts, where all else is
    /// exact.
    Instead(PassChange),
}

/// Returns what a use with these settings approximates, in the order of the text.
///
/// # Errors
/// A shader that is refused, and expressions without a value.
pub fn exact(
    cx: &UseContext<'_>,
    main: &MainShader,
    settings: &Settings,
) -> Result<Vec<Exact>, PassTypeError> {
    let scope = Scope::of_settings(settings);
    let values = |arguments: &[Argument]| -> Result<Vec<(String, Value)>, PassTypeError> {
        let value = |argument: &Argument| {
            let value = scope.value(&argument.value.text);
            let value = value.map_err(|wrong| wrong.at(&format!("{}: ", argument.value.place)))?;
            Ok((argument.name.clone(), value))
        };
        arguments.iter().map(value).collect()
    };
    let declared = options::declared(cx, main)?;
    let exact = declared.exact.iter().map(|declared| {
        let by = match &declared.form {
            ExactForm::Set(set) => ExactBy::Change(PassChange::Set(values(set)?)),
            ExactForm::Pass(kind, set) => {
                ExactBy::Change(PassChange::Replace { kind: kind.clone(), set: values(set)? })
            }
            ExactForm::Instead(kind, set) => {
                ExactBy::Instead(PassChange::Replace { kind: kind.clone(), set: values(set)? })
            }
            ExactForm::Input(input) => ExactBy::Change(PassChange::LeaveOut { input: input.clone() }),
            ExactForm::Reference(set) => ExactBy::Reference(values(set)?),
        };
        Ok(Exact { name: declared.name.clone(), doc: declared.doc.clone(), by })
    });
    exact.collect()
}
