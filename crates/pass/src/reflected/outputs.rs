//! What a shader of a user's writes: outputs, and scratch that its entry points share.

use super::{Reflected, facts, list, member_of};
use crate::{
    Clear, Content, Extent, Fact, Format, Interface, OutputContext, OutputDesc, OutputPort, PassTypeError,
    ResourceDesc, Usage, UseContext,
};
use shader_library::{Access, Attributes, Dimension, Entry, GlobalKind, Shader, TypeLayout};

/// Something that the shader writes.
#[derive(Clone, Debug)]
pub(super) struct Written {
    /// The global, or the result of a fragment shader.
    pub(super) name: String,
    /// What it is.
    pub(super) form: Form,
    /// Whether only the entry points see it.
    pub(super) scratch: bool,
    /// Of the result of a fragment shader, the position of its entry point.
    pub(super) entry: Option<usize>,
}

/// What a shader says of something that it writes.
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

/// An output port, with the member that each written thing is.
struct Group<'a> {
    port: &'a str,
    interface: &'a str,
    scratch: bool,
    members: Vec<(&'a str, &'a Written)>,
}

/// How many elements a buffer has: what a pass in WGSL alone tells of one by itself, and reads of others.
pub(super) const COUNT: Fact<u32> = Fact::required("count", "the number of elements");

/// What a fragment shader with one result writes, as a port.
const RESULT: &str = "result";

/// Lists what a shader writes: the results of its fragment entry points, in the order of their locations, then the
/// globals that no link claims.
pub(super) fn written(
    shader: &Shader,
    attributes: &Attributes,
    entries: &[Entry],
    linked: &[String],
) -> Result<Vec<Written>, PassTypeError> {
    let mut all = Vec::new();
    for (index, entry) in entries.iter().enumerate().filter(|(_, entry)| entry.workgroup_size[0] == 0) {
        let scratch = attributes.entries.iter().any(|said| said.name == entry.name && said.scratch);
        for location in results(entry)? {
            // One shader's only result has a name that says so; of several, each has that of its entry point.
            let unnamed = if entries.len() == 1 { RESULT } else { &entry.name };
            let name = if location.name.is_empty() { unnamed.to_owned() } else { location.name };
            if all.iter().any(|other: &Written| other.name == name) {
                return Err(PassTypeError::new(format!("two entry points have a result `{name}`")));
            }
            all.push(Written { name, form: Form::Target(location.ty), scratch, entry: Some(index) });
        }
    }
    let of = |name: &str| attributes.globals.iter().find(|said| said.name == name);
    for global in shader.interface.globals.iter().filter(|global| !linked.contains(&global.name)) {
        let form = match &global.kind {
            GlobalKind::StorageTexture { dimension, format, access } if *access != Access::Read => {
                Form::Texture { format, array: *dimension == Dimension::D2Array }
            }
            GlobalKind::Storage { writable: true, layout } => Form::Buffer(layout.clone()),
            _ => continue,
        };
        let scratch = of(&global.name).is_some_and(|said| said.scratch);
        all.push(Written { name: global.name.clone(), form, scratch, entry: None });
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
            return Err(PassTypeError::new(message).help(match frame_graph::nearest(read, names.clone()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("it writes {}", list(names)),
            }));
        }
    }
    Ok(all)
}

