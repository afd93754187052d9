//! What a pass approximates, as its shader declares it:
//!
//! ```wgsl
//! #exact interleaving: set(interleave_x: 1, interleave_y: 1) // Each pixel takes all lights.
//! #exact maps: pass visibility-ray-traced // A ray for each light.
//! #exact filter: input irradiance // Irradiance as it is gathered.
//! #exact pixels: reference(filter: 'centre') // The mean over each pixel.
//! #exact lights: instead trace-photons(count: settings.count) // As many photons.
//! ```

use crate::codes;
use crate::directive::{Fault, Placed};
use crate::line_map::span;
use crate::port::{Argument, Reader};
use data_file::{Source, Span, nearest};
use std::sync::Arc;

/// An approximation of a pass, with what is exact in its place.
#[derive(Clone, Debug)]
pub struct DeclaredExact {
    /// The name of the approximation.
    pub name: String,
    /// What is exact.
    pub form: ExactForm,
    /// The documentation: what is exact, in words.
    pub doc: String,
    /// Where the name stands.
    pub place: Span,
}

/// What is exact in place of an approximation.
#[derive(Clone, Debug)]
pub enum ExactForm {
    /// The pass with other values of its settings.
    Set(Vec<Argument>),
    /// Another pass type with these settings.
    Pass(String, Vec<Argument>),
    /// What is linked to this input of the pass.
    Input(String),
    /// Nothing that can be put there: a reference with these settings has the error too.
    Reference(Vec<Argument>),
    /// Another pass type with these settings, which does the same by other means: right on average, but with more noise. It tells
    /// who owes what is left where all approximations are exact.
    Instead(String, Vec<Argument>),
}

const FORMS: [&str; 5] = ["set", "pass", "input", "reference", "instead"];

/// Reads `NAME: FORM…` from byte `pos` of a text on, which starts at byte `at` of its file.
pub(crate) fn parse(
    source: &Arc<Source>,
    text: &str,
    (at, pos): (usize, usize),
) -> Result<Placed<DeclaredExact>, Fault> {
    let mut reader = Reader { text, at, pos };
    let name = reader.name("the name of what the pass approximates")?;
    if !reader.eat(':') {
        return Err(reader.expected("`:` and what is exact, as in `#exact maps: pass visibility-ray-traced`"));
    }
    let word = reader.name("set(…), pass, input, reference(…) or instead")?;
    let form = match word.value.as_str() {
        "set" => ExactForm::Set(reader.arguments(source)?),
        form @ ("pass" | "instead") => {
            let (kind, set) = (reader.kind()?, reader.arguments(source)?);
            if form == "pass" { ExactForm::Pass(kind, set) } else { ExactForm::Instead(kind, set) }
        }
        "input" => ExactForm::Input(reader.name("the name of an input")?.value),
        "reference" => ExactForm::Reference(reader.arguments(source)?),
        other => {
            let fault = Fault::new(&codes::DIRECTIVE, word.range, format!("`{other}` means nothing here"));
            return Err(match nearest(other, FORMS) {
                Some(near) => fault.note(format!("did you mean `{near}`?")),
                None => fault.note(format!("there are {}", FORMS.join(", "))),
            });
        }
    };
    let doc = reader.comment()?;
    let place = span(source, name.range.clone());
    Ok(Placed { value: DeclaredExact { name: name.value, form, doc, place }, range: name.range })
}
