//! Outputs, and scratch that the entry points of a pass share.

use super::checks::{check_like, check_members, check_members_of_input, unknown_fact};
use super::scope::{Scope, Wrong};
use super::written::{Form, Written, fixed_count, sort};
use super::{Reflected, begins, facts, instead, list, member_of};
use crate::{
    Clear, Extent, Fact, Format, Interface, OutputContext, OutputDesc, OutputPort, PassTypeError,
    ResourceDesc, Usage, UseContext,
};
use shader_library::{DeclaredPort, FormulaText, GlobalKind, TypeLayout};

/// An output port, with the member that each written thing is.
struct Group<'a> {
    port: &'a str,
    /// Its directive.
    declared: Option<&'a DeclaredPort>,
    interface: &'a str,
    scratch: bool,
    members: Vec<(&'a str, &'a Written)>,
}

/// The number of elements of a buffer.
pub(super) const COUNT: Fact<u32> = Fact::required("count", "the number of elements");

/// The name of formulas for the most dispatches into which an entry point is split.
const PARTS: &str = "parts";

/// The loop iterations of a function of a module, which its producer says for those who call it in a loop.
pub(super) const ITERATIONS: &str = "iterations";

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
                doc: group.declared.map_or_else(
                    || {
                        format!(
                            "Written as {}.",
                            list(group.members.iter().map(|(_, written)| &written.name))
                        )
                    },
                    |declared| declared.doc.clone(),
                ),
            })
            .collect();
        if ports.is_empty() && self.is_users() {
            return Err(PassTypeError::new("the shader writes nothing that another pass could read"));
        }
        Ok(ports)
    }

    /// Returns the resources of the outputs, and of scratch; `values` are names that formulas have beside their own.
    ///
    /// # Errors
    /// Formats that do not fit, and buffers whose number of elements nothing says.
    pub(super) fn outputs(
        &self,
        cx: &UseContext<'_>,
        outputs: &OutputContext<'_>,
        values: &[(&str, crate::Value)],
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        for input in &self.outline.inputs {
            check_members_of_input(input, cx.interfaces, outputs)?;
            check_like(input, outputs)?;
        }
        let declared = self.outline.inputs.iter().filter_map(|input| outputs.input(&input.name));
        let like = declared.chain(outputs.inputs).find(|input| input.size().is_some());
        let like = like.map_or(Extent::FRAME, |input| Extent::like(&input.name));
        let members = outputs.inputs.iter().flat_map(|input| &input.members);
        let layers = members.filter_map(|(_, desc)| desc.texture()).find(|texture| texture.array);
        let layers = layers.map_or(1, |texture| texture.layers);
        let constants = self.files.iter().flat_map(|file| &file.shader.interface.constants);
        let constants = constants.map(|(name, value)| (name.as_str(), value));
        let values = values.iter().map(|(name, value)| (*name, value));
        let names = self.outline.inputs.iter().map(|input| &*input.name);
        let scope = Scope::of_outputs(outputs).with(values.chain(constants), names);
        let parts = crate::Value::U32(self.parts(&scope)?);
        let scope = scope.and(PARTS, &parts);
        let mut descs = Vec::new();
        for group in self.groups(cx)? {
            let said = cx.use_.outputs.get(group.port);
            let argument = |name| group.declared.and_then(|declared| self.argument(&scope, declared, name));
            let size = match (said.and_then(|said| said.size.clone()), argument("size")) {
                (Some(size), _) => size,
                (None, Some(text)) => {
                    extent(&scope, &text?.text).map_err(|wrong| wrong.at(&self.place(&group)))?
                }
                (None, None) => like.clone(),
            };
            let whole = |text: &FormulaText| {
                scope.whole(&text.text).map_err(|wrong| wrong.at(&format!("{}: ", text.place)))
            };
            let said_layers = argument("layers").transpose()?.map(&whole).transpose()?;
            let layers = said_layers.unwrap_or(layers);
            let said_count = match (said.and_then(|said| said.count), argument("count")) {
                (Some(count), _) => Some(count),
                (None, text) => text.transpose()?.map(&whole).transpose()?,
            };
            let format = said.and_then(|said| said.format);
            let interface = cx.interfaces.iter().find(|known| known.name == group.interface);
            let own_count = |written: &Written, layout| match &written.size {
                Some(said) => scope.whole(&said.text).map(Some).map_err(|wrong| wrong.at(&said.place)),
                None => Ok(said_count.or_else(|| fixed_count(layout))),
            };
            let mut counted = None;
            for (_, written) in &group.members {
                if let Form::Buffer(layout) = &written.form {
                    counted = own_count(written, layout)?.or(counted);
                }
            }
            let mut desc = OutputDesc { scratch: group.scratch, ..OutputDesc::of(group.port, Vec::new()) };
            if let Some(input) = group.declared.and_then(|declared| declared.hands_on.as_ref()) {
                desc = OutputDesc::hand_on(group.port, input);
            }
            let counted = counted.or(said_count);
            desc.facts =
                facts::of_output(interface, group.port, said, group.declared.is_some(), counted, outputs)?;
            if let Some(declared) = group.declared {
                self.add_declared_facts(cx, &scope, declared, interface, outputs, &mut desc.facts)?;
            }
            for (member, written) in &group.members {
                let resource = match &written.form {
                    Form::Target(ty) => {
                        let format = format.or_else(|| format_of(interface?, member));
                        let (format, size) = (target_format(&written.name, ty, format)?, size.clone());
                        match said_layers {
                            Some(layers) => ResourceDesc::texture_2d_array(format, size, layers),
                            None => ResourceDesc::texture_2d(format, size),
                        }
                    }
                    Form::Texture { format: declared, array } => {
                        let declared = storage_format(&written.name, declared, format)?;
                        let size = match &written.size {
                            Some(said) => {
                                extent(&scope, &said.text).map_err(|wrong| wrong.at(&said.place))?
                            }
                            None => size.clone(),
                        };
                        if *array {
                            ResourceDesc::texture_2d_array(declared, size, layers)
                        } else {
                            ResourceDesc::texture_2d(declared, size)
                        }
                    }
                    Form::Buffer(layout) => {
                        let count = own_count(written, layout)?.or_else(|| COUNT.of(&desc.facts));
                        ResourceDesc::buffer(self.bytes(&written.name, group.port, layout, count)?)
                    }
                };
                let usage = self.usage(&group, member, written, outputs);
                desc.members.push(((*member).into(), resource, usage));
            }
            facts::check_required(interface, group.port, &desc.facts)?;
            descs.push(desc);
        }
        Ok(descs)
    }

    /// Returns how the pass treats the old content of a resource. Render targets are cleared by the draw; the storage that a user's shader
    /// writes may be written partially, and is cleared first.
    fn usage(&self, group: &Group<'_>, member: &str, written: &Written, cx: &OutputContext<'_>) -> Usage {
        let continued = group.declared.and_then(|declared| declared.continues.as_ref());
        if let Some(input) = continued.filter(|input| cx.input(input).is_some()) {
            return Usage::Continue { input: input.clone(), member: member.into() };
        }
        let cleared = written.cleared || group.declared.is_some_and(|declared| declared.cleared);
        let partial = self.is_users() && !matches!(written.form, Form::Target(_));
        if cleared || partial { Usage::ClearFirst(Clear::Zero) } else { Usage::Overwrites }
    }

    /// The expression that a directive gives for a size or a fact: the first whose condition holds.
    fn argument<'d>(
        &self,
        scope: &Scope<'_>,
        declared: &'d DeclaredPort,
        name: &str,
    ) -> Option<Result<&'d FormulaText, PassTypeError>> {
        declared.arguments.iter().filter(|argument| argument.name == name).find_map(|argument| {
            let Some(when) = &argument.when else { return Some(Ok(&argument.value)) };
            match scope.value(&when.text) {
                Ok(crate::Value::Bool(true)) => Some(Ok(&argument.value)),
                Ok(crate::Value::Bool(false)) => None,
                Ok(other) => {
                    let message = format!("{}: `{}` is {other}, not true or false", when.place, when.text);
                    Some(Err(PassTypeError::new(message)))
                }
                Err(wrong) => Some(Err(wrong.at(&format!("{}: ", when.place)))),
            }
        })
    }

    /// Adds the facts that a directive gives, and the module.
    fn add_declared_facts(
        &self,
        cx: &UseContext<'_>,
        scope: &Scope<'_>,
        declared: &DeclaredPort,
        interface: Option<&Interface>,
        outputs: &OutputContext<'_>,
        facts: &mut crate::Facts,
    ) -> Result<(), PassTypeError> {
        let mut of_module = Vec::new();
        let mut names: Vec<&str> = declared.arguments.iter().map(|argument| &*argument.name).collect();
        names.dedup();
        for name in names {
            let fact = interface.and_then(|interface| interface.fact(name));
            if fact.is_none() && matches!(name, "count" | "size" | "layers") {
                continue;
            }
            if fact.is_none() && declared.module.is_none() {
                return Err(unknown_fact(declared, name, interface));
            }
            let Some(text) = self.argument(scope, declared, name).transpose()? else { continue };
            let place = format!("{}: ", text.place);
            // `FORMULA?`: left out where an input lacks a fact.
            let (formula, may_lack) = match text.text.strip_suffix('?') {
                Some(formula) => (formula, true),
                None => (&*text.text, false),
            };
            let value = match scope.value(formula) {
                Ok(value) => value,
                Err(wrong) if wrong.absent.is_some() && may_lack => continue,
                Err(wrong) => return Err(wrong.at(&place)),
            };
            match fact {
                Some(fact) => {
                    let converted = value.clone().convert(fact.ty).ok_or_else(|| {
                        let wanted = fact.ty.with_article();
                        PassTypeError::new(format!(
                            "{place}the fact `{name}` is {wanted}; `{}` is {value}",
                            text.text
                        ))
                    })?;
                    facts.insert(name, converted);
                }
                None => of_module.push((name.to_owned(), value, place)),
            }
        }
        if let Some(name) = &declared.module {
            facts.set_module(self.module(cx, name, declared, of_module, outputs)?);
        }
        Ok(())
    }

    /// The place where a group is declared, for errors.
    fn place(&self, group: &Group<'_>) -> String {
        group.declared.map_or_else(String::new, |declared| format!("{}: ", declared.place))
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

    /// Groups what is written by output port: `out:` gathers members of an interface under one name. Of several names with
    /// which that of a global begins, the longest has it.
    fn groups<'a>(&'a self, cx: &UseContext<'a>) -> Result<Vec<Group<'a>>, PassTypeError> {
        let written = &self.written;
        let mut groups: Vec<Group<'a>> = Vec::new();
        for declared in &self.outline.outputs {
            groups.push(self.declared_group(cx, declared)?);
        }
        let is_declared = |port: &String| self.outline.outputs.iter().any(|declared| declared.name == *port);
        for (port, said) in cx.use_.outputs.iter().filter(|(port, _)| !is_declared(port)) {
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
            groups.push(Group { port, declared: None, interface, scratch, members });
        }
        for one in written {
            // Rust describes what neither a directive nor an attribute of a pass of the tree does.
            if !self.is_users() && !one.scratch {
                continue;
            }
            if !groups.iter().any(|group| group.members.iter().any(|(_, w)| w.name == one.name)) {
                let (scratch, members) = (one.scratch, vec![("", one)]);
                groups.push(Group {
                    port: &one.name,
                    declared: None,
                    interface: sort(one),
                    scratch,
                    members,
                });
            }
        }
        Ok(groups)
    }

    /// The group of an output that the shader declares.
    fn declared_group<'a>(
        &'a self,
        cx: &UseContext<'_>,
        declared: &'a DeclaredPort,
    ) -> Result<Group<'a>, PassTypeError> {
        let port = declared.name.as_str();
        let longer = |w: &Written| {
            let others = self.outline.outputs.iter().chain(&self.outline.inputs);
            others.map(|other| &*other.name).any(|other| other.len() > port.len() && begins(&w.name, other))
        };
        let of_port = |w: &'a Written| {
            let member = if w.name == port { "" } else { member_of(&w.name, port)? };
            (!w.scratch && !longer(w)).then_some((member, w))
        };
        let members: Vec<(&str, &Written)> = self.written.iter().filter_map(of_port).collect();
        let (interface, scratch) = (declared.interface.as_str(), false);
        if declared.hands_on.is_none() {
            let checked = check_members(cx.interfaces, port, interface, &members);
            checked.map_err(|error| PassTypeError {
                message: format!("{}: {}", declared.place, error.message),
                ..error
            })?;
        }
        Ok(Group { port, declared: Some(declared), interface, scratch, members })
    }

    /// The module of an output: its options have the values of settings, of traits and of what ports are connected, or else
    /// those of the module of the input that is handed on.
    fn module(
        &self,
        cx: &UseContext<'_>,
        name: &str,
        declared: &DeclaredPort,
        facts: Vec<(String, crate::Value, String)>,
        outputs: &OutputContext<'_>,
    ) -> Result<crate::Module, PassTypeError> {
        let folder = self.main.folder.as_deref().unwrap_or_default();
        let mut module = crate::Module::new(super::options::module_path(cx.shaders, folder, name));
        let outline = cx.shaders.outline(&crate::request(&module.path, &[]));
        let outline =
            outline.map_err(|errors| PassTypeError::new(format!("{}: {errors}", declared.place)))?;
        let handed = declared.hands_on.as_ref().and_then(|input| outputs.input(input)?.facts.module());
        super::with_known(outputs, |known| {
            for option in &outline.options {
                let handed = handed.and_then(|handed| handed.options.get(&option.name));
                let value = known.value(option, &self.outline).map(|define| define.to_value());
                if let Some(value) = value.or_else(|| handed.cloned()) {
                    module.options.insert(option.name.clone(), value);
                }
            }
        });
        let shader = cx.shaders.load(&crate::request_of_module(&module));
        let shader = shader.map_err(|errors| PassTypeError::new(format!("{}: {errors}", declared.place)))?;
        let uniforms = shader.interface.globals.iter().filter_map(|global| match &global.kind {
            GlobalKind::Uniform { layout } if global.name.ends_with("_facts") => {
                shader.interface.layout(&layout.ty)
            }
            _ => None,
        });
        let read: Vec<&str> =
            uniforms.flat_map(|layout| layout.members.iter().map(|member| &*member.name)).collect();
        for (fact, value, place) in facts {
            if fact != ITERATIONS && !read.contains(&&*fact) {
                let message = format!(
                    "{place}`{fact}` is neither a fact of the interface `{}` nor a member that {} reads",
                    declared.interface, module.path
                );
                return Err(PassTypeError::new(message).help(instead(&fact, "there are", read)));
            }
            module.facts.insert(fact, value);
        }
        Ok(module)
    }

    /// Bytes of a buffer of `count` elements.
    fn bytes(
        &self,
        name: &str,
        port: &str,
        layout: &TypeLayout,
        count: Option<u32>,
    ) -> Result<u64, PassTypeError> {
        let Some((_, stride)) = layout.element.as_ref().filter(|_| layout.runtime_sized) else {
            return Ok(layout.size.into());
        };
        let count = count.ok_or_else(|| {
            let message = format!("nothing says how many elements `{name}: {}` has", layout.ty);
            PassTypeError::new(message).help(if self.is_users() {
                format!("say it in the pipeline: out: {{ \"{port}\": Out(count: 1024) }}")
            } else {
                format!("say it: `#output {port}: …(count: settings.count)`, or `[scratch, count: settings.count]`")
            })
        })?;
        Ok(u64::from(layout.size) + u64::from(count.max(1)) * u64::from(*stride))
    }
}

