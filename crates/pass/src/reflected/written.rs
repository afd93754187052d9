//! What the shaders of a pass write.

use super::instead;
use crate::PassTypeError;
use shader_library::{Access, Attributes, Dimension, Entry, GlobalKind, Shader, TypeLayout};

/// Something that the shader writes.
#[derive(Clone, Debug)]
pub(super) struct Written {
    /// The global, or the result of a fragment shader.
    pub(super) name: String,
    /// Its declaration.
    pub(super) form: Form,
    /// Whether only the entry points see it.
    pub(super) scratch: bool,
    /// The size that its attributes say: of a texture as a directive has it, of a buffer its elements.
    pub(super) size: Option<SaidSize>,
    /// Whether its attributes say that it is cleared first.
    pub(super) cleared: bool,
    /// Of the result of a fragment shader, the position of its entry point.
    pub(super) entry: Option<usize>,
}

/// The size of scratch as its attributes say it.
#[derive(Clone, Debug)]
pub(super) struct SaidSize {
    /// The expression.
    pub(super) text: String,
    /// Where the attributes stand.
    pub(super) place: String,
}

impl Written {
    /// Adds what another file says of the same.
    pub(super) fn merge(&mut self, other: Written) {
        self.scratch |= other.scratch;
        self.cleared |= other.cleared;
        self.size = self.size.take().or(other.size);
    }
}

/// The declaration of something that a shader writes.
#[derive(Clone, Debug)]
pub(super) enum Form {
    /// A texture whose format the shader leaves open, but for the type of its texels.
    Target(String),
    /// A storage texture of a format, or of several layers.
    Texture {
        /// As WGSL writes it.
        format: &'static str,
        /// Of several layers.
        array: bool,
    },
    /// A buffer.
    Buffer(TypeLayout),
}

/// The port of the only result of a fragment shader.
const RESULT: &str = "result";

/// Lists what a shader writes: the results of its fragment entry points, in the order of their locations, then the
/// globals that no link claims.
pub(super) fn written(
    shader: &Shader,
    attributes: &Attributes,
    entries: &[Entry],
    inputs: &[&String],
    is_users: bool,
) -> Result<Vec<Written>, PassTypeError> {
    let mut all = Vec::new();
    for (index, entry) in entries.iter().enumerate().filter(|(_, entry)| entry.workgroup_size[0] == 0) {
        let scratch = attributes.entries.iter().any(|said| said.name == entry.name && said.scratch);
        for location in results(entry, is_users)? {
            // One shader's only result has a name that says so; of several, each has that of its entry point.
            let unnamed = if entries.len() == 1 { RESULT } else { &entry.name };
            let name = if location.name.is_empty() { unnamed.to_owned() } else { location.name };
            if all.iter().any(|other: &Written| other.name == name) {
                return Err(PassTypeError::new(format!("two entry points have a result `{name}`")));
            }
            let (form, entry) = (Form::Target(location.ty), Some(index));
            all.push(Written { name, form, scratch, size: None, cleared: false, entry });
        }
    }
    let of = |name: &str| attributes.globals.iter().find(|said| said.name == name);
    for global in shader.interface.globals.iter().filter(|global| !inputs.contains(&&global.name)) {
        let form = match &global.kind {
            GlobalKind::StorageTexture { dimension, format, access } if *access != Access::Read => {
                Form::Texture { format, array: *dimension == Dimension::D2Array }
            }
            GlobalKind::Storage { writable: true, layout } => Form::Buffer(layout.clone()),
            _ => continue,
        };
        let said = of(&global.name);
        let size = said.and_then(|said| {
            let text = said.count.as_ref().or(said.size.as_ref())?.0.clone();
            let place =
                shader.place(said.place.clone()).map_or_else(String::new, |place| format!("{place}: "));
            Some(SaidSize { text, place })
        });
        let (scratch, cleared) = said.map_or((false, false), |said| (said.scratch, said.cleared));
        all.push(Written { name: global.name.clone(), form, scratch, size, cleared, entry: None });
    }
    for said in &attributes.globals {
        let place = shader.place(said.place.clone()).map_or_else(String::new, |place| format!("{place}: "));
        let is_written = all.iter().any(|written| written.name == said.name);
        if said.scratch && !is_written {
            return Err(PassTypeError::new(format!(
                "{place}`{}` is scratch, but the shader does not write it",
                said.name
            )));
        }
        let Some(read) = &said.reads else { continue };
        if is_written {
            let message = format!("{place}`{}` is written itself, and cannot read `{read}`", said.name);
            return Err(PassTypeError::new(message));
        }
        if !all.iter().any(|written| written.name == *read) {
            let message = format!("{place}`{}` reads `{read}`, which the shader does not write", said.name);
            let names = all.iter().map(|written| &*written.name);
            return Err(PassTypeError::new(message).help(instead(read, "it writes", names)));
        }
    }
    Ok(all)
}

/// The results of a fragment entry point, in the order of their locations. Those of users' files are drawn over the frame; a
/// pass of the tree may record draws with vertices of its own.
fn results(entry: &Entry, is_users: bool) -> Result<Vec<shader_library::Location>, PassTypeError> {
    let name = &entry.name;
    if let Some(input) = entry.inputs.first().filter(|_| is_users) {
        let message = format!("`{name}` takes `{}` from the vertex stage, which outputs nothing", input.name);
        return Err(PassTypeError::new(message).help("the pixel is @builtin(position)"));
    }
    if entry.outputs.is_empty() {
        return Err(PassTypeError::new(format!("`{name}` has no result to draw"))
            .help("let it return a @location(0)"));
    }
    let mut outputs = entry.outputs.clone();
    outputs.sort_by_key(|output| output.location);
    let gap = outputs.iter().enumerate().find(|(i, output)| output.location as usize != *i);
    if let Some((expected, output)) = gap {
        let message = format!("`{name}` writes @location({}) but not @location({expected})", output.location);
        return Err(PassTypeError::new(message).help("locations count from 0 without gaps"));
    }
    Ok(outputs)
}

/// The interface of a single resource.
pub(super) fn sort(written: &Written) -> &'static str {
    if matches!(written.form, Form::Buffer(_)) { "Buffer" } else { "Texture" }
}

/// Elements of an array whose length the shader says.
pub(super) fn fixed_count(layout: &TypeLayout) -> Option<u32> {
    let (_, stride) = layout.element.as_ref().filter(|_| !layout.runtime_sized)?;
    layout.size.checked_div(*stride)
}
