//! A use of a kind that is WGSL alone: its settings, ports and resources, read from the shader.
//!
//! | in the shader | in the pipeline |
//! |---|---|
//! | a member of `struct Settings` with `[default: …]` | a setting |
//! | a global `K`, or `K_member` where `in:` links `K` | the input `K` |
//! | a global `K`, or `K_member` where `out:` names `K` | the output `K` |
//! | `camera`, `frame`, `scene_…` | nothing: the host program has it |
//! | an `#option` named as a trait of the scene in capitals (`TEXTURED`) | nothing: the scene decides |

use crate::{
    Clear, Define, Extent, Format, InputPort, KindError, OutputContext, OutputDesc, OutputPort, Ports,
    RecordContext, Request, ResourceDesc, Setting, Usage, UseContext, Value, externals, interfaces,
};
use shader_library::{Access, Dimension, Entry, GlobalKind, Shader, Stage, TypeLayout};
use std::fmt::Display;
use std::sync::Arc;

/// A shader of a user, as a pass.
#[derive(Debug)]
pub struct Reflected {
    shader: Arc<Shader>,
    /// The one entry point of the kind's stage.
    pub entry: Entry,
}

/// Something that the shader writes.
#[derive(Clone, Debug)]
pub struct Written {
    /// The global, or the result of a fragment shader.
    pub name: String,
    /// What it is.
    pub form: Form,
}

/// What a shader says of something that it writes.
#[derive(Clone, Debug)]
pub enum Form {
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
    members: Vec<(&'a str, &'a Written)>,
}

impl Reflected {
    /// Loads the shader of a use, whose file is `path`, and finds its entry point of the stage.
    pub fn new(
        cx: &UseContext<'_>,
        request: &Request,
        path: &str,
        stage: Stage,
    ) -> Result<Reflected, KindError> {
        let shader = cx
            .shaders
            .load(request)
            .map_err(|errors| KindError::new(format!("`{path}` is refused\n{errors}")))?;
        let of_stage: Vec<&Entry> =
            shader.interface.entries.iter().filter(|entry| entry.stage == stage).collect();
        let attribute = format!("@{stage:?}").to_lowercase();
        let entry = match of_stage.as_slice() {
            [entry] => (*entry).clone(),
            [] => return Err(KindError::new(format!("`{path}` has no {attribute} entry point"))),
            several => {
                let message = format!(
                    "`{path}` has {} {attribute} entry points: {}",
                    several.len(),
                    list(several.iter().map(|e| &e.name))
                );
                return Err(KindError::new(message).help(
                    "a use runs one; put the others into files of their own, or into variants by `#if`",
                ));
            }
        };
        Ok(Reflected { shader, entry })
    }

    /// The settings that `struct Settings` declares.
    pub fn settings(&self) -> Result<Vec<Setting>, KindError> {
        self.shader.settings().map_err(|errors| KindError::new(errors.to_string()))
    }

    /// The globals that the shader writes and no link claims.
    pub fn written_globals(&self, linked: &[String]) -> Vec<Written> {
        let globals = self.shader.interface.globals.iter().filter(|global| !linked.contains(&global.name));
        globals
            .filter_map(|global| {
                let form = match &global.kind {
                    GlobalKind::StorageTexture { dimension, format, access } if *access != Access::Read => {
                        Form::Texture { format, array: *dimension == Dimension::D2Array }
                    }
                    GlobalKind::Storage { writable: true, layout } => Form::Buffer(layout.clone()),
                    _ => return None,
                };
                Some(Written { name: global.name.clone(), form })
            })
            .collect()
    }

    /// The ports.
    pub fn ports(&self, cx: &UseContext<'_>, written: &[Written]) -> Result<Ports, KindError> {
        let interface = &self.shader.interface;
        let mut ports = Ports::default();
        for &global in &self.entry.globals {
            if let Some(part) = externals::of_global(&interface.globals[global].name) {
                ports.externals = ports.externals.and(part);
            }
        }
        let readable = || self.bindable().filter(|name| !written.iter().any(|w| w.name == *name));
        for port in cx.use_.inputs {
            let globals: Vec<&str> =
                readable().filter(|name| covering(name, cx.use_.inputs) == Some(port)).collect();
            if globals.is_empty() {
                let message =
                    format!("the shader has no global `{port}` and none that begins with `{port}_`");
                let others = readable().collect::<Vec<_>>();
                let help = if others.is_empty() {
                    "it has no global that a link can fill".to_owned()
                } else {
                    format!("it has {}", list(others))
                };
                return Err(KindError::input(port, message).help(help));
            }
            ports.inputs.push(self.input(port, &globals, true)?);
        }
        for name in readable().filter(|name| covering(name, cx.use_.inputs).is_none()) {
            ports.inputs.push(self.input(name, &[name], false)?);
        }
        for Group { port, interface, members } in self.groups(cx, written)? {
            let names = list(members.iter().map(|(_, written)| &written.name));
            ports.outputs.push(OutputPort {
                name: port.into(),
                interface: interface.into(),
                doc: format!("Written as {names}."),
            });
        }
        if ports.outputs.is_empty() {
            return Err(KindError::new("the shader writes nothing that another pass could read"));
        }
        Ok(ports)
    }

