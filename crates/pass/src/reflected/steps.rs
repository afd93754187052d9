//! The steps of a pass: a dispatch or a draw for each of the entry points of its main shader.

use super::outputs::COUNT;
use super::scope::Scope;
use super::{Reflected, begins, instead};
use crate::{
    Compute, Draw, PassTypeError, PortDesc, Ports, Raster, RecordContext, Recording, ResourceDesc, Settings,
    Step, Target, Threads, Value, split_count,
};
use shader_library::{Access, Amount, Entry, EntryAttributes, GlobalKind, Stage, ThreadCount};

/// The most steps that one entry point makes.
const MAX_REPEATS: u32 = 65_536;

/// The member of `settings` that says how often an entry point with `[repeat: …]` has been run before; 0 for others.
const ROUND: &str = "round";

impl Reflected {
    fn said(&self, entry: &Entry) -> Option<&EntryAttributes> {
        self.attributes().entries.iter().find(|said| said.name == entry.name)
    }

    /// With what an error in the attributes of an entry point begins.
    fn beginning(&self, said: &EntryAttributes) -> String {
        let place = self.shader().place(said.place.clone());
        let place = place.map_or_else(String::new, |place| format!("{place}: "));
        format!("{place}`{}`: ", said.name)
    }

    /// An error in the attributes of an entry point.
    fn wrong(&self, said: &EntryAttributes, message: String) -> PassTypeError {
        PassTypeError::new(format!("{}{message}", self.beginning(said)))
    }

    /// The number that an attribute gives.
    fn amount(
        &self,
        cx: &RecordContext<'_>,
        said: &EntryAttributes,
        amount: &Amount,
    ) -> Result<u32, PassTypeError> {
        self.whole(&self.scope_of_steps(cx), said, amount)
    }

    fn whole(
        &self,
        scope: &Scope<'_>,
        said: &EntryAttributes,
        Amount(text): &Amount,
    ) -> Result<u32, PassTypeError> {
        scope.whole(text).map_err(|wrong| wrong.at(&self.beginning(said)))
    }

    fn scope_of_steps<'a>(&'a self, cx: &RecordContext<'a>) -> Scope<'a> {
        let interface = &self.shader().interface;
        let constants = interface.constants.iter().map(|(name, value)| (name.as_str(), value));
        let names = self.outline.inputs.iter().map(|input| &*input.name);
        Scope::of_steps(cx).with(constants, names)
    }

    /// Returns the items over which the threads of an entry point loop, and the loop iterations of each; `None` where it
    /// says nothing of them.
    fn items(&self, scope: &Scope<'_>, said: &EntryAttributes) -> Result<Option<(u32, u32)>, PassTypeError> {
        let Some(items) = &said.items else { return Ok(None) };
        let iterations = said.iterations.as_ref().map_or(Ok(1), |each| self.whole(scope, said, each))?;
        Ok(Some((self.whole(scope, said, items)?, iterations)))
    }