/// The results of a fragment entry point, in the order of their locations.
fn results(entry: &Entry) -> Result<Vec<shader_library::Location>, PassTypeError> {
    let name = &entry.name;
    if let Some(input) = entry.inputs.first() {
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

impl Reflected {
    /// The output ports.
    pub(super) fn output_ports(&self, cx: &UseContext<'_>) -> Result<Vec<OutputPort>, PassTypeError> {
        let groups = self.groups(cx)?;
        let ports: Vec<OutputPort> = groups
            .iter()
            .filter(|group| !group.scratch)
            .map(|group| OutputPort {
                name: group.port.into(),
                interface: group.interface.into(),
                doc: format!("Written as {}.", list(group.members.iter().map(|(_, written)| &written.name))),
            })
            .collect();
        if ports.is_empty() {
            return Err(PassTypeError::new("the shader writes nothing that another pass could read"));
        }
        Ok(ports)
    }

    /// Returns the resources of the outputs, and of scratch.
    ///
    /// # Errors
    /// Formats that do not fit, and buffers whose number of elements nothing says.
    pub(super) fn outputs(
        &self,
        cx: &UseContext<'_>,
        outputs: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let like = outputs.inputs.iter().find(|input| input.size().is_some());
        let layers = outputs
            .inputs
            .iter()
            .flat_map(|input| &input.members)
            .find_map(|(_, desc)| desc.texture().filter(|t| t.array));
        let layers = layers.map_or(1, |texture| texture.layers);
        let mut descs = Vec::new();
        for group in self.groups(cx)? {
            let said = cx.use_.outputs.get(group.port);
            let size = said
                .and_then(|said| said.size.clone())
                .or_else(|| like.map(|input| Extent::like(&input.name)));
            let size = size.unwrap_or(Extent::FRAME);
            let format = said.and_then(|said| said.format);
            let interface = cx.interfaces.iter().find(|known| known.name == group.interface);
            let own_count = |layout| said.and_then(|said| said.count).or_else(|| fixed_count(layout));
            let counted = group.members.iter().rev().find_map(|(_, written)| match &written.form {
                Form::Buffer(layout) => own_count(layout),
                _ => None,
            });
            let mut desc = OutputDesc { scratch: group.scratch, ..OutputDesc::of(group.port, Vec::new()) };
            desc.facts = facts::of_output(interface, group.port, said, counted, outputs)?;
            for (member, written) in group.members {
                let resource = match &written.form {
                    Form::Target(ty) => {
                        let format = format.or_else(|| format_of(interface?, member));
                        ResourceDesc::texture_2d(target_format(&written.name, ty, format)?, size.clone())
                    }
                    Form::Texture { format: declared, array } => {
                        let declared = storage_format(&written.name, declared, format)?;
                        if *array {
                            ResourceDesc::texture_2d_array(declared, size.clone(), layers)
                        } else {
                            ResourceDesc::texture_2d(declared, size.clone())
                        }
                    }
                    Form::Buffer(layout) => {
                        let count = own_count(layout).or_else(|| COUNT.of(&desc.facts));
                        ResourceDesc::buffer(bytes(&written.name, group.port, layout, count)?)
                    }
                };
                // A target is cleared as it is drawn to; of the others nobody knows whether all of it is written.
                let usage = match written.form {
                    Form::Target(_) => Usage::Overwrites,
                    _ => Usage::ClearFirst(Clear::Zero),
                };
                desc.members.push((member.into(), resource, usage));
            }
            facts::check_required(interface, group.port, &desc.facts)?;
            descs.push(desc);
        }
        Ok(descs)
    }

    /// `port` or `port.member` of each target that an entry point draws to, in order.
    pub(super) fn targets(&self, cx: &UseContext<'_>, entry: usize) -> Result<Vec<String>, PassTypeError> {
        let groups = self.groups(cx)?;
        let resource = |one: &Written| {
            groups.iter().find_map(|group| {
                let (member, _) = group.members.iter().find(|(_, w)| w.name == one.name)?;
                let whole = member.is_empty();
                Some(if whole { group.port.to_owned() } else { format!("{}.{member}", group.port) })
            })
        };
        Ok(self.written.iter().filter(|one| one.entry == Some(entry)).filter_map(resource).collect())
    }

    /// What is written, by output port: `out:` gathers members of an interface under one name. Of several names with
    /// which that of a global begins, the longest has it.
    fn groups<'a>(&'a self, cx: &UseContext<'a>) -> Result<Vec<Group<'a>>, PassTypeError> {
        let written = &self.written;
        let mut groups: Vec<Group<'a>> = Vec::new();
        for (port, said) in cx.use_.outputs {
            let whole = written.iter().any(|w| w.name == **port);
            let known = cx.interfaces.iter().find(|known| Some(known.name) == said.interface.as_deref());
            let of_port = |w: &'a Written| {
                if w.name == **port {
                    return Some(("", w));
                }
                let member = member_of(&w.name, port)?;
                let longer = |other: &String| other.len() > port.len() && begins(&w.name, other);
                // Beside what is the port itself, only what its interface has is a member of it.
                let apart = whole && known.is_none_or(|known| known.member(member).is_none());
                (!apart && !cx.use_.outputs.keys().any(longer)).then_some((member, w))
            };
            let members: Vec<(&str, &Written)> = written.iter().filter_map(of_port).collect();
            if members.is_empty() {
                let message = format!("`out:` speaks of `{port}`, which the shader does not write");
                return Err(PassTypeError::new(message)
                    .help(format!("it writes {}", list(written.iter().map(|w| &w.name)))));
            }
            let scratch = members[0].1.scratch;
            if let Some((_, other)) = members.iter().find(|(_, w)| w.scratch != scratch) {
                let message =
                    format!("of the members of `{port}`, `{}` alone is scratch or alone is not", other.name);
                return Err(PassTypeError::new(message));
            }
            if scratch && said.interface.is_some() {
                let message = format!("`{port}` is scratch, which no other pass sees: it has no interface");
                return Err(PassTypeError::new(message));
            }
            let sort = sort(members[0].1);
            let interface = said.interface.as_deref().unwrap_or(sort);
            if !scratch || members.len() > 1 {
                check_members(cx.interfaces, port, interface, &members)?;
            }
            groups.push(Group { port, interface, scratch, members });
        }
        for one in written {
            if !groups.iter().any(|group| group.members.iter().any(|(_, w)| w.name == one.name)) {
                let (scratch, members) = (one.scratch, vec![("", one)]);
                groups.push(Group { port: &one.name, interface: sort(one), scratch, members });
            }
        }
        Ok(groups)
    }
}

/// Whether a global has the name of a port, or that of a member of it.
fn begins(global: &str, port: &str) -> bool {
    global == port || member_of(global, port).is_some()
}

/// Checks that what is written as a port is what its interface wants.
fn check_members(
    interfaces: &[Interface],
    port: &str,
    interface: &str,
    members: &[(&str, &Written)],
) -> Result<(), PassTypeError> {
    let Some(known) = interfaces.iter().find(|known| known.name == interface) else {
        if interface == "Texture" || interface == "Buffer" {
            return match members {
                [("", _)] => Ok(()),
                _ => Err(PassTypeError::new(format!(
                    "the output `{port}` has several members, so `out:` must name its interface"
                ))),
            };
        }
        let all = list(interfaces.iter().map(|known| known.name));
        return Err(PassTypeError::new(format!(
            "`out:` offers `{port}` as `{interface}`, which is no interface"
        ))
        .help(format!("there are {all}")));
    };
    let global = |member: &str| if member.is_empty() { port.to_owned() } else { format!("{port}_{member}") };
    for (member, written) in members {
        if !known.members.iter().any(|m| m.name == *member) {
            let names = list(known.members.iter().map(|m| global(m.name)));
            return Err(PassTypeError::new(format!("`{}` is no member of a `{interface}`", written.name))
                .help(format!("its members would be written as {names}")));
        }
    }
    for member in known.members.iter().filter(|m| !m.optional) {
        if !members.iter().any(|(name, _)| *name == member.name) {
            return Err(PassTypeError::new(format!(
                "`{port}` lacks a member of a `{interface}`: the shader does not write `{}`",
                global(member.name)
            )));
        }
    }
    Ok(())
}

/// The format in which the passes of the tree write a texture of an interface; `None` where the member is a buffer or
/// there is none of that name.
fn format_of(interface: &Interface, member: &str) -> Option<Format> {
    if let Content::Texture(format) = interface.member(member)?.content { Some(format) } else { None }
}

/// The interface of a single resource.
fn sort(written: &Written) -> &'static str {
    if matches!(written.form, Form::Buffer(_)) { "Buffer" } else { "Texture" }
}

