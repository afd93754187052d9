//! One variant of one shader: composed, validated, bound by name, reflected.

use crate::attributes::{self, Attributes};
use crate::codes;
use crate::compile::compile;
use crate::composed::{Composed, Outline};
use crate::interface::ShaderInterface;
use crate::layout::{StructLayout, side_by_side};
use crate::line_map::span;
use crate::reflect::{reflect, resources};
use crate::thread_order::permuted;
use crate::{scan, settings};
use data_file::{Diagnostics, Setting, Span};
use naga::Module;
use naga::valid::ModuleInfo;
use std::ops::Range;
use std::sync::{Arc, OnceLock};
use xxhash_rust::xxh3::xxh3_128;

/// A valid shader, and what reflection found.
#[derive(Debug)]
pub struct Shader {
    /// The module, its resources bound in group 0 as [`ShaderInterface::globals`] says.
    pub module: Module,
    /// The result of naga's validation.
    pub info: ModuleInfo,
    /// The shader interface.
    pub interface: ShaderInterface,
    /// Hash of the composed text and the bindings: equal shaders have equal ones, on any machine.
    pub hash: u128,
    composed: Composed,
    /// Where each of [`ShaderInterface::globals`] is declared in the composed text.
    declarations: Vec<Range<usize>>,
    attributes: OnceLock<Result<Arc<Attributes>, Diagnostics>>,
}

impl Shader {
    /// Compiles a composed text. With a `thread_order`, compute entry points run in the order that it chooses.
    pub(crate) fn new(composed: Composed, thread_order: Option<u32>) -> Result<Self, Diagnostics> {
        let _phase = tracing::info_span!(target: "phase", "shaders validated and reflected").entered();
        let (mut module, mut info) = compile(&composed)?;
        // Of the text in its own order, into which places point.
        let span = |handle| module.global_variables.get_span(handle).to_range().unwrap_or_default();
        let declarations = resources(&module).into_iter().map(span).collect();
        let mut hashed = composed.text.clone();
        if let Some(seed) = thread_order {
            let permuted = Composed { text: permuted(&composed.text, &module, seed), ..composed.clone() };
            (module, info) = compile(&permuted)?;
            hashed = permuted.text;
        }
        let interface = reflect(&module, &info).map_err(|(span, message)| {
            let label = span.to_range().map(|range| (range.start as u32..range.end as u32, String::new()));
            Diagnostics::from(composed.diagnostic(&codes::INVALID, message, label, []))
        })?;
        for global in &interface.globals {
            hashed.push_str(&format!("\n{} {}", global.binding, global.name));
        }
        let hash = xxh3_128(hashed.as_bytes());
        let attributes = OnceLock::new();
        Ok(Shader { module, info, interface, hash, composed, declarations, attributes })
    }

    /// Returns the composed WGSL, with threads in their own order.
    pub fn text(&self) -> &str {
        &self.composed.text
    }

    /// Returns the paths of all files of the shader.
    pub fn files(&self) -> &[String] {
        &self.composed.outline.files
    }

    /// Returns the options of its files and the interfaces whose modules they import.
    pub fn outline(&self) -> &Outline {
        &self.composed.outline
    }

    /// Returns the place in the user's file of a range of bytes of [`Shader::text`].
    pub fn place(&self, range: Range<u32>) -> Option<Span> {
        self.composed.map.span(range)
    }

    /// Returns the place where the global with this index in [`ShaderInterface::globals`] is declared.
    pub fn global_place(&self, index: usize) -> Option<Span> {
        let declared = self.declarations.get(index)?.clone();
        let name = &self.interface.globals.get(index)?.name;
        let at = scan::find_word(&self.composed.text[declared.clone()], name).map(|at| declared.start + at);
        let range = at.map_or(declared, |at| at..at + name.len());
        self.place(range.start as u32..range.end as u32)
    }

