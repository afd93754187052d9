//! naga: parsing, binding by name, validation, and its errors in words of WGSL.

use crate::codes;
use crate::composed::Composed;
use crate::extent;
use crate::library::Library;
use crate::reflect::resources;
use crate::scan::unclosed_brace;
use data_file::{Diagnostic, Diagnostics, nearest};
use naga::common::wgsl::TypeContext;
use naga::front::wgsl::ParseError;
use naga::valid::{
    CallError, EntryPointError, FunctionError, ModuleInfo, ValidationError, ValidationFlags, Validator,
};
use naga::{Module, ResourceBinding, Scalar, TypeInner, VectorSize, WithSpan};
use std::collections::BTreeSet;
use std::error::Error;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::thread::{self, ScopedJoinHandle};

/// The stack of the thread on which naga runs, in bytes: eight times what it takes for the deepest text that is let
/// through. Whoever loads a shader may have less left than naga asks for.
const STACK: usize = 16 << 20;

/// Parses, binds by name in group 0, and validates.
pub(crate) fn compile(composed: &Composed) -> Result<(Module, ModuleInfo), Diagnostics> {
    if let Some((place, message)) = extent::exceeded(&composed.text) {
        return Err(composed.diagnostic(&codes::EXTENT, message, [(place, String::new())], []).into());
    }
    thread::scope(|scope| {
        let naga = || compile_here(composed);
        let thread = thread::Builder::new().name("naga".into()).stack_size(STACK).spawn_scoped(scope, naga);
        match thread.map(ScopedJoinHandle::join) {
            Ok(Ok(result)) => result,
            Ok(Err(panic)) => resume_unwind(panic),
            Err(error) => {
                let message = format!("no thread can be started to compile it: {error}");
                Err(composed.diagnostic(&codes::COMPILER, message, [], []).into())
            }
        }
    })
}

fn compile_here(composed: &Composed) -> Result<(Module, ModuleInfo), Diagnostics> {
    // naga promises not to panic, but hot reload hands it every half-written text there is.
    let result = catch_unwind(AssertUnwindSafe(|| {
        let mut module =
            naga::front::wgsl::parse_str(&composed.text).map_err(|error| refused(composed, &error))?;
        for (binding, handle) in resources(&module).into_iter().enumerate() {
            let binding = ResourceBinding { group: 0, binding: binding as u32 };
            module.global_variables[handle].binding = Some(binding);
        }
        match Validator::new(ValidationFlags::all(), Library::PORTABLE).validate(&module) {
            Ok(info) => Ok((module, info)),
            Err(error) => Err(invalid(composed, &module, &error)),
        }
    }));
    let result = result.unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no reason given");
        Err(composed.diagnostic(&codes::COMPILER, format!("naga failed on this shader: {text}"), [], []))
    });
    result.map_err(Diagnostics::from)
}

fn label(span: naga::Span, message: String) -> Option<(Range<u32>, String)> {
    let range = span.to_range()?;
    Some((range.start as u32..range.end as u32, message))
}

/// An error of the parser.
fn refused(composed: &Composed, error: &ParseError) -> Diagnostic {
    let mut labels: Vec<_> = error.labels().filter_map(|(span, text)| label(span, text.to_owned())).collect();
    let mut message = error.message().to_owned();
    // Without its `}` a file runs on into the one that imports it, where naga finds the error.
    let file = |at: usize| composed.map.span(at as u32..at as u32 + 1).map(|span| span.source.name.clone());
    if let Some(brace) = unclosed_brace(&composed.text, |a, b| file(a) == file(b)) {
        message = format!("this `{{` is not closed ({message})");
        labels.insert(0, (brace as u32..brace as u32 + 1, "opened here".to_owned()));
    }
    let near = near(&composed.text, &message).map(|near| format!("did you mean `{near}`?"));
    composed.diagnostic(&codes::WGSL, message, labels, error.notes().map(str::to_owned).chain(near))
}

/// Returns the name of a text that is nearest to the one that an error of the parser says is not there.
fn near<'a>(text: &'a str, message: &str) -> Option<&'a str> {
    let of = |before: &str| message.strip_prefix(before)?.strip_suffix('`');
    let wrong = of("no definition in scope for identifier: `").or_else(|| of("invalid field accessor `"))?;
    let code = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    let words = code.flat_map(|line| line.split(|c: char| !(c.is_alphanumeric() || c == '_')));
    let names: BTreeSet<&str> = words.filter(|word| word.len() > 1 && *word != wrong).collect();
    nearest(wrong, names)
}