    /// Returns the most dispatches into which an entry point is split.
    pub(super) fn parts(&self, scope: &Scope<'_>) -> Result<u32, PassTypeError> {
        self.attributes().entries.iter().try_fold(1, |most, said| {
            let items = self.items(scope, said)?;
            Ok(items.map_or(1, |(items, iterations)| split_count(items, iterations)).max(most))
        })
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
                if !known.iter().any(|port| begins(name, port)) {
                    let error = self.wrong(said, format!("there is no input, output or scratch `{name}`"));
                    return Err(error.help(instead(name, "there are", known)));
                }
            }
            let threads = match &said.threads {
                Some(ThreadCount::Row(amount)) => std::slice::from_ref(amount),
                Some(ThreadCount::Grid(amounts)) => amounts,
                _ => &[],
            };
            let interface = &self.shader().interface;
            let constants = interface.constants.iter().map(|(name, value)| (name.as_str(), value));
            let scope = Scope::of_settings(settings).with(constants, []);
            let amounts = threads.iter().chain(&said.repeat).chain(&said.items).chain(&said.iterations);
            for Amount(text) in amounts {
                scope.check(text).map_err(|wrong| wrong.at(&self.beginning(said)))?;
            }
        }
        Ok(())
    }

    /// Checks that an entry point does not read what it writes under another name.
    fn check_aliases(&self, entry: &Entry) -> Result<(), PassTypeError> {
        let uses = |name: &str| {
            entry.globals.iter().any(|&global| self.shader().interface.globals[global].name == name)
        };
        for said in &self.attributes().globals {
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

    /// Returns the steps: the entry points in order, each as often as it says.
    ///
    /// # Errors
    /// Thread counts that nothing gives.
    pub(super) fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let use_cx = cx.use_context();
        let shader = cx.variant(self.main.request.clone());
        let is_split = self.attributes().entries.iter().any(|said| said.items.is_some());
        let mut recording = Recording::default();
        for (index, entry) in self.entries.iter().enumerate() {
            let said = self.said(entry);
            let repeat = said.and_then(|said| Some((said, said.repeat.as_ref()?)));
            let rounds = match repeat {
                Some((said, amount)) => match self.amount(cx, said, amount)? {
                    rounds if rounds > MAX_REPEATS => {
                        return Err(self.wrong(said, format!("{rounds} repeats are more than {MAX_REPEATS}")));
                    }
                    rounds => rounds,
                },
                None => 1,
            };
            let bind: Vec<(String, String)> = self
                .attributes()
                .globals
                .iter()
                .filter_map(|global| Some((global.name.clone(), global.reads.clone()?)))
                .collect();
            for round in 0..rounds {
                let is_setting = repeat.is_none() && cx.settings.get(ROUND).is_some();
                let values =
                    if is_setting { Vec::new() } else { vec![(ROUND.to_owned(), Value::U32(round))] };
                if entry.stage == Stage::Compute {
                    let step = Compute {
                        bind: bind.clone(),
                        values,
                        ..Compute::new(shader.clone(), &entry.name, self.threads(cx, entry)?)
                    };
                    let items = said.map_or(Ok(None), |said| self.items(&self.scope_of_steps(cx), said))?;
                    recording = match items {
                        Some((items, iterations)) => recording.then_all(step.split(items, iterations)),
                        // The members of `settings` that say which items a dispatch takes are there for all of them.
                        None if is_split => recording.then_all(step.split(0, 1)),
                        None => recording.then(step),
                    };
                } else {
                    let targets = self.targets(&use_cx, index)?;
                    let targets = targets.iter().map(|name| Target::clear(name)).collect();
                    let draw =
                        Raster::new(shader.clone(), "fullscreen", &entry.name, targets, Draw::Fullscreen);
                    recording.steps.push(Step::Raster(Raster { values, bind: bind.clone(), ..draw }));
                }
            }
        }
        Ok(recording)
    }

    /// Returns the number of threads of an entry point.
    fn threads(&self, cx: &RecordContext<'_>, entry: &Entry) -> Result<Threads, PassTypeError> {
        let said = self.said(entry).and_then(|said| Some((said, said.threads.as_ref()?)));
        let Some((said, threads)) = said else { return Ok(self.threads_of_outputs(cx, entry)) };
        let port = |name: &str| {
            let ports = || cx.inputs.iter().chain(cx.outputs);
            let exact = ports().find(|port| port.name == *name);
            exact.or_else(|| ports().find(|port| begins(name, &port.name)))
        };
        match threads {
            ThreadCount::Row(amount) => Ok(Threads::Row(self.amount(cx, said, amount)?.max(1))),
            ThreadCount::Grid([x, y, z]) => {
                let amount = |amount| self.amount(cx, said, amount).map(|count| count.max(1));
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
                count.map(|count| Threads::Row(count.max(1))).ok_or_else(|| {
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
        let (_, global) = self.shader().interface.global(name)?;
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
                let mut globals =
                    entry.globals.iter().map(|&global| &self.shader().interface.globals[global]);
                // Another file of the pass may write what this entry point reads.
                globals.any(|global| {
                    global.name == name
                        && match &global.kind {
                            GlobalKind::StorageTexture { access, .. } => *access != Access::Read,
                            GlobalKind::Storage { writable, .. } => *writable,
                            _ => false,
                        }
                })
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
        Threads::Row(count.unwrap_or(1).max(1))
    }
}
