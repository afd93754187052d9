//! The steps of a shader of a user's: a dispatch or a draw for each of its entry points.

use super::outputs::{COUNT, Form};
use super::{Reflected, UserShader, list, member_of, options};
use crate::{
    Compute, Draw, PassTypeError, PortDesc, Ports, Raster, RecordContext, Recording, ResourceDesc, Settings,
    Step, Target, Threads, Value,
};
use frame_graph::nearest;
use shader_library::{Amount, Entry, EntryAttributes, GlobalKind, Stage, ThreadCount};

/// The most steps that one entry point makes.
const MAX_REPEATS: u32 = 65_536;

/// The member of `settings` that says how often an entry point with `[repeat: …]` has been run before; 0 for others.
const ROUND: &str = "round";

impl Reflected {
    fn said(&self, entry: &Entry) -> Option<&EntryAttributes> {
        self.attributes.entries.iter().find(|said| said.name == entry.name)
    }

    /// An error in the attributes of an entry point.
    fn wrong(&self, said: &EntryAttributes, message: String) -> PassTypeError {
        let place =
            self.shader.place(said.place.clone()).map_or_else(String::new, |place| format!("{place}: "));
        PassTypeError::new(format!("{place}`{}`: {message}", said.name))
    }

    /// Checks that what attributes name is there.
    pub(super) fn check_steps(&self, ports: &Ports, settings: &Settings) -> Result<(), PassTypeError> {
        for entry in &self.entries {
            self.check_aliases(entry)?;
            let Some(said) = self.said(entry) else { continue };
            if entry.stage != Stage::Compute && said.threads.is_some() {
                return Err(self
                    .wrong(said, "`threads` is of compute entry points; a draw covers its targets".into()));
            }
            if entry.stage == Stage::Compute && said.scratch {
                return Err(
                    self.wrong(said, "`scratch` is of globals, and of results of fragment shaders".into())
                );
            }
            if let Some(ThreadCount::Texels(name) | ThreadCount::Elements(name)) = &said.threads {
                let inputs = ports.inputs.iter().map(|input| &*input.name);
                let outputs = ports.outputs.iter().map(|output| &*output.name);
                let scratch =
                    self.written.iter().filter(|written| written.scratch).map(|written| &*written.name);
                let known: Vec<&str> = inputs.chain(outputs).chain(scratch).collect();
                if !known.iter().any(|port| is_of(port, name)) {
                    let error = self.wrong(said, format!("there is no input, output or scratch `{name}`"));
                    return Err(error.help(match nearest(name, known.iter().copied()) {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => format!("there are {}", list(known)),
                    }));
                }
            }
            let threads = match &said.threads {
                Some(ThreadCount::Row(amount)) => std::slice::from_ref(amount),
                Some(ThreadCount::Grid(amounts)) => amounts,
                _ => &[],
            };
            for amount in threads.iter().chain(&said.repeat) {
                self.amount(said, amount, settings)?;
            }
        }
        Ok(())
    }

    /// Checks that an entry point does not read what it writes under another name.
    fn check_aliases(&self, entry: &Entry) -> Result<(), PassTypeError> {
        let uses = |name: &str| {
            entry.globals.iter().any(|&global| self.shader.interface.globals[global].name == name)
        };
        for said in &self.attributes.globals {
            if let Some(read) = &said.reads
                && uses(&said.name)
                && uses(read)
            {
                let message =
                    format!("`{}` reads `{}`, which it writes itself as `{read}`", entry.name, said.name);
                return Err(
                    PassTypeError::new(message).help("let an entry point before it write what it reads")
                );
            }
        }
        Ok(())
    }