/// The format of a target: as said, or the widest that every GPU can blend for the type of its texels.
fn target_format(name: &str, ty: &str, said: Option<Format>) -> Result<Format, PassTypeError> {
    let whole = ty.contains("u32");
    let Some(format) = said else {
        return Ok(match ty {
            "f32" => Format::R16Float,
            "vec2<f32>" => Format::Rg16Float,
            "u32" => Format::R32Uint,
            "vec2<u32>" => Format::Rg32Uint,
            _ if whole => Format::Rgba32Uint,
            _ => Format::Rgba16Float,
        });
    };
    if format.name().ends_with("uint") != whole || format == Format::Depth32Float {
        return Err(PassTypeError::new(format!(
            "`{name}` is {ty}, which a texture of {} does not hold",
            format.name()
        )));
    }
    Ok(format)
}

/// The format of a storage texture, which the shader says.
fn storage_format(name: &str, declared: &str, said: Option<Format>) -> Result<Format, PassTypeError> {
    let Some(format) = Format::from_name(declared) else {
        let known = list(Format::ALL.iter().map(|format| format.name()));
        return Err(PassTypeError::new(format!(
            "`{name}` is of the format {declared}, which no texture here has"
        ))
        .help(format!("there are {known}")));
    };
    match said.filter(|said| *said != format) {
        Some(said) => Err(PassTypeError::new(format!(
            "`out:` says {} of `{name}`, but the shader says {declared}",
            said.name()
        ))),
        None => Ok(format),
    }
}

/// Elements of an array whose length the shader says.
fn fixed_count(layout: &TypeLayout) -> Option<u32> {
    let (_, stride) = layout.element.as_ref().filter(|_| !layout.runtime_sized)?;
    layout.size.checked_div(*stride)
}

/// Bytes of a buffer of `count` elements.
fn bytes(name: &str, port: &str, layout: &TypeLayout, count: Option<u32>) -> Result<u64, PassTypeError> {
    let Some((_, stride)) = layout.element.as_ref().filter(|_| layout.runtime_sized) else {
        return Ok(layout.size.into());
    };
    let count = count.ok_or_else(|| {
        let message = format!("nothing says how many elements `{name}: {}` has", layout.ty);
        PassTypeError::new(message)
            .help(format!("say it in the pipeline: out: {{ \"{port}\": Out(count: 1024) }}"))
    })?;
    Ok(u64::from(layout.size) + u64::from(count.max(1)) * u64::from(*stride))
}
