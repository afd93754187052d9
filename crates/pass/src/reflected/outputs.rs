//! What the shaders of a pass write: outputs, and scratch that its entry points share.

use super::scope::{Scope, Wrong};
use super::{Reflected, begins, facts, list, member_of};
use crate::{
    Clear, Content, Extent, Fact, Format, Interface, OutputContext, OutputDesc, OutputPort, PassTypeError,
    ResourceDesc, Usage, UseContext,
};
use shader_library::{
    Access, Attributes, DeclaredPort, Dimension, Entry, FormulaText, GlobalKind, Shader, TypeLayout,
};

/// Something that the shader writes.
#[derive(Clone, Debug)]
pub(super) struct Written {
    /// The global, or the result of a fragment shader.
    pub(super) name: String,
    /// What it is.
    pub(super) form: Form,
    /// Whether only the entry points see it.
    pub(super) scratch: bool,
    /// The size that its attributes say: of a texture as a directive has it, of a buffer its elements.
    size: Option<SaidSize>,
    /// Whether its attributes say that it is cleared first.
    cleared: bool,
    /// Of the result of a fragment shader, the position of its entry point.
    pub(super) entry: Option<usize>,
}

/// The size of scratch as its attributes say it.
#[derive(Clone, Debug)]
struct SaidSize {
    /// The expression.
    text: String,
    /// Where the attributes stand.
    place: String,
}

impl Written {
    /// Adds what another file says of the same.
    pub(super) fn merge(&mut self, other: Written) {
        self.scratch |= other.scratch;
        self.cleared |= other.cleared;
        self.size = self.size.take().or(other.size);
    }
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
    /// What the shader declares of it.
    declared: Option<&'a DeclaredPort>,
    interface: &'a str,
    scratch: bool,
    members: Vec<(&'a str, &'a Written)>,
}

/// How many elements a buffer has: what a pass in WGSL alone tells of one by itself, and reads of others.
pub(super) const COUNT: Fact<u32> = Fact::required("count", "the number of elements");

/// The name of formulas for the most dispatches into which an entry point is split.
const PARTS: &str = "parts";

/// The loop iterations of a function of a module, which its producer says for those who call it in a loop.
pub(super) const ITERATIONS: &str = "iterations";

/// What a fragment shader with one result writes, as a port.
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
            return Err(PassTypeError::new(message).help(match frame_graph::nearest(read, names.clone()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("it writes {}", list(names)),
            }));
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

    /// How the pass treats what was in a resource. Render targets are cleared by the draw; the storage that a user's shader
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

    /// Where a group is declared, for errors.
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

    /// What is written, by output port: `out:` gathers members of an interface under one name. Of several names with
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
            // Of a pass of the tree, Rust describes what neither a directive nor an attribute does.
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
                return Err(PassTypeError::new(message).help(
                    match frame_graph::nearest(&fact, read.iter().copied()) {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => format!("there are {}", list(read)),
                    },
                ));
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

/// The error that a directive gives something that is neither a size nor a fact.
fn unknown_fact(declared: &DeclaredPort, name: &str, interface: Option<&Interface>) -> PassTypeError {
    let argument = declared.arguments.iter().find(|argument| argument.name == name);
    let place = argument.map_or(&declared.place, |argument| &argument.place);
    let interface_name = &declared.interface;
    let message = format!("{place}: `{name}` is no fact of the interface `{interface_name}`, and no size");
    let facts = interface.map_or(&[][..], |interface| interface.facts);
    let known = facts.iter().map(|fact| fact.name).chain(["count", "size", "layers"]);
    PassTypeError::new(message).help(match frame_graph::nearest(name, known.clone()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("there are {}", list(known)),
    })
}

/// Checks that what is linked to an input has the members and facts that it is declared `with`, and not the members that
/// it is declared `without`.
fn check_members_of_input(
    declared: &DeclaredPort,
    interfaces: &[Interface],
    outputs: &OutputContext<'_>,
) -> Result<(), PassTypeError> {
    let name = &declared.name;
    let Some(input) = outputs.input(name) else { return Ok(()) };
    let interface = interfaces.iter().find(|known| known.name == declared.interface);
    let is_fact = |name: &str| interface.is_some_and(|interface| interface.fact(name).is_some());
    let (facts, members): (Vec<&String>, Vec<&String>) = declared.with.iter().partition(|name| is_fact(name));
    if let Some(fact) = facts.into_iter().find(|fact| input.facts.get(fact).is_none()) {
        return Err(PassTypeError::no_fact(name, fact).help(&*declared.doc));
    }
    let refused = |message, help| Err(PassTypeError::input(name, message).help(help));
    if let Some(member) = members.into_iter().find(|member| input.member(member).is_none()) {
        let message = format!("what is linked to `{name}` lacks the member `{member}`");
        return refused(message, format!("link a pass that gives `{member}`, or take this pass out"));
    }
    if let Some(member) = declared.without.iter().find(|member| input.member(member).is_some()) {
        let message = format!("what is linked to `{name}` has the member `{member}` already");
        return refused(
            message,
            "let one such pass stand between what makes it and what reads it".to_owned(),
        );
    }
    Ok(())
}

/// Checks that an input that is declared `like` another has its size, or as many elements.
fn check_like(declared: &DeclaredPort, outputs: &OutputContext<'_>) -> Result<(), PassTypeError> {
    let Some(other) = &declared.like else { return Ok(()) };
    let (Some(input), Some(like)) = (outputs.input(&declared.name), outputs.input(other)) else {
        return Ok(());
    };
    let shape = |input: &frame_graph::port::InputDesc| {
        let textures = input.members.iter().filter_map(|(_, desc)| desc.texture());
        // Some members have a texel for a block of those of others.
        let texture = textures.max_by_key(|texture| texture.size).map(|texture| {
            let layers = if texture.array { format!("×{}", texture.layers) } else { String::new() };
            format!("{}×{}{layers}", texture.size.0, texture.size.1)
        });
        texture.or_else(|| COUNT.of(&input.facts).map(|count| format!("{count} elements")))
    };
    match (shape(input), shape(like)) {
        (Some(found), Some(expected)) if found != expected => {
            let (name, verb) = (&declared.name, if found.ends_with("elements") { "has" } else { "is" });
            Err(PassTypeError::input(
                name,
                format!("`{name}` {verb} {found}, but `{other}` {verb} {expected}"),
            ))
        }
        _ => Ok(()),
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