/// The size that a directive says: `like(view)`, `like(view) / 2`, `frame`, `(width, height)`, or the side of a square.
fn extent(scope: &Scope<'_>, text: &str) -> Result<Extent, Wrong> {
    let text = text.trim();
    let (base, rest) = match text.strip_prefix("like(").and_then(|rest| rest.split_once(')')) {
        Some((input, rest)) => (Some(input.trim()), rest),
        None => match text.strip_prefix("frame").filter(|rest| !rest.starts_with('.')) {
            Some(rest) => (None, rest),
            None => {
                let sides = text.strip_prefix('(').and_then(|text| text.strip_suffix(')')?.split_once(','));
                let (width, height) = sides.unwrap_or((text, text));
                return Ok(Extent::Fixed(scope.whole(width)?, scope.whole(height)?));
            }
        },
    };
    let rest = rest.trim();
    let (num, den) = match rest.split_at_checked(1) {
        Some(("*", factor)) => (scope.whole(factor)?, 1),
        Some(("/", divisor)) => (1, scope.whole(divisor)?.max(1)),
        _ => (1, 1),
    };
    Ok(match base {
        Some(input) => Extent::Like { input: input.to_owned(), num, den },
        None => Extent::Frame { num, den },
    })
}

/// The format in which the passes of the tree write a texture of an interface; `None` where the member is a buffer or
/// there is none of that name.
fn format_of(interface: &Interface, member: &str) -> Option<Format> {
    interface.member(member)?.content.format()
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