    /// Returns the place where a member of a struct is declared.
    pub fn member_place(&self, structure: &str, member: &str) -> Option<Span> {
        let found = scan::find_struct(&self.composed.text, structure)?;
        let is_same = |found: &str| crate::setting_name(found) == crate::setting_name(member);
        let range = found.members.into_iter().find(|found| is_same(&found.name))?.range;
        self.place(range.start as u32..range.end as u32)
    }

    /// Returns the place where the file that was requested begins.
    pub fn start(&self) -> Span {
        span(&self.composed.main, 0..0)
    }

    /// Returns the place in one of its files, or else in the file that was requested, where a name first stands: in any
    /// variant of the file. Where it does not stand there, this is the file's first byte.
    pub fn place_of_name(&self, file: &str, name: &str) -> Span {
        let source = self.composed.map.source(file).unwrap_or(&self.composed.main);
        let range = scan::find_word(&source.text, name).map_or(0..0, |at| at..at + name.len());
        span(source, range)
    }

    /// Returns the values of the options of this variant, as `A = true, B = 2`; empty where there are no options.
    pub fn variant(&self) -> String {
        self.composed.variant()
    }

    /// Returns the names of the resources that the functions of the requested file use, with all that they call:
    /// what a module adds to the shader that imports it. Functions of imports count where they
    /// are called.
    pub fn used_by_own_functions(&self) -> impl Iterator<Item = &str> {
        let mut used = std::collections::BTreeSet::new();
        for (function, _) in self.module.functions.iter() {
            let Some(range) = self.module.functions.get_span(function).to_range() else { continue };
            let place = self.composed.map.span(range.start as u32..range.end as u32);
            if place.is_some_and(|place| place.source.name == self.composed.main.name) {
                let found = self.module.global_variables.iter();
                let found = found.filter(|(global, _)| !self.info[function][*global].is_empty());
                used.extend(found.filter_map(|(_, variable)| variable.name.as_deref()));
            }
        }
        used.into_iter()
    }

    /// Returns the settings declared by the doc comments of `struct Settings`, in the order of its members; members
    /// without a declaration are for the pass to fill. Empty where there is no such struct.
    ///
    /// # Errors
    /// Each declaration that cannot be read, at its place.
    pub fn settings(&self) -> Result<Vec<Setting>, Diagnostics> {
        match &self.interface.settings {
            Some(layout) => settings::read(&self.composed, Some(layout)),
            None => Ok(Vec::new()),
        }
    }

    /// Returns what the doc comments of entry points and globals say in brackets: `[threads: texels(sums)]`,
    /// `[scratch]` and so on.
    ///
    /// # Errors
    /// Each attribute that cannot be read, at its place.
    pub fn attributes(&self) -> Result<Arc<Attributes>, Diagnostics> {
        let read = || attributes::read(&self.composed, &self.interface).map(Arc::new);
        self.attributes.get_or_init(read).clone()
    }

    /// Checks that each struct that both Rust and the shader declare has the same layout. `expected` are the layouts that
    /// Rust was built with, and `place` names the part of the program that has them, for the error. Structs that the
    /// shader does not declare are ignored.
    ///
    /// # Errors
    /// Each struct that differs, both layouts side by side.
    pub fn check_layout(&self, expected: &[StructLayout], place: &str) -> Result<(), Diagnostics> {
        let mut errors = Vec::new();
        for cpu in expected {
            let Some(shader) = self.interface.layout(&cpu.name).filter(|shader| *shader != cpu) else {
                continue;
            };
            let label = scan::find_struct(&self.composed.text, &cpu.name)
                .map(|found| (found.name.start as u32..found.name.end as u32, "declared here".to_owned()));
            let message = format!("the struct `{}` differs from the CPU's in {place}", cpu.name);
            errors.push(self.composed.diagnostic(
                &codes::LAYOUT,
                message,
                label,
                [side_by_side(shader, cpu)],
            ));
        }
        if errors.is_empty() { Ok(()) } else { Err(Diagnostics(errors)) }
    }
}