    /// The number that an attribute gives.
    fn amount(
        &self,
        said: &EntryAttributes,
        amount: &Amount,
        settings: &Settings,
    ) -> Result<u32, PassTypeError> {
        let name = match amount {
            Amount::Number(number) => return Ok(*number),
            Amount::Setting(name) => name,
        };
        match settings.0.get(name) {
            Some(Value::U32(number)) => Ok(*number),
            Some(other) => {
                Err(self.wrong(said, format!("`{name}` is {}, not a u32", other.ty().with_article())))
            }
            None => {
                let error = self.wrong(said, format!("there is no setting `{name}`"));
                Err(error.help(match nearest(name, settings.0.keys().map(String::as_str)) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => format!("there are {}", list(settings.0.keys())),
                }))
            }
        }
    }

    /// Returns the steps: the entry points in order, each as often as it says.
    ///
    /// # Errors
    /// Thread counts that nothing gives.
    pub(super) fn record(
        &self,
        cx: &RecordContext<'_>,
        user: &UserShader<'_>,
    ) -> Result<Recording, PassTypeError> {
        let use_cx = cx.use_context();
        // First what the use says, then what the modules of producers add.
        let request = options::select(cx.shaders, cx.with_modules(user.request.clone()), cx.settings);
        let shader = options::select_for_scene(cx.shaders, request, cx.traits);
        let mut recording = Recording::default();
        for (index, entry) in self.entries.iter().enumerate() {
            let said = self.said(entry);
            let repeat = said.and_then(|said| Some((said, said.repeat.as_ref()?)));
            let rounds = match repeat {
                Some((said, amount)) => match self.amount(said, amount, cx.settings)? {
                    rounds if rounds > MAX_REPEATS => {
                        return Err(self.wrong(said, format!("{rounds} repeats are more than {MAX_REPEATS}")));
                    }
                    rounds => rounds,
                },
                None => 1,
            };
            let bind: Vec<(String, String)> = self
                .attributes
                .globals
                .iter()
                .filter_map(|global| Some((global.name.clone(), global.reads.clone()?)))
                .collect();
            for round in 0..rounds {
                let is_setting = repeat.is_none() && cx.settings.get(ROUND).is_some();
                let values =
                    if is_setting { Vec::new() } else { vec![(ROUND.to_owned(), Value::U32(round))] };
                recording.steps.push(match entry.stage {
                    Stage::Compute => Step::Compute(Compute {
                        bind: bind.clone(),
                        values,
                        ..Compute::new(shader.clone(), &entry.name, self.threads(cx, entry)?)
                    }),
                    _ => Step::Raster(Raster {
                        shader: shader.clone(),
                        vertex: "fullscreen".into(),
                        fragment: Some(entry.name.clone()),
                        targets: self
                            .targets(&use_cx, index)?
                            .iter()
                            .map(|name| Target::clear(name))
                            .collect(),
                        depth: None,
                        draw: Draw::Fullscreen,
                        values,
                        bind: bind.clone(),
                        windows: Vec::new(),
                    }),
                });
            }
        }
        Ok(recording)
    }

    /// How many threads an entry point is dispatched with.
    fn threads(&self, cx: &RecordContext<'_>, entry: &Entry) -> Result<Threads, PassTypeError> {
        let said = self.said(entry).and_then(|said| Some((said, said.threads.as_ref()?)));
        let Some((said, threads)) = said else { return Ok(self.threads_of_outputs(cx, entry)) };
        let port = |name: &str| {
            let ports = || cx.inputs.iter().chain(cx.outputs);
            let exact = ports().find(|port| port.name == *name);
            exact.or_else(|| ports().find(|port| is_of(&port.name, name)))
        };
        match threads {
            ThreadCount::Row(amount) => self.amount(said, amount, cx.settings).map(Threads::Row),
            ThreadCount::Grid([x, y, z]) => {
                let amount = |amount| self.amount(said, amount, cx.settings);
                Ok(Threads::Grid([amount(x)?, amount(y)?, amount(z)?]))
            }
            ThreadCount::Texels(name) => {
                let texture =
                    port(name).and_then(|port| port.members.iter().find_map(|(_, desc)| desc.texture()));
                let texture =
                    texture.ok_or_else(|| self.wrong(said, format!("`{name}` holds no texture")))?;
                Ok(Threads::Grid([texture.size.0, texture.size.1, texture.layers]))
            }
            ThreadCount::Elements(name) => {
                let count = port(name).and_then(|port| self.elements(port, name));
                count.map(Threads::Row).ok_or_else(|| {
                    self.wrong(
                        said,
                        format!("nothing says how many elements `{name}` has: it has no fact `count`"),
                    )
                })
            }
        }
    }

    /// Elements of a buffer: as its producer says, or as many as its bytes hold.
    fn elements(&self, port: &PortDesc, name: &str) -> Option<u32> {
        if let Some(count) = COUNT.of(&port.facts) {
            return Some(count);
        }
        let (_, global) = self.shader.interface.global(name)?;
        let GlobalKind::Storage { layout, .. } = &global.kind else { return None };
        let (_, stride) = layout.element.as_ref()?;
        let bytes = port.members.iter().find_map(|(_, desc)| match desc {
            ResourceDesc::Buffer(buffer) => Some(buffer.bytes),
            ResourceDesc::Texture(_) => None,
        })?;
        let header = if layout.runtime_sized { u64::from(layout.size) } else { 0 };
        u32::try_from(bytes.saturating_sub(header) / u64::from(*stride)).ok()
    }

    /// A thread for each texel of the first texture that an entry point writes, or else each element of the first
    /// buffer.
    fn threads_of_outputs(&self, cx: &RecordContext<'_>, entry: &Entry) -> Threads {
        let writes = |port: &PortDesc| {
            let of_entry = |name: &str| {
                let written =
                    self.written.iter().any(|w| w.name == name && !matches!(w.form, Form::Target(_)));
                written && entry.globals.iter().any(|&g| self.shader.interface.globals[g].name == name)
            };
            port.members.iter().any(|(member, _)| match &**member {
                "" => of_entry(&port.name),
                member => of_entry(&format!("{}_{member}", port.name)),
            })
        };
        let written: Vec<&PortDesc> = cx.outputs.iter().filter(|port| writes(port)).collect();
        let texture = written.iter().flat_map(|port| &port.members).find_map(|(_, desc)| desc.texture());
        if let Some(texture) = texture {
            return Threads::Grid([texture.size.0, texture.size.1, texture.layers]);
        }
        let count = written.iter().find_map(|port| COUNT.of(&port.facts));
        Threads::Row(count.unwrap_or(1))
    }
}

/// Whether a name is that of a port, or of a global that the port fills.
fn is_of(port: &str, name: &str) -> bool {
    name == port || member_of(name, port).is_some()
}