    /// The resources of the outputs.
    pub fn outputs(
        &self,
        cx: &UseContext<'_>,
        outputs: &OutputContext<'_>,
        written: &[Written],
    ) -> Result<Vec<OutputDesc>, KindError> {
        let like = outputs.inputs.iter().find(|input| input.size().is_some());
        let layers = outputs
            .inputs
            .iter()
            .flat_map(|input| &input.members)
            .find_map(|(_, desc)| desc.texture().filter(|t| t.array));
        let layers = layers.map_or(1, |texture| texture.layers);
        let mut descs = Vec::new();
        for group in self.groups(cx, written)? {
            let said = cx.use_.outputs.get(group.port);
            let size = said
                .and_then(|said| said.size.clone())
                .or_else(|| like.map(|input| Extent::like(&input.name)));
            let size = size.unwrap_or(Extent::FRAME);
            let format = said.and_then(|said| said.format);
            let mut desc = OutputDesc::of(group.port, Vec::new());
            for (member, written) in group.members {
                let resource = match &written.form {
                    Form::Target(ty) => {
                        let format = format.or_else(|| interfaces::format_of(group.interface, member));
                        ResourceDesc::texture_2d(target_format(&written.name, ty, format)?, size.clone())
                    }
                    Form::Texture { format: declared, array } => {
                        let declared = storage_format(&written.name, declared, format)?;
                        if *array {
                            desc = desc.fact("layers", Value::U32(layers));
                            ResourceDesc::texture_2d_array(declared, size.clone(), layers)
                        } else {
                            ResourceDesc::texture_2d(declared, size.clone())
                        }
                    }
                    Form::Buffer(layout) => {
                        let count = said.and_then(|said| said.count).or_else(|| fixed_count(layout));
                        if let Some(count) = count {
                            desc = desc.fact("count", Value::U32(count));
                        }
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
            descs.push(desc);
        }
        Ok(descs)
    }

    /// The variant of the shader for a scene: options that are named as its traits have their values.
    pub fn variant(&self, mut request: Request, cx: &RecordContext<'_>) -> Request {
        for option in &self.shader.outline().options {
            let value =
                cx.traits.0.get(&option.name.to_lowercase()).and_then(|value| Define::try_from(value).ok());
            let fits =
                |value: &Define| std::mem::discriminant(value) == std::mem::discriminant(&option.default);
            if let Some(value) = value.filter(fits) {
                request.defines.insert(option.name.clone(), value);
            }
        }
        request
    }

    /// `port` or `port.member` of each target that is written, in order.
    pub fn targets(&self, cx: &UseContext<'_>, written: &[Written]) -> Result<Vec<String>, KindError> {
        let groups = self.groups(cx, written)?;
        let resource = |one: &Written| {
            groups.iter().find_map(|group| {
                let (member, _) = group.members.iter().find(|(_, w)| w.name == one.name)?;
                let whole = member.is_empty();
                Some(if whole { group.port.to_owned() } else { format!("{}.{member}", group.port) })
            })
        };
        Ok(written.iter().filter(|one| matches!(one.form, Form::Target(_))).filter_map(resource).collect())
    }

    /// Globals that a port can fill.
    fn bindable(&self) -> impl Iterator<Item = &str> {
        let names = self.shader.interface.globals.iter().map(|global| global.name.as_str());
        names.filter(|name| *name != "settings" && externals::of_global(name).is_none())
    }

    /// The port that fills these globals.
    fn input(&self, port: &str, globals: &[&str], linked: bool) -> Result<InputPort, KindError> {
        let mut interface = "Any";
        for &name in globals {
            let refused = |message: String, help: &str| {
                let error = if linked { KindError::input(port, message) } else { KindError::new(message) };
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
                    return refused(format!("`{name}` is a sampler, which no link brings"), help);
                }
                Some(GlobalKind::Uniform { .. }) => {
                    let help =
                        "numbers are members of `struct Settings`, in `var<uniform> settings: Settings`";
                    return refused(format!("`{name}` is a uniform, which no link brings"), help);
                }
                Some(GlobalKind::AccelerationStructure) => {
                    let message = format!("`{name}` is an acceleration structure, which no link brings");
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

    /// What is written, by output port: `out:` gathers members of an interface under one name.
    fn groups<'a>(&self, cx: &UseContext<'a>, written: &'a [Written]) -> Result<Vec<Group<'a>>, KindError> {
        let mut groups: Vec<Group<'a>> = Vec::new();
        for (port, said) in cx.use_.outputs {
            let of_port = |w: &'a Written| {
                if w.name == **port { Some(("", w)) } else { Some((member_of(&w.name, port)?, w)) }
            };
            let members: Vec<(&str, &Written)> = written.iter().filter_map(of_port).collect();
            if members.is_empty() {
                let message = format!("`out:` speaks of `{port}`, which the shader does not write");
                return Err(KindError::new(message)
                    .help(format!("it writes {}", list(written.iter().map(|w| &w.name)))));
            }
            let sort = sort(members[0].1);
            let interface = said.interface.as_deref().unwrap_or(sort);
            check_members(port, interface, &members)?;
            groups.push(Group { port, interface, members });
        }
        for one in written {
            if !groups.iter().any(|group| group.members.iter().any(|(_, w)| w.name == one.name)) {
                groups.push(Group { port: &one.name, interface: sort(one), members: vec![("", one)] });
            }
        }
        Ok(groups)
    }
}

/// Checks that what is written as a port is what its interface wants.
fn check_members(port: &str, interface: &str, members: &[(&str, &Written)]) -> Result<(), KindError> {
    let Some(known) = interfaces::INTERFACES.iter().find(|known| known.name == interface) else {
        if interface == "Texture" || interface == "Buffer" {
            return match members {
                [("", _)] => Ok(()),
                _ => Err(KindError::new(format!(
                    "the output `{port}` has several members, so `out:` must name its interface"
                ))),
            };
        }
        let all = list(interfaces::INTERFACES.iter().map(|known| known.name));
        return Err(KindError::new(format!(
            "`out:` offers `{port}` as `{interface}`, which is no interface"
        ))
        .help(format!("there are {all}")));
    };
    let global = |member: &str| if member.is_empty() { port.to_owned() } else { format!("{port}_{member}") };
    for (member, written) in members {
        if !known.members.iter().any(|m| m.name == *member) {
            let names = list(known.members.iter().map(|m| global(m.name)));
            return Err(KindError::new(format!("`{}` is no member of a `{interface}`", written.name))
                .help(format!("its members would be written as {names}")));
        }
    }
    for member in known.members.iter().filter(|m| !m.optional) {
        if !members.iter().any(|(name, _)| *name == member.name) {
            return Err(KindError::new(format!(
                "`{port}` lacks a member of a `{interface}`: the shader does not write `{}`",
                global(member.name)
            )));
        }
    }
    Ok(())
}

/// The interface of a single resource.
fn sort(written: &Written) -> &'static str {
    if matches!(written.form, Form::Buffer(_)) { "Buffer" } else { "Texture" }
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

/// The format of a target: as said, or the widest that every GPU can blend for the type of its texels.
fn target_format(name: &str, ty: &str, said: Option<Format>) -> Result<Format, KindError> {
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
        return Err(KindError::new(format!(
            "`{name}` is {ty}, which a texture of {} does not hold",
            format.name()
        )));
    }
    Ok(format)
}

/// The format of a storage texture, which the shader says.
fn storage_format(name: &str, declared: &str, said: Option<Format>) -> Result<Format, KindError> {
    let Some(format) = Format::from_name(declared) else {
        let known = list(Format::ALL.iter().map(|format| format.name()));
        return Err(KindError::new(format!(
            "`{name}` is of the format {declared}, which no texture here has"
        ))
        .help(format!("there are {known}")));
    };
    match said.filter(|said| *said != format) {
        Some(said) => Err(KindError::new(format!(
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
fn bytes(name: &str, port: &str, layout: &TypeLayout, count: Option<u32>) -> Result<u64, KindError> {
    let Some((_, stride)) = layout.element.as_ref().filter(|_| layout.runtime_sized) else {
        return Ok(layout.size.into());
    };
    let count = count.ok_or_else(|| {
        let message = format!("nothing says how many elements `{name}: {}` has", layout.ty);
        KindError::new(message)
            .help(format!("say it in the pipeline: out: {{ \"{port}\": Out(count: 1024) }}"))
    })?;
    Ok(u64::from(layout.size) + u64::from(count.max(1)) * u64::from(*stride))
}

/// `a`, `b`, `c`
fn list(names: impl IntoIterator<Item = impl Display>) -> String {
    let names: Vec<String> = names.into_iter().map(|name| format!("`{name}`")).collect();
    if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
}