/// An error of the validator.
fn invalid(composed: &Composed, module: &Module, error: &WithSpan<ValidationError>) -> Diagnostic {
    let mut labels: Vec<_> = error.spans().filter_map(|(span, text)| label(*span, describe(text))).collect();
    // The least range is the place itself; naga begins with the function around it.
    labels.sort_by_key(|(range, _)| range.end - range.start);
    if labels.len() > 1 {
        labels.retain(|(_, text)| text != "this function");
    }
    let mut causes = vec![error.as_inner().to_string()];
    let mut cause = error.source();
    while let Some(inner) = cause {
        causes.push(inner.to_string());
        cause = inner.source();
    }
    causes.dedup();
    let innermost = causes.pop().unwrap_or_default();
    let message = explain(module, error.as_inner()).unwrap_or(innermost);
    // "Function [3] is invalid" says no more than the place does.
    causes.retain(|cause| !cause.ends_with(" is invalid"));
    causes.reverse();
    let plain = |text: String| in_wgsl(module, text);
    composed.diagnostic(&codes::INVALID, plain(message), labels, causes.into_iter().map(plain))
}

/// Common errors that naga words by the handles in its arenas.
fn explain(module: &Module, error: &ValidationError) -> Option<String> {
    let function = match error {
        ValidationError::Function { source, .. } => source,
        ValidationError::EntryPoint { source: EntryPointError::Function(source), .. } => source,
        _ => return None,
    };
    let name = |ty: naga::Handle<naga::Type>| module.to_ctx().type_to_string(ty);
    match function {
        FunctionError::InvalidReturnType { expression: None, expected_ty: Some(ty) } => {
            Some(format!("a way through this function ends without `return`ing its `{}`", name(*ty)))
        }
        FunctionError::InvalidReturnType { expression: Some(_), expected_ty: Some(ty) } => {
            Some(format!("what is returned is not of the declared type `{}`", name(*ty)))
        }
        FunctionError::InvalidReturnType { expression: Some(_), expected_ty: None } => {
            Some("this function declares no type to return".to_owned())
        }
        FunctionError::InvalidCall { error: CallError::ArgumentType { index, required, .. }, .. } => {
            Some(format!("argument {} of this call is not of type `{}`", index + 1, name(*required)))
        }
        FunctionError::InvalidStoreTypes { .. } => {
            Some("what is stored is not of the type of where it is stored".to_owned())
        }
        _ => None,
    }
}

/// naga labels some places by the handles in its arenas, such as `naga::ir::Expression [12]`.
fn describe(label: &str) -> String {
    let handle = label.strip_prefix("naga::").and_then(|label| label.split_once(" ["));
    let kind = handle.and_then(|(path, _)| path.rsplit("::").next());
    match kind {
        Some("Expression") => "this expression".to_owned(),
        Some("GlobalVariable" | "LocalVariable") => "this variable".to_owned(),
        Some(kind) => format!("this {}", kind.to_lowercase()),
        None => label.to_owned(),
    }
}

/// Writes types as WGSL does, `vec3<f32>`, where naga shows how it keeps them, and leaves the handles of
/// expressions away where their types are given.
fn in_wgsl(module: &Module, mut text: String) -> String {
    let scalars = [Scalar::F32, Scalar::U32, Scalar::I32, Scalar::BOOL];
    let sizes = [VectorSize::Bi, VectorSize::Tri, VectorSize::Quad];
    for scalar in scalars {
        let vectors = sizes.map(|size| TypeInner::Vector { size, scalar });
        let matrices = sizes
            .into_iter()
            .flat_map(|columns| sizes.map(|rows| TypeInner::Matrix { columns, rows, scalar }));
        for inner in
            vectors.into_iter().chain(matrices).chain([TypeInner::Atomic(scalar), TypeInner::Scalar(scalar)])
        {
            let mut name = String::new();
            if module.types.write_type_inner(&inner, &mut name).is_ok() {
                text = text.replace(&format!("{inner:?}"), &format!("`{name}`"));
            }
        }
    }
    while let Some(middle) = text.find("] (of type ") {
        let Some(start) = text[..middle].rfind('[') else { break };
        let inner = middle + "] (of type ".len();
        let Some(end) = text[inner..].find(')').map(|len| inner + len) else { break };
        text = format!("{}{}{}", &text[..start], &text[inner..end], &text[end + 1..]);
    }
    text
}
